//! What is wrong with a device, apart from its line: causes that stand, an axis that is blocked, feedback that is gone,
//! contacts that stick or bounce. They come and go by command and outlast the power.

use super::{Drive, Timer};
use crate::event::{Change, DeviceFault};
use crate::time::{Duration, Instant};
use crate::vocabulary::{AlarmCause, AlarmCauses, Input, Named};

/// What is wrong with it right now.
#[derive(Debug, Default)]
pub(super) struct DeviceFaults {
    causes: AlarmCauses,
    encoder_lost: bool,
    frozen: bool,
    /// What was seen of the axis last, while nothing new is.
    pub(super) seen: Option<FrozenFeedback>,
    /// Terminals that stick, bit by bit, and the signals that they keep.
    stuck: u16,
    kept: u16,
    /// Terminals that bounce right now, bit by bit.
    bounced: u16,
    bounces: Vec<Bounce>,
}

/// Position in counts of the machine, and speed in counts per second.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrozenFeedback {
    pub(super) position: i64,
    pub(super) speed: f64,
}

#[derive(Debug)]
struct Bounce {
    bit: u16,
    index: u8,
    edges: u32,
    every: Duration,
    next: Instant,
}

impl DeviceFaults {
    /// When the next edges of bounces come, and on which terminals.
    pub(super) fn timers(&self) -> impl Iterator<Item = (Instant, Timer)> {
        self.bounces.iter().map(|bounce| (bounce.next, Timer::Bounce(bounce.index)))
    }

    /// The signals of input terminals as they get through their contacts.
    pub(super) fn signals(&self, wired: u32) -> u32 {
        let (stuck, kept) = (u32::from(self.stuck), u32::from(self.kept));
        (wired ^ u32::from(self.bounced)) & !stuck | kept & stuck
    }
}

impl Drive {
    /// Something is wrong from `now` on, or no longer.
    ///
    /// Returns whether that can be: a cause needs an alarm of the model.
    pub fn set_device_fault(&mut self, now: Instant, device_fault: DeviceFault, on: bool) -> bool {
        self.advance_to(now);
        if let DeviceFault::Cause(cause) = device_fault
            && self.model.wiring.alarm(cause).is_none()
        {
            return false;
        }
        if self.has_device_fault(device_fault) != on {
            self.changes.push_back(Change::DeviceFault { device_fault, on });
            self.change_device_fault(device_fault, on);
            self.tell_stages(None);
            self.gather_inputs();
            self.update_axis();
            self.explain();
        }
        true
    }

    /// Has the contact on input terminal `index` leave its level and come back so many `times`, each edge
    /// `every` after the one before; both are above 0. One that bounces already begins anew.
    pub fn bounce_terminal(&mut self, now: Instant, index: u8, times: u16, every: Duration) {
        self.advance_to(now);
        self.changes.push_back(Change::Bounces { index, times, every });
        let bit = 1 << index;
        self.device_faults.bounces.retain(|bounce| bounce.bit != bit);
        self.device_faults.bounced &= !bit;
        let edges = u32::from(times) * 2;
        self.device_faults.bounces.push(Bounce { bit, index, edges, every, next: now });
        self.advance_to(now);
    }

    /// Is the contact on input terminal `index` stuck?
    pub(super) fn is_stuck(&self, index: u8) -> bool {
        self.has_device_fault(DeviceFault::Stuck(index))
    }

    /// Where the axis seems to be, in the machine's coordinate.
    pub(super) fn seen_position(&self, now: Instant) -> i64 {
        self.device_faults.seen.map_or_else(|| self.motor.position(now), |seen| seen.position)
    }

    /// How fast it seems to go, in counts per second.
    pub(super) fn seen_speed(&self, now: Instant) -> f64 {
        self.device_faults.seen.map_or_else(|| self.motor.speed(now), |seen| seen.speed)
    }

    /// Causes that stand: no reset clears their alarms.
    pub(super) fn standing_causes(&self) -> AlarmCauses {
        let forced = self.inputs.has(Input::AlarmForce);
        let DeviceFaults { causes, encoder_lost, .. } = self.device_faults;
        causes
            .with(AlarmCause::Forced, forced || causes.has(AlarmCause::Forced))
            .with(AlarmCause::Encoder, encoder_lost || causes.has(AlarmCause::Encoder))
    }

    /// Trips again with what stands and has no alarm.
    pub(super) fn uphold_causes(&mut self) {
        let standing = self.standing_causes();
        self.power_stage.set_active_causes(standing);
        if self.power_stage.alarm().is_none() {
            let causes = AlarmCause::ALL.iter().filter(|cause| standing.has(**cause));
            causes.for_each(|cause| {
                self.trip(*cause);
            });
        }
    }

    /// The next edges of contacts that bounce.
    pub(super) fn bounce(&mut self) {
        let mut told = Vec::new();
        for bounce in self.device_faults.bounces.iter_mut().filter(|it| it.next <= self.now) {
            bounce.edges -= 1;
            bounce.next += bounce.every;
            self.device_faults.bounced ^= bounce.bit;
            told.push((bounce.bit, bounce.index));
        }
        self.device_faults.bounces.retain(|bounce| bounce.edges > 0);
        for (bit, index) in told.iter().filter(|(bit, _)| self.device_faults.stuck & bit == 0) {
            let signal = self.terminal_signals(self.now) & u32::from(*bit) != 0;
            self.changes.push_back(Change::Terminal { index: *index, signal });
        }
        if !told.is_empty() {
            self.gather_inputs();
        }
    }

    fn has_device_fault(&self, device_fault: DeviceFault) -> bool {
        let DeviceFaults { causes, encoder_lost, frozen, stuck, .. } = self.device_faults;
        match device_fault {
            DeviceFault::Cause(cause) => causes.has(cause),
            DeviceFault::Blocked => self.motor.is_blocked(),
            DeviceFault::EncoderLost => encoder_lost,
            DeviceFault::Frozen => frozen,
            DeviceFault::Stuck(index) => stuck >> index & 1 != 0,
        }
    }

    fn suffer(&mut self, cause: AlarmCause, on: bool) {
        if on && self.powered {
            self.trip(cause);
        }
    }

    fn change_device_fault(&mut self, device_fault: DeviceFault, on: bool) {
        match device_fault {
            DeviceFault::Cause(cause) => {
                self.device_faults.causes = self.device_faults.causes.with(cause, on);
                self.suffer(cause, on);
            }
            DeviceFault::Blocked if on => self.motor.block(self.now),
            DeviceFault::Blocked => self.motor.free(self.now),
            DeviceFault::EncoderLost => {
                self.device_faults.encoder_lost = on;
                self.suffer(AlarmCause::Encoder, on);
            }
            DeviceFault::Frozen => self.device_faults.frozen = on,
            DeviceFault::Stuck(index) => {
                let (bit, kept) = (1 << index, self.terminal_signals(self.now) as u16);
                let DeviceFaults { stuck, kept: keeps, .. } = &mut self.device_faults;
                *stuck = if on { *stuck | bit } else { *stuck & !bit };
                *keeps = *keeps & !bit | kept & bit;
            }
        }
        let blind = self.device_faults.encoder_lost || self.device_faults.frozen;
        let seen = FrozenFeedback {
            position: self.seen_position(self.now),
            speed: self.seen_speed(self.now),
        };
        self.device_faults.seen = blind.then_some(seen);
    }
}
