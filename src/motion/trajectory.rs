//! A trajectory: pieces of constant acceleration, and what they say about an instant.
//!
//! Made in `plan.rs`, only read here. It relies on two things that plans promise:
//! in no segment does the speed change its sign, and the first segment starts at the beginning.
//!
//! When it passes a position is a whole nanosecond at which the state is past the mark, while one nanosecond before it is
//! not. So the state at a deadline is what the deadline says.

use super::{CrossingDirection, State, search};
use crate::time::{Duration, Instant};

/// A move in the worst case: brake, speed up, cruise, slow down.
pub(super) const MOST_SEGMENTS: usize = 4;

/// Nearer than this to a whole count is on it. Sums of ramps are a few 1e-10 off; without this an axis
/// that stopped at 5000 would show 4999 now and then, with its switches to match.
pub(super) const SNAP: f64 = 1e-6;

/// Constant acceleration until the next segment or the end.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Segment {
    /// Seconds since the trajectory began.
    pub(super) from: f64,
    /// The state there.
    pub(super) start: State,
    /// Counts per second squared, signed.
    pub(super) accel: f64,
}

impl Segment {
    /// The state `t` seconds after the trajectory began.
    fn state(&self, t: f64) -> State {
        let State { position, speed } = self.start;
        let x = t - self.from;
        let now = speed + self.accel * x;
        State {
            position: snap(position + (speed + 0.5 * self.accel * x) * x),
            // Rounding must not turn the last crawl before a standstill round.
            speed: if now * speed < 0.0 { 0.0 } else { now },
        }
    }
}

/// The motion of one axis from an instant on: a value, evaluated wherever it is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trajectory {
    pub(super) begin: Instant,
    pub(super) segments: [Segment; MOST_SEGMENTS],
    pub(super) len: usize,
    /// From here on it stands at `rest`; without it the last segment goes on for ever.
    pub(super) end: Option<Instant>,
    pub(super) rest: f64,
}

impl Trajectory {
    /// The state at `at`; before the beginning, the state there. Exactly at rest, after a move on the
    /// whole count that was its target, at and after [`Trajectory::end`].
    pub fn state(&self, at: Instant) -> State {
        if self.end.is_some_and(|end| end <= at) {
            return State::at_rest(self.rest);
        }
        let t = self.seconds(at);
        let segment = self.segments().iter().rev().find(|it| it.from <= t);
        segment.map_or(State::at_rest(self.rest), |it| it.state(t))
    }

    /// The last whole count reached at `at`: the position rounded down.
    pub fn position(&self, at: Instant) -> i64 {
        self.state(at).position.floor() as i64
    }

    /// Counts per second at `at`, signed.
    pub fn speed(&self, at: Instant) -> f64 {
        self.state(at).speed
    }

    /// Counts per second that it goes on with in the end, signed; 0 if it comes to rest.
    pub fn last_speed(&self) -> f64 {
        let last = self.segments().last().filter(|_| self.end.is_none());
        last.map_or(0.0, |segment| segment.start.speed)
    }

    /// When it comes to rest. `None` if it never does, and for a move that can never arrive because
    /// its speed is zero.
    pub fn end(&self) -> Option<Instant> {
        self.end
    }

    /// Is it under way at `at`? Also while it turns round and stands for no time at all.
    pub fn is_moving(&self, at: Instant) -> bool {
        match self.end {
            Some(end) => at < end,
            None => {
                let t = self.seconds(at);
                let segment = self.segments().iter().rev().find(|it| it.from <= t);
                segment.is_some_and(|it| it.start.speed != 0.0 || it.accel != 0.0)
            }
        }
    }

    /// From when on, not before `after`, it goes this way first.
    pub fn goes_at(&self, way: CrossingDirection, after: Instant) -> Option<Instant> {
        let now = self.seconds(after);
        let goes = |(segment, until): &(&Segment, f64)| {
            let middle = if until.is_finite() { (segment.from + until) / 2.0 } else { f64::MAX };
            segment.state(middle).speed * way.sign() > 0.0 && *until > now
        };
        let (segment, _) = self.spans().find(goes)?;
        Some(self.instant(segment.from).max(after))
    }

