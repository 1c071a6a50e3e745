//! What happens to an axis by itself: how its deadlines are found, and what each of them brings.

use super::{Effect, Motor, MotorTimer, Phase};
use crate::motion::{CrossingDirection, Switch};
use crate::time::Instant;

impl Motor {
    /// What happens to it next by itself, and when.
    pub fn next_timer(&self) -> Option<(Instant, MotorTimer)> {
        self.timers.next()
    }

    /// All that will happen to it by itself if nothing comes between, and when.
    pub fn timers(&self) -> impl Iterator<Item = (Instant, MotorTimer)> {
        self.timers.set_ones()
    }

    /// Has a switch of the machine changed up to `now`? Asked once for each time; whoever knows what the
    /// switches are wired to looks at them then, and before [`Motor::advance`].
    pub fn take_switch_edge(&mut self, now: Instant) -> bool {
        let expired = self.timers.take(MotorTimer::SwitchEdge, now);
        if expired {
            self.timers.set(MotorTimer::SwitchEdge, self.next_edge(now));
        }
        expired
    }

    /// Lets time pass up to `now`, which is not later than the next timer.
    pub fn advance(&mut self, now: Instant) {
        while let Some(timer) = self.timers.take_expired(now) {
            self.on_timer(now, timer);
        }
    }

    /// Finds out again what lies ahead.
    pub(super) fn look_ahead(&mut self, now: Instant) {
        self.deviates &= self.is_deviating(now);
        let wait = self.homing.as_ref().map(|it| it.waits_for()).unwrap_or_default();
        let soft = self.wants.soft_limits.and_then(|[low, high]| match self.forward {
            true => self.trajectory.crossing(beyond(high), CrossingDirection::Rising, now),
            false => self.trajectory.crossing(low as f64, CrossingDirection::Falling, now),
        });
        let left = wait.limits_by_stop.then(|| self.next_leave(now)).flatten();
        let collision = wait.collision.and_then(|counts| self.pressed_at(counts as f64, now));
        let deviation = self.wants.deviation.and_then(|most| self.deviates_at(most, now));
        // What was over before is over now.
        let end = self.trajectory.end().map(|end| end.max(now));
        let (target, standstill) = match self.phase {
            // A move that is held back waits for its level.
            Phase::Moving => (end.filter(|_| !self.paused), None),
            // A run at a speed that has become 0 waits for another.
            Phase::Standing | Phase::Running => (None, None),
            Phase::Jogging { .. } | Phase::Homing | Phase::Stopping | Phase::Coasting => {
                (None, end)
            }
        };
        let timers = &mut self.timers;
        timers.set_hard_stop(self.machine.next_hit(&self.trajectory, now));
        timers.set(MotorTimer::HardStopLeft, left);
        timers.set(MotorTimer::Collision, collision);
        timers.set(MotorTimer::DeviationLimit, deviation);
        timers.set(MotorTimer::SoftLimit, soft);
        timers.set(MotorTimer::TargetReached, target);
        timers.set(MotorTimer::Standstill, standstill);
        timers.set(MotorTimer::HomingTimeLimit, wait.until);
        let pulse = wait.index.and_then(|index| self.next_index(now, index));
        self.timers.set_index_pulse(pulse);
        self.timers.set(MotorTimer::SwitchEdge, self.next_edge(now));
    }

    /// The axis is elsewhere than its command was: who knows where the switches lie.
    pub(super) fn look_at_switches(&mut self, now: Instant) {
        self.timers.set(MotorTimer::SwitchEdge, Some(now));
    }

    fn on_timer(&mut self, now: Instant, timer: MotorTimer) {
        match timer {
            // Not the axis's to look at.
            MotorTimer::SwitchEdge => {}
            MotorTimer::HardStop => {
                self.effects.push_back(Effect::HardStopHit(self.timers.hit_at()));
                self.home_look(now);
            }
            MotorTimer::HardStopLeft => self.home_look(now),
            MotorTimer::Collision => self.home_found(now, self.position(now)),
            MotorTimer::IndexPulse => self.home_found(now, self.timers.mark()),
            MotorTimer::DeviationLimit => {
                self.deviates = true;
                self.effects.push_back(Effect::DeviationExceeded);
            }
            MotorTimer::SoftLimit => self.obey_limits(now),
            MotorTimer::TargetReached => {
                self.arrived = true;
                self.stand(now);
            }
            MotorTimer::Standstill if self.is_homing() => self.home_stands(now),
            MotorTimer::Standstill => {
                self.arrived = false;
                self.stand(now);
            }
            MotorTimer::HomingTimeLimit => self.home_late(now),
        }
    }

    /// Nothing is under way any more.
    pub(super) fn stand(&mut self, now: Instant) {
        self.phase = Phase::Standing;
        self.look_ahead(now);
        // Where it is to stand: it may still be on its last counts.
        self.effects.push_back(Effect::Stopped(self.commanded(now)));
    }

    fn next_edge(&self, now: Instant) -> Option<Instant> {
        let switches = [Switch::Home, Switch::NegativeLimit, Switch::PositiveLimit];
        let edge = |switch| self.machine.next_edge(switch, &self.trajectory, now).map(|it| it.at);
        switches.into_iter().filter_map(edge).min()
    }

    /// When the axis gets to be more than `most` counts from its command: a hard stop holds it, or it is too slow.
    fn deviates_at(&self, most: f64, now: Instant) -> Option<Instant> {
        if self.deviates || !self.wants.power {
            return None;
        }
        if self.is_deviating(now) {
            return Some(now);
        }
        let late = self.lag.exceeds_at(&self.trajectory, most, now);
        [late, self.pressed_at(most, now)].into_iter().flatten().min()
    }

    fn is_deviating(&self, now: Instant) -> bool {
        self.wants.deviation.is_some_and(|most| self.deviation(now).abs() > most)
    }

    /// When the trajectory gets `counts` beyond the hard stop that holds the axis.
    fn pressed_at(&self, counts: f64, now: Instant) -> Option<Instant> {
        let [low, high] = self.machine.hard_stop?;
        let (low, high) = (low as f64 - counts, (high as f64 + counts).next_up());
        let position = self.trajectory.state(now).position;
        if position < low || position >= high {
            return Some(now);
        }
        let rising = self.trajectory.crossing(high, CrossingDirection::Rising, now);
        let falling = self.trajectory.crossing(low, CrossingDirection::Falling, now);
        [rising, falling].into_iter().flatten().min()
    }

    fn next_leave(&self, now: Instant) -> Option<Instant> {
        let [low, high] = self.machine.hard_stop?;
        let falling = self.trajectory.crossing(high as f64, CrossingDirection::Falling, now);
        let rising = self.trajectory.crossing(beyond(low), CrossingDirection::Rising, now);
        [rising, falling].into_iter().flatten().min()
    }
}

/// The first position that is more than `mark`.
fn beyond(mark: i64) -> f64 {
    (mark as f64).next_up()
}
