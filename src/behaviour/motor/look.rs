//! What an axis shows: where it is behind its command, and what outputs want to know of it.

use super::{Motor, Phase};
use crate::motion::State;
use crate::time::{Duration, Instant};

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
        // The last half of a count takes for ever: what shows as arrived stands.
        let stands = self.lag.settles_at(&self.trajectory, 0.0).is_some_and(|at| at <= now);
        if stands { 0.0 } else { self.feedback(now).speed }
    }

    /// Position and speed as they are, not in whole counts.
    pub fn feedback(&self, now: Instant) -> State {
        self.machine.hold(self.lag.feedback(&self.trajectory, now))
    }

    /// How far the axis is behind its command, in counts.
    pub fn deviation(&self, now: Instant) -> f64 {
        self.trajectory.state(now).position - self.feedback(now).position
    }

    /// Has the last move ended, and has the axis been within `window` counts of its end for `settle`?
    pub fn is_in_position(&self, now: Instant, window: f64, settle: Duration) -> bool {
        let settles = || self.lag.settles_at(&self.trajectory, window);
        let held = || self.machine.hold(self.trajectory.state(now)) != self.trajectory.state(now);
        self.in_position && settles().is_some_and(|at| at + settle <= now) && !held()
    }

    /// The speed that a run or a jog was ordered to have, in counts per second; `None` in any other phase.
    pub fn speed_ordered(&self) -> Option<f64> {
        let by_speed = matches!(self.phase, Phase::Running | Phase::Jogging { .. });
        by_speed.then(|| self.trajectory.last_speed())
    }
}
