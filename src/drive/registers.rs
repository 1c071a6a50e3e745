//! The registers of a drive: the values that are in force and kept, what they mean, and what is put into the memory.

use super::effects::EffectQueue;
use super::setup::Setup;
use crate::bank::{Bank, Kept, OFTEN, SOON, WritePlan, WriteRate, is_worn, word_of};
use crate::event::{Decoder, DriveEvent, RowName, TerminalName};
use crate::model::{Applies, Choice, Counts, HoldTime, Located, Model, Terminals};
use crate::time::{Duration, Instant};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Action, RowId};
use std::sync::Arc;

/// The values of one station by its model.
#[derive(Debug)]
pub(super) struct Registers {
    model: Arc<Model>,
    station: usize,
    /// Values that the bench gave it survive a factory reset no more than a real user's do.
    bank: Bank,
    /// Something was stored that nobody has asked about yet.
    unsaved: bool,
    write_rate: WriteRate,
}

impl Registers {
    /// As the bench sets them up.
    pub(super) fn new(model: Arc<Model>, setup: &Setup) -> Self {
        let mut bank = Bank::new(&model, setup.station);
        bank.recall(&model, &setup.kept);
        setup.values.iter().for_each(|(row, raw)| bank.preset(&model, *row, *raw));
        let (station, write_rate) = (setup.station, WriteRate::default());
        Self { model, station, bank, unsaved: false, write_rate }
    }

    pub(super) fn model(&self) -> &Arc<Model> {
        &self.model
    }

    pub(super) fn station(&self) -> usize {
        self.station
    }

    pub(super) fn bank(&self) -> &Bank {
        &self.bank
    }

    /// The bits in force.
    pub(super) fn raw(&self, row: RowId) -> u32 {
        self.bank.raw(row)
    }

    /// The number in force.
    pub(super) fn value(&self, row: RowId) -> i64 {
        self.bank.value(&self.model, row)
    }

    /// The word at `address` that the register holds, whatever it shows; 0 where there is none.
    pub(super) fn word_at(&self, address: u16) -> u16 {
        let Located::Word { row: id, word, .. } = self.model.map.locate(address) else { return 0 };
        let row = self.model.map.row(id);
        word_of(row, self.bank.order(&self.model, row), self.bank.raw(id), word)
    }

    /// Is the bit set?
    pub(super) fn is_set(&self, row: RowId, bit: u16) -> bool {
        self.raw(row) >> bit & 1 != 0
    }

    /// Sets what the drive itself decides.
    pub(super) fn set(&mut self, row: RowId, raw: u32) {
        self.bank.set(row, raw);
    }

    /// Power comes back.
    pub(super) fn power_cycle(&mut self) {
        self.bank.power_cycle();
    }

    /// Power has come on: nothing was stored in a cycle.
    pub(super) fn power_on(&mut self) {
        self.write_rate = WriteRate::default();
    }

    /// Carries out what a master writes.
    pub(super) fn commit(&mut self, now: Instant, plan: &WritePlan, out: &mut EffectQueue) {
        self.bank.commit(&self.model, plan);
        let model = self.model.clone();
        for (row, _) in plan.stored(&model) {
            self.note(now, Some(row), self.bank.writes(row), out);
        }
    }

    /// Stores all rows at once.
    pub(super) fn store_all(&mut self, now: Instant, out: &mut EffectQueue) {
        self.bank.store_all(&self.model);
        out.change(DriveEvent::Stored);
        self.note(now, None, self.bank.saves(), out);
    }

    /// Puts all values back as they left the factory, which stores them.
    pub(super) fn restore_factory(&mut self, now: Instant, out: &mut EffectQueue) {
        self.bank.restore_factory(&self.model, self.station);
        out.change(DriveEvent::FactoryRestored);
        self.note(now, None, self.bank.saves(), out);
    }

    fn note(&mut self, now: Instant, row: Option<RowId>, writes: u32, out: &mut EffectQueue) {
        self.unsaved = true;
        let named = |it: &Self| row.map(|row| RowName(it.decoder(), row));
        if is_worn(writes) {
            let row = named(self);
            out.change(DriveEvent::ExcessiveWrites { row, writes, within: None });
        }
        if self.write_rate.stored(row, now) {
            let (row, within) = (named(self), Some(SOON));
            out.change(DriveEvent::ExcessiveWrites { row, writes: OFTEN, within });
        }
    }

    /// What is kept over power-off.
    pub(super) fn kept(&self) -> Kept {
        self.bank.kept(&self.model, self.station)
    }

