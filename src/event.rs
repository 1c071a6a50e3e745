//! What happened: self-contained values that the log and the tests are made from.
//!
//! One definition each: the variants and fields, with their documentation, are the public JSON log; `Display` is the
//! text log. Neither needs the bus or a drive, so both can be made on another thread, later. What a drive would have
//! to say about its numbers travels with them ([`Decoder`]).

mod decoder;
mod drive_event;
mod no_effect;
mod transaction;

pub use decoder::{DecodedRequest, Decoder, Item, RowName, TerminalName};
pub use drive_event::{ChainEnd, DeviceFaultChange, DriveEvent, MilliRpm, Replanned};
pub use no_effect::{Ignored, NoEffect, Ordered, REASONS, ReasonEntry};
pub use transaction::{Broadcast, Transaction};

use crate::line::Units;
use crate::medium::FaultHit;
use crate::serial::{Mode, Settings};
use crate::text::one_line;
use crate::time::Instant;
use crate::vocabulary::{Action, AlarmCause, Named};
use crate::wire::ascii::BadAscii;
use crate::wire::mbap::BadHeader;
use crate::wire::rtu::BadCrc;
use crate::wire::{BROADCAST, Frame, Inline, NoiseCause, Pdu};
use serde::{Serialize, Serializer};
use std::fmt;

/// Something that happened on a line, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    /// When, in the emulated world.
    pub at: Instant,
    /// What.
    pub kind: EventKind,
}

/// Number of a drive on its bus, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct DriveId(pub u16);

/// What happened.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum EventKind {
    /// A drive executed a broadcast, or refused to; either way there is no reply.
    Broadcast(
        #[cfg_attr(feature = "cli", schemars(with = "transaction::BroadcastFields"))] Broadcast,
    ),
    /// A read was broadcast, to which nothing can reply.
    BroadcastRead {
        /// The PDU of the request.
        request: Pdu,
    },
    /// Traffic of other devices: a request to a unit that is not reachable on this line, or a reply of another device.
    Foreign {
        /// The unit address in it, 0 to 255.
        unit: u8,
        /// The PDU.
        pdu: Pdu,
        /// A reply, not a request?
        reply: bool,
        /// Which units there are instead, where a request has no reply.
        #[serde(skip)]
        here: Option<Here>,
    },
    /// A frame with a wrong CRC.
    BadCrc {
        /// The frame, with its CRC.
        frame: Frame,
        /// The CRC in the frame, as it was received.
        got: Inline<2>,
        /// The CRC of its bytes.
        expected: Inline<2>,
        /// The exception code that the drive replied with; null without a reply.
        exception: Option<u8>,
    },
    /// An ASCII frame that cannot be decoded.
    BadAscii {
        /// The characters between `:` and CR LF.
        #[serde(serialize_with = "lossy_text")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        characters: Frame,
        /// Why, as a sentence.
        #[serde(serialize_with = "sentence")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        why: BadAscii,
    },
    /// Bytes that are no frame.
    Noise {
        /// The first of them, at most 16.
        #[serde(rename = "bytes")]
        head: Inline<16>,
        /// How many bytes there were.
        #[serde(rename = "length")]
        len: usize,
        /// Why they are no frame.
        #[serde(serialize_with = "sentence")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        why: NoiseCause,
    },
    /// All drives of the line changed their serial settings to these, and the port follows.
    LineSettings {
        /// The new settings, such as `9600-8N2 RTU`.
        mode: Mode,
    },
    /// The port of the master is set differently from the line, or no longer is.
    PortSettings {
        /// The baud rate of the master's port.
        baud: u32,
        /// Its stop bits, 1 or 2.
        stop_bits: u8,
        /// How the line is set, such as `9600-8N2`.
        #[serde(rename = "line_settings")]
        line: Settings,
        /// Do baud rate and stop bits match?
        fits: bool,
        /// Does what the master sends reach the drives nevertheless?
        passes: bool,
    },
    /// A TCP stream lost its framing and was closed.
    StreamClosed {
        /// Why, as a sentence.
        #[serde(serialize_with = "sentence")]
        #[cfg_attr(feature = "cli", schemars(with = "String"))]
        why: BadHeader,
    },
    /// A fault rule acted on a request or its reply.
    Fault(FaultHit),
    /// A step of a scenario started or ended.
    Step(Remark),
    /// A master repeated a command whose first reply cannot have reached it, and the drive received it twice.
    RepeatedCommand {
        /// Which drive.
        #[serde(skip)]
        drive: DriveId,
        /// The unit address that was asked.
        unit: u8,
        /// The command.
        action: Action,
        /// How often this has happened to the drive so far, from 1.
        count: u64,
    },
    /// A drive received a request and replied.
    #[serde(untagged)]
    Transaction(
        #[cfg_attr(feature = "cli", schemars(with = "transaction::TransactionFields"))] Transaction,
    ),
    /// Something happened in a drive.
    #[serde(untagged)]
    Drive {
        /// Which drive.
        #[serde(skip)]
        drive: DriveId,
        /// The unit address of the drive, 0 to 255.
        unit: u8,
        /// How a serial line was set then, where the event may change which drives it reaches.
        #[serde(skip)]
        line: Option<Mode>,
        /// What.
        #[serde(flatten)]
        event: DriveEvent,
    },
}

