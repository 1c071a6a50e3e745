//! What models say about motions: the steps of homing methods, targets, chains of segments, interrupt positioning.

use super::{Input, named_terms};

/// Most steps that one list of a method can have.
pub const MOST_STEPS: usize = 6;

/// One step: go until something happens, then do something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HomingStep {
    /// In the positive direction?
    pub forward: bool,
    /// How fast.
    pub pace: Pace,
    /// Until what.
    pub until: Until,
    /// And then.
    pub then: Then,
}

named_terms! {
    /// How fast a homing step goes.
    Pace {
        Fast "fast" "at `home.speed_fast`",
        Slow "slow" "at `home.speed_slow`",
    }
}

/// What a homing step waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Until {
    /// A switch changes.
    Edge(SignalEdge),
    /// An index pulse comes; with an edge, the first one after it.
    Index(Option<SignalEdge>),
    /// The index pulse comes again that ended an earlier step.
    SameIndex,
    /// The axis is pressed against a hard stop.
    Collision,
}

impl Until {
    /// The change of a switch in it.
    pub fn edge(self) -> Option<SignalEdge> {
        match self {
            Self::Edge(edge) => Some(edge),
            Self::Index(edge) => edge,
            Self::SameIndex | Self::Collision => None,
        }
    }
}

/// A change of a switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SignalEdge {
    /// Which signal.
    pub signal: Input,
    /// Does it turn on?
    pub on: bool,
}

named_terms! {
    /// What happens at the end of a homing step.
    Then {
        Ramp "ramp" "decelerate to standstill, then continue with the next step",
        Keep "keep" "continue with the next step without stopping",
        Origin "origin" "this position is the origin",
    }
}

/// Steps in order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Steps {
    steps: [Option<HomingStep>; MOST_STEPS],
}

impl Steps {
    /// Those of `steps` that there is room for.
    pub fn new(steps: &[HomingStep]) -> Self {
        let mut all = [None; MOST_STEPS];
        all.iter_mut().zip(steps).for_each(|(slot, step)| *slot = Some(*step));
        Self { steps: all }
    }

    /// Step `index`, from 0.
    pub fn get(&self, index: usize) -> Option<HomingStep> {
        self.steps.get(index).copied().flatten()
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = HomingStep> + '_ {
        self.steps.iter().flatten().copied()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.steps[0].is_none()
    }
}

/// A homing method.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Method {
    /// The switch that decides where it begins.
    pub by: Option<Input>,
    /// The steps, where that switch is off at the start. None at all: the origin is where the axis stands.
    pub steps: Steps,
    /// The steps after the first one's way ended at a limit instead.
    pub at_limit: Steps,
    /// The steps where the switch is on at the start.
    pub on: Steps,
    /// Does an index pulse refine the origin, where the drive is set so?
    pub index: bool,
}

impl Method {
    /// Every step that it may take.
    pub fn all_steps(&self) -> impl Iterator<Item = HomingStep> + '_ {
        [&self.steps, &self.at_limit, &self.on].into_iter().flat_map(Steps::iter)
    }
}

named_terms! {
    /// What happens when a limit ends the way of a homing step.
    LimitRule {
        Turn "turn" "the method continues with its steps `at_limit`; without any, the axis waits there until `home.time_limit`, or without one the homing is aborted",
        Alarm "alarm" "the homing is aborted with alarm `homing_limit_pos` or `homing_limit_neg`",
    }
}

named_terms! {
    /// What tells a homing that the axis has come to a limit.
    LimitSource {
        Switch "switch" "the limit switch",
        HardStop "hard_stop" "the hard stop",
        Either "either" "whichever comes first",
    }
}

named_terms! {
    /// How an index pulse refines the origin of methods that say `index: true`.
    IndexRule {
        None "none" "not used",
        Back "back" "the origin is the next index pulse against the direction of the method's first step",
        Onward "onward" "the origin is the next index pulse in the direction of the method's first step; a limit switch named in `by` does not stop this search",
    }
}

named_terms! {
    /// How an axis stands at its origin.
    OriginStop {
        AtOnce "at_once" "immediately, exactly on it",
        Ramp "ramp" "with a ramp, slightly beyond it",
    }
}

named_terms! {
    /// What the position register says when a homing is over.
    OriginPosition {
        Coordinate "coordinate" "`home.coordinate`",
        Zero "zero" "0",
        MinusCoordinate "minus_coordinate" "`home.coordinate` with the sign inverted",
        Kept "kept" "unchanged",
        KeptPlus "kept_plus_coordinate" "unchanged, plus `home.coordinate`",
        KeptMinus "kept_minus_coordinate" "unchanged, minus `home.coordinate`",
    }
}

named_terms! {
    /// What can start a homing, where a row decides about that.
    HomeStarter {
        Never "never" "nothing",
        Input "input" "signal `home_start`",
        Command "command" "action `home_start`",
        FirstEnable "first_enable" "the first enable after power-on",
    }
}

named_terms! {
    /// How an axis stops at a limit.
    LimitStop {
        Coast "coast" "it coasts, with the power stage off",
        Quick "quick" "at once",
        Ramp "ramp" "with the deceleration of the current motion",
    }
}

impl Default for LimitStop {
    /// As a switch in the power line would.
    fn default() -> Self {
        Self::Quick
    }
}

named_terms! {
    /// When soft limits are in force.
    SoftLimitRule {
        Off "off" "never",
        AfterHoming "after_homing" "once homing is complete",
        Always "always" "always",
    }
}

named_terms! {
    /// Why a homing ended without an origin.
    HomeEnd {
        Limit "limit" "limit reached",
        TimeLimit "time_limit" "time limit exceeded",
        Alarm "alarm" "alarm raised",
        Stopped "stopped" "axis stopped",
        PowerOff "power_off" "servo off",
        Replaced "replaced" "replaced by another motion",
    }
}

named_terms! {
    /// A condition for the next segment of a chain.
    Condition {
        Delay "delay" "the given time has passed since the axis came to be in position",
        Step "step" "a rising edge of input `segment_step` since the segment started",
        Position "position" "the axis has reached the given position since the segment started",
    }
}

named_terms! {
    /// What the target of a position segment is.
    Target {
        Relative "relative" "a distance",
        Absolute "absolute" "an absolute position",
        None "none" "the segment is empty and cannot be started",
    }
}

named_terms! {
    /// What becomes of what the axis is behind its command when that is inhibited.
    InhibitRule {
        Clears "clears" "it is cleared, as by `clear_deviation`",
        Keeps "keeps" "it is kept, and made up afterwards",
    }
}

named_terms! {
    /// What becomes of interrupt positioning.
    InterruptRule {
        Off "off" "`interrupt_start` has no effect",
        Free "free" "each `interrupt_start` is accepted",
        Locks "locks" "after one has run, further ones are locked until `interrupt_unlock`",
    }
}

named_terms! {
    /// How long a velocity segment lasts.
    Lasts {
        Level "level" "while `segment_run` is active",
        Edge "edge" "from the rising edge of `segment_run` until it is stopped",
    }
}
