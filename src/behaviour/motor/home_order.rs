//! What a homing goes by: its method, its speeds, and what counts as a limit.

use super::motion_state::Slope;
use crate::behaviour::effect::Replan;
use crate::motion::{Index, Move, State, Trajectory};
use crate::time::{Duration, Instant};
use crate::vocabulary::{IndexRule, LimitRule, LimitSource, Method, OriginStop, Pace};

/// Everything that a homing goes by.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeOrder {
    /// The steps.
    pub method: Method,
    /// Counts per second.
    pub fast: f64,
    /// Counts per second.
    pub slow: f64,
    /// Slope of all changes of speed; a time is that up to `fast`.
    pub accel: Slope,
    /// What a limit on the way means.
    pub limit: LimitRule,
    /// What tells that there is one.
    pub source: LimitSource,
    /// Is the origin refined by an index pulse?
    pub index: IndexRule,
    /// Index marks, where the machine has none of its own.
    pub marks: Index,
    /// How it stands at the origin.
    pub stop: OriginStop,
    /// Counts to go on from the origin.
    pub way: i64,
    /// Counts of pressing that make a collision.
    pub collision: i64,
    /// Most time that it may take.
    pub time_limit: Option<Duration>,
}

impl HomeOrder {
    /// Slope of all changes of speed, counts per second squared.
    pub(super) fn slope(&self) -> f64 {
        self.accel.of(if self.fast > 0.0 { self.fast } else { self.slow })
    }

    /// At a speed, from a state.
    pub(super) fn go(&self, now: Instant, from: State, speed: f64) -> Trajectory {
        Trajectory::to_speed(now, from, speed, self.slope(), self.slope())
    }

    /// To a standstill.
    pub(super) fn brake(&self, now: Instant, from: State) -> Trajectory {
        Trajectory::stop(now, from, self.slope())
    }

    /// From the origin to where it ends.
    pub(super) fn onward(&self, now: Instant, from: State, origin: i64) -> Trajectory {
        let (speed, accel) = (self.fast, self.slope());
        let how = Move { start_speed: 0.0, speed, accel, decel: accel };
        Trajectory::to_position(now, from, origin.saturating_add(self.way), how)
    }

    /// Is there a part of the way that it would never go, because its speed is 0?
    pub(super) fn stands_still(&self) -> bool {
        let paces = |pace| self.method.all_steps().any(|step| step.pace == pace);
        let refines = self.method.index && self.index != IndexRule::None;
        (self.fast == 0.0 && (paces(Pace::Fast) || self.way != 0))
            || (self.slow == 0.0 && (paces(Pace::Slow) || refines))
    }

    /// What is different in `other`.
    pub(super) fn replans(&self, other: &Self) -> impl Iterator<Item = Replan> + use<> {
        let all = [
            (self.fast != other.fast).then_some(Replan::Speed(other.fast)),
            (self.slow != other.slow).then_some(Replan::SlowSpeed(other.slow)),
            (self.accel != other.accel).then(|| Replan::Accel(other.slope())),
            (self.way != other.way).then_some(Replan::HomeOffset(other.way)),
            (self.time_limit != other.time_limit).then_some(Replan::TimeLimit(other.time_limit)),
        ];
        all.into_iter().flatten()
    }
}
