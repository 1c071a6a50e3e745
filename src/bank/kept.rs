//! What a station keeps over power-off, as a value: its memory can be taken out and put into another run.
//!
//! Deliberately without names and text: what a file makes of it is the bench's.

use crate::vocabulary::RowId;

/// The memory of one station.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Kept {
    /// Rows that were stored by themselves, or differ from what left the factory; by address.
    pub rows: Vec<KeptRow>,
    /// How often all rows were stored at once.
    pub saves: u32,
}

/// One row of a [`Kept`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeptRow {
    /// Which.
    pub row: RowId,
    /// Its bits.
    pub raw: u32,
    /// How often it was stored by itself.
    pub writes: u32,
}

impl Kept {
    /// The bits of `row`, if it is among them.
    pub fn raw(&self, row: RowId) -> Option<u32> {
        self.find(row).map(|it| it.raw)
    }

    /// Has a master stored `row`, by itself or with all others?
    pub fn is_stored(&self, row: RowId) -> bool {
        self.find(row).is_some_and(|it| it.writes > 0 || self.saves > 0)
    }

    fn find(&self, row: RowId) -> Option<&KeptRow> {
        self.rows.iter().find(|it| it.row == row)
    }
}
