//! Orders without effect, for people and for programs.

use super::rows::{self, Item};
use crate::drive::Drive;
use crate::event::{Ignored, Ordered};
use crate::vocabulary::{Named, RowId};

/// `C01 bit 1 enable has no effect: C11 bit 1 is 0`.
pub fn text(drive: &Drive, order: Ordered, why: Ignored) -> String {
    let (ordered, reason) = (ordered(drive, order), reason(drive, why));
    match order {
        Ordered::Read(_) => format!("{ordered} reads 0: {reason}"),
        Ordered::Function(_) => format!("{ordered}: {reason}"),
        _ => format!("{ordered} has no effect: {reason}"),
    }
}

fn ordered(drive: &Drive, order: Ordered) -> String {
    match order {
        Ordered::Action(action) => action.name().into(),
        Ordered::Input(input) => input.name().into(),
        Ordered::InputOff(input) => format!("{} off", input.name()),
        Ordered::Bit { row, bit, on } => {
            let off = if on { "" } else { " = 0" };
            let bits = &drive.model().map.row(row).bits;
            let name = bits.get(&bit).map(|name| format!(" {name}")).unwrap_or_default();
            format!("{} bit {bit}{name}{off}", code(drive, row))
        }
        Ordered::Write { row, value } => rows::text(drive, Item::Row(row, value)),
        Ordered::Read(row) => code(drive, row),
        Ordered::Terminal { index, on } => {
            format!("terminal {} {}", rows::terminal(drive, index), if on { "on" } else { "off" })
        }
        Ordered::Function(index) => rows::not_simulated(drive, index).into(),
        Ordered::Raise(cause) => format!("raise {}", cause.name()),
    }
}

/// Why, as people read it.
pub fn reason(drive: &Drive, why: Ignored) -> String {
    match why {
        Ignored::NoSupply => "the drive has no power".into(),
        Ignored::NotReady => "the drive is not ready yet".into(),
        Ignored::Alarm => "an alarm is active".into(),
        Ignored::PowerOff => "the servo is off".into(),
        Ignored::Released => "an input keeps the servo off".into(),
        Ignored::Inhibited => "an input inhibits it".into(),
        Ignored::AlreadyOn => "the servo is already on".into(),
        Ignored::AlreadyOff => "the servo is already off".into(),
        Ignored::KeptOn => "an input keeps the servo on".into(),
        Ignored::Latched => "a command keeps the servo on".into(),
        Ignored::AlreadyStopped => "already stopped".into(),
        Ignored::Stopping => "already stopping".into(),
        Ignored::Locked => "locked since its last run".into(),
        Ignored::NotLocked => "nothing is locked".into(),
        Ignored::Held => "a stop input is active".into(),
        Ignored::Moving => "the axis is moving".into(),
        Ignored::Homing => "homing in progress".into(),
        Ignored::Limit => "a limit is active in that direction".into(),
        Ignored::NoSpeed => "speed is 0".into(),
        Ignored::Contradiction => "another input requests a different motion".into(),
        Ignored::Spent => "ended by a command; needs a rising edge".into(),
        Ignored::NoEdge { since } => format!("on since {since}; needs a rising edge"),
        Ignored::Starter { row, value } => {
            format!("{} does not allow it", rows::text(drive, Item::Row(row, value)))
        }
        Ignored::Unsupported { row, value } => {
            format!("{} is not supported", rows::text(drive, Item::Row(row, value)))
        }
        Ignored::NoMeaning => "a parameter holds an undefined value".into(),
        Ignored::NoSegment => "no such segment".into(),
        Ignored::NoChain => "no segment is waiting for it".into(),
        Ignored::NoMotion => "no segment of the chain moves the axis".into(),
        Ignored::NoAlarm => "no alarm is active".into(),
        Ignored::NotResettable(cause) => {
            format!("a reset cannot clear this alarm: {}", cause.about())
        }
        Ignored::CauseStands(cause) => {
            format!("the cause of the alarm is still present: {}", cause.about())
        }
        Ignored::OtherAlarm(cause) => format!("a different alarm is active: {}", cause.about()),
        Ignored::Disabled { row, bit: Some(bit) } => format!("{} bit {bit} is 0", code(drive, row)),
        Ignored::Disabled { row, bit: None } => format!("{} is 0", code(drive, row)),
        Ignored::Overridden { row } => {
            format!("{} assigns the signal to another function", code(drive, row))
        }
        Ignored::Nothing => "undefined".into(),
        Ignored::NotSimulated => "not simulated".into(),
        Ignored::StoredOnly => "stored; not simulated".into(),
        Ignored::NoFunction { row, value } => rows::text(drive, Item::Row(row, value)),
        Ignored::Stuck => "the terminal is stuck".into(),
        Ignored::AlreadySo => "already in that state".into(),
        Ignored::OtherSource(signal) => format!("another source keeps {} on", signal.name()),
        Ignored::After(action) => format!("{} in the same write takes precedence", action.name()),
        Ignored::NoOrder => "no command in the same write".into(),
        Ignored::MovesOnly => "applies to move_start only".into(),
        Ignored::MovesAndRunsOnly => "applies to move_start and run_start only".into(),
    }
}

