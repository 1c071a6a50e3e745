//! What holds for every trajectory, from whatever it starts.

use super::*;
use crate::time::{Duration, Instant};
use proptest::prelude::*;

/// An acceleration, or none.
fn slopes() -> impl Strategy<Value = f64> {
    prop_oneof![8 => 100.0..1e6, 1 => Just(f64::INFINITY), 1 => Just(0.0)]
}

fn states() -> impl Strategy<Value = State> {
    let position = prop_oneof![(-20_000i64..20_000).prop_map(|it| it as f64), -20_000.0..20_000.0];
    let speed = prop_oneof![Just(0.0), -30_000.0..30_000.0, -10.0..10.0];
    (position, speed).prop_map(|(position, speed)| State { position, speed })
}

fn moves() -> impl Strategy<Value = Move> {
    let start_speed = prop_oneof![Just(0.0), 0.0..2000.0];
    (start_speed, 1.0..20_000.0, slopes(), slopes())
        .prop_map(|(start_speed, speed, accel, decel)| Move { start_speed, speed, accel, decel })
}

fn begins() -> impl Strategy<Value = Instant> {
    (0u64..10_000_000_000_000).prop_map(Instant::from_nanos)
}

/// Trajectories of all kinds.
pub(super) fn trajectories() -> impl Strategy<Value = Trajectory> {
    (begins(), states(), -20_000i64..20_000, moves(), 0..4).prop_map(
        |(now, from, to, how, kind)| match kind {
            0 => Trajectory::to_position(now, from, to, how),
            1 => Trajectory::to_speed(now, from, to as f64, how.accel, how.decel),
            2 => Trajectory::stop(now, from, how.decel),
            _ => Trajectory::coast(now, from, Duration::from_millis(to.unsigned_abs() / 20)),
        },
    )
}

/// `count` instants from the beginning to a little after the end, and those around each seam.
pub(super) fn instants(of: &Trajectory, count: u64) -> Vec<Instant> {
    let begin = of.begin.as_nanos();
    let over = of.end.map_or(begin + 20_000_000_000, |end| end.as_nanos() + 1000);
    let seams = of.segments().iter().map(|it| of.instant(it.from).as_nanos());
    let seams = seams.chain(of.end.map(Instant::as_nanos));
    let near = seams.flat_map(|ns| [ns.saturating_sub(1), ns, ns + 1, ns + 2]);
    let mut all: Vec<_> = (0..count).map(|i| begin + (over - begin) * i / (count - 1)).collect();
    all.extend(near.filter(|ns| *ns >= begin));
    all.sort_unstable();
    all.dedup();
    all.into_iter().map(Instant::from_nanos).collect()
}

/// Counts that rounding may cost.
const TINY: f64 = 3e-6;

fn is_continuous(of: &Trajectory) -> Result<(), TestCaseError> {
    let all = instants(of, 1000);
    for pair in all.windows(2) {
        let (a, b) = (of.state(pair[0]), of.state(pair[1]));
        let seconds = pair[1].since(pair[0]).as_secs_f64();
        // Between two looks the speed may have had its peak; nothing here is faster than this.
        let way = (b.position - a.position).abs();
        prop_assert!(way <= 30_000.0 * seconds + TINY, "{:?} {:?} in {} s", a, b, seconds);
    }
    Ok(())
}

/// No change of speed is steeper than its ramp, but for speeds up to `jump`, which come and go at once.
fn keeps_ramps(of: &Trajectory, jump: f64, accel: f64, decel: f64) -> Result<(), TestCaseError> {
    let slope = |it: f64| if it > 0.0 { it } else { f64::INFINITY };
    for pair in instants(of, 1000).windows(2) {
        let (a, b) = (of.speed(pair[0]), of.speed(pair[1]));
        let seconds = pair[1].since(pair[0]).as_secs_f64();
        let ramped = |speed: f64| speed.signum() * (speed.abs() - jump).max(0.0);
        let change = (ramped(b) - ramped(a)).abs();
        let limit = match (a * b < 0.0, b.abs() > a.abs()) {
            // Through zero on both ramps.
            (true, _) => slope(accel).max(slope(decel)),
            (_, true) => slope(accel),
            (_, false) => slope(decel),
        };
        prop_assert!(change <= limit * seconds + 1e-5, "{} to {} in {} s", a, b, seconds);
    }
    Ok(())
}