    /// Has something been stored since this was asked last?
    pub(super) fn take_unsaved(&mut self) -> bool {
        std::mem::take(&mut self.unsaved)
    }

    /// Puts an alarm before those that were raised earlier. The oldest is lost where there is no room. That wears nothing
    /// out that anybody counts.
    pub(super) fn remember_alarm(&mut self, code: u16) {
        let mut newer = u32::from(code);
        for row in &self.model.wiring.alarm_history {
            let older = self.bank.raw(*row);
            self.bank.preset(&self.model, *row, newer);
            newer = older;
        }
        self.unsaved |= !self.model.wiring.alarm_history.is_empty();
    }

    /// Forgets the alarms that were raised earlier.
    pub(super) fn forget_alarms(&mut self) {
        for row in &self.model.wiring.alarm_history {
            self.bank.preset(&self.model, *row, 0);
        }
        self.unsaved = true;
    }

    /// A homing is over: rows that started it say so no longer.
    pub(super) fn end_home_commands(&mut self) {
        for commands in &self.model.wiring.commands {
            let starts = |(_, action): &(i64, Action)| *action == Action::HomeStart;
            if self.model.map.row(commands.row).clears && commands.actions.iter().any(starts) {
                self.bank.set(commands.row, 0);
            }
        }
    }

    /// The bits with which `row` starts a homing, if it does.
    pub(super) fn home_command(&self, row: RowId) -> Option<u32> {
        let commands = self.model.wiring.commands.iter().find(|it| it.row == row)?;
        let start = commands.actions.iter().find(|(_, action)| *action == Action::HomeStart)?;
        Some(self.model.map.row(row).kind.raw(start.0))
    }

    /// What a choice comes to, if there is one.
    pub(super) fn chosen<T: Copy>(&self, choice: &Option<Choice<T>>) -> Option<T> {
        self.choose(choice.as_ref()?)
    }

    /// What a choice comes to.
    pub(super) fn choose<T: Copy>(&self, choice: &Choice<T>) -> Option<T> {
        choice.get(|row| self.value(row))
    }

    /// Does a value of `row` count at once, as printed?
    pub(super) fn is_live(&self, row: RowId) -> bool {
        self.model.map.row(row).applies == Some(Applies::Now)
    }

    /// The unit of a row. That of a speed may be finer than the model says, where a row decides.
    pub(super) fn unit_of(&self, row: RowId) -> Unit {
        let unit = self.model.map.row(row).unit;
        match unit.dimension {
            Dimension::Speed => Unit { scale: unit.scale * self.speed_factor(), ..unit },
            _ => unit,
        }
    }

    /// What a row makes of the unit of speeds.
    fn speed_factor(&self) -> f64 {
        let rule = self.model.wiring.axis.speed_unit.as_ref();
        rule.and_then(|it| it.decode(self.value(it.row))).unwrap_or(1.0)
    }

    /// How requests, replies and values read at present, for the events that tell of them.
    pub(super) fn decoder(&self) -> Decoder {
        let order = self.bank.common_order(&self.model);
        Decoder::new(self.model.clone(), order, self.speed_factor())
    }

    /// The name of an input terminal.
    pub(super) fn terminal_name(&self, index: u8) -> TerminalName {
        TerminalName(self.decoder(), index)
    }

    /// The value of a row in the base unit of its dimension.
    pub(super) fn in_base_unit(&self, row: RowId) -> f64 {
        self.value(row) as f64 * self.unit_of(row).scale
    }

    /// Counts or increments for one revolution.
    pub(super) fn per_rev(&self, counts: Counts) -> f64 {
        match counts {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => self.value(row) as f64,
        }
    }

    /// The time that a master has to do something again; `None` for ever.
    pub(super) fn hold_time(&self, hold: Option<&HoldTime>) -> Option<Duration> {
        let hold = hold?;
        match self.value(hold.row) {
            0 => hold.zero,
            time => hold.unit.duration(time),
        }
    }

    /// The setting that gives the signal of this bit to somebody else.
    pub(super) fn overridden_by(&self, row: RowId, bit: u8) -> Option<RowId> {
        let overrides = &self.model.wiring.bit_overrides;
        let mut of_bit = overrides.iter().filter(|it| (it.row, it.bit) == (row, bit));
        of_bit.find(|it| it.by.of(self.value(it.by.row)) != 0).map(|it| it.by.row)
    }

    /// Terminals that are normally closed, bit by bit.
    pub(super) fn normally_closed<S>(&self, terminals: &Terminals<S>) -> u32 {
        let all = (1u32 << terminals.functions.len()) - 1;
        terminals.normally_closed.map_or(0, |row| self.raw(row) & all)
    }
}
