//! What is wrong with a device, apart from its line: causes that stand, an axis that is blocked, feedback that is gone,
//! contacts that stick or bounce. They come and go by command and outlast the power.

use super::Drive;
use crate::event::{Change, Trouble};
use crate::time::{Duration, Instant};
use crate::words::{AlarmCause, AlarmCauses, Input, Word};

/// What is wrong with it right now.
#[derive(Debug, Default)]
pub(super) struct Troubles {
    causes: AlarmCauses,
    encoder_lost: bool,
    frozen: bool,
    /// What was seen of the axis last, while nothing new is.
    pub(super) seen: Option<Seen>,
    /// Terminals that stick, bit by bit, and the signals that they keep.
    stuck: u16,
    kept: u16,
    /// Terminals that bounce right now, bit by bit.
    bounced: u16,
    bounces: Vec<Bounce>,
}

/// Position in counts of the machine, and speed in counts per second.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
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

impl Troubles {
    /// When the next edge of a bounce comes.
    pub(super) fn deadline(&self) -> Option<Instant> {
        self.bounces.iter().map(|bounce| bounce.next).min()
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
    pub fn set_trouble(&mut self, now: Instant, trouble: Trouble, on: bool) -> bool {
        self.advance_to(now);
        if let Trouble::Cause(cause) = trouble
            && self.model.wiring.alarm(cause).is_none()
        {
            return false;
        }
        if self.has_trouble(trouble) != on {
            self.changes.push_back(Change::Trouble { trouble, on });
            self.change_trouble(trouble, on);
            self.tell_stages(None);
            self.gather_inputs();
            self.settle();
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
        self.troubles.bounces.retain(|bounce| bounce.bit != bit);
        self.troubles.bounced &= !bit;
        let edges = u32::from(times) * 2;
        self.troubles.bounces.push(Bounce { bit, index, edges, every, next: now });
        self.advance_to(now);
    }

    /// Is the contact on input terminal `index` stuck?
    pub(super) fn is_stuck(&self, index: u8) -> bool {
        self.has_trouble(Trouble::Stuck(index))
    }

    /// Where the axis seems to be, in the machine's coordinate.
    pub(super) fn seen_position(&self) -> i64 {
        self.troubles.seen.map_or_else(|| self.motor.position(self.now), |seen| seen.position)
    }

    /// How fast it seems to go, in counts per second.
    pub(super) fn seen_speed(&self) -> f64 {
        self.troubles.seen.map_or_else(|| self.motor.speed(self.now), |seen| seen.speed)
    }

    /// Causes that stand: no reset clears their alarms.
    pub(super) fn standing_causes(&self) -> AlarmCauses {
        let forced = self.inputs.has(Input::AlarmForce);
        let Troubles { causes, encoder_lost, .. } = self.troubles;
        causes
            .with(AlarmCause::Forced, forced || causes.has(AlarmCause::Forced))
            .with(AlarmCause::Encoder, encoder_lost || causes.has(AlarmCause::Encoder))
    }

    /// Trips again with what stands and has no alarm.
    pub(super) fn uphold_causes(&mut self) {
        let standing = self.standing_causes();
        self.servo.stand(standing);
        if self.servo.alarm().is_none() {
            let causes = AlarmCause::ALL.iter().filter(|cause| standing.has(**cause));
            causes.for_each(|cause| {
                self.trip(*cause);
            });
        }
    }

    /// The next edges of contacts that bounce.
    pub(super) fn bounce(&mut self) {
        let mut told = Vec::new();
        for bounce in self.troubles.bounces.iter_mut().filter(|it| it.next <= self.now) {
            bounce.edges -= 1;
            bounce.next += bounce.every;
            self.troubles.bounced ^= bounce.bit;
            told.push((bounce.bit, bounce.index));
        }
        self.troubles.bounces.retain(|bounce| bounce.edges > 0);
        for (bit, index) in told.iter().filter(|(bit, _)| self.troubles.stuck & bit == 0) {
            let signal = self.terminal_signals() & u32::from(*bit) != 0;
            self.changes.push_back(Change::Terminal { index: *index, signal });
        }
        if !told.is_empty() {
            self.gather_inputs();
        }
    }

    fn has_trouble(&self, trouble: Trouble) -> bool {
        let Troubles { causes, encoder_lost, frozen, stuck, .. } = self.troubles;
        match trouble {
            Trouble::Cause(cause) => causes.has(cause),
            Trouble::Blocked => self.motor.is_blocked(),
            Trouble::EncoderLost => encoder_lost,
            Trouble::Frozen => frozen,
            Trouble::Stuck(index) => stuck >> index & 1 != 0,
        }
    }

    fn suffer(&mut self, cause: AlarmCause, on: bool) {
        if on && self.powered {
            self.trip(cause);
        }
    }

    fn change_trouble(&mut self, trouble: Trouble, on: bool) {
        match trouble {
            Trouble::Cause(cause) => {
                self.troubles.causes = self.troubles.causes.with(cause, on);
                self.suffer(cause, on);
            }
            Trouble::Blocked if on => self.motor.block(self.now),
            Trouble::Blocked => self.motor.free(self.now),
            Trouble::EncoderLost => {
                self.troubles.encoder_lost = on;
                self.suffer(AlarmCause::Encoder, on);
            }
            Trouble::Frozen => self.troubles.frozen = on,
            Trouble::Stuck(index) => {
                let (bit, kept) = (1 << index, self.terminal_signals() as u16);
                let Troubles { stuck, kept: keeps, .. } = &mut self.troubles;
                *stuck = if on { *stuck | bit } else { *stuck & !bit };
                *keeps = *keeps & !bit | kept & bit;
            }
        }
        let blind = self.troubles.encoder_lost || self.troubles.frozen;
        let seen = Seen { position: self.seen_position(), speed: self.seen_speed() };
        self.troubles.seen = blind.then_some(seen);
    }
}
