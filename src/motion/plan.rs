//! A trajectory in the making: what an axis can be told (stand, stop, coast, go to a speed, go to a position; from any
//! state), as ramps and cruises, one after the other.
//!
//! All speeds are continuous but for ramps that happen at once and for the start speed of a move, which
//! a stepper takes and drops without a ramp.

use super::trajectory::{MOST_SEGMENTS, SNAP, Segment, after, snap};
use super::{State, Trajectory};
use crate::time::{Duration, Instant};

/// Faster than any axis. Keeps squares and quotients finite.
const TOP_SPEED: f64 = 1e15;

/// Slower and faster than any ramp, for the same reason.
const LEAST_RAMP: f64 = 1e-6;
const MOST_RAMP: f64 = 1e18;

/// How a move to a position goes about it. Speeds are magnitudes; below zero counts as zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Taken at once from standstill, and dropped at once at the end; counts per second. Not above
    /// `speed`, where it stops to matter.
    pub start_speed: f64,
    /// Counts per second. With zero the axis brakes and never arrives.
    pub speed: f64,
    /// Counts per second squared.
    pub accel: f64,
    /// Counts per second squared.
    pub decel: f64,
}

impl Move {
    fn cleaned(self) -> Self {
        // Not `clamp`, which would let a NaN pass.
        let magnitude = |it: f64| if it > 0.0 { it } else { 0.0 };
        let speed = magnitude(self.speed).min(TOP_SPEED);
        Self {
            start_speed: magnitude(self.start_speed).min(speed),
            speed,
            accel: slope(self.accel),
            decel: slope(self.decel),
        }
    }
}

impl Trajectory {
    /// Standing at `position`.
    pub fn rest(now: Instant, position: f64) -> Self {
        Plan::new(now, State::at_rest(position)).rest(position)
    }

    /// Standing at once where it is.
    pub fn halt(now: Instant, from: State) -> Self {
        Self::rest(now, from.position)
    }

    /// Ramps down to rest.
    pub fn stop(now: Instant, from: State, decel: f64) -> Self {
        Self::to_speed(now, from, 0.0, decel, decel)
    }

    /// Runs out to rest, which takes `time` from whatever speed.
    pub fn coast(now: Instant, from: State, time: Duration) -> Self {
        Self::stop(now, from, from.speed.abs() / time.as_secs_f64())
    }

    /// Goes to `speed` and stays there; to the other direction through zero, with `decel` before it
    /// and `accel` after.
    pub fn to_speed(now: Instant, from: State, speed: f64, accel: f64, decel: f64) -> Self {
        Self::to_speed_with_start(now, from, speed, accel, decel, 0.0)
    }

    /// The same, for an axis that takes `start_speed`, a magnitude, without a ramp.
    pub fn to_speed_with_start(
        now: Instant,
        from: State,
        speed: f64,
        accel: f64,
        decel: f64,
        start_speed: f64,
    ) -> Self {
        let speed = if speed.is_nan() { 0.0 } else { speed.clamp(-TOP_SPEED, TOP_SPEED) };
        let start_speed = if start_speed > 0.0 { start_speed.min(speed.abs()) } else { 0.0 };
        let (accel, decel) = (slope(accel), slope(decel));
        let mut plan = Plan::new(now, from);
        if from.speed * speed < 0.0 {
            plan.ramp(from.speed.clamp(-start_speed, start_speed), decel);
            plan.at.speed = 0.0;
        }
        if plan.at.speed.abs() < start_speed {
            plan.at.speed = start_speed.copysign(speed);
        }
        let faster = speed.abs() > plan.at.speed.abs();
        plan.ramp(speed, if faster { accel } else { decel });
        if speed != 0.0 {
            return plan.forever();
        }
        let position = plan.at.position;
        plan.rest(position)
    }

