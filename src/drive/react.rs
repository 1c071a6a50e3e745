//! What a committed write sets off: input words refreshed, commands issued, the address changed.

use super::{Drive, IssuedCommand};
use crate::bank::WritePlan;
use crate::event::{Change, Ignored, Ordered};
use crate::model::{self, Reaction};
use crate::time::Duration;
use crate::vocabulary::{Action, Modifier, Modifiers, RowId};

impl Drive {
    /// Reacts to the rows that `plan` wrote, in order of address, to commands last. Rows that only hold a
    /// value react to nothing: whoever needs the value reads it.
    pub(super) fn react(&mut self, plan: &WritePlan) {
        let (mut inputs, mut line) = (false, false);
        for (row, _) in plan.values() {
            match self.model.wiring.reaction(row) {
                Reaction::None | Reaction::Command(_) | Reaction::Trigger(_) => {}
                Reaction::Inputs => inputs = true,
                Reaction::InputWord(word) => {
                    inputs = true;
                    let time = self.hold_time();
                    self.word_watchdogs[usize::from(word)].refresh(self.now, time);
                }
                Reaction::Line => line = true,
                Reaction::Timeout => self.hear(),
            }
        }
        // What was written may be the time that words hold.
        let time = self.hold_time();
        self.word_watchdogs.iter_mut().for_each(|hold| hold.retime(time));
        self.expire_words();
        if inputs {
            self.gather_inputs();
        }
        if line {
            self.follow_line_settings();
        }
        // What was written may be a limit that the axis goes by.
        self.update_axis();
        self.tell_not_simulated();
        // Commands act on what the same request has written, so they come last.
        let mut cleared = false;
        for (row, raw) in plan.values() {
            let reaction = self.model.wiring.reaction(row);
            match reaction {
                Reaction::Command(index) => self.command(index, row, raw),
                Reaction::Trigger(index) => self.trigger(index, row, raw),
                _ => {}
            }
            if self.model.map.row(row).clears {
                self.bank.set(row, self.at_work(row).unwrap_or(0));
                cleared |= matches!(reaction, Reaction::Inputs | Reaction::InputWord(_));
            }
            if let Reaction::InputWord(word) = reaction
                && self.bank.raw(row) == 0
            {
                self.word_watchdogs[usize::from(word)].stop();
            }
        }
        if cleared {
            self.explain();
            // The signals of such a row fall with it, so that the next write is an edge again.
            self.gather_inputs();
        }
        self.look_at_stored(plan);
        self.explain();
    }

    /// Lets input words fall back that were not refreshed in time.
    pub(super) fn expire_words(&mut self) {
        let model = self.model.clone();
        let Some(words) = &model.wiring.input_words else { return };
        let mut expired = false;
        for (hold, word) in self.word_watchdogs.iter_mut().zip(&words.rows) {
            let (Some(held), Some(rule)) = (hold.expired(self.now), &words.hold) else { continue };
            self.bank.set(*word, 0);
            let held_ms = u32::try_from(held.as_millis()).unwrap_or(u32::MAX);
            let change = Change::WordExpired { word: *word, hold: rule.row, held_ms };
            self.changes.push_back(change);
            expired = true;
        }
        if expired {
            self.gather_inputs();
        }
    }

    /// How long a write of an input word word_watchdogs; `None` for ever.
    fn hold_time(&self) -> Option<Duration> {
        self.time_in(self.model.wiring.input_words.as_ref()?.hold.as_ref()?)
    }

    /// The time that a master has for something; `None` for ever.
    pub(super) fn time_in(&self, hold: &model::HoldTime) -> Option<Duration> {
        match self.bank.value(&self.model, hold.row) {
            0 => hold.zero,
            time => hold.unit.duration(time),
        }
    }

    fn command(&mut self, index: u16, row: RowId, raw: u32) {
        let value = self.model.map.row(row).kind.value(raw);
        let actions = &self.model.wiring.commands[usize::from(index)].actions;
        match actions.iter().find(|(it, _)| *it == value) {
            Some((_, action)) => self.give(*action, Modifiers::default()),
            // 0 is what such a row says while nothing is asked of it.
            None if value == 0 => {}
            None => self.ignore(Ordered::Write { row, value }, Ignored::Nothing),
        }
    }

    fn trigger(&mut self, index: u16, row: RowId, raw: u32) {
        let model = self.model.clone();
        let triggers = &model.wiring.triggers[usize::from(index)];
        let is_set = |bit: u8| raw >> bit & 1 != 0;
        let mut modifiers = Modifiers::default();
        let mut orders = triggers.actions.iter().filter(|(bit, _)| is_set(*bit));
        let first = orders.next().map(|(_, action)| *action);
        for (_, modifier) in triggers.modifiers.iter().filter(|(bit, _)| is_set(*bit)) {
            modifiers.insert(*modifier);
        }
        if let Some(action) = first {
            self.give(action, modifiers);
            orders.for_each(|(_, it)| self.ignore(Ordered::Action(*it), Ignored::After(action)));
        }
        let interrupts = |bit: u8| triggers.modifiers.contains(&(bit, Modifier::Interrupt));
        for bit in (0..32u8).filter(|bit| is_set(*bit)) {
            let is_modifier = triggers.modifiers.iter().any(|(it, _)| *it == bit);
            let is_order = triggers.actions.iter().any(|(it, _)| *it == bit);
            let why = match first {
                _ if is_order => continue,
                _ if !is_modifier => Ignored::Nothing,
                None => Ignored::NoOrder,
                Some(Action::MoveStart) => continue,
                // It can take the place of a move.
                Some(Action::RunStart) if interrupts(bit) => continue,
                Some(_) if interrupts(bit) => Ignored::MovesAndRunsOnly,
                Some(_) => Ignored::MovesOnly,
            };
            self.ignore(Ordered::Bit { row, bit, on: true }, why);
        }
    }

    /// Carries out what a master orders, and keeps in mind what a second time would add to.
    fn give(&mut self, action: Action, modifiers: Modifiers) {
        let done = self.act(action, modifiers);
        if action.adds_up(modifiers) {
            self.issued = Some(IssuedCommand { action, obeyed: done.is_ok() });
        }
        if let Err(why) = done {
            self.ignore(Ordered::Action(action), why);
        }
    }

    /// Puts a new address, speed or format in force, as far as it does not wait for power-on.
    pub(super) fn follow_line_settings(&mut self) {
        let changes = self.comms.follow_settings(&self.model, &self.bank);
        self.changes.extend(changes.into_iter().flatten());
    }
}