impl From<Transaction> for EventKind {
    fn from(transaction: Transaction) -> Self {
        Self::Transaction(transaction)
    }
}

impl From<Broadcast> for EventKind {
    fn from(broadcast: Broadcast) -> Self {
        Self::Broadcast(broadcast)
    }
}

impl EventKind {
    /// A frame whose CRC is wrong, and the exception that was replied, if any.
    pub fn bad_crc(frame: Frame, crc: BadCrc, exception: Option<u8>) -> Self {
        let bytes = |crc: u16| Inline::from_slice(&crc.to_le_bytes());
        Self::BadCrc { frame, got: bytes(crc.got), expected: bytes(crc.want), exception }
    }
}

/// Why nothing replies to a request: who is on the line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Here {
    /// The unit that was asked, without power.
    NoPower,
    /// The unit that was asked, with other serial settings, or with undefined ones.
    SetTo(Option<Mode>),
    /// These units.
    Units(Units),
}

/// How the port of a master is set, and the line behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortSettings {
    /// Bits per second of the master's port.
    pub baud: u32,
    /// Its stop bits, 1 or 2.
    pub stop_bits: u8,
    /// How the line is set.
    pub line: Settings,
}

impl PortSettings {
    /// Do they talk at one speed?
    pub fn same_baud(self) -> bool {
        self.baud == self.line.baud
    }

    /// The event that tells of it; does what the master sends pass nevertheless?
    pub fn event(self, passes: bool) -> EventKind {
        let Self { baud, stop_bits, line } = self;
        EventKind::PortSettings { baud, stop_bits, line, fits: self.fits(), passes }
    }

    /// Are they the same, as far as can be seen?
    pub fn fits(self) -> bool {
        self.same_baud() && self.stop_bits == self.line.format.stop_bits
    }
}

/// What is to be told of a step of a scenario.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Remark {
    /// The name of the step.
    pub step: String,
    /// What became of it.
    pub outcome: Outcome,
    /// Why it failed, if it did.
    #[serde(rename = "why", skip_serializing_if = "String::is_empty")]
    pub what: String,
}

/// What became of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum Outcome {
    /// It started.
    #[serde(rename = "started")]
    Begins,
    /// What it expects holds.
    Passed,
    /// It does not hold, or something could not be done.
    Failed,
}

/// What can be wrong with a device, apart from its line, for as long as somebody says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceFault {
    /// The cause of an alarm stands: the drive trips, and no reset helps.
    Cause(AlarmCause),
    /// The axis can't leave the count at which it is.
    Blocked,
    /// There is no feedback: position and speed stay as they were seen last, and the drive trips if it has an
    /// alarm for that.
    EncoderLost,
    /// Position and speed stay as they were seen last, and the drive does not notice.
    Frozen,
    /// The input terminal of this index, from 0, keeps its level.
    Stuck(u8),
}

