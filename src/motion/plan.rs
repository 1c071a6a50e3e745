//! A trajectory in the making: ramps and cruises, one after the other.

use super::trajectory::{MOST_SEGMENTS, Segment, after, snap};
use super::{State, Trajectory};
use crate::time::Instant;

/// Faster than any axis. Keeps squares and quotients finite.
pub(super) const TOP_SPEED: f64 = 1e15;

/// Slower and faster than any ramp, for the same reason.
const LEAST_RAMP: f64 = 1e-6;
const MOST_RAMP: f64 = 1e18;

/// A trajectory as far as it is made.
pub(super) struct Plan {
    begin: Instant,
    /// Seconds since the beginning.
    t: f64,
    /// The state there.
    pub(super) at: State,
    segments: [Segment; MOST_SEGMENTS],
    len: usize,
}

impl Plan {
    /// Nothing yet.
    pub(super) fn new(begin: Instant, from: State) -> Self {
        Self { begin, t: 0.0, at: from, segments: Default::default(), len: 0 }
    }

    /// Changes speed at `slope`. Not through zero: the sign of the speed holds within a segment.
    pub(super) fn ramp(&mut self, speed: f64, slope: f64) {
        let seconds = (speed - self.at.speed).abs() / slope;
        if seconds > 0.0 {
            let mean = 0.5 * (self.at.speed + speed);
            self.push((speed - self.at.speed) / seconds, seconds, mean);
        }
        self.at.speed = speed;
    }

    /// Keeps its speed.
    pub(super) fn cruise(&mut self, seconds: f64) {
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
    pub(super) fn can_reach(&self, target: f64, start_speed: f64, decel: f64) -> bool {
        let way = target - self.at.position;
        let towards = self.at.speed * way.signum();
        let brakes =
            if towards > start_speed { ramp_way(towards, start_speed, decel) } else { 0.0 };
        towards >= -start_speed && brakes <= way.abs()
    }

    /// And stands there.
    pub(super) fn rest(self, position: f64) -> Trajectory {
        let end = Some(self.begin + after(self.t));
        self.trajectory(end, snap(position))
    }

    /// And so on for ever.
    pub(super) fn forever(mut self) -> Trajectory {
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
pub(super) fn ramp_way(from: f64, to: f64, slope: f64) -> f64 {
    (from * from - to * to).abs() * 0.5 / slope
}

/// An acceleration as the caller means it: what is no ramp is at once.
pub(super) fn slope(accel: f64) -> f64 {
    if accel > 0.0 && accel < MOST_RAMP { accel.max(LEAST_RAMP) } else { f64::INFINITY }
}
