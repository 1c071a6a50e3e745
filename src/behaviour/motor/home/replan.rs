//! A homing under way that goes by another setting from now on.

use super::{HomeOrder, HomingState};
use crate::behaviour::effect::{Effect, Replan};
use crate::behaviour::motor::Motor;
use crate::motion::Trajectory;
use crate::time::Instant;

impl Motor {
    /// The order of the homing under way.
    pub fn home_order(&self) -> Option<&HomeOrder> {
        self.homing.as_ref().map(|it| &it.order)
    }

    /// The homing under way goes as `order` says, the method apart.
    pub fn retune_home(&mut self, now: Instant, order: HomeOrder) {
        let Some(homing) = self.homing.as_mut().filter(|it| it.order != order) else { return };
        let before = std::mem::replace(&mut homing.order, order);
        homing.until = homing.order.time_limit.map(|time| homing.began + time);
        self.tell_home(&before);
        let from = self.trajectory.state(now);
        let Some(homing) = &self.homing else { return };
        let accel = homing.order.slope();
        let trajectory = match (homing.doing, homing.heading()) {
            (HomingState::Seeking { .. } | HomingState::Refining { .. }, Some(forward)) => {
                let speed = homing.speed();
                let speed = if forward { speed } else { -speed };
                Trajectory::to_speed(now, from, speed, accel, accel)
            }
            (HomingState::Ending, Some(_)) => homing.order.onward(now, from, homing.origin),
            _ => Trajectory::stop(now, from, accel),
        };
        let source = homing.order.source;
        self.go_on(now, trajectory);
        // What tells of limits may be something else now, which is no edge.
        let seen = self.home_switches(now, source);
        self.homing.iter_mut().for_each(|it| it.seen = seen);
        self.home_limit(now);
        self.advance(now);
    }

    fn tell_home(&mut self, before: &HomeOrder) {
        let Some(order) = self.homing.as_ref().map(|it| &it.order) else { return };
        let mut told = Vec::new();
        if before.fast != order.fast {
            told.push(Replan::Speed(order.fast));
        }
        if before.slow != order.slow {
            told.push(Replan::SlowSpeed(order.slow));
        }
        if before.accel != order.accel {
            told.push(Replan::Accel(order.slope()));
        }
        if before.way != order.way {
            told.push(Replan::HomeOffset(order.way));
        }
        if before.time_limit != order.time_limit {
            told.push(Replan::TimeLimit(order.time_limit));
        }
        self.effects.extend(told.into_iter().map(Effect::Replanned));
    }
}
