//! Interrupt positioning: a move that takes the place of a motion under way when a signal rises.

use super::Drive;
use super::course::MoveRows;
use crate::behaviour::Phase;
use crate::event::Ignored;
use crate::time::{Duration, Instant};
use crate::vocabulary::{Input, InterruptRule, Threshold};

/// What has become of the last interrupt positioning.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Interrupt {
    stage: InterruptState,
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

impl Drive {
    /// Starts interrupt positioning.
    ///
    /// # Errors
    /// Why not: as of [`Self::may_interrupt`], or the axis can't go that way.
    pub(super) fn start_interrupt(&mut self) -> Result<(), Ignored> {
        self.settle_interrupt();
        self.may_interrupt()?;
        self.go_to(MoveRows::Interrupt, false, true)?;
        self.interrupt.stage = InterruptState::Active;
        Ok(())
    }

    /// May interrupt positioning start right now?
    ///
    /// # Errors
    /// Why not: a row or a signal forbids it, it is locked, one is under way, or the axis can't start.
    pub(super) fn may_interrupt(&self) -> Result<(), Ignored> {
        let interrupt = self.model.wiring.axis.interrupt.as_ref().ok_or(Ignored::NoMeaning)?;
        match self.interrupt_rule().ok_or(Ignored::NoMeaning)? {
            InterruptRule::Off => {
                let row = interrupt.rule.row().ok_or(Ignored::NoMeaning)?;
                return Err(Ignored::Starter { row, value: self.bank.value(&self.model, row) });
            }
            InterruptRule::Locks if self.interrupt.locked => return Err(Ignored::Locked),
            InterruptRule::Locks | InterruptRule::Free => {}
        }
        match () {
            () if self.inputs.has(Input::InterruptInhibit) => Err(Ignored::Inhibited),
            () if self.interrupt.stage == InterruptState::Active => Err(Ignored::Moving),
            () if self.motor.is_homing() => Err(Ignored::Homing),
            () => self.motor.may_move(true),
        }
    }

    /// Sees whether the one under way has come to its end, or was broken off, and whether it is unlocked.
    pub(super) fn settle_interrupt(&mut self) {
        let arrived = self.motor.has_arrived();
        if self.interrupt.stage == InterruptState::Active {
            let done = self.in_position_at(self.now).filter(|at| *at <= self.now);
            let broken = self.motor.phase() != Phase::Moving && !arrived;
            self.interrupt.stage = match done {
                Some(at) => InterruptState::Done { at },
                None if broken => InterruptState::None,
                None => InterruptState::Active,
            };
            if self.interrupt.stage != InterruptState::Active {
                self.lock_interrupt();
            }
        }
        self.interrupt.locked &= !self.inputs.has(Input::InterruptUnlock);
    }

    /// Is there something to unlock: one that has run, or one under way?
    pub(super) fn can_unlock_interrupt(&self) -> bool {
        self.interrupt.locked || self.interrupt.stage == InterruptState::Active
    }

    /// Another motion takes its place.
    pub(super) fn replace_interrupt(&mut self) {
        if std::mem::take(&mut self.interrupt.stage) == InterruptState::Active {
            self.lock_interrupt();
        }
    }

    /// One has run.
    fn lock_interrupt(&mut self) {
        self.interrupt.locked = self.interrupt_rule() == Some(InterruptRule::Locks);
    }

    fn interrupt_rule(&self) -> Option<InterruptRule> {
        let interrupt = self.model.wiring.axis.interrupt.as_ref()?;
        interrupt.rule.get(|row| self.bank.value(&self.model, row))
    }

    /// Is one under way, and has one just come to its end?
    pub(super) fn interrupt_shows(&self, now: Instant) -> (bool, bool) {
        match (self.interrupt.stage, self.interrupt_done_at(now)) {
            (InterruptState::Active, at) if at.is_none_or(|at| at > now) => (true, false),
            (_, Some(at)) => (false, at <= now && now < at + self.interrupt_done_time()),
            (_, None) => (false, false),
        }
    }

    /// When one that has come to its end is told of no longer.
    pub(super) fn interrupt_forgotten_at(&self, now: Instant) -> Option<Instant> {
        Some(self.interrupt_done_at(now)? + self.interrupt_done_time())
    }

    fn interrupt_done_at(&self, now: Instant) -> Option<Instant> {
        match self.interrupt.stage {
            InterruptState::None => None,
            InterruptState::Active => self.in_position_at(now),
            InterruptState::Done { at } => Some(at),
        }
    }

    fn interrupt_done_time(&self) -> Duration {
        let time = self.threshold(Threshold::InterruptDoneTime).unwrap_or(0.0);
        Duration::try_from_secs_f64(time).unwrap_or_default()
    }
}
