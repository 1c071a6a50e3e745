//! Motion of one axis in closed form: where it is at `t`, and when it will be at `p`.
//!
//! Nothing ticks. A [`Trajectory`] is a few pieces of constant acceleration; its state at an instant is
//! a pure function of the two, so it does not matter how often anybody looks. What happens on the way
//! (switch edges, index pulses, hard stops) is solved for.
//!
//! Units: counts, counts per second, counts per second squared; all signed along the machine's own
//! coordinate. An acceleration that is zero, infinite or not a number means *at once*: that is what a
//! ramp time of zero comes to, whichever way the caller divides.
//!
//! Positions are whole when a move ends and fractional in between and after a stop. The whole count
//! shown is the last one reached, so it is rounded down. So an edge at count `n` lies where the shown
//! count changes between `n - 1` and `n`, in both directions.
//!
//! Deliberately absent: torque, inertia, jerk; what starts or ends a motion; any rounding of ramps to a
//! control cycle.

mod lag;
mod machine;
mod plan;
mod search;
#[cfg(test)]
mod tests;
mod trajectory;

pub use lag::Lag;
pub use machine::{Hit, Index, IndexPulse, Machine, Switch, SwitchEdge, Zone};
pub use plan::Move;
pub use search::first_equal;
pub use trajectory::Trajectory;

/// Where an axis is and how fast it goes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct State {
    /// Counts.
    pub position: f64,
    /// Counts per second; its sign is the direction.
    pub speed: f64,
}

impl State {
    /// Standing at `position`.
    pub const fn at_rest(position: f64) -> Self {
        Self { position, speed: 0.0 }
    }
}

/// Through which side something is passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrossingDirection {
    /// From below to at or above.
    Rising,
    /// From at or above to below.
    Falling,
}

impl CrossingDirection {
    /// Is `value` past `mark`, for an axis that goes this way? A mark belongs to its upper side, so
    /// that zones `[from, to)` can be made of two of them.
    fn is_past(self, value: f64, mark: f64) -> bool {
        match self {
            Self::Rising => value >= mark,
            Self::Falling => value < mark,
        }
    }

    /// The direction as a factor.
    fn sign(self) -> f64 {
        match self {
            Self::Rising => 1.0,
            Self::Falling => -1.0,
        }
    }
}
