//! What will happen to an axis by itself, and when: a table of deadlines, each with a name.
//!
//! They are solved for whenever the axis gets another trajectory, or what it has to look out for changes. The earliest one
//! comes first; those of one instant come in the order in which [`MotorTimer`] lists them.

use crate::motion::{Hit, IndexPulse};
use crate::time::Instant;

/// What an axis waits for. Of several at one instant the first one here comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotorTimer {
    /// A switch of the machine changes. It comes before all others: what it is wired to has changed when they happen.
    SwitchEdge,
    /// The axis runs against a hard stop.
    HardStop,
    /// The axis comes off a hard stop.
    HardStopLeft,
    /// The axis has been pressed against a hard stop as far as a homing step waits for.
    Collision,
    /// The axis passes an index mark that a homing waits for.
    IndexPulse,
    /// The axis gets to be farther from its command than is allowed.
    DeviationLimit,
    /// The axis gets beyond a soft limit.
    SoftLimit,
    /// The command of a move is at its target.
    TargetReached,
    /// The command of a stop is at rest, be it one within a homing.
    Standstill,
    /// The time for a homing is over.
    HomingTimeLimit,
}

impl MotorTimer {
    /// All of them, in their order.
    pub const ALL: [Self; 10] = [
        Self::SwitchEdge,
        Self::HardStop,
        Self::HardStopLeft,
        Self::Collision,
        Self::IndexPulse,
        Self::DeviationLimit,
        Self::SoftLimit,
        Self::TargetReached,
        Self::Standstill,
        Self::HomingTimeLimit,
    ];
}

/// The deadlines of an axis.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MotorTimers {
    at: [Option<Instant>; MotorTimer::ALL.len()],
    /// The first of them: it is asked for at each request, and set only when a motion changes.
    next: Option<(Instant, MotorTimer)>,
    /// Where the axis is to run against a hard stop.
    hit_at: i64,
    /// The index mark that is to be passed.
    mark: i64,
}

impl MotorTimers {
    /// Sets a deadline, or stops it.
    pub(super) fn set(&mut self, timer: MotorTimer, at: Option<Instant>) {
        self.at[timer as usize] = at;
        self.next = self.set_ones().min();
    }

    pub(super) fn set_hard_stop(&mut self, hit: Option<Hit>) {
        self.set(MotorTimer::HardStop, hit.map(|it| it.at));
        self.hit_at = hit.map_or(0, |it| it.position);
    }

    pub(super) fn set_index_pulse(&mut self, pulse: Option<IndexPulse>) {
        self.set(MotorTimer::IndexPulse, pulse.map(|it| it.at));
        self.mark = pulse.map_or(0, |it| it.mark);
    }

    /// The count at which the axis runs against a hard stop, where that timer is set or has just expired.
    pub(super) fn hit_at(&self) -> i64 {
        self.hit_at
    }

    /// The index mark that is passed, where that timer is set or has just expired.
    pub(super) fn mark(&self) -> i64 {
        self.mark
    }

    /// The next deadline.
    pub(super) fn next(&self) -> Option<(Instant, MotorTimer)> {
        self.next
    }

    /// Stops `timer` if it has expired by `now`. Has it?
    pub(super) fn take(&mut self, timer: MotorTimer, now: Instant) -> bool {
        let has_expired = self.at[timer as usize].is_some_and(|at| at <= now);
        if has_expired {
            self.set(timer, None);
        }
        has_expired
    }

    /// Stops the first one that has expired by `now`, but for switches, which are not the axis's to look at.
    pub(super) fn take_expired(&mut self, now: Instant) -> Option<MotorTimer> {
        let others = self.set_ones().filter(|(_, timer)| *timer != MotorTimer::SwitchEdge);
        let (_, timer) = others.min().filter(|(at, _)| *at <= now)?;
        self.set(timer, None);
        Some(timer)
    }

    /// Those that are set, in the order of their names.
    pub(super) fn set_ones(&self) -> impl Iterator<Item = (Instant, MotorTimer)> {
        self.at.iter().zip(MotorTimer::ALL).filter_map(|(at, timer)| at.map(|at| (at, timer)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    #[test]
    fn each_has_its_place_in_the_table() {
        for (i, timer) in MotorTimer::ALL.into_iter().enumerate() {
            assert_eq!(timer as usize, i, "{timer:?}");
        }
        assert!(MotorTimer::ALL.is_sorted());
    }

    #[test]
    fn the_earliest_comes_first() {
        let mut timers = MotorTimers::default();
        assert_eq!(timers.next(), None);
        timers.set(MotorTimer::SoftLimit, Some(ms(20)));
        timers.set(MotorTimer::Standstill, Some(ms(10)));
        assert_eq!(timers.next(), Some((ms(10), MotorTimer::Standstill)));
        assert_eq!(timers.take_expired(ms(9)), None);
        assert_eq!(timers.take_expired(ms(30)), Some(MotorTimer::Standstill));
        assert_eq!(timers.take_expired(ms(30)), Some(MotorTimer::SoftLimit));
        assert_eq!((timers.take_expired(ms(30)), timers.next()), (None, None));
    }

    #[test]
    fn those_of_one_instant_come_in_the_order_of_their_names() {
        let mut timers = MotorTimers::default();
        for timer in MotorTimer::ALL.into_iter().rev() {
            timers.set(timer, Some(ms(5)));
        }
        assert_eq!(timers.next(), Some((ms(5), MotorTimer::SwitchEdge)));
        let order: Vec<_> = std::iter::from_fn(|| timers.take_expired(ms(5))).collect();
        let all = "HardStop, HardStopLeft, Collision, IndexPulse, DeviationLimit, SoftLimit, \
                   TargetReached, Standstill, HomingTimeLimit";
        let names: Vec<_> = order.iter().map(|timer| format!("{timer:?}")).collect();
        assert_eq!(names.join(", "), all);
        // Switches are the drive's to look at.
        assert_eq!(timers.next(), Some((ms(5), MotorTimer::SwitchEdge)));
        assert!(timers.take(MotorTimer::SwitchEdge, ms(5)));
        assert_eq!(timers.next(), None);
    }
}
