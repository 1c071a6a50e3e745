//! Why something was refused or ignored, in words.

use super::rows::label;
use crate::drive::Drive;
use crate::event::PortSettings;
use crate::vocabulary::{Cause, Condition, Detail, Named, Refusal, SignalEdge, Until};
use crate::wire::NoiseCause;
use crate::wire::ascii::BadAscii;
use crate::wire::mbap::BadHeader;

/// `range 0..6000`, `0x1234 is not mapped`.
pub fn refusal(drive: &Drive, refusal: &Refusal) -> String {
    let map = &drive.model().map;
    match (refusal.cause, refusal.detail) {
        (Cause::Function, Detail::Function(code)) => {
            let known: Vec<_> =
                drive.model().line.functions.iter().map(|code| format!("{code:02X}")).collect();
            format!("function {code:02X} is not one of {}", known.join(", "))
        }
        (_, Detail::Length { got, want }) => {
            format!("lengths do not agree, {got} bytes of PDU where {want} should be")
        }
        (_, Detail::Quantity { got: 0, .. }) => "no register asked for".into(),
        (_, Detail::Quantity { got, most }) => format!("{got} registers, at most {most}"),
        (Cause::AddressBeyond, Detail::Address(address)) => {
            format!("0x{address:04X} lies beyond the map")
        }
        (_, Detail::Address(address)) => format!("0x{address:04X} is not mapped"),
        (Cause::SplitLong, Detail::Row(row)) => {
            format!("half of {}, which goes whole only", label(map.row(row)))
        }
        (Cause::ReadOnly, Detail::Row(row)) => format!("{} is read only", label(map.row(row))),
        (Cause::WriteOnly, Detail::Row(row)) => format!("{} is write only", label(map.row(row))),
        (Cause::State, Detail::Row(row)) => {
            format!("{} is locked while the servo is on", label(map.row(row)))
        }
        (_, Detail::Value { row, .. }) => map.row(row).admits_text(),
        (cause, detail) => format!("{cause:?} {detail:?}"),
    }
}

/// Why a chain goes on.
pub fn chain_step(why: Option<Condition>) -> &'static str {
    match why {
        None => "in position",
        Some(Condition::Delay) => "its time is over",
        Some(Condition::HomingStep) => "`segment_step` has risen",
        Some(Condition::Position) => "the position is reached",
    }
}

/// Why bytes are no frame.
pub fn noise(why: NoiseCause) -> String {
    match why {
        NoiseCause::TooShort => "too short for a frame".into(),
        NoiseCause::TooLong => "too long for a frame".into(),
        NoiseCause::OutsideFrame => "outside a frame".into(),
        NoiseCause::Speed(baud) => format!("sent at {baud} baud"),
        NoiseCause::Unfinished => "a frame that was not finished".into(),
    }
}

/// What comes of the settings of a master's port.
pub fn port(port: PortSettings, heard: bool) -> &'static str {
    match heard {
        _ if port.fits() => "as it should be",
        false => "nothing passes until they agree",
        true if port.same_baud() => "most receivers take that",
        true => "a wire would carry nothing, this pseudo-terminal does",
    }
}

/// Why characters are no ASCII frame.
pub fn ascii(why: BadAscii) -> String {
    match why {
        BadAscii::NotHex(at) => format!("character {} is no hex digit", at + 1),
        BadAscii::Length(len) => format!("{len} characters, not an even number of at least 6"),
        BadAscii::Lrc { got, want } => format!("LRC {got:02X} should be {want:02X}"),
    }
}

/// Why a TCP stream is lost.
pub fn header(why: BadHeader) -> String {
    match why {
        BadHeader::Protocol(id) => format!("protocol {id} is not Modbus; is this serial framing?"),
        BadHeader::Length(len) => format!("a length of {len} is not possible"),
    }
}

/// What a homing step waits for.
pub fn until(until: Until) -> String {
    let edge =
        |edge: SignalEdge| format!("{} {}", edge.signal.name(), if edge.on { "on" } else { "off" });
    match until {
        Until::Edge(it) => edge(it),
        Until::Index(None) => "an index pulse".into(),
        Until::SameIndex => "the same index pulse".into(),
        Until::Index(Some(it)) => format!("an index pulse after {}", edge(it)),
        Until::Collision => "a hard stop".into(),
    }
}
