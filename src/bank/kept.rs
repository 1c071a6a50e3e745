//! What a station keeps over power-off, as a value: its memory can be taken out and put into another run.
//!
//! Deliberately without names and text: what a file makes of it is the bench's.

use super::{Bank, factory};
use crate::model::{Model, RowId};

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

impl Bank {
    /// What returns at power-on, and how often it was stored. `station` is the one of the model that this
    /// bank was made for.
    pub fn kept(&self, model: &Model, station: usize) -> Kept {
        let factory = factory(model, station);
        let rows = model.map.rows().filter(|(_, row)| !row.volatile).filter_map(|(row, _)| {
            let index = usize::from(row.0);
            let (raw, writes) = (self.store[index], self.writes[index]);
            (writes > 0 || raw != factory[index]).then_some(KeptRow { row, raw, writes })
        });
        Kept { rows: rows.collect(), saves: self.saves }
    }

    /// Puts a memory in, values in force with it.
    pub fn recall(&mut self, model: &Model, kept: &Kept) {
        for KeptRow { row, raw, writes } in &kept.rows {
            self.preset(model, *row, *raw);
            self.writes[usize::from(row.0)] = *writes;
        }
        self.saves = kept.saves;
    }

    /// How often `row` was stored by itself.
    pub fn writes(&self, row: RowId) -> u32 {
        self.writes[usize::from(row.0)]
    }

    /// How often all rows were stored at once.
    pub fn saves(&self) -> u32 {
        self.saves
    }
}
