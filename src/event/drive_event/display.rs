//! Events of drives as text, and those of their fields that JSON tells in another shape.

use super::super::{DeviceFault, on_off};
use super::{ChainEnd, DeviceFaultChange, DriveEvent, MilliRpm, Replanned};
use crate::time::Duration;
use crate::vocabulary::{AlarmCause, Condition, HomingStep, Named, SignalEdge, Then, Until};
use serde::{Serialize, Serializer};
use std::fmt;

impl fmt::Display for DriveEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PowerOn => f.write_str("power on"),
            Self::PowerOff => f.write_str("power off"),
            Self::Ready => f.write_str("ready"),
            Self::Servo { on } => write!(f, "servo {}", on_off(*on)),
            Self::Alarm { cause, code } => write!(f, "alarm {code}: {}", cause.about()),
            Self::AlarmCleared => f.write_str("alarm cleared"),
            Self::AlarmHistoryCleared => f.write_str("alarm history cleared"),
            Self::WordExpired { word, hold, held_ms } => {
                let (held, hold) = (f64::from(*held_ms) / 1000.0, &hold.0.row(hold.1).id);
                write!(f, "{word} reset to 0: not refreshed for {held} s ({hold})")
            }
            Self::PositionCleared => f.write_str("position set to 0"),
            Self::TurnsCleared => f.write_str("encoder turns set to 0"),
            Self::Stored => f.write_str("all parameters stored"),
            Self::ExcessiveWrites { row, writes, within } => {
                f.write_str("excessive EEPROM writes: ")?;
                match row {
                    Some(row) => write!(f, "{row} stored {writes} times")?,
                    None => write!(f, "all parameters stored {writes} times")?,
                }
                within.map_or(Ok(()), |within| write!(f, " within {} s", within.as_secs()))
            }
            Self::FactoryRestored => f.write_str("factory defaults restored"),
            Self::UnitChanged { from, to } => write!(f, "unit address changed from {from} to {to}"),
            Self::ModeChanged { to: Some(to), .. } => write!(f, "serial settings changed to {to}"),
            Self::ModeChanged { to: None, .. } => {
                f.write_str("unreachable: undefined baud or format code")
            }
            Self::Moving { to } => write!(f, "moving to {to}"),
            Self::Running { rpm } => write!(f, "running at {rpm} rpm"),
            Self::Jogging { rpm } => write!(f, "jogging at {rpm} rpm"),
            Self::PositionSegment { number, to } => {
                write!(f, "position segment {number}: moving to {to}")
            }
            Self::VelocitySegment { number, rpm } => {
                write!(f, "velocity segment {number}: running at {rpm} rpm")
            }
            Self::ChainStep { from, to, why } => {
                write!(f, "segment {from} chained to segment {to}: {}", condition_text(*why))
            }
            Self::ChainEnded(end) => end.fmt(f),
            Self::Replanned(what) => what.fmt(f),
            Self::Pausing => f.write_str("pausing"),
            Self::Resumed { to } => write!(f, "resumed: moving to {to}"),
            Self::DeviationCleared { counts } => {
                write!(f, "position deviation cleared: {counts} counts")
            }
            Self::Stopping => f.write_str("stopping"),
            Self::Coasting => f.write_str("coasting: servo off"),
            Self::Stopped { at } => write!(f, "stopped at {at}"),
            Self::Limit { forward, soft } => {
                let kind = if *soft { "soft limit" } else { "limit switch" };
                write!(f, "{} {kind} reached", side(*forward))
            }
            Self::HardStop { at } => write!(f, "hard stop hit at {at}"),
            Self::PositionDeviation => f.write_str("position deviation above threshold"),
            Self::HomingStarted { method } => write!(f, "homing method {method} started"),
            Self::HomingMoving { method, step, rpm } => {
                let until = until_text(step.until);
                write!(f, "homing method {method}: moving at {rpm} rpm until {until}")
            }
            Self::HomingFound { method, step, at } => {
                let until = until_text(step.until);
                let then = match step.then {
                    Then::Ramp => "decelerating",
                    Then::Keep => "continuing",
                    Then::Origin => "taken as origin",
                };
                write!(f, "homing method {method}: {until} at {at}, {then}")
            }
            Self::HomingLimit { method, forward, turns, at } => {
                let then = if *turns { "reversing" } else { "waiting for the time limit" };
                write!(f, "homing method {method}: {} limit at {at}, {then}", side(*forward))
            }
            Self::HomingIndex { method, forward } => {
                let way = if *forward { "forward" } else { "backward" };
                write!(f, "homing method {method}: moving {way} to the next index pulse")
            }
            Self::HomingOrigin { method, at } => {
                write!(f, "homing method {method}: origin at {at}")
            }
            Self::HomingComplete { method, position } => {
                write!(f, "homing method {method} complete, position {position}")
            }
            Self::HomingAborted { method, why } => {
                write!(f, "homing method {method} aborted: {}", why.about())
            }
            Self::NoEffect(it) => it.fmt(f),
            Self::DeviceFault(it) => it.fmt(f),
            Self::Bouncing { terminal, times, every } => {
                let every = every.as_secs_f64() * 1000.0;
                write!(f, "terminal {terminal} bouncing {times} times, {every} ms between edges")
            }
            Self::Terminal { terminal, signal } => {
                write!(f, "terminal {terminal} {}", on_off(*signal))
            }
        }
    }
}