    /// What is left of it at `now`, `by` counts further on.
    #[must_use]
    pub fn left(&self, now: Instant, by: f64) -> Self {
        if self.end.is_some_and(|end| end <= now) {
            return Self::rest(now, self.rest + by);
        }
        let t = self.seconds(now);
        let mut left = Self { begin: now, len: 0, rest: self.rest + by, ..*self };
        for (segment, _) in self.spans().filter(|(_, until)| *until > t) {
            let started = segment.from <= t;
            let State { position, speed } = if started { segment.state(t) } else { segment.start };
            left.segments[left.len] = Segment {
                from: (segment.from - t).max(0.0),
                start: State { position: position + by, speed },
                accel: segment.accel,
            };
            left.len += 1;
        }
        left
    }

    /// The first instant after `after` at which it passes `position` in the given way.
    ///
    /// A mark belongs to its upper side: coming to rest on it from below passes it, coming to rest on
    /// it from above does not, and leaving it downwards does.
    pub fn crossing(
        &self,
        position: f64,
        way: CrossingDirection,
        after: Instant,
    ) -> Option<Instant> {
        self.first(
            after,
            |it| way.is_past(it.position, position),
            |segment| {
                let sign = way.sign();
                let far = (position - segment.start.position) * sign;
                let (speed, accel) = (segment.start.speed * sign, segment.accel * sign);
                // This form of the root loses no digits when the acceleration is small or negative.
                2.0 * far / (speed + (speed * speed + 2.0 * accel * far).max(0.0).sqrt())
            },
        )
    }

    /// The first instant after `after` from which on `past` holds; `guess` gives the seconds from the
    /// start of a segment. Within a segment `past` changes at most once, since the speed keeps its sign.
    fn first(
        &self,
        after: Instant,
        past: impl Fn(State) -> bool,
        guess: impl Fn(&Segment) -> f64,
    ) -> Option<Instant> {
        search::first(
            after,
            self.marks(),
            |at| past(self.state(at)),
            |segment| self.instant(segment.from + guess(segment)),
        )
    }

    /// Instants between which position and speed are monotone, each with the segment before it.
    fn marks(&self) -> impl Iterator<Item = (Instant, &Segment)> {
        self.spans().flat_map(|(segment, until)| {
            // A segment may end between two nanoseconds, and the nearest whole one may lie on either
            // side of that. What has no end ends with time, where the conversion saturates.
            let ns = (until * 1e9 + 0.5) as u64;
            let begin = self.begin.as_nanos();
            let marks = [ns.saturating_sub(1), ns, ns.saturating_add(1)];
            marks.map(|ns| (Instant::from_nanos(begin.saturating_add(ns)), segment))
        })
    }

    pub(super) fn segments(&self) -> &[Segment] {
        &self.segments[..self.len]
    }

    /// Each segment with the second at which it is over.
    pub(super) fn spans(&self) -> impl Iterator<Item = (&Segment, f64)> {
        let last = self.end.map_or(f64::INFINITY, |end| self.seconds(end));
        let ends = self.segments().iter().skip(1).map(|it| it.from).chain([last]);
        self.segments().iter().zip(ends)
    }

    /// Seconds from the beginning to `at`.
    pub(super) fn seconds(&self, at: Instant) -> f64 {
        // Divided and not multiplied by 1e-9: 300 ms must be the double nearest to 0.3.
        at.as_nanos().saturating_sub(self.begin.as_nanos()) as f64 / 1e9
    }

    /// The first instant not before `t` seconds after the beginning.
    pub(super) fn instant(&self, t: f64) -> Instant {
        self.begin + after(t)
    }
}

/// The least time in whole nanoseconds that is not below `t` seconds; what is only a rounding error
/// above a nanosecond is on it.
pub(super) fn after(t: f64) -> Duration {
    let ns = t * 1e9;
    let whole = ns.round();
    let ns = if (ns - whole).abs() < 1e-3 { whole } else { ns.ceil() };
    Duration::from_nanos(ns as u64)
}

