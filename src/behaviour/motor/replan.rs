//! A motion under way that goes by another setting from now on: it is planned anew, from where the axis is told to be
//! and as fast as it is told to go, and as far behind as it is.

use super::goal::{Goal, Ramp, Slope};
use super::{Motor, Phase};
use crate::behaviour::effect::{Effect, Replan};
use crate::motion::Trajectory;
use crate::time::Instant;

impl Motor {
    /// The move under way goes to `target`, a count of the machine, and as `ramp` says.
    pub fn retune_move(&mut self, now: Instant, target: i64, ramp: Ramp) {
        if self.phase == Phase::Moving {
            self.retune(now, Goal::Position(target, ramp));
            self.advance(now);
        }
    }

    /// The run by order under way goes as `ramp` says.
    pub fn retune_run(&mut self, now: Instant, ramp: Ramp) {
        if self.phase == Phase::Running {
            self.retune(now, Goal::Speed(ramp));
            self.advance(now);
        }
    }

    /// The stop under way slows down like this.
    pub(super) fn retune_stop(&mut self, now: Instant, decel: Slope) {
        if let (Phase::Stopping, Goal::Stop(_, change)) = (self.phase, self.goal) {
            self.retune(now, Goal::Stop(decel, change));
        }
    }

    /// The motion under way comes to `goal` instead, which is of the same kind as the one so far.
    pub(super) fn retune(&mut self, now: Instant, goal: Goal) {
        let before = std::mem::replace(&mut self.goal, goal);
        if before == goal {
            return;
        }
        if self.paused {
            return self.tell_difference(before, goal);
        }
        let from = self.trajectory.state(now);
        let trajectory = match goal {
            Goal::None => return,
            Goal::Speed(ramp) => {
                self.forward = ramp.speed >= 0.0;
                ramp.in_motion(from).keep(now, from)
            }
            Goal::Position(target, ramp) => {
                self.forward = target >= self.commanded(now);
                ramp.in_motion(from).reach(now, from, target)
            }
            Goal::Stop(decel, change) => Trajectory::stop(now, from, decel.of(change)),
        };
        self.go_on(now, trajectory);
        self.tell_difference(before, goal);
    }

    /// Goes on along `trajectory`, which starts where the present one is.
    pub(super) fn go_on(&mut self, now: Instant, trajectory: Trajectory) {
        self.lag = self.lag.with_deviation(self.lag.deviation(&self.trajectory, now));
        self.trajectory = trajectory;
        self.look_ahead(now);
    }

    fn tell_difference(&mut self, before: Goal, goal: Goal) {
        let mut tell = |what| self.effects.push_back(Effect::Replanned(what));
        if let (Goal::Position(from, _), Goal::Position(to, _)) = (before, goal)
            && from != to
        {
            tell(Replan::Target(to));
        }
        match (before, goal) {
            (Goal::Speed(was), Goal::Speed(is))
            | (Goal::Position(_, was), Goal::Position(_, is)) => {
                if was.speed != is.speed {
                    tell(Replan::Speed(is.speed));
                }
                if was.start_speed != is.start_speed {
                    tell(Replan::StartSpeed(is.start_speed));
                }
                if was.accel != is.accel {
                    tell(Replan::Accel(is.accel.of(is.change())));
                }
                if was.decel != is.decel {
                    tell(Replan::Decel(is.decel.of(is.change())));
                }
            }
            (_, Goal::Stop(decel, change)) => tell(Replan::Decel(decel.of(change))),
            _ => {}
        }
    }
}
