//! Following error: the feedback runs behind the command by a first-order delay.
//!
//! A position controller with gain `K` (1/s) moves the axis at `K` times its deviation, so the deviation
//! obeys `d' = v - K d`: it tends to `v / K` and decays when the command rests. For constant
//! acceleration that has a closed form, applied segment by segment.

use super::trajectory::Segment;
use super::{State, Trajectory, search};
use crate::time::{Duration, Instant};

/// Stretches between two turns are looked at in so many parts: a position may turn round inside one.
const PARTS: u32 = 16;

const END_OF_TIME: Instant = Instant::from_nanos(u64::MAX);

/// How far the feedback is behind the trajectory that it belongs to. Goes with each new trajectory by
/// [`Lag::with_deviation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// Position gain, 1/s; `None` follows without delay.
    gain: Option<f64>,
    /// Counts at the beginning of the trajectory.
    deviation: f64,
}

impl Lag {
    /// Feedback that is the command.
    pub const NONE: Self = Self { gain: None, deviation: 0.0 };

    /// Position gain in 1/s, no deviation yet. A gain that is zero or infinite follows without delay.
    pub fn new(gain: f64) -> Self {
        // Below 0.01/s, a time constant of minutes, the closed form would drown in rounding.
        Self { gain: (gain > 0.0 && gain.is_finite()).then(|| gain.max(0.01)), deviation: 0.0 }
    }

    /// The same, as far behind as it gets to be at `speed`, in counts per second.
    pub fn at_speed(gain: f64, speed: f64) -> Self {
        let lag = Self::new(gain);
        Self { deviation: lag.gain.map_or(0.0, |gain| speed / gain), ..lag }
    }

    /// The same with a deviation of so many counts at the beginning of the trajectory.
    #[must_use]
    pub fn with_deviation(self, deviation: f64) -> Self {
        Self { deviation: if self.gain.is_some() { deviation } else { 0.0 }, ..self }
    }

    /// Is the axis behind at all? Then it makes up for what it is behind.
    pub fn makes_up(&self) -> bool {
        self.gain.is_some()
    }

    /// Command less feedback at `at`, in counts.
    pub fn deviation(&self, trajectory: &Trajectory, at: Instant) -> f64 {
        let Some(gain) = self.gain else { return 0.0 };
        let t = trajectory.seconds(at);
        let mut deviation = self.deviation;
        for (segment, until) in trajectory.spans() {
            if t <= segment.from {
                return deviation;
            }
            deviation = behind(gain, deviation, segment, until.min(t) - segment.from);
        }
        let rested = trajectory.end.map_or(0.0, |end| t - trajectory.seconds(end));
        deviation * (-gain * rested.max(0.0)).exp()
    }

    /// Where the axis really is at `at`, and how fast.
    pub fn feedback(&self, trajectory: &Trajectory, at: Instant) -> State {
        let command = trajectory.state(at);
        let Some(gain) = self.gain else { return command };
        let deviation = self.deviation(trajectory, at);
        State { position: command.position - deviation, speed: gain * deviation }
    }

    /// The feedback in whole counts: the command's, less the deviation rounded to the nearest. Rounded
    /// down it would show one count less until the decay is over, which takes for ever.
    pub fn position(&self, trajectory: &Trajectory, at: Instant) -> i64 {
        trajectory.position(at).saturating_sub(self.deviation(trajectory, at).round() as i64)
    }

    /// When the command rests and the deviation is within `window` counts from then on; `None` if the
    /// command never rests. A window below half a count is half a count, which shows as zero.
    pub fn settles_at(&self, trajectory: &Trajectory, window: f64) -> Option<Instant> {
        let end = trajectory.end()?;
        let window = window.max(0.5);
        let left = self.deviation(trajectory, end).abs();
        let Some(gain) = self.gain.filter(|_| left > window) else { return Some(end) };
        let at = end + Duration::from_nanos(((left / window).ln() / gain * 1e9).ceil() as u64);
        // The logarithm may be a rounding error short.
        let late =
            |ns: &u64| self.deviation(trajectory, at + Duration::from_nanos(*ns)).abs() > window;
        let ns = (0..4).take_while(late).count() as u64;
        Some(at + Duration::from_nanos(ns))
    }

    /// Instants after `after` between which neither speed nor deviation turns round, up to the end of time, and
    /// some between them.
    pub fn marks(&self, of: &Trajectory, after: Instant) -> Vec<Instant> {
        let seams = of.spans().map(|(_, until)| of.instant(until));
        let turns = self.turns(of).map(|(at, _)| at);
        let mut turns: Vec<_> = seams.chain(turns).filter(|at| *at > after).collect();
        turns.sort_unstable();
        turns.dedup();
        let mut marks = Vec::with_capacity((turns.len() + 1) * PARTS as usize);
        let mut from = after;
        for to in turns {
            let part = to.since(from) / PARTS;
            marks.extend((1..PARTS).map(|i| from + part * i));
            marks.push(to);
            from = to;
        }
        // What is left decays, or goes on for ever.
        marks.extend((from < END_OF_TIME).then_some(END_OF_TIME));
        marks
    }

