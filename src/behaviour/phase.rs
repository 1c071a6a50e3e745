//! What an axis is doing, and what it tells about it.

use crate::time::Duration;
use crate::vocabulary::{HomeEnd, HomingStep};

/// What an axis is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Nothing.
    Standing,
    /// Going to a position.
    Moving,
    /// Going at a speed by order.
    Running,
    /// Going at a speed while a level asks for it.
    Jogging {
        /// In the positive direction?
        forward: bool,
    },
    /// Looking for its origin.
    Homing,
    /// Slowing down.
    Stopping,
    /// Running out.
    Coasting,
}

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

/// A new phase, as it is told: machine counts, counts per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionReport {
    /// It goes to this position.
    Moves(i64),
    /// It goes at this speed by order.
    Runs(f64),
    /// It goes at this speed while a level asks for it.
    Jogs(f64),
    /// It goes by another setting from now on.
    Replans(Replan),
    /// A level holds its move back: it slows down to a standstill.
    Pauses,
    /// The move goes on to this position.
    Resumes(i64),
    /// It gives up so many counts that it was behind its command.
    Clears(i64),
    /// It slows down.
    Stops,
    /// It runs out without power.
    Coasts,
    /// It stands at this position.
    Stands(i64),
    /// A limit ends the motion.
    Limit {
        /// The positive one?
        forward: bool,
        /// One that the drive keeps by itself, without a switch?
        soft: bool,
    },
    /// It runs against a hard stop at this position.
    Hits(i64),
    /// It should be farther from where it is than is allowed.
    Deviates,
    /// It takes a homing step, at this speed.
    Seeks(HomingStep, f64),
    /// What a homing step waited for has come at this position.
    Finds(HomingStep, i64),
    /// It has come to a limit instead.
    FindsLimit {
        /// The positive one?
        forward: bool,
        /// Does it go on from there?
        turns: bool,
        /// Where.
        at: i64,
    },
    /// It looks for the index pulse that refines its origin.
    Refines {
        /// In the positive direction?
        forward: bool,
    },
    /// The index pulse that refines the origin has come at this position.
    Refined(i64),
    /// The homing is over: this is the origin.
    Homed(i64),
    /// The homing is over without an origin.
    Lost {
        /// Why.
        why: HomeEnd,
        /// In which direction it went.
        forward: bool,
        /// Is it a fault?
        alarm: bool,
    },
}
