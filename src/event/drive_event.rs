//! What a drive does without being asked, or as a consequence. The documentation of variants and fields is that of the
//! public log: the schema and docs/log.md are made from it.

mod display;

use super::DeviceFault;
use super::decoder::{Decoder, RowName, TerminalName};
use super::no_effect::{Ignored, NoEffect};
use crate::serial::Mode;
use crate::time::Duration;
use crate::vocabulary::{AlarmCause, Condition, HomeEnd, HomingStep};
use display as shown;
use serde::Serialize;

/// Something that happened in a drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum DriveEvent {
    /// Power came on.
    PowerOn,
    /// Power went off.
    PowerOff,
    /// The drive is initialised and can be enabled.
    Ready,
    /// The power stage was switched on or off.
    Servo {
        /// On?
        on: bool,
    },
    /// An alarm was raised.
    Alarm {
        /// Its cause.
        cause: AlarmCause,
        /// The vendor's number of it.
        code: u16,
    },
    /// The alarm was cleared.
    AlarmCleared,
    /// The alarm history was cleared.
    AlarmHistoryCleared,
    /// An input word was not refreshed in time and was reset to 0.
    WordExpired {
        /// The code of the word's row.
        #[serde(rename = "row")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        word: RowName,
        /// The code of the row with its time.
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        hold: RowName,
        /// How long it was held, in milliseconds.
        held_ms: u32,
    },
    /// The position register was set to 0.
    PositionCleared,
    /// The multi-turn count of the encoder was set to 0.
    TurnsCleared,
    /// All parameters were stored.
    Stored,
    /// A master writes to non-volatile memory so often that it would wear out.
    ExcessiveWrites {
        /// The code of the row that was stored; null for all at once.
        #[cfg_attr(feature = "cli", schemars(with = "Option<String>"))]
        row: Option<RowName>,
        /// How often it was stored.
        writes: u32,
        /// In how many seconds; null since the drive left the factory.
        #[serde(rename = "within_s", serialize_with = "shown::seconds")]
        #[cfg_attr(feature = "cli", schemars(with = "Option<u64>"))]
        within: Option<Duration>,
    },
    /// All parameters were set to their factory defaults.
    FactoryRestored,
    /// The drive responds to another unit address from now on.
    UnitChanged {
        /// The old address.
        from: u8,
        /// The new address.
        to: u8,
    },
    /// The serial settings of the drive changed.
    ModeChanged {
        /// The old settings, such as `9600-8N2 RTU`; null where the parameters held undefined codes.
        from: Option<Mode>,
        /// The new settings; null where the parameters hold undefined codes.
        to: Option<Mode>,
    },
    /// A move started.
    Moving {
        /// The target position, in counts.
        to: i64,
    },
    /// A run by command started, or took another speed.
    Running {
        /// The speed in revolutions per minute; its sign is the direction.
        rpm: MilliRpm,
    },
    /// A jog started: a run while an input is active.
    Jogging {
        /// The speed in revolutions per minute; its sign is the direction.
        rpm: MilliRpm,
    },
    /// A position segment started.
    PositionSegment {
        /// The number of the segment.
        #[serde(rename = "segment")]
        number: u16,
        /// The target position, in counts.
        to: i64,
    },
    /// A velocity segment started.
    VelocitySegment {
        /// The number of the segment.
        #[serde(rename = "segment")]
        number: u16,
        /// The speed in revolutions per minute; its sign is the direction.
        rpm: MilliRpm,
    },
    /// A chain of segments goes to its next segment.
    ChainStep {
        /// The number of the segment so far.
        from: u16,
        /// The number of the next segment.
        to: u16,
        /// The condition that was met last.
        #[serde(serialize_with = "shown::condition")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        why: Option<Condition>,
    },
    /// A chain of segments ended at a segment that cannot follow.
    ChainEnded(#[cfg_attr(feature = "cli", schemars(with = "shown::ChainEndFields"))] ChainEnd),
    /// A setting was written that changes the motion in progress.
    Replanned(Replanned),
    /// An input holds the move back: the axis decelerates to a standstill, and the move is not over.
    Pausing,
    /// The move that was held back continues.
    Resumed {
        /// The target position, in counts.
        to: i64,
    },
    /// The position deviation was cleared.
    DeviationCleared {
        /// How much it was, in counts.
        counts: i64,
    },
    /// The axis decelerates to a standstill.
    Stopping,
    /// The power stage went off in motion: the axis coasts.
    Coasting,
    /// The axis has come to rest.
    Stopped {
        /// The position, in counts.
        at: i64,
    },
    /// A limit ends the motion.
    Limit {
        /// The positive limit, not the negative one?
        #[serde(rename = "positive")]
        forward: bool,
        /// A software limit, not a switch?
        soft: bool,
    },
    /// The axis was moved against a hard stop.
    HardStop {
        /// The position, in counts.
        at: i64,
    },
    /// The position deviation is above its threshold.
    PositionDeviation,
    /// A homing started.
    HomingStarted {
        /// The number of the homing method.
        method: i64,
    },
    /// A homing moves the axis until something happens.
    HomingMoving {
        /// The number of the homing method.
        method: i64,
        /// What ends this step.
        #[serde(rename = "until", serialize_with = "shown::step_end")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        step: HomingStep,
        /// The speed in revolutions per minute; its sign is the direction.
        rpm: MilliRpm,
    },
    /// What a homing step was waiting for has happened.
    HomingFound {
        /// The number of the homing method.
        method: i64,
        /// What it was (`until`), and what the axis does next (`then`).
        #[serde(flatten, serialize_with = "shown::step_found")]
        #[cfg_attr(feature = "cli", schemars(with = "shown::StepFound"))]
        step: HomingStep,
        /// The position, in counts.
        at: i64,
    },
    /// A homing step came to a limit instead.
    HomingLimit {
        /// The number of the homing method.
        method: i64,
        /// The positive limit, not the negative one?
        #[serde(rename = "positive")]
        forward: bool,
        /// Does the homing go on in the other direction? Otherwise it waits for its time limit.
        #[serde(rename = "reverses")]
        turns: bool,
        /// The position, in counts.
        at: i64,
    },
    /// A homing looks for the index pulse that refines its origin.
    HomingIndex {
        /// The number of the homing method.
        method: i64,
        /// In the positive direction?
        #[serde(rename = "positive")]
        forward: bool,
    },
    /// A homing has found its index pulse: the origin.
    HomingOrigin {
        /// The number of the homing method.
        method: i64,
        /// The position as it was counted until now, in counts.
        at: i64,
    },
    /// A homing is complete.
    HomingComplete {
        /// The number of the homing method.
        method: i64,
        /// What the position register reads now, in counts.
        position: i64,
    },
    /// A homing ended without an origin.
    HomingAborted {
        /// The number of the homing method.
        method: i64,
        /// Why.
        why: HomeEnd,
    },
    /// An order of a master, or a signal, has no effect. It is told once, however often the master repeats it.
    NoEffect(
        #[cfg_attr(feature = "cli", schemars(with = "super::no_effect::NoEffectFields"))] NoEffect,
    ),
    /// Something is wrong with the device from now on, or no longer.
    DeviceFault(
        #[cfg_attr(feature = "cli", schemars(with = "shown::DeviceFaultFields"))] DeviceFaultChange,
    ),
    /// The contact at an input terminal bounces.
    Bouncing {
        /// The name of the terminal.
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        terminal: TerminalName,
        /// How often it leaves its level and comes back.
        times: u16,
        /// From one edge to the next, in milliseconds.
        #[serde(rename = "every_ms", serialize_with = "shown::milliseconds")]
        #[cfg_attr(feature = "cli", schemars(with = "f64"))]
        every: Duration,
    },
    /// The level of an input terminal changed.
    Terminal {
        /// The name of the terminal.
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        terminal: TerminalName,
        /// With a signal, or without?
        signal: bool,
    },
}

