//! What the state machines of a drive report: one kind of value from the power stage and the axis alike.

use crate::time::Duration;
use crate::vocabulary::{AlarmCause, HomeEnd, HomingStep};

/// What has become different about a motion under way: machine counts, counts per second (squared).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Replan {
    /// Where a move ends.
    Target(i64),
    /// The speed; of a homing the fast one.
    Speed(f64),
    /// The slow speed of a homing.
    SlowSpeed(f64),
    /// The speed that is taken at once.
    StartSpeed(f64),
    /// Getting faster; what is not above 0 or not finite is at once.
    Accel(f64),
    /// Getting slower; likewise.
    Decel(f64),
    /// How far a homing goes on from the origin.
    HomeOffset(i64),
    /// How long a homing may take since it began.
    TimeLimit(Option<Duration>),
}

/// What has happened to the power stage or the axis, for the drive to act on and to report: machine counts, counts per
/// second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effect {
    /// Initialising is over.
    Ready,
    /// The power stage is on from now on, or off.
    Enabled(bool),
    /// The first alarm since there was none.
    AlarmRaised {
        /// Why.
        cause: AlarmCause,
        /// The vendor's number.
        code: u16,
    },
    /// There is no alarm any more.
    AlarmCleared,

    /// The axis starts a move to this position.
    MoveStarted(i64),
    /// The axis starts to run at this speed, by order.
    RunStarted(f64),
    /// The axis starts to run at this speed, while a level asks for it.
    JogStarted(f64),
    /// The motion under way goes by another setting from now on.
    Replanned(Replan),
    /// A level holds the move back: the axis slows down to a standstill.
    MovePaused,
    /// The move goes on to this position.
    MoveResumed(i64),
    /// The axis gives up so many counts that it was behind its command.
    DeviationCleared(i64),
    /// The axis slows down.
    Stopping,
    /// The axis coasts without power.
    Coasting,
    /// The axis has stopped at this position.
    Stopped(i64),
    /// A limit ends the motion.
    LimitReached {
        /// The positive one?
        forward: bool,
        /// One that the drive keeps by itself, without a switch?
        soft: bool,
    },
    /// The axis runs against a hard stop at this position.
    HardStopHit(i64),
    /// The axis is farther from its command than is allowed.
    DeviationExceeded,

    /// A homing step begins, at this speed.
    HomingStepStarted(HomingStep, f64),
    /// What a homing step waited for has come at this position.
    HomingStepDone(HomingStep, i64),
    /// A homing has come to a limit instead.
    HomingLimit {
        /// The positive one?
        forward: bool,
        /// Does it go on from there, the other way?
        turns: bool,
        /// Where.
        at: i64,
    },
    /// A homing looks for the index pulse that refines its origin.
    IndexSearchStarted {
        /// In the positive direction?
        forward: bool,
    },
    /// The index pulse that refines the origin has come at this position.
    IndexFound(i64),
    /// The homing is over: this is the origin.
    HomingDone(i64),
    /// The homing is over without an origin.
    HomingAborted {
        /// Why.
        why: HomeEnd,
        /// In which direction it went.
        forward: bool,
        /// Is it a fault?
        alarm: bool,
    },
}
