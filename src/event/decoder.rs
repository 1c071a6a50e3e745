//! Requests, replies and values in terms of a drive's rows: `C03.04 jog speed = 7000`.

use crate::model::{Located, Model, RegisterOrder, Row};
use crate::units::Dimension;
use crate::vocabulary::RowId;
use crate::wire::{LengthCheck, Masks, Request, Span, Words};
use serde::Serialize;
use std::fmt;
use std::sync::Arc;

/// What an event needs of its drive to be read without it: the model, and the settings by which numbers on the wire
/// were read at the time.
#[derive(Clone)]
pub struct Decoder {
    model: Arc<Model>,
    /// Of pairs whose row says nothing else.
    order: RegisterOrder,
    /// What a row makes of the unit of speeds.
    speed_factor: f64,
}

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
    Write(Vec<Item>),
    /// No function that reads or writes rows.
    Other,
}

/// An item in JSON.
#[derive(Debug, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) enum ItemFields {
    /// A whole row.
    Row {
        /// Its code in the manual, or drivemu's name for it.
        row: String,
        /// The address of its first word.
        address: u16,
        /// Its name.
        name: String,
        /// The number on the wire, in steps of the row's unit.
        value: i64,
    },
    /// One word of a 32-bit pair.
    Half {
        /// The code of the row.
        row: String,
        /// The address of its first word.
        address: u16,
        /// Its name.
        name: String,
        /// The word.
        word: u16,
    },
    /// An address that no row has.
    Bare {
        /// The address.
        address: u16,
        /// The word.
        word: u16,
    },
    /// A word of which some bits are written.
    Masked {
        /// The code of the row, if it is one.
        #[serde(skip_serializing_if = "Option::is_none")]
        row: Option<String>,
        /// The address of the word.
        address: u16,
        /// The name of the row.
        #[serde(skip_serializing_if = "Option::is_none")]
        name: Option<String>,
        /// The AND mask.
        and: u16,
        /// The OR mask.
        or: u16,
    },
    /// Addresses that no row has and that read as 0.
    Unlisted {
        /// The first of them.
        address: u16,
        /// How many there are.
        words: u16,
        /// Always false.
        mapped: bool,
    },
}

