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
            format!("function {code:02X} is not supported, only {}", known.join(", "))
        }
        (_, Detail::Length { got, want }) => {
            format!("PDU of {got} bytes, expected {want}")
        }
        (_, Detail::Quantity { got: 0, .. }) => "quantity of registers is 0".into(),
        (_, Detail::Quantity { got, most }) => format!("{got} registers, at most {most}"),
        (Cause::AddressBeyond, Detail::Address(address)) => {
            format!("0x{address:04X} is above the highest mapped address")
        }
        (_, Detail::Address(address)) => format!("0x{address:04X} is not mapped"),
        (Cause::SplitLong, Detail::Row(row)) => {
            format!("{} must be accessed as a 32-bit pair", label(map.row(row)))
        }
        (Cause::ReadOnly, Detail::Row(row)) => format!("{} is read-only", label(map.row(row))),
        (Cause::WriteOnly, Detail::Row(row)) => format!("{} is write-only", label(map.row(row))),
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
        Some(Condition::Delay) => "delay elapsed",
        Some(Condition::Step) => "rising edge of segment_step",
        Some(Condition::Position) => "position reached",
    }
}

/// Why bytes are no frame.
pub fn noise(why: NoiseCause, len: usize) -> String {
    let bytes = if len == 1 { "1 byte".into() } else { format!("{len} bytes") };
    match why {
        NoiseCause::TooShort => format!("{bytes}, too short for a frame"),
        NoiseCause::TooLong => format!("{bytes}, too long for a frame"),
        NoiseCause::OutsideFrame => format!("{bytes} outside a frame"),
        NoiseCause::Speed(baud) => format!("{bytes} sent at {baud} baud"),
        NoiseCause::Unfinished => format!("{bytes} of an incomplete frame"),
    }
}

/// What comes of the settings of a master's port.
pub fn port(port: PortSettings, heard: bool) -> &'static str {
    match heard {
        _ if port.fits() => "they match",
        false => "nothing passes until they match",
        true if port.same_baud() => "most receivers accept that",
        true => "a real line would garble every byte, this pseudo-terminal does not",
    }
}

/// Why characters are no ASCII frame.
pub fn ascii(why: BadAscii) -> String {
    match why {
        BadAscii::NotHex(at) => format!("character {} is not a hex digit", at + 1),
        BadAscii::Length(len) => format!("{len} characters, expected an even number of at least 6"),
        BadAscii::Lrc { got, want } => format!("LRC {got:02X}, expected {want:02X}"),
    }
}

/// Why a TCP stream is lost.
pub fn header(why: BadHeader) -> String {
    match why {
        BadHeader::Protocol(id) => {
            format!("protocol identifier {id} is not Modbus; is the master using serial framing?")
        }
        BadHeader::Length(len) => format!("length {len} is out of range"),
    }
}

/// What a homing step waits for.
pub fn until(until: Until) -> String {
    let edge =
        |edge: SignalEdge| format!("{} {}", edge.signal.name(), if edge.on { "on" } else { "off" });
    match until {
        Until::Edge(it) => edge(it),
        Until::Index(None) => "index pulse".into(),
        Until::SameIndex => "same index pulse".into(),
        Until::Index(Some(it)) => format!("index pulse after {}", edge(it)),
        Until::Collision => "hard stop".into(),
    }
}
