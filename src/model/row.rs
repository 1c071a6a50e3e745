//! Compiled rows and the map that finds them by address.

use crate::units::{Unit, parse_integer};
use crate::vocabulary::RowId;
use crate::wire::Span;
use std::collections::BTreeMap;

/// One register, or one register pair.
#[derive(Debug)]
pub struct Row {
    /// The manual's code, or our own word for it in small letters.
    pub id: String,
    /// Address of its first word.
    pub at: u16,
    /// Width and sign.
    pub kind: RowKind,
    /// Values that may be written, in spans.
    pub spans: Vec<(i64, i64)>,
    /// Are they the values of `values`, for want of a range?
    pub listed: bool,
    /// Value as it leaves the factory.
    pub init: u32,
    /// Unit of the value.
    pub unit: Unit,
    /// The unit as the file says it, empty without one.
    pub unit_text: String,
    /// What a master may do.
    pub access: Access,
    /// When a new value takes effect.
    pub applies: Option<Applies>,
    /// Refuses writes while the power stage is on.
    pub locked_while_enabled: bool,
    /// Never kept over power-off.
    pub volatile: bool,
    /// Every write is kept over power-off.
    pub autosave: bool,
    /// Returns to 0 once it has acted.
    pub clears: bool,
    /// Word order of its own.
    pub order: Option<super::RegisterOrder>,
    /// English name.
    pub name: String,
    /// Name as printed.
    pub zh: String,
    /// Section of the manual.
    pub see: String,
    /// What single values mean.
    pub values: BTreeMap<i64, String>,
    /// What single bits mean.
    pub bits: BTreeMap<u8, String>,
    /// Hex digits that ask for something which is not simulated, and for what.
    pub not_simulated: BTreeMap<u8, String>,
    /// Remark.
    pub note: String,
    /// What was assumed, empty if nothing was.
    pub assumed: String,
    /// Stored and read back, and nothing else.
    pub inert: bool,
}

/// Width and sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// One word, unsigned.
    U16,
    /// One word, signed.
    I16,
    /// Two words, unsigned.
    U32,
    /// Two words, signed.
    I32,
}

/// What a master may do with a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Read only.
    Read,
    /// Write only.
    Write,
    /// Reads and writes.
    Both,
}

/// When a written value takes effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Applies {
    /// At once.
    Now,
    /// When the axis stands still.
    AtStop,
    /// At the next power-on.
    PowerOn,
}

/// Where a written value goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// In force only.
    Ram,
    /// In force, and kept over power-off.
    RamAndStore,
}

/// The registers of a model by address.
#[derive(Debug, Default)]
pub struct Map {
    rows: Vec<Row>,
    /// Row index + 1 by address, 0 for a hole, up to the highest mapped address.
    index: Vec<u16>,
    windows: Vec<Window>,
    top: u16,
}

/// An address window onto the rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Window {
    /// Its name in the file.
    pub name: String,
    /// Added to a row's address.
    pub base: u16,
    /// First and last row address that it shows.
    pub span: (u16, u16),
    /// Where a write goes.
    pub layer: Layer,
}

/// What stands at an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Located {
    /// Word `word` of a row, reached through a window that writes to `layer`.
    Word {
        /// The row at that address.
        row: RowId,
        /// 0, or 1 for the second word of a pair.
        word: u8,
        /// Where a write goes.
        layer: Layer,
    },
    /// Nothing, with something mapped above.
    Hole,
    /// Nothing, and nothing above.
    Beyond,
}

impl Map {
    /// A map of `rows`, which do not overlap, through `windows`, which do not either.
    pub(super) fn new(mut rows: Vec<Row>, windows: Vec<Window>) -> Self {
        rows.sort_by_key(|row| row.at);
        let last =
            rows.last().map_or(0, |row| usize::from(row.at) + usize::from(row.kind.words()) - 1);
        let mut index = vec![0; if rows.is_empty() { 0 } else { last + 1 }];
        for (i, row) in rows.iter().enumerate() {
            for word in 0..row.kind.words() {
                index[usize::from(row.at + word)] = i as u16 + 1;
            }
        }
        let shown_top = |w: &Window| {
            rows.iter().rfind(|r| w.shows(r.at)).map(|r| w.base + r.last().min(w.span.1))
        };
        let top = windows.iter().filter_map(shown_top).max().unwrap_or(0);
        Self { rows, index, windows, top }
    }

    /// All rows, by address.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = (RowId, &Row)> {
        self.rows.iter().enumerate().map(|(i, row)| (RowId(i as u16), row))
    }

    /// The row with that index.
    pub fn row(&self, id: RowId) -> &Row {
        &self.rows[usize::from(id.0)]
    }

    /// How many rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The windows.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// The addresses of a row, through each window that shows it.
    pub fn spans(&self, id: RowId) -> Vec<Span> {
        let row = self.row(id);
        let shown = self.windows.iter().filter(|window| window.shows(row.at));
        let span = |window: &Window| Span::new(window.base.checked_add(row.at)?, row.kind.words());
        shown.filter_map(span).collect()
    }

    /// What stands at `address`.
    pub fn locate(&self, address: u16) -> Located {
        for window in &self.windows {
            let Some(at) = address.checked_sub(window.base).filter(|at| window.shows(*at)) else {
                continue;
            };
            if let Some(row) = self.index.get(usize::from(at)).and_then(|i| i.checked_sub(1)) {
                let word = (at - self.rows[usize::from(row)].at) as u8;
                return Located::Word { row: RowId(row), word, layer: window.layer };
            }
        }
        if address > self.top { Located::Beyond } else { Located::Hole }
    }

    /// The row called `name`: its id, or its address in hex (`0x1234`, `1234H`) or decimal.
    pub fn find(&self, name: &str) -> Option<RowId> {
        if let Some((id, _)) = self.rows().find(|(_, row)| row.id == name) {
            return Some(id);
        }
        match self.locate(parse_address(name)?) {
            Located::Word { row, .. } => Some(row),
            Located::Hole | Located::Beyond => None,
        }
    }
}

