//! When a trajectory passes a position or a speed.
//!
//! The instant found is a whole nanosecond at which the state is past the mark, while one nanosecond
//! before it is not. So whoever looks at the state when the deadline fires sees what the deadline says.

use super::trajectory::Segment;
use super::{CrossingDirection, State, Trajectory, search};
use crate::time::Instant;

impl Trajectory {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{instants, trajectories};
    use crate::time::Duration;
    use proptest::prelude::*;

    const NS: Duration = Duration::from_nanos(1);

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

    /// `found` is a change, and nobody who looks at `instants` sees one before it.
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
                // Whoever asks later, but not too late, gets the same answer.
                if let Some(at) = found {
                    prop_assert_eq!(of.crossing(position, way, at - NS), found);
                }
            }
        }
    }
}
