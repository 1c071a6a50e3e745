//! What a motion is to come to: a speed, a position or a standstill, and how.

use crate::motion::{Move, State, Trajectory};
use crate::time::Instant;

/// How fast a speed changes. 0 of either is at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slope {
    /// Counts per second squared.
    Rate(f64),
    /// Seconds for the whole change, that is from the start speed to the speed.
    Time(f64),
}

impl Slope {
    /// In counts per second squared, where the whole change is `change` counts per second. Not a number above
    /// 0 is at once.
    pub fn of(self, change: f64) -> f64 {
        match self {
            Self::Rate(rate) => rate,
            Self::Time(time) => change / time,
        }
    }
}

/// A speed and how to get to it and from it; counts per second, the sign is the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Where to.
    pub speed: f64,
    /// Getting faster.
    pub accel: Slope,
    /// Getting slower.
    pub decel: Slope,
    /// A magnitude that is taken at once.
    pub start_speed: f64,
}

impl Ramp {
    /// The change of speed that a ramp in time is about.
    pub fn change(&self) -> f64 {
        (self.speed.abs() - self.start_speed).max(0.0)
    }

    /// The trajectory that keeps its speed. A speed above it is part of the change.
    pub(super) fn keep(&self, now: Instant, from: State) -> Trajectory {
        let Move { start_speed, accel, decel, .. } = self.plan(from);
        Trajectory::to_speed_with_start(now, from, self.speed, accel, decel, start_speed)
    }

    /// The trajectory that ends at `target`.
    pub(super) fn reach(&self, now: Instant, from: State, target: i64) -> Trajectory {
        Trajectory::to_position(now, from, target, self.plan(from))
    }

    /// The same for an axis that moves already: it takes no start speed at once.
    #[must_use]
    pub(super) fn in_motion(&self, from: State) -> Self {
        let start_speed = match from.speed {
            0.0 => self.start_speed,
            speed => self.start_speed.min(speed.abs()),
        };
        Self { start_speed, ..*self }
    }

    fn plan(&self, from: State) -> Move {
        let start_speed = self.start_speed;
        let change = (self.speed.abs().max(from.speed.abs()) - start_speed).max(0.0);
        let [accel, decel] = [self.accel, self.decel].map(|it| it.of(change));
        Move { start_speed, speed: self.speed.abs(), accel, decel }
    }
}

/// What a motion is to come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// Nothing that settings could change.
    None,
    /// To keep a speed.
    Speed(Ramp),
    /// To stand at a count of the machine.
    Position(i64, Ramp),
    /// To stand, after a ramp from a speed of so many counts per second at most.
    Stop(Slope, f64),
}

impl Goal {
    /// How a stop slows down, and from which change of speed, in counts per second squared.
    pub(super) fn stop(&self, decel: Option<Slope>) -> (Slope, f64) {
        match self {
            Self::None => (decel.unwrap_or(Slope::Rate(0.0)), 0.0),
            Self::Speed(ramp) | Self::Position(_, ramp) => {
                (decel.unwrap_or(ramp.decel), ramp.change())
            }
            Self::Stop(slope, change) => (decel.unwrap_or(*slope), *change),
        }
    }
}
