//! What the levels ask of an axis: power, a stop, a pause, a jog, and within which limits.

use super::motion_state::{Ramp, Slope};
use crate::vocabulary::{Input, Inputs, LimitStop};

/// What the levels ask for right now.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MotorLevels {
    /// Power stage on?
    pub power: bool,
    /// Stand, after a ramp.
    pub stop: bool,
    /// Stand at once.
    pub quick_stop: bool,
    /// Hold a move back, to go on later.
    pub pause: bool,
    /// What becomes of the commands of moves.
    pub commands: Commands,
    /// Jog; `None` for neither direction, or both.
    pub jog: Option<Jog>,
    /// How a stop slows down that begins now, or is under way; `None` as the motion says.
    pub decel: Option<Slope>,
    /// The signals of home switch and limits, among others.
    pub switches: Inputs,
    /// Positions of the machine that the axis must not leave, if such are in force.
    pub soft_limits: Option<[i64; 2]>,
    /// How a limit stops it.
    pub limit_stop: LimitStop,
    /// Most counts between the axis and its command.
    pub deviation: Option<f64>,
}

/// A run that a level asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jog {
    /// How it goes.
    pub ramp: Ramp,
    /// Does another level ask for it than for the one under way?
    pub takes_over: bool,
    /// Does it go by the position, and not by the speed?
    pub by_position: bool,
}

/// What becomes of the commands of moves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Commands {
    /// The axis follows them.
    #[default]
    Taken,
    /// There are none; the axis makes up for what it is behind.
    Inhibited,
    /// There are none, and the axis gives up what it is behind.
    Cleared,
}

impl MotorLevels {
    /// Does a level hold the axis still?
    pub(super) fn hold(&self) -> bool {
        self.stop || self.quick_stop
    }

    /// Is an axis at `position` at the limit in that direction?
    pub(super) fn limit_at(&self, position: f64, forward: bool) -> bool {
        self.has_limit_switch(forward) || self.is_beyond_soft_limit(position, forward)
    }

    /// Is the limit switch in that direction active?
    pub(super) fn has_limit_switch(&self, forward: bool) -> bool {
        self.switches.has(limit_switch(forward))
    }

    fn is_beyond_soft_limit(&self, position: f64, forward: bool) -> bool {
        self.soft_limits.is_some_and(|[low, high]| {
            if forward { position > high as f64 } else { position < low as f64 }
        })
    }

    /// The soft limit in that direction.
    pub(super) fn soft_limit(&self, forward: bool) -> Option<i64> {
        self.soft_limits.map(|[low, high]| if forward { high } else { low })
    }
}

/// The limit switch in that direction.
pub(super) fn limit_switch(forward: bool) -> Input {
    if forward { Input::LimitPos } else { Input::LimitNeg }
}