impl fmt::Display for Replanned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut ramp = |name: &str, rpm_per_s: &Option<MilliRpm>| match rpm_per_s {
            Some(rpm) => write!(f, "{name} changed to {rpm} rpm/s"),
            None => write!(f, "{name} without a ramp"),
        };
        match self {
            Self::Acceleration { rpm_per_s } => ramp("acceleration", rpm_per_s),
            Self::Deceleration { rpm_per_s } => ramp("deceleration", rpm_per_s),
            Self::Target { to } => write!(f, "target changed to {to}"),
            Self::Speed { rpm } => write!(f, "speed changed to {rpm} rpm"),
            Self::SlowSpeed { rpm } => write!(f, "slow speed changed to {rpm} rpm"),
            Self::StartSpeed { rpm } => write!(f, "start speed changed to {rpm} rpm"),
            Self::HomeOffset { by } => write!(f, "home offset changed to {by}"),
            Self::TimeLimit { time: Some(time) } => {
                write!(f, "homing time limit changed to {} s", time.as_secs_f64())
            }
            Self::TimeLimit { time: None } => f.write_str("homing time limit removed"),
        }
    }
}

impl fmt::Display for ChainEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "chain ended at segment {}: {}", self.at, self.why.text(&self.decoder))
    }
}

impl fmt::Display for DeviceFaultChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "device fault {}: ", on_off(self.on))?;
        match self.fault {
            DeviceFault::Cause(cause) => f.write_str(cause.about()),
            DeviceFault::Blocked => f.write_str("axis blocked"),
            DeviceFault::EncoderLost => f.write_str("encoder lost"),
            DeviceFault::Frozen => f.write_str("position feedback frozen"),
            DeviceFault::Stuck(index) => {
                write!(f, "terminal {} stuck", self.decoder.terminal(index))
            }
        }
    }
}

impl fmt::Display for MilliRpm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (self.0 as f64 / 1000.0).fmt(f)
    }
}

#[cfg(feature = "cli")]
impl schemars::JsonSchema for MilliRpm {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Rpm".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "number" })
    }
}

impl Serialize for MilliRpm {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0 as f64 / 1000.0)
    }
}

/// The keys of [`DriveEvent::ChainEnded`].
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct ChainEndFields {
    /// The number of the segment.
    segment: u16,
    /// Why it cannot follow, as a word of the list of reasons.
    #[cfg_attr(feature = "cli", schemars(extend("enum" = super::super::no_effect::reason_names())))]
    reason: &'static str,
    /// Why, as a sentence.
    why: String,
}

impl From<ChainEnd> for ChainEndFields {
    fn from(ChainEnd { decoder, at, why }: ChainEnd) -> Self {
        Self { segment: at, reason: why.name(), why: why.text(&decoder) }
    }
}

/// The keys of [`DriveEvent::DeviceFault`].
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct DeviceFaultFields {
    /// What is wrong.
    #[cfg_attr(
        feature = "cli",
        schemars(extend("enum" = ["cause", "blocked", "encoder_lost", "frozen", "stuck"]))
    )]
    device_fault: &'static str,
    /// The alarm cause that is present, of `cause`.
    #[serde(skip_serializing_if = "Option::is_none")]
    cause: Option<AlarmCause>,
    /// The name of the terminal that keeps its level, of `stuck`.
    #[serde(skip_serializing_if = "Option::is_none")]
    terminal: Option<String>,
    /// From now on, or no longer?
    on: bool,
}

impl From<DeviceFaultChange> for DeviceFaultFields {
    fn from(DeviceFaultChange { decoder, fault, on }: DeviceFaultChange) -> Self {
        let (device_fault, cause, terminal) = match fault {
            DeviceFault::Cause(cause) => ("cause", Some(cause), None),
            DeviceFault::Blocked => ("blocked", None, None),
            DeviceFault::EncoderLost => ("encoder_lost", None, None),
            DeviceFault::Frozen => ("frozen", None, None),
            DeviceFault::Stuck(index) => ("stuck", None, Some(decoder.terminal(index))),
        };
        Self { device_fault, cause, terminal, on }
    }
}

/// The keys of a homing step that was found.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct StepFound {
    /// What happened.
    until: String,
    /// What the axis does next.
    then: Then,
}

pub(super) fn step_found<S: Serializer>(step: &HomingStep, to: S) -> Result<S::Ok, S::Error> {
    StepFound { until: until_text(step.until), then: step.then }.serialize(to)
}

pub(super) fn step_end<S: Serializer>(step: &HomingStep, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&until_text(step.until))
}

pub(super) fn condition<S: Serializer>(why: &Option<Condition>, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(condition_text(*why))
}

pub(super) fn seconds<S: Serializer>(time: &Option<Duration>, to: S) -> Result<S::Ok, S::Error> {
    time.map(|time| time.as_secs()).serialize(to)
}

pub(super) fn fractional_seconds<S: Serializer>(
    time: &Option<Duration>,
    to: S,
) -> Result<S::Ok, S::Error> {
    time.map(|time| time.as_secs_f64()).serialize(to)
}

pub(super) fn milliseconds<S: Serializer>(time: &Duration, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(time.as_secs_f64() * 1000.0)
}

/// Why a chain goes on.
fn condition_text(why: Option<Condition>) -> &'static str {
    match why {
        None => "in position",
        Some(Condition::Delay) => "delay elapsed",
        Some(Condition::Step) => "rising edge of segment_step",
        Some(Condition::Position) => "position reached",
    }
}

/// What a homing step waits for.
fn until_text(until: Until) -> String {
    let edge = |it: SignalEdge| format!("{} {}", it.signal.name(), on_off(it.on));
    match until {
        Until::Edge(it) => edge(it),
        Until::Index(None) => "index pulse".into(),
        Until::SameIndex => "same index pulse".into(),
        Until::Index(Some(it)) => format!("index pulse after {}", edge(it)),
        Until::Collision => "hard stop".into(),
    }
}

fn side(forward: bool) -> &'static str {
    if forward { "positive" } else { "negative" }
}
