//! What an axis shows: where it is behind its command, and what outputs want to know of it.

use super::{Motor, Phase};
use crate::motion::State;
use crate::time::Instant;

impl Motor {
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

    /// How far the axis is behind its command, in counts.
    pub fn deviation(&self, now: Instant) -> f64 {
        self.trajectory.state(now).position - self.feedback(now).position
    }

    /// When the axis is within `window` counts of the end of its last move for good. That move has ended by
    /// `now`, and nothing holds the axis back.
    pub fn arrives_at(&self, now: Instant, window: f64) -> Option<Instant> {
        let command = self.trajectory.state(now);
        let held = self.machine.hold(command) != command;
        self.settles_at(window).filter(|_| self.arrived && !held)
    }

    fn settles_at(&self, window: f64) -> Option<Instant> {
        self.lag.settles_at(&self.trajectory, window)
    }

    /// The speed that a run or a jog was ordered to have, in counts per second; `None` in any other phase.
    pub fn speed_ordered(&self) -> Option<f64> {
        let by_speed = matches!(self.phase, Phase::Running | Phase::Jogging { .. });
        by_speed.then(|| self.trajectory.last_speed())
    }
}
