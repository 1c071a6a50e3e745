//! What a drive puts into its memory: counted, and said to whoever keeps it.

use super::Drive;
use crate::bank::{Kept, OFTEN, SOON, WritePlan, WriteRate, is_worn};
use crate::event::Change;
use crate::vocabulary::RowId;

/// What has become of the memory since power-on.
#[derive(Debug, Default)]
pub(super) struct Memory {
    /// Something was stored that nobody has asked about yet.
    fresh: bool,
    write_rate: WriteRate,
}

impl Memory {
    /// Power came on.
    pub(super) fn power_on(&mut self) {
        self.write_rate = WriteRate::default();
    }

    /// The drive itself has stored something, which wears nothing out that anybody counts.
    pub(super) fn change(&mut self, stored: bool) {
        self.fresh |= stored;
    }
}

impl Drive {
    /// What it keeps over power-off.
    pub fn kept(&self) -> Kept {
        self.bank.kept(&self.model, self.station)
    }

    /// Has something been stored since this was asked last?
    pub fn take_stored(&mut self) -> bool {
        std::mem::take(&mut self.memory.fresh)
    }

    /// Takes note of what `plan` has stored.
    pub(super) fn note_stored(&mut self, plan: &WritePlan) {
        let model = self.model.clone();
        for (row, _) in plan.stored(&model) {
            self.note(Some(row), self.bank.writes(row));
        }
    }

    /// Takes note that all rows were stored at once.
    pub(super) fn note_stored_all(&mut self) {
        self.note(None, self.bank.saves());
    }

    fn note(&mut self, row: Option<RowId>, writes: u32) {
        self.memory.fresh = true;
        if is_worn(writes) {
            self.changes.push_back(Change::Wear { row, writes, within: None });
        }
        if self.memory.write_rate.stored(row, self.now) {
            self.changes.push_back(Change::Wear { row, writes: OFTEN, within: Some(SOON) });
        }
    }
}
