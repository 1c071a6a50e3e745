//! The registers of one station: what a request may do, and what is kept over power-off.
//!
//! Decide, then act: [`Bank::plan_read`] and [`Bank::plan_write`] turn a request into a plan or a
//! refusal and change nothing; [`Bank::commit`] cannot fail. The bank knows rows, layers and locks. It does not
//! know axes or signals: what the rest of the drive has to say about a write comes in through a [`Gate`].

mod causes;
mod kept;
mod plan;
mod write_rate;

pub use causes::Causes;
pub use kept::{Kept, KeptRow};
pub use plan::WritePlan;
pub use write_rate::{OFTEN, SOON, WriteRate, is_worn};

use crate::model::{Model, RegisterOrder, Row, RowId, WordOrder};

/// What the rest of the drive says about locked rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Gate {
    /// Power stage on?
    pub enabled: bool,
}

/// The values of one station.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bank {
    /// In force, by row.
    ram: Box<[u32]>,
    /// Back after power-off, by row.
    store: Box<[u32]>,
    /// How often each was stored by itself, by row.
    writes: Box<[u32]>,
    /// How often all were stored at once.
    saves: u32,
}

impl Bank {
    /// Values as they leave the factory.
    pub fn new(model: &Model, station: usize) -> Self {
        let factory = factory(model, station);
        let writes = vec![0; factory.len()].into_boxed_slice();
        Self { ram: factory.clone(), store: factory, writes, saves: 0 }
    }

    /// The value in force.
    pub fn raw(&self, row: RowId) -> u32 {
        self.ram[usize::from(row.0)]
    }

    /// The value in force as a number.
    pub fn value(&self, model: &Model, row: RowId) -> i64 {
        model.map.row(row).kind.value(self.raw(row))
    }

    /// Sets the value in force. For what the drive itself decides; masters go through a plan.
    pub fn set(&mut self, row: RowId, raw: u32) {
        self.ram[usize::from(row.0)] = raw;
    }

    /// Sets the value in force and, unless the row is never kept, the one that returns at power-on.
    pub fn preset(&mut self, model: &Model, row: RowId, raw: u32) {
        self.set(row, raw);
        if !model.map.row(row).volatile {
            self.store[usize::from(row.0)] = raw;
        }
    }

    /// Carries out a plan. The drive's own bank made it an instant ago, so there is nothing to fail.
    pub fn commit(&mut self, model: &Model, plan: &WritePlan) {
        for (row, raw) in plan.values() {
            self.set(row, raw);
        }
        for (row, raw) in plan.stored(model) {
            self.store[usize::from(row.0)] = raw;
            let writes = &mut self.writes[usize::from(row.0)];
            *writes = writes.saturating_add(1);
        }
    }

    /// Keeps every value in force, but for what is never kept.
    pub fn store_all(&mut self, model: &Model) {
        for (id, row) in model.map.rows() {
            if !row.volatile {
                self.store[usize::from(id.0)] = self.raw(id);
            }
        }
        self.saves = self.saves.saturating_add(1);
    }

    /// Puts every value back as it left the factory, in force and kept. What was worn stays worn, and alarms
    /// that were raised are no values of somebody's: they stay on record.
    pub fn restore_factory(&mut self, model: &Model, station: usize) {
        let before = std::mem::replace(&mut self.ram, factory(model, station));
        self.store.clone_from(&self.ram);
        for row in &model.wiring.alarm_history {
            self.preset(model, *row, before[usize::from(row.0)]);
        }
        self.saves = self.saves.saturating_add(1);
    }

    /// Power off and on: kept values return, the others are lost.
    pub fn power_cycle(&mut self) {
        self.ram.copy_from_slice(&self.store);
    }

    /// Which word of `row` stands at the lower address right now.
    pub fn order(&self, model: &Model, row: &Row) -> RegisterOrder {
        row.order.unwrap_or_else(|| self.common_order(model))
    }

    /// The same for rows that say nothing about it.
    pub fn common_order(&self, model: &Model) -> RegisterOrder {
        match &model.line.word_order {
            WordOrder::Fixed(order) => *order,
            WordOrder::Row { row, codes } => {
                codes.get(&self.value(model, *row)).copied().unwrap_or(RegisterOrder::HighFirst)
            }
        }
    }

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

fn factory(model: &Model, station: usize) -> Box<[u32]> {
    let mut values: Box<[u32]> = model.map.rows().map(|(_, row)| row.init).collect();
    for (row, raw) in model.stations.get(station).map_or(&[][..], |station| &station.init) {
        values[usize::from(row.0)] = *raw;
    }
    values
}

/// Word `word` (0 or 1, by address) of a value of `row`.
pub(crate) fn word_of(row: &Row, order: RegisterOrder, raw: u32, word: u8) -> u16 {
    if is_high(row, order, word) { (raw >> 16) as u16 } else { raw as u16 }
}

/// `raw` with its word `word` (by address) replaced.
pub(crate) fn with_word(row: &Row, order: RegisterOrder, raw: u32, word: u8, value: u16) -> u32 {
    match is_high(row, order, word) {
        true => raw & 0x0000_FFFF | u32::from(value) << 16,
        false => raw & 0xFFFF_0000 | u32::from(value),
    }
}

fn is_high(row: &Row, order: RegisterOrder, word: u8) -> bool {
    row.kind.words() == 2 && (order == RegisterOrder::HighFirst) == (word == 0)
}
