//! How a drive talks, compiled: functions, limits, word order, the ladder of refusals.

use super::{Coded, RowId};
use crate::serial::{Format, Mode};
use crate::time::Duration;
use crate::vocabulary::Cause;
use crate::wire::LengthCheck;
use std::collections::BTreeMap;

/// How a drive talks.
#[derive(Debug)]
pub struct LineRules {
    /// Function codes that it knows.
    pub functions: Vec<u8>,
    /// Where its unit address comes from.
    pub unit: UnitRule,
    /// Where its baud rate comes from.
    pub baud: Coded<u32>,
    /// Number of DIP switches above those of the address that hold the code of the baud rate; 0 where its row does.
    pub baud_switches: u8,
    /// Where framing and character format come from.
    pub format: Coded<WireFormat>,
    /// Characters of silence that end an RTU frame.
    pub silence: f64,
    /// From the end of that silence to the beginning of a reply, where replies are paced.
    pub reply_after: Duration,
    /// Most registers in one read.
    pub max_read: u16,
    /// Most registers in one write.
    pub max_write: u16,
    /// Exception code that answers a wrong CRC; `None` is silence.
    pub crc_error: Option<u8>,
    /// How far the lengths in a 0x10 request must agree.
    pub length_check: LengthCheck,
    /// Which word of a pair stands first.
    pub word_order: WordOrder,
    /// May a request touch one word of a pair alone?
    pub long_access: LongAccess,
    /// Does reading a write-only row give 0 (or is it refused)?
    pub write_only_reads_zero: bool,
    /// Does reading an address without a row give 0 (or is it refused)?
    pub unlisted_reads_zero: bool,
    /// Causes and their codes, first one first.
    pub refuse: Refuse,
}

impl LineRules {
    /// The rows that it goes by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> {
        // Switches that hold the speed leave nothing to do for its row, nor for that of the format.
        let by_rows = (self.baud_switches == 0).then_some([self.baud.row, self.format.row]);
        let order = match self.word_order {
            WordOrder::Fixed(_) => None,
            WordOrder::Row { row, .. } => Some(row),
        };
        [self.unit.row].into_iter().chain(by_rows.into_iter().flatten()).chain(order)
    }

    /// From the end of a request to the beginning of its reply in `mode`. CR LF ends an ASCII frame, so there
    /// the drive waits for no silence.
    pub fn turnaround(&self, mode: Mode) -> Duration {
        match mode.ascii {
            true => self.reply_after,
            false => mode.settings.silence(self.silence) + self.reply_after,
        }
    }
}

/// Where the unit address comes from.
#[derive(Debug)]
pub struct UnitRule {
    /// The row that holds the code.
    pub row: RowId,
    /// Number of DIP switches; 0 without any.
    pub switches: u8,
    /// The address when switches and row say 0.
    pub zero: u8,
}

/// Framing and character format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WireFormat {
    /// ASCII instead of RTU.
    pub ascii: bool,
    /// The shape of a character.
    pub format: Format,
}

/// Which word of a pair stands at the lower address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegisterOrder {
    /// The high word at the lower address.
    HighFirst,
    /// The low word at the lower address.
    LowFirst,
}

/// Word order: fixed, or as a row says.
#[derive(Debug)]
pub enum WordOrder {
    /// Always the same.
    Fixed(RegisterOrder),
    /// By value of a row.
    Row {
        /// The row that selects the word order.
        row: RowId,
        /// Register order by value.
        codes: BTreeMap<i64, RegisterOrder>,
    },
}

/// May a request touch one word of a pair alone?
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LongAccess {
    /// Yes.
    Any,
    /// No.
    Whole,
}

/// The ladder of refusals: causes in the order in which they answer, each with its code.
#[derive(Debug)]
pub struct Refuse(Vec<(Cause, u8)>);

impl Refuse {
    /// `ladder`, first one first, each cause once.
    pub(super) fn new(ladder: Vec<(Cause, u8)>) -> Self {
        Self(ladder)
    }

    /// Causes and codes, first one first.
    pub fn ladder(&self) -> impl Iterator<Item = (Cause, u8)> + '_ {
        self.0.iter().copied()
    }

    /// The code that `cause` answers with, if the ladder has it.
    pub fn code(&self, cause: Cause) -> Option<u8> {
        self.0.iter().find(|(it, _)| *it == cause).map(|(_, code)| *code)
    }
}