fn code(drive: &Drive, row: RowId) -> String {
    drive.model().map.row(row).code()
}

/// What was ordered and why nothing comes of it, each in a field of its own.
#[cfg(feature = "cli")]
pub fn fields(drive: &Drive, order: Ordered, why: Ignored) -> serde_json::Value {
    use serde_json::json;
    let id = |row: RowId| &drive.model().map.row(row).id;
    let mut fields = match order {
        Ordered::Action(action) => json!({"order": "action", "action": action.name()}),
        Ordered::Input(input) => json!({"order": "input", "input": input.name(), "on": true}),
        Ordered::InputOff(input) => {
            json!({"order": "input", "input": input.name(), "on": false})
        }
        Ordered::Bit { row, bit, on } => {
            json!({"order": "bit", "row": id(row), "bit": bit, "on": on})
        }
        Ordered::Write { row, value } => {
            json!({"order": "write", "row": id(row), "value": value})
        }
        Ordered::Read(row) => json!({"order": "read", "row": id(row)}),
        Ordered::Terminal { index, on } => {
            json!({"order": "terminal", "terminal": rows::terminal(drive, index), "on": on})
        }
        Ordered::Function(index) => {
            json!({"order": "function", "function": rows::not_simulated(drive, index)})
        }
        Ordered::Raise(cause) => json!({"order": "raise", "cause": cause.name()}),
    };
    let more = match why {
        Ignored::NoEdge { since } => json!({"since": since.as_nanos() as f64 / 1e9}),
        Ignored::Starter { row, value }
        | Ignored::Unsupported { row, value }
        | Ignored::NoFunction { row, value } => json!({"by": id(row), "by_value": value}),
        Ignored::Disabled { row, bit } => json!({"by": id(row), "by_bit": bit}),
        Ignored::Overridden { row } => json!({"by": id(row)}),
        Ignored::NotResettable(cause)
        | Ignored::CauseStands(cause)
        | Ignored::OtherAlarm(cause) => json!({"alarm": cause.name()}),
        Ignored::OtherSource(signal) => json!({"signal": signal.name()}),
        Ignored::After(action) => json!({"after": action.name()}),
        _ => json!({}),
    };
    super::json::merge(&mut fields, json!({"reason": name(why), "why": reason(drive, why)}));
    super::json::merge(&mut fields, more);
    fields
}

/// Why, as programs read it.
#[cfg(feature = "cli")]
pub fn name(why: Ignored) -> &'static str {
    match why {
        Ignored::NoSupply => "no_power",
        Ignored::NotReady => "not_ready",
        Ignored::Alarm => "alarm",
        Ignored::PowerOff => "servo_off",
        Ignored::Released => "released",
        Ignored::Inhibited => "inhibited",
        Ignored::Locked => "locked",
        Ignored::NotLocked => "not_locked",
        Ignored::AlreadyOn => "already_on",
        Ignored::AlreadyOff => "already_off",
        Ignored::KeptOn => "kept_on",
        Ignored::Latched => "latched",
        Ignored::AlreadyStopped => "already_stopped",
        Ignored::Stopping => "stopping",
        Ignored::Held => "stop_active",
        Ignored::Moving => "moving",
        Ignored::Homing => "homing",
        Ignored::Limit => "limit",
        Ignored::NoSpeed => "speed_zero",
        Ignored::Contradiction => "contradiction",
        Ignored::Spent => "spent",
        Ignored::NoEdge { .. } => "no_edge",
        Ignored::Starter { .. } => "not_allowed",
        Ignored::Unsupported { .. } => "not_supported",
        Ignored::NoMeaning => "undefined_parameter",
        Ignored::NoSegment => "no_segment",
        Ignored::NoChain => "no_chain",
        Ignored::NoMotion => "no_motion",
        Ignored::NoAlarm => "no_alarm",
        Ignored::NotResettable(_) => "not_resettable",
        Ignored::CauseStands(_) => "cause_present",
        Ignored::OtherAlarm(_) => "other_alarm",
        Ignored::Disabled { .. } => "disabled",
        Ignored::Overridden { .. } => "assigned_elsewhere",
        Ignored::Nothing => "undefined",
        Ignored::NotSimulated => "not_simulated",
        Ignored::StoredOnly => "stored_only",
        Ignored::NoFunction { .. } => "no_function",
        Ignored::Stuck => "stuck",
        Ignored::AlreadySo => "no_change",
        Ignored::OtherSource(_) => "other_source",
        Ignored::After(_) => "lower_priority",
        Ignored::NoOrder => "no_order",
        Ignored::MovesOnly => "moves_only",
        Ignored::MovesAndRunsOnly => "moves_and_runs_only",
    }
}