    /// The first instant after `after` at which the deviation gets to be more than `most` counts, either way.
    pub fn exceeds_at(&self, of: &Trajectory, most: f64, after: Instant) -> Option<Instant> {
        let gain = self.gain?;
        let beyond = |sign: f64| {
            search::first(
                after,
                self.turns(of),
                |at| sign * self.deviation(of, at) > most,
                |(deviation, segment)| {
                    of.instant(segment.from + comes_to(gain, deviation, segment, sign * most))
                },
            )
        };
        [beyond(1.0), beyond(-1.0)].into_iter().flatten().min()
    }

    /// Instants between which the deviation is monotone, each with the segment before it and the deviation with
    /// which the trajectory enters that.
    fn turns<'a>(&self, of: &'a Trajectory) -> impl Iterator<Item = (Instant, (f64, &'a Segment))> {
        let mut deviation = self.deviation;
        let spans = self.gain.into_iter().flat_map(|gain| of.spans().map(move |it| (gain, it)));
        spans.flat_map(move |(gain, (segment, until))| {
            // What would turn after the segment is over does not.
            let turn = (segment.from + turn(gain, deviation, segment)).min(until);
            let entered = deviation;
            deviation = behind(gain, deviation, segment, until - segment.from);
            [turn, until].map(|t| (of.instant(t), (entered, segment)))
        })
    }
}

/// The deviation `x` seconds into `segment`, which it enters with `deviation`.
fn behind(gain: f64, deviation: f64, segment: &Segment, x: f64) -> f64 {
    if x.is_infinite() {
        // Only the last segment of an endless trajectory, which has no acceleration.
        return segment.start.speed / gain;
    }
    // What a rounding error left over may start after the end, which is on a whole nanosecond.
    let x = x.max(0.0);
    // The share of the way to the new balance, and what of the time went into growth.
    let share = -(-gain * x).exp_m1();
    let lagged = share / gain;
    deviation * (1.0 - share) + segment.start.speed * lagged + segment.accel * (x - lagged) / gain
}

/// Seconds into `segment` after which the deviation, `deviation` at its start, comes to `target`: exact at constant
/// speed, else as near as Newton gets in a few steps.
fn comes_to(gain: f64, deviation: f64, segment: &Segment, target: f64) -> f64 {
    let growth = segment.accel / gain;
    let steady = segment.start.speed / gain - growth / gain;
    let rest = deviation - steady;
    let at_constant_speed = (rest / (target - steady)).ln() / gain;
    if growth == 0.0 {
        return at_constant_speed;
    }
    let step = |x: f64| {
        let decayed = rest * (-gain * x).exp();
        x - (steady + growth * x + decayed - target) / (growth - gain * decayed)
    };
    let start = ((target - steady) / growth).max(0.0);
    (0..4).fold(start, |x, _| step(x))
}