/// `position`, on the whole count if it is next to one.
pub(super) fn snap(position: f64) -> f64 {
    // By way of an integer, because rounding a float is a call on many processors and this is the one
    // sum that everything evaluates. Out of the integer's range there is no fraction to lose.
    let whole = (position + 0.5_f64.copysign(position)) as i64 as f64;
    // Adding zero makes a plain zero of a negative one.
    if (position - whole).abs() < SNAP { whole + 0.0 } else { position }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{instants, trajectories};
    use proptest::prelude::*;

    const NS: Duration = Duration::from_nanos(1);

    #[test]
    fn shows_the_last_count_reached() {
        for (position, count) in [(2.999, 2), (3.0, 3), (2.999_999_9, 3), (-0.1, -1), (-3.0, -3)] {
            let of = Trajectory::rest(Instant::ZERO, position);
            assert_eq!(of.position(Instant::ZERO), count, "{position}");
        }
        let zero = Trajectory::rest(Instant::ZERO, -1e-9).state(Instant::ZERO).position;
        assert!(zero == 0.0 && zero.is_sign_positive());
    }

    #[test]
    fn before_its_beginning_it_is_at_its_beginning() {
        let from = State { position: 7.0, speed: 100.0 };
        let of = Trajectory::stop(Instant::from_millis(50), from, 1000.0);
        assert_eq!(of.state(Instant::ZERO), from);
        assert_eq!(of.end(), Some(Instant::from_millis(150)));
    }

    #[test]
    fn is_small() {
        assert!(size_of::<Trajectory>() <= 176, "one for each axis, copied at each order");
    }

    #[test]
    fn solves_what_paper_solves() {
        let of = Trajectory::to_speed(Instant::ZERO, State::at_rest(0.0), 1000.0, 5000.0, 5000.0);
        let at = |position| of.crossing(position, CrossingDirection::Rising, Instant::ZERO);
        assert_eq!(at(25.0).map(Instant::as_nanos).map(|it| it / 1000), Some(99_999));
        assert_eq!(at(1100.0).map(Instant::as_nanos).map(|it| (it + 500) / 1000), Some(1_200_000));
        assert_eq!(at(0.0), None, "it is there already");
    }

    #[test]
    fn a_target_is_passed_from_below_only() {
        let go = |from, to| {
            let how = crate::motion::Move { start_speed: 5.0, speed: 1e3, accel: 1e4, decel: 1e4 };
            Trajectory::to_position(Instant::ZERO, State::at_rest(from), to, how)
        };
        let up = go(0.0, 500);
        let at = up.crossing(500.0, CrossingDirection::Rising, Instant::ZERO).expect("it arrives");
        assert!(up.end().expect("an end").since(at) < Duration::from_micros(1));
        assert_eq!(go(900.0, 500).crossing(500.0, CrossingDirection::Falling, Instant::ZERO), None);
        assert!(go(500.0, 0).crossing(500.0, CrossingDirection::Falling, Instant::ZERO).is_some());
    }

    #[test]
    fn endless_motion_gets_anywhere() {
        let of = Trajectory::to_speed(Instant::ZERO, State::at_rest(0.0), -0.5, 1.0, 1.0);
        let at = of.crossing(-1e6, CrossingDirection::Falling, Instant::ZERO).expect("in 23 days");
        assert!((at.as_secs_f64() - 2_000_000.25).abs() < 1e-4, "{at}");
        assert_eq!(of.crossing(1.0, CrossingDirection::Rising, Instant::ZERO), None);
        let standing = Trajectory::rest(Instant::ZERO, 5.0);
        assert_eq!(standing.crossing(5.0, CrossingDirection::Rising, Instant::ZERO), None);
    }

    /// `found` is a change, and none of `instants` before it shows one.
    fn check(
        found: Option<Instant>,
        after: Instant,
        instants: &[Instant],
        past: impl Fn(Instant) -> bool,
    ) -> Result<(), TestCaseError> {
        if let Some(at) = found {
            prop_assert!(at > after && past(at) && !past(at - NS), "{:?}", at);
        }
        let mut was = past(after);
        for &at in instants.iter().filter(|at| **at > after) {
            if found.is_some_and(|found| found <= at) {
                break;
            }
            let is = past(at);
            prop_assert!(was || !is, "missed between {} and the one before", at.as_nanos());
            was = is;
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn agrees_with_looking(
            of in trajectories(), position in -30_000.0..30_000.0, whole: bool, rising: bool, part in 0.0..1.0,
        ) {
            let way = if rising { CrossingDirection::Rising } else { CrossingDirection::Falling };
            let position: f64 = if whole { f64::round(position) } else { position };
            let instants = instants(&of, 1000);
            for after in [Instant::ZERO, of.begin, instants[(part * 999.0) as usize]] {
                let found = of.crossing(position, way, after);
                let past = |at| way.is_past(of.state(at).position, position);
                check(found, after.max(of.begin), &instants, past)?;
                // A later question, but not too late, has the same answer.
                if let Some(at) = found {
                    prop_assert_eq!(of.crossing(position, way, at - NS), found);
                }
            }
        }
    }
}
