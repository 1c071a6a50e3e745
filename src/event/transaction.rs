//! Requests and replies: what was asked for in rows, and why it was refused.

use super::DriveId;
use super::decoder::{DecodedRequest, Decoder, Item, ItemFields, label};
use crate::vocabulary::{Cause, Detail, Refusal};
use crate::wire::Pdu;
use serde::Serialize;
use std::fmt;

/// Rows of one transaction that the text names; the rest is counted.
const ROWS_TOLD: usize = 6;

/// A request to one drive and its reply.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "TransactionFields")]
pub struct Transaction {
    /// Which drive.
    pub drive: DriveId,
    /// The unit address that was asked.
    pub unit: u8,
    /// How to read it.
    pub decoder: Decoder,
    /// The request's PDU.
    pub request: Pdu,
    /// The reply's PDU.
    pub reply: Pdu,
    /// Why it was refused, if it was.
    pub refusal: Option<Refusal>,
}

/// A drive received a broadcast, to which nothing replies.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "BroadcastFields")]
pub struct Broadcast {
    /// Which drive.
    pub drive: DriveId,
    /// Its unit address.
    pub unit: u8,
    /// How to read it.
    pub decoder: Decoder,
    /// The request's PDU.
    pub request: Pdu,
    /// Why it was not executed, if it was not.
    pub refusal: Option<Refusal>,
}

/// How an item is told.
type Tell = fn(&Decoder, Item) -> String;

impl fmt::Display for Transaction {
    /// `unit 1 write C03.04 jog speed = 7000: refused, range 0..6000 -> exception 03`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { unit, decoder, request, reply, refusal, .. } = self;
        if let Some(refusal) = refusal {
            let asked = asked(decoder, request, Decoder::refused_text);
            let (why, code) = (refusal_text(decoder, refusal), refusal.code);
            return write!(f, "unit {unit} {asked}: refused, {why} -> exception {code:02X}");
        }
        match decoder.request(request) {
            DecodedRequest::Read(span) => {
                let items = decoder.reply(span, reply);
                write!(f, "unit {unit} read {}", list(decoder, &items, Decoder::text))
            }
            _ => write!(f, "unit {unit} {}", asked(decoder, request, Decoder::text)),
        }
    }
}

impl fmt::Display for Broadcast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { unit, decoder, request, refusal, .. } = self;
        match refusal {
            None => {
                write!(f, "broadcast to unit {unit}: {}", asked(decoder, request, Decoder::text))
            }
            Some(refusal) => {
                let asked = asked(decoder, request, Decoder::refused_text);
                let why = refusal_text(decoder, refusal);
                write!(f, "broadcast to unit {unit}: {asked}: refused, {why} -> no reply")
            }
        }
    }
}

/// What a request asks for, without its reply.
fn asked(decoder: &Decoder, request: &Pdu, tell: Tell) -> String {
    match decoder.request(request) {
        DecodedRequest::Read(span) => match span.count() {
            1 => format!("read 0x{:04X}", span.start()),
            count => format!("read 0x{:04X} x {count}", span.start()),
        },
        DecodedRequest::Write(items) => format!("write {}", list(decoder, &items, tell)),
        DecodedRequest::Other => format!("function {request:?}"),
    }
}

fn list(decoder: &Decoder, items: &[Item], tell: Tell) -> String {
    let told = items.iter().take(ROWS_TOLD).map(|item| tell(decoder, *item));
    let told = told.collect::<Vec<_>>().join(", ");
    match items.len().checked_sub(ROWS_TOLD) {
        None | Some(0) => told,
        Some(more) => format!("{told}, and {more} more"),
    }
}