/// Seconds into `segment` at which the deviation turns round; zero if it does not.
fn turn(gain: f64, deviation: f64, segment: &Segment) -> f64 {
    // d = steady + growth * x + rest * exp(-K x); its slope is zero where exp(-K x) = growth / (K rest).
    let growth = segment.accel / gain;
    let rest = deviation - segment.start.speed / gain + growth / gain;
    let ratio = gain * rest / growth;
    if ratio > 1.0 { ratio.ln() / gain } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{instants, trajectories};
    use proptest::prelude::*;

    #[test]
    fn at_speed_it_is_speed_by_gain() {
        let of = Trajectory::to_speed(Instant::ZERO, State::at_rest(0.0), 2000.0, 1e4, 1e4);
        let lag = Lag::new(40.0);
        let late = Instant::from_millis(3_600_000);
        assert_eq!(lag.deviation(&of, Instant::ZERO), 0.0);
        assert!((lag.deviation(&of, late) - 50.0).abs() < 1e-9);
        assert!((lag.feedback(&of, late).speed - 2000.0).abs() < 1e-6);
        assert_eq!(lag.settles_at(&of, 5.0), None);
        assert_eq!(lag.position(&of, late), of.position(late) - 50);
    }

    #[test]
    fn exceeds_a_limit_by_a_logarithm() {
        let from = State { position: 0.0, speed: 1000.0 };
        let of = Trajectory::to_speed(Instant::ZERO, from, 1000.0, 1e4, 1e4);
        let lag = Lag::new(50.0);
        // It tends to 20 counts: half of that takes ln(2) / 50 s.
        let at = lag.exceeds_at(&of, 10.0, Instant::ZERO).expect("it gets so far behind");
        assert!((at.as_secs_f64() - 2f64.ln() / 50.0).abs() < 2e-9, "{at}");
        assert_eq!(lag.exceeds_at(&of, 20.0, Instant::ZERO), None);
        assert_eq!(Lag::NONE.exceeds_at(&of, 0.0, Instant::ZERO), None);
    }

    #[test]
    fn settles_by_a_logarithm() {
        let from = State { position: 0.0, speed: 1000.0 };
        let running = Trajectory::to_speed(Instant::ZERO, from, 1000.0, 1e4, 1e4);
        let now = Instant::from_millis(10_000);
        let of = Trajectory::halt(now, running.state(now));
        let lag = Lag::new(50.0);
        let lag = lag.with_deviation(lag.deviation(&running, now));
        // 20 counts behind; a tenth is left after ln(10) / 50 s.
        let at = lag.settles_at(&of, 2.0).expect("it settles");
        assert!((at.since(now).as_secs_f64() - 10f64.ln() / 50.0).abs() < 1e-8);
        assert_eq!(lag.position(&of, now), of.position(now) - 20);
        assert_eq!(lag.position(&of, now + Duration::from_secs(1)), of.position(now));
        assert_eq!(lag.settles_at(&of, 25.0), Some(now));
        assert_eq!(Lag::NONE.settles_at(&of, 0.0), Some(now));
        assert_eq!(Lag::new(f64::INFINITY).feedback(&running, now), running.state(now));
    }

    proptest! {
        #[test]
        fn obeys_its_equation(of in trajectories(), gain in 1.0..500.0, start in -100.0..100.0) {
            let lag = Lag { deviation: start, ..Lag::new(gain) };
            // Not across the seams, where the slope of the deviation changes.
            let seams: Vec<_> = of.spans().flat_map(|(it, until)| [it.from, until]).collect();
            for pair in instants(&of, 200).windows(2) {
                let (a, b) = (of.seconds(pair[0]), of.seconds(pair[1]));
                if seams.iter().any(|it| a - 1e-6 < *it && *it < b + 1e-6) || b - a < 1e-5 {
                    continue;
                }
                let (middle, h) = ((a + b) / 2.0, 1e-6);
                let d = |t| lag.deviation(&of, of.instant(t));
                let got = (d(middle + h) - d(middle - h)) / (2.0 * h);
                let want = of.speed(of.instant(middle)) - gain * d(middle);
                // What a difference quotient over rounded instants is worth.
                prop_assert!((got - want).abs() < 1e-2 * (1.0 + want.abs()), "{} {}", got, want);
            }
        }

        #[test]
        fn exceeds_a_limit_when_looking_says_so(
            of in trajectories(), gain in 1.0..500.0, start in -100.0..100.0, most in 0.5..3000.0, part in 0.0..1.0,
        ) {
            let lag = Lag { deviation: start, ..Lag::new(gain) };
            let instants = instants(&of, 400);
            let after = instants[(part * 399.0) as usize];
            let over = |at| lag.deviation(&of, at).abs() > most;
            let found = lag.exceeds_at(&of, most, after);
            if let Some(at) = found {
                prop_assert!(at > after && over(at) && !over(at - Duration::from_nanos(1)));
            }
            let mut was = over(after);
            for &at in instants.iter().filter(|at| **at > after) {
                if found.is_some_and(|found| found <= at) {
                    break;
                }
                let is = over(at);
                prop_assert!(was || !is, "missed before {}", at.as_nanos());
                was = is;
            }
        }

        #[test]
        fn does_not_jump(of in trajectories(), gain in 1.0..500.0, start in -100.0..100.0) {
            let lag = Lag { deviation: start, ..Lag::new(gain) };
            for pair in instants(&of, 100).windows(2) {
                let most = 30_000.0 + gain * (30_000.0 / gain + 100.0);
                let change = lag.deviation(&of, pair[1]) - lag.deviation(&of, pair[0]);
                prop_assert!(change.abs() <= most * pair[1].since(pair[0]).as_secs_f64() + 1e-6);
            }
        }

        #[test]
        fn carried_it_goes_on(of in trajectories(), gain in 1.0..500.0, part in 0.0..1.0) {
            let lag = Lag::new(gain);
            let all = instants(&of, 100);
            let now = all[(part * 99.0) as usize];
            let next = Trajectory::halt(now, of.state(now));
            let carried = lag.with_deviation(lag.deviation(&of, now));
            prop_assert_eq!(carried.deviation(&next, now), lag.deviation(&of, now));
            let window = 0.7;
            let at = carried.settles_at(&next, window).expect("it settles");
            prop_assert!(carried.deviation(&next, at).abs() <= window);
            let before = at - Duration::from_nanos(2);
            prop_assert!(at == now || carried.deviation(&next, before).abs() > window);
        }
    }
}