    /// Goes to `target` and rests there: a trapezoid, or where the way is short a triangle with the
    /// same slopes. An axis that moves away, or comes too fast to stop in time, brakes and returns.
    pub fn to_position(now: Instant, from: State, target: i64, how: Move) -> Self {
        let Move { start_speed, speed, accel, decel } = how.cleaned();
        let target = target as f64;
        let mut plan = Plan::new(now, from);
        if !plan.can_reach(target, start_speed, decel) {
            plan.ramp(plan.at.speed.clamp(-start_speed, start_speed), decel);
            plan.at.speed = 0.0;
        }
        if speed == 0.0 {
            plan.ramp(0.0, decel);
        }
        let way = target - plan.at.position;
        // Braking may end on the target: nothing to return from then but a rounding error.
        if way.abs() < SNAP {
            return plan.rest(target);
        }
        if speed == 0.0 {
            return plan.forever();
        }
        let (sign, way) = (way.signum(), way.abs());
        let first = (plan.at.speed * sign).max(start_speed);
        plan.at.speed = first * sign;
        let (peak, slope) = if first > speed {
            (speed, decel)
        } else {
            // The two ramps meet where their ways add up to the whole way.
            let (up, down) = (0.5 / accel, 0.5 / decel);
            let ways = way + first * first * up + start_speed * start_speed * down;
            ((ways / (up + down)).sqrt().clamp(first, speed), accel)
        };
        let ramps = ramp_way(first, peak, slope) + ramp_way(peak, start_speed, decel);
        plan.ramp(peak * sign, slope);
        plan.cruise((way - ramps) / peak);
        plan.ramp(start_speed * sign, decel);
        plan.rest(target)
    }
}

/// A trajectory as far as it is made.
struct Plan {
    begin: Instant,
    /// Seconds since the beginning.
    t: f64,
    /// The state there.
    at: State,
    segments: [Segment; MOST_SEGMENTS],
    len: usize,
}

impl Plan {
    /// Nothing yet.
    fn new(begin: Instant, from: State) -> Self {
        Self { begin, t: 0.0, at: from, segments: Default::default(), len: 0 }
    }

    /// Changes speed at `slope`. Not through zero: the sign of the speed holds within a segment.
    fn ramp(&mut self, speed: f64, slope: f64) {
        let seconds = (speed - self.at.speed).abs() / slope;
        if seconds > 0.0 {
            let mean = 0.5 * (self.at.speed + speed);
            self.push((speed - self.at.speed) / seconds, seconds, mean);
        }
        self.at.speed = speed;
    }

    /// Keeps its speed.
    fn cruise(&mut self, seconds: f64) {
        // Below zero it is the rounding error of a triangle.
        if seconds > 0.0 {
            self.push(0.0, seconds, self.at.speed);
        }
    }

    fn push(&mut self, accel: f64, seconds: f64, mean: f64) {
        self.segments[self.len] = Segment { from: self.t, start: self.at, accel };
        self.len += 1;
        self.t += seconds;
        self.at.position += mean * seconds;
    }

    /// Can it stop at `target` without turning round? Up to the start speed it can at any time.
    fn can_reach(&self, target: f64, start_speed: f64, decel: f64) -> bool {
        let way = target - self.at.position;
        let towards = self.at.speed * way.signum();
        let brakes =
            if towards > start_speed { ramp_way(towards, start_speed, decel) } else { 0.0 };
        towards >= -start_speed && brakes <= way.abs()
    }

    /// And stands there.
    fn rest(self, position: f64) -> Trajectory {
        let end = Some(self.begin + after(self.t));
        self.trajectory(end, snap(position))
    }

    /// And so on for ever.
    fn forever(mut self) -> Trajectory {
        self.push(0.0, 0.0, 0.0);
        let rest = self.at.position;
        self.trajectory(None, rest)
    }

    fn trajectory(self, end: Option<Instant>, rest: f64) -> Trajectory {
        let Self { begin, segments, len, .. } = self;
        Trajectory { begin, segments, len, end, rest }
    }
}

/// Counts covered between two speeds.
fn ramp_way(from: f64, to: f64, slope: f64) -> f64 {
    (from * from - to * to).abs() * 0.5 / slope
}