/// Why a request was refused: `range 0..6000`, `0x1234 is not mapped`.
fn refusal_text(decoder: &Decoder, refusal: &Refusal) -> String {
    let name = |row| label(decoder.row(row));
    match (refusal.cause, refusal.detail) {
        (Cause::Function, Detail::Function(code)) => {
            let known = &decoder.model().line.functions;
            let known: Vec<_> = known.iter().map(|code| format!("{code:02X}")).collect();
            format!("function {code:02X} is not supported, only {}", known.join(", "))
        }
        (_, Detail::Length { got, want }) => format!("PDU of {got} bytes, expected {want}"),
        (_, Detail::Quantity { got: 0, .. }) => "quantity of registers is 0".into(),
        (_, Detail::Quantity { got, most }) => format!("{got} registers, at most {most}"),
        (Cause::AddressBeyond, Detail::Address(address)) => {
            format!("0x{address:04X} is above the highest mapped address")
        }
        (_, Detail::Address(address)) => format!("0x{address:04X} is not mapped"),
        (Cause::SplitLong, Detail::Row(row)) => {
            format!("{} must be accessed as a 32-bit pair", name(row))
        }
        (Cause::ReadOnly, Detail::Row(row)) => format!("{} is read-only", name(row)),
        (Cause::WriteOnly, Detail::Row(row)) => format!("{} is write-only", name(row)),
        (Cause::State, Detail::Row(row)) => {
            format!("{} is locked while the servo is on", name(row))
        }
        (_, Detail::Value { row, .. }) => decoder.row(row).admits_text(),
        (cause, detail) => format!("{cause:?} {detail:?}"),
    }
}

/// A transaction in JSON.
#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) enum TransactionFields {
    /// A master read registers of a drive.
    Read(TransactionBody),
    /// A master wrote registers of a drive.
    Write(TransactionBody),
    /// A drive received a request that reads or writes no registers.
    Request(TransactionBody),
}

/// The keys of each transaction.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct TransactionBody {
    /// The unit address that was asked, 0 to 255.
    unit: u8,
    /// The PDU of the request.
    request: Pdu,
    /// The PDU of the reply.
    reply: Pdu,
    /// The registers, by address: `row`, `address`, `name` and `value`, the number on the wire; one word of a pair has
    /// `word` for `value`; an address that no row has is `address` and `word`, several of them `address`, `words` and
    /// `mapped`: false; a word with masks has `and` and `or`. None of a read that was refused.
    rows: Vec<ItemFields>,
    #[serde(flatten)]
    refusal: Option<RefusalFields>,
}

/// A broadcast in JSON.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct BroadcastFields {
    /// The unit address of the drive that received it.
    unit: u8,
    /// The PDU of the request.
    request: Pdu,
    #[serde(flatten)]
    refusal: Option<RefusalFields>,
}

/// A refusal in JSON.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct RefusalFields {
    /// The cause of the refusal, if it was refused.
    refused: Cause,
    /// The exception code that goes with it; a broadcast has no reply that would carry it.
    exception: u8,
    /// Why, as a sentence.
    why: String,
}

fn refusal_fields(decoder: &Decoder, refusal: Option<Refusal>) -> Option<RefusalFields> {
    refusal.map(|it| RefusalFields {
        refused: it.cause,
        exception: it.code,
        why: refusal_text(decoder, &it),
    })
}

impl From<Transaction> for TransactionFields {
    fn from(it: Transaction) -> Self {
        let Transaction { unit, decoder, request, reply, refusal, .. } = it;
        let decoded = decoder.request(&request);
        let items = match &decoded {
            DecodedRequest::Read(span) if refusal.is_none() => decoder.reply(*span, &reply),
            DecodedRequest::Write(items) => items.clone(),
            DecodedRequest::Read(_) | DecodedRequest::Other => Vec::new(),
        };
        let rows = items.iter().map(|item| decoder.fields(*item)).collect();
        let refusal = refusal_fields(&decoder, refusal);
        let body = TransactionBody { unit, request, reply, rows, refusal };
        match decoded {
            DecodedRequest::Read(_) => Self::Read(body),
            DecodedRequest::Write(_) => Self::Write(body),
            DecodedRequest::Other => Self::Request(body),
        }
    }
}

impl From<Broadcast> for BroadcastFields {
    fn from(it: Broadcast) -> Self {
        let refusal = refusal_fields(&it.decoder, it.refusal);
        Self { unit: it.unit, request: it.request, refusal }
    }
}
