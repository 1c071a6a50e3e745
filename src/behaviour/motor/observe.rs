//! What an axis shows: where it is behind its command, and what outputs want to know of it.

use super::{Motor, Phase};
use crate::motion::State;
use crate::time::Instant;

/// What the drive holds to its command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Control {
    /// The position; at a standstill and in a homing too.
    Position,
    /// The speed, which was ordered to be so many counts per second.
    Speed(f64),
}

impl Motor {
    /// What is controlled; `None` without power, and until an axis that runs out has stopped.
    pub fn control(&self) -> Option<Control> {
        match self.phase {
            _ if !self.wants.power => None,
            Phase::Coasting => None,
            Phase::Standing => Some(Control::Position),
            _ if self.by_speed => Some(Control::Speed(self.trajectory.last_speed())),
            _ => Some(Control::Position),
        }
    }

    /// The last whole count reached, in the machine's coordinate.
    pub fn position(&self, now: Instant) -> i64 {
        let position = self.lag.position(&self.trajectory, now);
        let [low, high] = self.machine.hard_stop.unwrap_or([i64::MIN, i64::MAX]);
        position.clamp(low, high)
    }

    /// Instants after `now` between which what it shows changes in one direction only, if nothing happens to it.
    pub fn marks(&self, now: Instant) -> Vec<Instant> {
        self.lag.marks(&self.trajectory, now)
    }

    /// Counts per second.
    pub fn speed(&self, now: Instant) -> f64 {
        self.whereabouts(now).speed
    }

    /// Position and speed as they are, not in whole counts.
    pub fn feedback(&self, now: Instant) -> State {
        self.machine.hold(self.lag.feedback(&self.trajectory, now))
    }

    /// The same, but that an axis stands which shows as arrived: the last half of a count takes for ever.
    pub(super) fn whereabouts(&self, now: Instant) -> State {
        match self.settles_at(0.0).is_some_and(|at| at <= now) {
            true => self.state(now),
            false => self.feedback(now),
        }
    }

    /// How far the axis is behind its command, in counts. A homing is told where the axis is to be, so its command is
    /// as far ahead as the axis is to be behind at its speed.
    pub fn deviation(&self, now: Instant) -> f64 {
        let feedback = self.feedback(now);
        let behind = self.trajectory.state(now).position - feedback.position;
        match self.gain.filter(|_| self.control() == Some(Control::Position)) {
            Some(gain) if !self.lag.makes_up() => behind + feedback.speed / gain,
            _ => behind,
        }
    }

    /// Counts per second of the command, as far as it is one of positions.
    pub fn command_rate(&self, now: Instant) -> f64 {
        let position = self.control() == Some(Control::Position);
        if position { self.trajectory.state(now).speed } else { 0.0 }
    }

    /// Is it held back from its command?
    pub fn is_held_back(&self, now: Instant) -> bool {
        let command = self.trajectory.state(now);
        self.machine.hold(command) != command
    }

    /// When the axis is within `window` counts of the end of its last move for good. That move has ended by
    /// `now`, and nothing holds the axis back.
    pub fn arrives_at(&self, now: Instant, window: f64) -> Option<Instant> {
        self.rests_at(now, window).filter(|_| self.arrived)
    }

    /// When the axis is within `window` counts of its command for good, which is at rest. Nothing holds it back.
    pub fn rests_at(&self, now: Instant, window: f64) -> Option<Instant> {
        let rests = !self.is_moving() && !self.is_held_back(now);
        self.settles_at(window).filter(|_| rests)
    }

    fn settles_at(&self, window: f64) -> Option<Instant> {
        self.lag.settles_at(&self.trajectory, window)
    }
}