/// An acceleration as the caller means it: what is no ramp is at once.
fn slope(accel: f64) -> f64 {
    if accel > 0.0 && accel < MOST_RAMP { accel.max(LEAST_RAMP) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOW: Move = Move { start_speed: 0.0, speed: 1000.0, accel: 5000.0, decel: 2000.0 };

    fn go(from: State, target: i64, how: Move) -> Trajectory {
        Trajectory::to_position(Instant::ZERO, from, target, how)
    }

    /// Position and speed every so many milliseconds.
    fn states(of: &Trajectory, ms: &[u64]) -> Vec<(f64, f64)> {
        let state = |ms: &u64| of.state(Instant::from_millis(*ms));
        ms.iter().map(|ms| (state(ms).position, state(ms).speed)).collect()
    }

    fn end_ms(of: &Trajectory) -> Option<f64> {
        of.end().map(|it| it.as_nanos() as f64 / 1e6)
    }

    #[test]
    fn trapezoid() {
        // 200 ms up on 100 counts, 500 ms down on 250, the other 650 at full speed.
        let of = go(State::at_rest(0.0), 1000, HOW);
        let states = states(&of, &[0, 100, 200, 850, 1100, 1350, 9999]);
        let want = [(0.0, 0.0), (25.0, 500.0), (100.0, 1000.0), (750.0, 1000.0), (937.5, 500.0)];
        assert_eq!(states[..5], want);
        assert_eq!(states[5..], [(1000.0, 0.0); 2]);
        assert_eq!(end_ms(&of), Some(1350.0));
        assert!(of.is_moving(Instant::ZERO) && !of.is_moving(Instant::from_millis(1350)));
    }

    #[test]
    fn triangle_with_the_same_slopes() {
        // 40 counts up and 100 down would meet at sqrt(2 * 5000 * 40).
        let of = go(State::at_rest(0.0), -140, HOW);
        let peak = (2.0 * 5000.0 * 40.0_f64).sqrt();
        let top = of.state(of.instant(peak / 5000.0));
        assert!((top.position + 40.0).abs() < 1e-4 && (top.speed + peak).abs() < 1e-4, "{top:?}");
        let want = (peak / 5000.0 + peak / 2000.0) * 1e3;
        assert!((end_ms(&of).expect("an end") - want).abs() < 1e-5);
    }

    #[test]
    fn too_late_brakes_and_returns() {
        // Stops at 250, 150 beyond.
        let of = go(State { position: 0.0, speed: 1000.0 }, 100, HOW);
        assert_eq!(states(&of, &[500]), [(250.0, 0.0)]);
        assert_eq!(of.state(Instant::from_millis(5000)), State::at_rest(100.0));
        let away = go(State { position: 0.0, speed: -1000.0 }, 100, HOW);
        assert_eq!(states(&away, &[500]), [(-250.0, 0.0)]);
        // Just in time.
        let of = go(State { position: 0.0, speed: 1000.0 }, 250, HOW);
        assert_eq!(end_ms(&of), Some(500.0));
    }

    #[test]
    fn too_fast_slows_down_to_its_speed() {
        let of = go(State { position: 0.0, speed: 2000.0 }, 2000, HOW);
        assert_eq!(states(&of, &[500, 1500]), [(750.0, 1000.0), (1750.0, 1000.0)]);
        assert_eq!(end_ms(&of), Some(2000.0));
    }

    #[test]
    fn start_speed_is_taken_and_dropped_at_once() {
        let how = Move { start_speed: 200.0, ..HOW };
        let of = go(State::at_rest(0.0), 1000, how);
        let end = of.end().expect("an end");
        let last = of.speed(end - Duration::from_nanos(1));
        assert_eq!((of.speed(Instant::ZERO), of.speed(end)), (200.0, 0.0));
        assert!((last - 200.0).abs() < 1e-3, "{last}");
        // Not faster than the move itself.
        let slow = go(State::at_rest(0.0), 100, Move { speed: 100.0, ..how });
        assert_eq!(end_ms(&slow), Some(1000.0));
        // A crawl the wrong way turns round at once.
        let of = go(State { position: 0.0, speed: -150.0 }, 1000, how);
        assert_eq!(of.speed(Instant::ZERO), 200.0);
        // Faster than that it brakes to it, and turns round at once from there.
        let of = go(State { position: 0.0, speed: -1000.0 }, 1000, how);
        assert_eq!(states(&of, &[400]), [(-240.0, 200.0)]);
    }

    #[test]
    fn triangle_on_a_start_speed() {
        let how = Move { start_speed: 200.0, decel: 5000.0, ..HOW };
        let of = go(State::at_rest(0.0), 64, how);
        assert_eq!(states(&of, &[80, 160]), [(32.0, 600.0), (64.0, 0.0)]);
        assert_eq!(end_ms(&of), Some(160.0));
    }

    #[test]
    fn no_ramp_is_at_once() {
        for none in [0.0, f64::INFINITY, f64::NAN, -1.0] {
            let how = Move { accel: none, decel: none, ..HOW };
            let of = go(State { position: 0.0, speed: -700.0 }, 500, how);
            assert_eq!(states(&of, &[0, 250]), [(0.0, 1000.0), (250.0, 1000.0)]);
            assert_eq!(end_ms(&of), Some(500.0));
            let of = Trajectory::stop(Instant::ZERO, State { position: 3.5, speed: 9.0 }, none);
            assert_eq!((end_ms(&of), of.state(Instant::ZERO)), (Some(0.0), State::at_rest(3.5)));
        }
    }

    #[test]
    fn without_speed_it_never_arrives() {
        let of = go(State { position: 0.0, speed: 200.0 }, 1000, Move { speed: 0.0, ..HOW });
        assert_eq!(states(&of, &[100, 9000]), [(10.0, 0.0), (10.0, 0.0)]);
        assert_eq!(of.end(), None);
        assert!(of.is_moving(Instant::ZERO) && !of.is_moving(Instant::from_millis(100)));
        let there = go(State::at_rest(10.0), 10, Move { speed: f64::NAN, ..HOW });
        assert_eq!(end_ms(&there), Some(0.0));
    }

    #[test]
    fn reverses_through_zero() {
        let from = State { position: 0.0, speed: 1000.0 };
        let of = Trajectory::to_speed(Instant::ZERO, from, -500.0, 5000.0, 2000.0);
        let want = [(250.0, 0.0), (225.0, -500.0), (-275.0, -500.0)];
        assert_eq!(states(&of, &[500, 600, 1600]), want);
        assert_eq!(of.end(), None);
        assert!(of.is_moving(Instant::from_millis(500)));
    }

    #[test]
    fn a_run_takes_its_start_speed_at_once() {
        let run = |from: f64, speed: f64, start_speed: f64| {
            let from = State { position: 0.0, speed: from };
            let now = Instant::ZERO;
            Trajectory::to_speed_with_start(now, from, speed, 5000.0, 2000.0, start_speed)
        };
        assert_eq!(states(&run(0.0, 1000.0, 200.0), &[0, 160]), [(0.0, 200.0), (96.0, 1000.0)]);
        // Not above the speed of the run, and of no matter to what is faster already.
        assert_eq!(states(&run(0.0, -100.0, 200.0), &[0, 100]), [(0.0, -100.0), (-10.0, -100.0)]);
        assert_eq!(run(300.0, 1000.0, 200.0), run(300.0, 1000.0, 0.0));
        // Turning round it drops it at once and takes it at once.
        assert_eq!(
            states(&run(1000.0, -500.0, 200.0), &[400, 460]),
            [(240.0, -200.0), (219.0, -500.0)]
        );
    }

    #[test]
    fn coasting_takes_its_time() {
        let from = State { position: 10.5, speed: -1000.0 };
        let of = Trajectory::coast(Instant::ZERO, from, Duration::from_millis(200));
        assert_eq!((end_ms(&of), of.position(Instant::from_millis(200))), (Some(200.0), -90));
        assert_eq!(of.state(Instant::from_millis(200)).position, -89.5);
        let at_once = Trajectory::coast(Instant::ZERO, from, Duration::ZERO);
        assert_eq!(at_once, Trajectory::halt(Instant::ZERO, from));
    }
}
