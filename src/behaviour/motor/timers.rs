//! What will happen to an axis by itself, and when: solved for whenever it gets another trajectory.

use super::{MotionReport, Motor, Phase};
use crate::motion::{CrossingDirection, Hit, IndexPulse, Switch};
use crate::time::Instant;

/// What will happen to an axis that is left alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MotorTimers {
    /// A switch changes.
    edge: Option<Instant>,
    /// It runs against a hard stop.
    hit: Option<Hit>,
    /// It comes off a hard stop.
    leave: Option<Instant>,
    /// It has been pressed against a hard stop as far as a homing step waits for.
    collision: Option<Instant>,
    /// It should be farther from where it is than is allowed.
    deviation: Option<Instant>,
    /// It gets beyond a soft limit.
    soft: Option<Instant>,
    /// It passes an index mark that a homing step waits for.
    index: Option<IndexPulse>,
    /// Its trajectory is over.
    end: Option<Instant>,
    /// The time for a homing is over.
    time: Option<Instant>,
}

impl Motor {
    /// When something happens to it by itself.
    pub fn deadline(&self) -> Option<Instant> {
        let MotorTimers { edge, hit, leave, collision, deviation, soft, index, end, time } =
            &self.due;
        let (hit, index) = (hit.map(|it| it.at), index.map(|it| it.at));
        let all = [*edge, hit, *leave, *collision, *deviation, *soft, index, *end, *time];
        all.into_iter().flatten().min()
    }

    /// Has a switch of the machine changed up to `now`? Asked once for each time; whoever knows what the
    /// switches are wired to looks at them then, and before [`Motor::advance`].
    pub fn take_edge(&mut self, now: Instant) -> bool {
        let due = take(&mut self.due.edge, now);
        if due {
            self.due.edge = self.next_edge(now);
        }
        due
    }

    /// Lets time pass up to `now`, which is not later than the deadline.
    pub fn advance(&mut self, now: Instant) {
        while self.happen(now) {}
    }

    /// Finds out again what lies ahead.
    pub(super) fn look_ahead(&mut self, now: Instant) {
        self.deviates &= self.is_deviating(now);
        let wait = self.homing.as_ref().map(|it| it.waits_for()).unwrap_or_default();
        self.due = MotorTimers {
            edge: self.next_edge(now),
            hit: self.machine.next_hit(&self.trajectory, now),
            leave: wait.limits_by_stop.then(|| self.next_leave(now)).flatten(),
            collision: wait.collision.and_then(|counts| self.pressed_at(counts as f64, now)),
            deviation: self.wants.deviation.and_then(|most| self.deviates_at(most, now)),
            soft: self.wants.soft_limits.and_then(|[low, high]| match self.forward {
                true => self.trajectory.crossing(beyond(high), CrossingDirection::Rising, now),
                false => self.trajectory.crossing(low as f64, CrossingDirection::Falling, now),
            }),
            index: wait.index.and_then(|index| self.next_index(now, index)),
            // A run at a speed that has become 0 waits for another, and a move that is held back for its level.
            end: self
                .trajectory
                .end()
                .filter(|_| self.is_moving() && self.phase != Phase::Running && !self.paused),
            time: wait.until,
        };
    }

    /// The axis is elsewhere than its command was: who knows where the switches lie.
    pub(super) fn look_at_switches(&mut self, now: Instant) {
        self.due.edge = Some(now);
    }

    /// The first thing that is due happens. Was there any?
    fn happen(&mut self, now: Instant) -> bool {
        let due = &mut self.due;
        if let Some(hit) = due.hit.take_if(|it| it.at <= now) {
            self.told.push_back(MotionReport::Hits(hit.position));
            self.home_look(now);
        } else if take(&mut due.leave, now) {
            self.home_look(now);
        } else if take(&mut due.collision, now) {
            self.home_found(now, self.position(now));
        } else if let Some(pulse) = due.index.take_if(|it| it.at <= now) {
            self.home_found(now, pulse.mark);
        } else if take(&mut due.deviation, now) {
            self.deviates = true;
            self.told.push_back(MotionReport::Deviates);
        } else if take(&mut due.soft, now) {
            self.obey_limits(now);
        } else if take(&mut due.end, now) {
            self.end(now);
        } else if take(&mut due.time, now) {
            self.home_late(now);
        } else {
            return false;
        }
        true
    }

    fn end(&mut self, now: Instant) {
        if self.is_homing() {
            return self.home_stands(now);
        }
        // A move that is held back is not over.
        if self.paused {
            return;
        }
        self.arrived = self.phase == Phase::Moving;
        self.stand(now);
    }

    /// Nothing is under way any more.
    pub(super) fn stand(&mut self, now: Instant) {
        self.phase = Phase::Standing;
        self.look_ahead(now);
        // Where it is to stand: it may still be on its last counts.
        self.told.push_back(MotionReport::Stands(self.commanded(now)));
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

/// Is `due` over at `now`? It is no more then.
fn take(due: &mut Option<Instant>, now: Instant) -> bool {
    due.take_if(|at| *at <= now).is_some()
}
