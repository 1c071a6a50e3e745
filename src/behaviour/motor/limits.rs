//! Limits outside a homing: a switch, or a position that the drive keeps by itself. Into them nothing goes, out
//! of them everything does.

use super::goal::Goal;
use super::{Effect, Motor, Phase};
use crate::event::Ignored;
use crate::motion::Trajectory;
use crate::time::Instant;
use crate::vocabulary::{Input, LimitStop};

impl Motor {
    /// Is the axis at the limit in that direction?
    pub(super) fn is_at_limit(&self, now: Instant, forward: bool) -> bool {
        self.wants.switches.has(limit(forward)) || self.is_beyond_soft_limit(now, forward)
    }

    /// Is it beyond the soft limit in that direction?
    pub(super) fn is_beyond_soft_limit(&self, now: Instant, forward: bool) -> bool {
        self.wants.soft_limits.is_some_and(|[low, high]| {
            let position = self.state(now).position;
            if forward { position > high as f64 } else { position < low as f64 }
        })
    }

    /// May a motion start in the direction of `way`?
    ///
    /// # Errors
    /// There is a limit.
    pub fn may_go(&self, now: Instant, way: f64) -> Result<(), Ignored> {
        match way != 0.0 && self.is_at_limit(now, way > 0.0) {
            true => Err(Ignored::Limit),
            false => Ok(()),
        }
    }

    /// Ends a motion that goes into a limit.
    pub(super) fn obey_limits(&mut self, now: Instant) {
        let free = match self.phase {
            Phase::Moving | Phase::Running | Phase::Jogging { .. } => false,
            Phase::Standing | Phase::Stopping | Phase::Coasting | Phase::Homing => true,
        };
        if free || !self.is_at_limit(now, self.forward) {
            return;
        }
        let soft = !self.wants.switches.has(limit(self.forward));
        self.effects.push_back(Effect::LimitReached { forward: self.forward, soft });
        self.stop_at_limit(now);
    }

    /// Ends a motion as a limit does.
    pub(super) fn stop_at_limit(&mut self, now: Instant) {
        match self.wants.limit_stop {
            LimitStop::Coast => self.run_out(now),
            LimitStop::Quick => {
                self.goal = Goal::None;
                let trajectory = Trajectory::halt(now, self.state(now));
                self.begin(now, trajectory, Phase::Stopping);
            }
            LimitStop::Ramp => {
                let trajectory = self.slow_down(now);
                self.begin(now, trajectory, Phase::Stopping);
            }
        }
    }
}

/// The limit in that direction.
pub(super) fn limit(forward: bool) -> Input {
    if forward { Input::LimitPos } else { Input::LimitNeg }
}