impl DriveEvent {
    /// Can it change which requests the drive receives?
    pub fn changes_reach(&self) -> bool {
        matches!(
            self,
            Self::UnitChanged { .. } | Self::ModeChanged { .. } | Self::PowerOn | Self::PowerOff
        )
    }
}

/// A speed in thousandths of a revolution per minute; in JSON in revolutions per minute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MilliRpm(pub i64);

/// A chain of segments ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "shown::ChainEndFields")]
pub struct ChainEnd {
    /// Whose rows they are.
    pub decoder: Decoder,
    /// The number of the segment.
    pub at: u16,
    /// Why it cannot follow.
    pub why: Ignored,
}

/// A device fault came or went.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "shown::DeviceFaultFields")]
pub struct DeviceFaultChange {
    /// Whose terminals they are.
    pub decoder: Decoder,
    /// What is wrong.
    pub fault: DeviceFault,
    /// From now on?
    pub on: bool,
}

/// What has changed about a motion in progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum Replanned {
    /// Where a move ends.
    Target {
        /// The target position, in counts.
        #[serde(rename = "target")]
        to: i64,
    },
    /// The speed; of a homing the fast one.
    Speed {
        /// The speed in revolutions per minute; its sign is the direction.
        rpm: MilliRpm,
    },
    /// The slow speed of a homing.
    SlowSpeed {
        /// The slow homing speed in revolutions per minute.
        #[serde(rename = "slow_rpm")]
        rpm: MilliRpm,
    },
    /// The speed that is taken at once.
    StartSpeed {
        /// The start speed in revolutions per minute.
        #[serde(rename = "start_rpm")]
        rpm: MilliRpm,
    },
    /// How it gets faster.
    Acceleration {
        /// The acceleration in revolutions per minute per second; null is without a ramp.
        #[serde(rename = "acceleration_rpm_s")]
        rpm_per_s: Option<MilliRpm>,
    },
    /// How it gets slower.
    Deceleration {
        /// The deceleration in revolutions per minute per second; null is without a ramp.
        #[serde(rename = "deceleration_rpm_s")]
        rpm_per_s: Option<MilliRpm>,
    },
    /// How far a homing goes on from the origin.
    HomeOffset {
        /// The home offset, in counts.
        #[serde(rename = "offset")]
        by: i64,
    },
    /// How long a homing may take.
    TimeLimit {
        /// The time limit of the homing since it started, in seconds; null is none.
        #[serde(rename = "time_limit_s", serialize_with = "shown::fractional_seconds")]
        #[cfg_attr(feature = "cli", schemars(with = "Option<f64>"))]
        time: Option<Duration>,
    },
}
