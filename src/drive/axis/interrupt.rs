//! Interrupt positioning: a move that takes the place of a motion under way when a signal rises.

use super::settings::TakenSettings;
use crate::behaviour::{Motor, Phase};
use crate::drive::context::DriveContext;
use crate::drive::registers::Registers;
use crate::event::Ignored;
use crate::time::{Duration, Instant};
use crate::vocabulary::{Input, InterruptRule, Threshold};

/// What has become of the last interrupt positioning.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Interrupt {
    state: InterruptState,
    /// No other starts until it is unlocked.
    locked: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum InterruptState {
    /// There was none, or it was broken off, or it is long over.
    #[default]
    None,
    /// It is under way.
    Active,
    /// It came to its end.
    Done {
        /// When the axis was in position.
        at: Instant,
    },
}

impl Interrupt {
    /// It has started.
    pub(super) fn start(&mut self) {
        self.state = InterruptState::Active;
    }

    /// May it start right now?
    ///
    /// # Errors
    /// Why not: a row or a signal forbids it, it is locked, one is under way, or the axis can't start.
    pub(super) fn may_start(&self, cx: DriveContext<'_>, motor: &Motor) -> Result<(), Ignored> {
        let interrupt = cx.model().wiring.axis.interrupt.as_ref().ok_or(Ignored::NoMeaning)?;
        match rule(cx.registers).ok_or(Ignored::NoMeaning)? {
            InterruptRule::Off => {
                let row = interrupt.rule.row().ok_or(Ignored::NoMeaning)?;
                return Err(Ignored::Starter { row, value: cx.registers.value(row) });
            }
            InterruptRule::Locks if self.locked => return Err(Ignored::Locked),
            InterruptRule::Locks | InterruptRule::Free => {}
        }
        match () {
            () if cx.has(Input::InterruptInhibit) => Err(Ignored::Inhibited),
            () if self.state == InterruptState::Active => Err(Ignored::Moving),
            () if motor.is_homing() => Err(Ignored::Homing),
            () => motor.may_move(true),
        }
    }

    /// Sees whether the one under way has come to its end, `in_position_at` then, or was broken off, and whether it is
    /// unlocked.
    pub(super) fn update(
        &mut self,
        cx: DriveContext<'_>,
        motor: &Motor,
        in_position_at: Option<Instant>,
    ) {
        if self.state == InterruptState::Active {
            let done = in_position_at.filter(|at| *at <= cx.now);
            let broken = motor.phase() != Phase::Moving && !motor.has_arrived();
            self.state = match done {
                Some(at) => InterruptState::Done { at },
                None if broken => InterruptState::None,
                None => InterruptState::Active,
            };
            if self.state != InterruptState::Active {
                self.lock(cx.registers);
            }
        }
        self.locked &= !cx.has(Input::InterruptUnlock);
    }

    /// Is there something to unlock: one that has run, or one under way?
    pub(super) fn can_unlock(&self) -> bool {
        self.locked || self.state == InterruptState::Active
    }

    /// Another motion takes its place.
    pub(super) fn replace(&mut self, registers: &Registers) {
        if std::mem::take(&mut self.state) == InterruptState::Active {
            self.lock(registers);
        }
    }

    /// One has run.
    fn lock(&mut self, registers: &Registers) {
        self.locked = rule(registers) == Some(InterruptRule::Locks);
    }

    /// When it came to its end, or will, where the axis is, or will be, `in_position_at` then.
    pub(super) fn done_at(&self, in_position_at: Option<Instant>) -> Option<Instant> {
        match self.state {
            InterruptState::None => None,
            InterruptState::Active => in_position_at,
            InterruptState::Done { at } => Some(at),
        }
    }

    /// Is one under way at `now`, and has one just come to its end, which was, or will be, `done_at` then, and is shown
    /// `shown` long?
    pub(super) fn shows(
        &self,
        now: Instant,
        done_at: Option<Instant>,
        shown: Duration,
    ) -> (bool, bool) {
        match (self.state, done_at) {
            (InterruptState::Active, at) if at.is_none_or(|at| at > now) => (true, false),
            (_, Some(at)) => (false, at <= now && now < at + shown),
            (_, None) => (false, false),
        }
    }
}

/// How long the end of one is shown.
pub(super) fn shown_time(registers: &Registers, taken: &TakenSettings) -> Duration {
    let time = taken.threshold(registers, Threshold::InterruptDoneTime).unwrap_or(0.0);
    Duration::try_from_secs_f64(time).unwrap_or_default()
}

fn rule(registers: &Registers) -> Option<InterruptRule> {
    registers.choose(&registers.model().wiring.axis.interrupt.as_ref()?.rule)
}