proptest! {
    #[test]
    fn a_move_ends_on_its_target(
        now in begins(), from in states(), to in -20_000i64..20_000, how in moves(), later: u32,
    ) {
        let of = Trajectory::to_position(now, from, to, how);
        let end = of.end().expect("a move ends");
        for at in [end, end + Duration::from_nanos(later.into())] {
            prop_assert_eq!(of.state(at), State::at_rest(to as f64));
            prop_assert_eq!(of.position(at), to);
            prop_assert!(!of.is_moving(at));
        }
        let before = of.state(end - Duration::from_nanos(1));
        prop_assert!((before.position - to as f64).abs() < 1e-9 * 30_000.0 + TINY);
        is_continuous(&of)?;
    }

    #[test]
    fn a_move_keeps_its_speed_and_ramps(
        now in begins(), from in states(), to in -20_000i64..20_000, how in moves(),
    ) {
        let of = Trajectory::to_position(now, from, to, how);
        let top = how.speed.max(from.speed.abs());
        for at in instants(&of, 1000) {
            prop_assert!(of.speed(at).abs() <= top * (1.0 + 1e-9));
        }
        keeps_ramps(&of, how.start_speed.min(how.speed), how.accel, how.decel)?;
    }

    #[test]
    fn a_speed_is_reached_and_kept(
        now in begins(), from in states(), to in -20_000.0..20_000.0, accel in slopes(), decel in slopes(),
    ) {
        let of = Trajectory::to_speed(now, from, to, accel, decel);
        prop_assert_eq!(of.end(), None);
        prop_assert_eq!(of.speed(now + Duration::from_secs(1000)), to);
        is_continuous(&of)?;
        keeps_ramps(&of, 0.0, accel, decel)?;
    }

    #[test]
    fn a_stop_takes_its_ramp_and_no_longer(now in begins(), from in states(), decel in slopes()) {
        let of = Trajectory::stop(now, from, decel);
        let ramp = if decel > 0.0 { from.speed.abs() / decel } else { 0.0 };
        let took = of.end().expect("a stop ends").since(now).as_secs_f64();
        prop_assert!((took - ramp).abs() <= 1.001e-9, "{} for {}", took, ramp);
        is_continuous(&of)?;
        keeps_ramps(&of, 0.0, decel, decel)?;
    }

    /// To order the same move again on the way changes nothing that anybody could see.
    #[test]
    fn ordered_again_it_arrives_as_before(
        now in begins(), from in states(), to in -20_000i64..20_000, how in moves(), part in 0.0..1.0,
    ) {
        let how = Move { start_speed: 0.0, ..how };
        let of = Trajectory::to_position(now, from, to, how);
        let end = of.end().expect("a move ends");
        let at = now + end.since(now).mul_f64(part);
        let again = Trajectory::to_position(at, of.state(at), to, how);
        prop_assert_eq!(again.state(again.end().expect("a move ends")), of.state(end));
        let (a, b) = (again.end().expect("an end"), end);
        // A rounding error more than the last stopping point costs the way back over it.
        prop_assert!(a.since(b).max(b.since(a)) < Duration::from_millis(1), "{} {}", a.as_nanos(), b.as_nanos());
    }
}

proptest! {
    #[test]
    fn what_is_left_goes_on(of in trajectories(), part in 0.0..1.0, by in -5000.0..5000.0) {
        let all = instants(&of, 100);
        let now = all[(part * 99.0) as usize];
        let left = of.left(now, by);
        for at in all.into_iter().filter(|at| *at >= now) {
            let (was, is) = (of.state(at), left.state(at));
            prop_assert!((is.position - was.position - by).abs() < 1e-3, "{:?} {:?}", was, is);
            prop_assert!((is.speed - was.speed).abs() < 1e-2, "{:?} {:?}", was, is);
        }
        prop_assert_eq!(left.end(), of.end().map(|end| end.max(now)));
    }
}

proptest! {
    /// A wait for a count ends at the first nanosecond that shows it.
    #[test]
    fn counts_are_met(of in trajectories(), count in -20_000i64..20_000) {
        let side = |at| of.position(at).cmp(&count);
        let found = first_equal(of.begin, &Lag::NONE.marks(&of, of.begin), side);
        if let Some(at) = found {
            prop_assert!(side(at).is_eq() && side(at - Duration::from_nanos(1)).is_ne());
        }
        let looks = instants(&of, 1000).into_iter().skip_while(|at| side(*at).is_eq());
        let mut before = looks.take_while(|at| found.is_none_or(|found| *at < found));
        prop_assert!(before.all(|at| side(at).is_ne()), "{:?}", found);
    }
}