/// One line of the text log, whatever names of drives, rows and steps hold: `0.532 unit 1 servo on`.
impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.at, one_line(&self.kind.to_string()))
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Broadcast(it) => it.fmt(f),
            Self::BroadcastRead { request } => {
                write!(f, "broadcast {request:?} -> no reply: reads cannot be broadcast")
            }
            Self::Foreign { unit, pdu, reply, here } => {
                let kind = if *reply { "reply from" } else { "request to" };
                write!(f, "foreign {kind} unit {unit}: {pdu:?}")?;
                here.as_ref().map_or(Ok(()), |here| write!(f, " -> no reply: {here}"))
            }
            Self::BadCrc { frame, got, expected, exception } => {
                write!(f, "bad CRC {got:?}, expected {expected:?}: {frame:?} -> ")?;
                match exception {
                    Some(code) => write!(f, "exception {code:02X}"),
                    None => f.write_str("no reply"),
                }
            }
            Self::BadAscii { characters, why } => {
                let characters = String::from_utf8_lossy(characters);
                write!(f, "bad ASCII frame `:{}`, {why} -> no reply", characters.escape_debug())
            }
            Self::Noise { head, len, why } => {
                let (s, more) = (plural(*len), if *len > head.len() { " ..." } else { "" });
                write!(f, "noise, {len} byte{s}, {why}: {head:?}{more} -> no reply")
            }
            Self::LineSettings { mode } => write!(f, "line settings changed to {mode}"),
            Self::PortSettings { baud, stop_bits, line, fits, passes } => {
                let why = match passes {
                    _ if *fits => "they match",
                    false => "nothing passes until they match",
                    true if *baud == line.baud => "most receivers accept that",
                    true => "a real line would garble every byte, this pseudo-terminal does not",
                };
                let s = plural((*stop_bits).into());
                write!(f, "master port set to {baud} baud, {stop_bits} stop bit{s}; ")?;
                write!(f, "line set to {line}: {why}")
            }
            Self::StreamClosed { why } => write!(f, "stream closed: {why}"),
            Self::Fault(hit) => hit.fmt(f),
            Self::Step(Remark { step, outcome, what }) => match outcome {
                Outcome::Begins => write!(f, "step {step}"),
                Outcome::Passed => write!(f, "step {step} passed"),
                Outcome::Failed => write!(f, "step {step} failed: {what}"),
            },
            Self::RepeatedCommand { unit, action, count, .. } => {
                let name = action.name();
                write!(f, "unit {unit} {name} repeated; the first reply never arrived (#{count})")
            }
            Self::Transaction(it) => it.fmt(f),
            Self::Drive { unit, line, event, .. } => {
                write!(f, "unit {unit} {event}")?;
                match (event, line) {
                    (DriveEvent::ModeChanged { to: Some(to), .. }, Some(line)) if to != line => {
                        write!(f, "; unreachable: the line is set to {line}")
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}

impl fmt::Display for Here {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPower => f.write_str("the drive has no power"),
            Self::SetTo(Some(mode)) => write!(f, "the drive is set to {mode}"),
            Self::SetTo(None) => {
                f.write_str("the drive is set to an undefined baud or format code")
            }
            Self::Units(units) => {
                let units = (0..=u8::MAX).filter(|unit| *unit != BROADCAST && units.has(*unit));
                let units: Vec<_> = units.map(|unit| unit.to_string()).collect();
                match units.as_slice() {
                    [only] => write!(f, "the only unit on this line is {only}"),
                    _ => write!(f, "the units on this line are {}", units.join(", ")),
                }
            }
        }
    }
}

fn sentence<S: Serializer>(why: &impl fmt::Display, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(why)
}

fn lossy_text<S: Serializer>(frame: &Frame, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&String::from_utf8_lossy(frame))
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