impl Window {
    /// Does it show the row address `at`?
    fn shows(&self, at: u16) -> bool {
        (self.span.0..=self.span.1).contains(&at)
    }
}

impl Row {
    /// Address of its last word.
    pub fn last(&self) -> u16 {
        self.at + (self.kind.words() - 1)
    }

    /// May a write carry `value`?
    pub fn admits(&self, value: i64) -> bool {
        self.spans.iter().any(|(low, high)| (*low..=*high).contains(&value))
    }

    /// The manual's code, or the address where the manual has no code.
    pub fn code(&self) -> String {
        match self.id.starts_with(|c: char| c.is_ascii_lowercase()) {
            true => format!("0x{:04X}", self.at),
            false => self.id.clone(),
        }
    }

    /// How people call it: its code and its name.
    pub fn label(&self) -> String {
        format!("{} {}", self.code(), self.name)
    }

    /// Its range as people write it: `0..6000`, `-4..-1, 1..14`.
    pub fn range_text(&self) -> String {
        span_text(&self.spans)
    }

    /// What a write may carry, in words: `range 0..6000`, `only -4..-1, 1..14`, `only 0 (none), 1 (absolute)`.
    pub fn admits_text(&self) -> String {
        let named = |(value, name): (&i64, &String)| format!("{value} ({name})");
        let range = self.range_text();
        match () {
            () if self.listed && self.values.len() <= NAMED => {
                let named: Vec<_> = self.values.iter().map(named).collect();
                format!("only {}", named.join(", "))
            }
            () if self.listed || self.spans.len() > 1 => format!("only {range}"),
            () => format!("range {range}"),
        }
    }
}

/// Longer lists of values are told as spans.
const NAMED: usize = 8;

/// Spans of values as people write them.
pub(super) fn span_text(spans: &[(i64, i64)]) -> String {
    let text = |(low, high): &(i64, i64)| match low == high {
        true => low.to_string(),
        false => format!("{low}..{high}"),
    };
    spans.iter().map(text).collect::<Vec<_>>().join(", ")
}

impl RowKind {
    /// Words that it takes.
    pub fn words(self) -> u16 {
        match self {
            Self::U16 | Self::I16 => 1,
            Self::U32 | Self::I32 => 2,
        }
    }

    /// The number that the two words of a pair stand for, lower address first.
    pub fn pair(self, order: super::RegisterOrder, [first, second]: [u16; 2]) -> i64 {
        let [high, low] = match order {
            super::RegisterOrder::HighFirst => [first, second],
            super::RegisterOrder::LowFirst => [second, first],
        };
        self.value(u32::from(high) << 16 | u32::from(low))
    }

    /// Lowest and highest value.
    pub fn limits(self) -> (i64, i64) {
        match self {
            Self::U16 => (0, u16::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U32 => (0, u32::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
        }
    }

    /// The number that the bits `raw` stand for.
    pub fn value(self, raw: u32) -> i64 {
        match self {
            Self::U16 => (raw as u16).into(),
            Self::I16 => (raw as u16 as i16).into(),
            Self::U32 => raw.into(),
            Self::I32 => (raw as i32).into(),
        }
    }

    /// The number that `bits`, written as an unsigned number, stand for: -4 for 65532 in one signed word. `None` if
    /// they are more than the type has.
    pub fn of_bits(self, bits: i64) -> Option<i64> {
        let most = if self.words() == 1 { u16::MAX.into() } else { u32::MAX };
        let bits = u32::try_from(bits).ok().filter(|bits| *bits <= most)?;
        Some(self.value(bits))
    }

    /// The bits of `value`, without those that do not fit.
    pub fn wrapped(self, value: i64) -> u32 {
        if self.words() == 1 { value as u32 & 0xFFFF } else { value as u32 }
    }

    /// The bits of `value`, clamped to what fits.
    pub fn raw(self, value: i64) -> u32 {
        let (low, high) = self.limits();
        self.wrapped(value.clamp(low, high))
    }
}

/// Reads `0x1234`, `1234H` or `4660`.
pub(crate) fn parse_address(text: &str) -> Option<u16> {
    u16::try_from(parse_integer(text)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_bits() {
        assert_eq!(RowKind::I16.value(0xFFFC), -4);
        assert_eq!(RowKind::I16.raw(-4), 0xFFFC);
        assert_eq!(RowKind::I32.value(0xFFFF_FFF6), -10);
        assert_eq!(RowKind::U16.raw(70_000), 0xFFFF);
        assert_eq!(RowKind::I16.raw(-70_000), 0x8000);
        assert_eq!(RowKind::I32.wrapped(0x8000_0000), 0x8000_0000);
        assert_eq!(RowKind::I16.wrapped(-70_000), 0xEE90);
        assert_eq!(RowKind::I16.of_bits(0xFFFC), Some(-4));
        assert_eq!(RowKind::I32.of_bits(0xFFFF_FFFC), Some(-4));
        for (kind, bits) in
            [(RowKind::U16, 0x1_0000), (RowKind::I16, 99_999), (RowKind::U32, 1 << 32)]
        {
            assert_eq!(kind.of_bits(bits), None);
        }
    }

    #[test]
    fn addresses_as_people_write_them() {
        for text in ["0x1234", "1234H", "1234h", "4660"] {
            assert_eq!(parse_address(text), Some(0x1234), "{text}");
        }
        for text in ["", "x", "0x10000", "H", "-1"] {
            assert_eq!(parse_address(text), None, "{text}");
        }
    }
}