impl Decoder {
    /// For a drive of `model` whose pairs have the word `order` and whose speeds come in steps of the printed unit
    /// times `speed_factor`.
    pub fn new(model: Arc<Model>, order: RegisterOrder, speed_factor: f64) -> Self {
        Self { model, order, speed_factor }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// A row of the model.
    pub fn row(&self, id: RowId) -> &Row {
        self.model.map.row(id)
    }

    /// Reads a request PDU.
    pub fn request(&self, pdu: &[u8]) -> DecodedRequest {
        let parsed = Request::parse(pdu, self.model.line.length_check)
            .or_else(|_| Request::parse(pdu, LengthCheck::CountOnly));
        match parsed {
            Ok(Request::Read(span)) => DecodedRequest::Read(span),
            Ok(Request::WriteOne { address, value }) => {
                DecodedRequest::Write(self.items(Span::one(address), |i| value.get(i)))
            }
            Ok(Request::WriteMany { span, values }) => {
                DecodedRequest::Write(self.items(span, |i| Words::get(values, i)))
            }
            Ok(Request::MaskWrite { address, masks }) => {
                DecodedRequest::Write(vec![Item::Masked(address, masks)])
            }
            Err(_) => DecodedRequest::Other,
        }
    }

    /// The rows that the reply to a read of `span` carries.
    pub fn reply(&self, span: Span, pdu: &[u8]) -> Vec<Item> {
        let word = |i: usize| {
            let bytes = pdu.get(2 + 2 * i..4 + 2 * i)?;
            Some(u16::from_be_bytes([bytes[0], bytes[1]]))
        };
        let mut told: Vec<Item> = Vec::new();
        for item in self.items(span, word) {
            match (told.last_mut(), item) {
                (Some(Item::Unlisted(_, last)), Item::Bare(address, _)) => *last = address,
                (_, Item::Bare(address, _)) => told.push(Item::Unlisted(address, address)),
                _ => told.push(item),
            }
        }
        told
    }

    fn items(&self, span: Span, word: impl Fn(usize) -> Option<u16>) -> Vec<Item> {
        let map = &self.model.map;
        let mut items = Vec::new();
        let mut addresses = span.addresses().enumerate().peekable();
        while let Some((i, address)) = addresses.next() {
            let Some(first) = word(i) else { break };
            let Located::Word { row: id, word: 0, .. } = map.locate(address) else {
                items.push(match map.locate(address) {
                    Located::Word { row, .. } => Item::Half(row, first),
                    _ => Item::Bare(address, first),
                });
                continue;
            };
            let row = map.row(id);
            if row.kind.words() == 1 {
                items.push(Item::Row(id, row.kind.value(first.into())));
                continue;
            }
            items.push(match addresses.next_if(|_| word(i + 1).is_some()) {
                Some((j, _)) => {
                    let words = [first, word(j).unwrap_or(0)];
                    Item::Row(id, row.kind.pair(row.order.unwrap_or(self.order), words))
                }
                None => Item::Half(id, first),
            });
        }
        items
    }

    /// `C03.04 jog speed = 7000`.
    pub fn text(&self, item: Item) -> String {
        match item {
            Item::Row(id, value) => format!("{} = {}", label(self.row(id)), self.number(id, value)),
            Item::Half(id, word) => format!("one word of {} = 0x{word:04X}", label(self.row(id))),
            Item::Bare(address, word) => format!("0x{address:04X} = {word}"),
            Item::Unlisted(first, last) if first == last => {
                format!("0x{first:04X} = 0 (not mapped)")
            }
            Item::Unlisted(first, last) => format!("0x{first:04X}..0x{last:04X} = 0 (not mapped)"),
            Item::Masked(address, Masks { and, or }) => {
                let place = match self.model.map.locate(address) {
                    Located::Word { row, .. } => match self.row(row) {
                        row if row.kind.words() == 1 => label(row),
                        row => format!("one word of {}", label(row)),
                    },
                    Located::Hole | Located::Beyond => format!("0x{address:04X}"),
                };
                format!("{place} AND 0x{and:04X} OR 0x{or:04X}")
            }
        }
    }

    /// `C101 jog speed = 7000`: the bare number of a value that was refused, to be held against the range.
    pub fn refused_text(&self, item: Item) -> String {
        match item {
            Item::Row(id, value) => format!("{} = {value}", label(self.row(id))),
            item => self.text(item),
        }
    }

    /// A value as the row means it: words in hex where bits have names, and the meaning of a code.
    fn number(&self, id: RowId, value: i64) -> String {
        let row = self.row(id);
        if let Some(meaning) = row.values.get(&value) {
            return format!("{value} ({meaning})");
        }
        if !row.bits.is_empty() {
            return format!("0x{:04X}", row.kind.raw(value));
        }
        let is_speed = row.unit.dimension == Dimension::Speed;
        match row.unit_text.as_str() {
            "" => value.to_string(),
            // Another row says that the unit is another one at present, in steps of the plain symbol.
            unit if is_speed && self.speed_factor != 1.0 => {
                let step = (row.unit.scale * self.speed_factor * 1e6).round() / 1e6;
                format!("{value} x {step} {}", unit.rsplit(' ').next().unwrap_or(unit))
            }
            // A factor is no unit of its own: 60 of `0.1 rpm`.
            unit if unit.contains(' ') => format!("{value} x {unit}"),
            unit => format!("{value} {unit}"),
        }
    }

    /// What the model calls an input terminal.
    pub fn terminal(&self, index: u8) -> String {
        let terminals = self.model.wiring.input_terminals.as_ref();
        terminals.map(|it| it.name(usize::from(index))).unwrap_or_default()
    }

    /// What the model calls a function that is not simulated.
    pub fn not_simulated(&self, function: u8) -> &str {
        let labels = &self.model.wiring.not_simulated.labels;
        labels.get(usize::from(function)).map_or("", String::as_str)
    }

    pub(super) fn fields(&self, item: Item) -> ItemFields {
        let named = |id: RowId| {
            let row = self.row(id);
            (row.id.clone(), row.at, row.name.clone())
        };
        match item {
            Item::Row(id, value) => {
                let (row, address, name) = named(id);
                ItemFields::Row { row, address, name, value }
            }
            Item::Half(id, word) => {
                let (row, address, name) = named(id);
                ItemFields::Half { row, address, name, word }
            }
            Item::Bare(address, word) => ItemFields::Bare { address, word },
            Item::Unlisted(first, last) => {
                ItemFields::Unlisted { address: first, words: last - first + 1, mapped: false }
            }
            Item::Masked(address, Masks { and, or }) => {
                let row = match self.model.map.locate(address) {
                    Located::Word { row, .. } => Some(self.row(row)),
                    Located::Hole | Located::Beyond => None,
                };
                let (row, name) = (row.map(|it| it.id.clone()), row.map(|it| it.name.clone()));
                ItemFields::Masked { row, address, name, and, or }
            }
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

/// Two are the same if they read everything alike: the model of one name, with the same settings.
impl PartialEq for Decoder {
    fn eq(&self, other: &Self) -> bool {
        let same_model = Arc::ptr_eq(&self.model, &other.model)
            || (&self.model.vendor, &self.model.name) == (&other.model.vendor, &other.model.name);
        same_model && self.order == other.order && self.speed_factor == other.speed_factor
    }
}

impl Eq for Decoder {}

/// The name of the model: a test's failure should not print all of its rows.
impl fmt::Debug for Decoder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.model.name)
    }
}

/// A row of a drive, told by its code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowName(pub Decoder, pub RowId);

impl fmt::Display for RowName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&label(self.0.row(self.1)))
    }
}

/// An input terminal of a drive, told by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TerminalName(pub Decoder, pub u8);

impl fmt::Display for TerminalName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.terminal(self.1))
    }
}

impl Serialize for RowName {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0.row(self.1).id)
    }
}

impl Serialize for TerminalName {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
