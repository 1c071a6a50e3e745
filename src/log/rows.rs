//! Requests and answers in terms of rows: `C03.04 jog speed = 7000`.

use crate::bank::row_value;
use crate::drive::Drive;
use crate::model::{Located, Row, RowId};
use crate::wire::{LengthCheck, Masks, Request, Span, Words};

/// A row of a request with the number that travelled, or a bare word where there is no row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// A whole row.
    Row(RowId, i64),
    /// One word of a pair.
    Half(RowId, u16),
    /// An address without a row.
    Bare(u16, u16),
    /// Addresses without a row, from the first to the last, that a read gave as 0.
    Unlisted(u16, u16),
    /// What becomes of the bits of the word at an address.
    Masked(u16, Masks),
}

/// What a request does, in rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DecodedRequest {
    /// Read these addresses.
    Read(Span),
    /// Write these rows.
    Write(Span, Vec<Item>),
    /// Not a request of ours.
    Other,
}

/// Reads a request PDU.
pub fn request(drive: &Drive, pdu: &[u8]) -> DecodedRequest {
    let parsed = Request::parse(pdu, drive.model().line.length_check)
        .or_else(|_| Request::parse(pdu, LengthCheck::CountOnly));
    match parsed {
        Ok(Request::Read(span)) => DecodedRequest::Read(span),
        Ok(Request::WriteOne { address, value }) => {
            let span = Span::one(address);
            DecodedRequest::Write(span, items(drive, span, |i| value.get(i)))
        }
        Ok(Request::WriteMany { span, values }) => {
            DecodedRequest::Write(span, items(drive, span, |i| Words::get(values, i)))
        }
        Ok(Request::MaskWrite { address, masks }) => {
            DecodedRequest::Write(Span::one(address), vec![Item::Masked(address, masks)])
        }
        Err(_) => DecodedRequest::Other,
    }
}

/// What the model calls an input terminal.
pub fn terminal(drive: &Drive, index: u8) -> String {
    let terminals = drive.model().wiring.input_terminals.as_ref();
    terminals.map(|it| it.name(usize::from(index))).unwrap_or_default()
}

/// What the model calls a function that is not simulated.
pub fn not_simulated(drive: &Drive, function: u8) -> &str {
    let labels = &drive.model().wiring.not_simulated.labels;
    labels.get(usize::from(function)).map_or("", String::as_str)
}

/// The rows that the answer to a read carries.
pub fn answer(drive: &Drive, span: Span, pdu: &[u8]) -> Vec<Item> {
    let word = |i: usize| {
        let bytes = pdu.get(2 + 2 * i..4 + 2 * i)?;
        Some(u16::from_be_bytes([bytes[0], bytes[1]]))
    };
    let mut told: Vec<Item> = Vec::new();
    for item in items(drive, span, word) {
        match (told.last_mut(), item) {
            (Some(Item::Unlisted(_, last)), Item::Bare(address, _)) => *last = address,
            (_, Item::Bare(address, _)) => told.push(Item::Unlisted(address, address)),
            _ => told.push(item),
        }
    }
    told
}

fn items(drive: &Drive, span: Span, word: impl Fn(usize) -> Option<u16>) -> Vec<Item> {
    let (model, bank) = (drive.model(), drive.bank());
    let mut items = Vec::new();
    let mut addresses = span.addresses().enumerate().peekable();
    while let Some((i, address)) = addresses.next() {
        let Some(first) = word(i) else { break };
        let Located::Word { row: id, word: 0, .. } = model.map.locate(address) else {
            items.push(match model.map.locate(address) {
                Located::Word { row, .. } => Item::Half(row, first),
                _ => Item::Bare(address, first),
            });
            continue;
        };
        let row = model.map.row(id);
        if row.kind.words() == 1 {
            items.push(Item::Row(id, row.kind.value(first.into())));
            continue;
        }
        match addresses.next_if(|_| word(i + 1).is_some()) {
            Some((j, _)) => {
                let second = word(j).unwrap_or(0);
                let value = row_value(row, bank.order(model, row), [first, second]);
                items.push(Item::Row(id, value));
            }
            None => items.push(Item::Half(id, first)),
        }
    }
    items
}

/// `C03.04 jog speed = 7000`.
pub fn text(drive: &Drive, item: Item) -> String {
    let map = &drive.model().map;
    match item {
        Item::Row(id, value) => format!("{} = {}", label(map.row(id)), number(drive, id, value)),
        Item::Half(id, word) => format!("one word of {} = 0x{word:04X}", label(map.row(id))),
        Item::Bare(address, word) => format!("0x{address:04X} = {word}"),
        Item::Unlisted(first, last) if first == last => {
            format!("0x{first:04X} = 0 (not mapped)")
        }
        Item::Unlisted(first, last) => format!("0x{first:04X}..0x{last:04X} = 0 (not mapped)"),
        Item::Masked(address, Masks { and, or }) => {
            let place = match map.locate(address) {
                Located::Word { row, .. } if map.row(row).kind.words() == 1 => label(map.row(row)),
                Located::Word { row, .. } => format!("one word of {}", label(map.row(row))),
                Located::Hole | Located::Beyond => format!("0x{address:04X}"),
            };
            format!("{place} AND 0x{and:04X} OR 0x{or:04X}")
        }
    }
}

/// The row as the log calls it: code, or address, and name in small letters.
pub fn label(row: &Row) -> String {
    let label = row.label();
    let Some((code, name)) = label.split_once(' ') else { return label };
    let mut letters = name.chars();
    match (letters.next(), letters.next()) {
        (Some(first), second) if second.is_none_or(|it| it.is_lowercase() || it == ' ') => {
            format!("{code} {}{}", first.to_lowercase(), &name[first.len_utf8()..])
        }
        _ => label,
    }
}

/// `C101 jog speed = 7000`: the bare number of a value that was refused, to be held against the range.
pub fn refused_text(drive: &Drive, item: Item) -> String {
    match item {
        Item::Row(id, value) => format!("{} = {value}", label(drive.model().map.row(id))),
        item => text(drive, item),
    }
}

/// A value as the row means it: words in hex where bits have names, and the meaning of a code.
fn number(drive: &Drive, id: RowId, value: i64) -> String {
    let row = drive.model().map.row(id);
    if let Some(meaning) = row.values.get(&value) {
        return format!("{value} ({meaning})");
    }
    if !row.bits.is_empty() {
        return format!("0x{:04X}", row.kind.raw(value));
    }
    match row.unit_text.as_str() {
        "" => value.to_string(),
        // A row says that it is another one at present, in steps of the plain symbol.
        unit if drive.unit_of(id) != row.unit => {
            let step = (drive.unit_of(id).scale * 1e6).round() / 1e6;
            format!("{value} x {step} {}", unit.rsplit(' ').next().unwrap_or(unit))
        }
        // A factor is no unit of its own: 60 of `0.1 rpm`.
        unit if unit.contains(' ') => format!("{value} x {unit}"),
        unit => format!("{value} {unit}"),
    }
}
