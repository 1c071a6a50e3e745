//! What a committed write sets off: input words refreshed, commands carried out, the address changed.

use super::parts::{Parts, Update};
use super::setup::IssuedCommand;
use crate::bank::WritePlan;
use crate::event::{DriveEvent, Ignored, Ordered};
use crate::model::Reaction;
use crate::vocabulary::{Action, AlarmCause, HomeStarter, Modifier, Modifiers, RowId};

impl Parts {
    /// Reacts to the rows that `plan` wrote, in order of address, to commands last. Rows that only hold a
    /// value react to nothing: whoever needs the value reads it.
    pub(super) fn react(&mut self, plan: &WritePlan) {
        let model = self.registers.model().clone();
        let rule = model.wiring.input_words.as_ref().and_then(|words| words.hold.as_ref());
        let time = self.registers.hold_time(rule);
        let (mut inputs, mut line) = (false, false);
        for (row, _) in plan.values() {
            match model.wiring.reaction(row) {
                Reaction::None | Reaction::Command(_) | Reaction::Trigger(_) => {}
                Reaction::Inputs => inputs = true,
                Reaction::InputWord(word) => {
                    inputs = true;
                    self.inputs.refresh_word(self.now, word, time);
                }
                Reaction::Line => line = true,
                Reaction::Timeout => self.on_request(),
            }
        }
        // What was written may be the time that words hold.
        self.inputs.retime_words(time);
        self.expire_words();
        if inputs {
            self.update(Update::Inputs);
        }
        if line {
            self.follow_line_settings();
        }
        // What was written may be a limit that the axis goes by.
        self.update(Update::Axis);
        self.update(Update::NotSimulated);
        // Commands act on what the same request has written, so they come last.
        let mut cleared = false;
        for (row, raw) in plan.values() {
            let reaction = model.wiring.reaction(row);
            match reaction {
                Reaction::Command(index) => self.command(index, row, raw),
                Reaction::Trigger(index) => self.trigger(index, row, raw),
                _ => {}
            }
            if model.map.row(row).clears {
                // A command that is still at work stays.
                let at_work = self.registers.home_command(row).filter(|_| self.axis.is_homing());
                self.registers.set(row, at_work.unwrap_or(0));
                cleared |= matches!(reaction, Reaction::Inputs | Reaction::InputWord(_));
            }
            if let Reaction::InputWord(word) = reaction
                && self.registers.raw(row) == 0
            {
                self.inputs.stop_word(word);
            }
        }
        if cleared {
            self.report_inactive();
            // The signals of such a row fall with it, so that the next write is an edge again.
            self.update(Update::Inputs);
        }
        let (view, no_effect, out) = self.split_no_effect();
        no_effect.note_written(view, out, plan);
        self.report_inactive();
    }

    fn command(&mut self, index: u16, row: RowId, raw: u32) {
        let value = self.registers.model().map.row(row).kind.value(raw);
        let actions = &self.registers.model().wiring.commands[usize::from(index)].actions;
        match actions.iter().find(|(it, _)| *it == value) {
            Some((_, action)) => self.give(*action, Modifiers::default()),
            // 0 is what such a row says while nothing is asked of it.
            None if value == 0 => {}
            None => self.ignore(Ordered::Write { row, value }, Ignored::Nothing),
        }
    }

    fn trigger(&mut self, index: u16, row: RowId, raw: u32) {
        let model = self.registers.model().clone();
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

    /// Carries out `action`.
    ///
    /// # Errors
    /// Why it has no effect.
    fn act(&mut self, action: Action, modifiers: Modifiers) -> Result<(), Ignored> {
        if matches!(action, Action::StoreAll | Action::RestoreFactory) && self.is_moving() {
            return Err(Ignored::Moving);
        }
        let [absolute, interrupt] =
            [Modifier::Absolute, Modifier::Interrupt].map(|it| modifiers.has(it));
        let (cx, axis, out) = self.split();
        let mut done = Ok(());
        match action {
            Action::MoveStart => done = axis.start_move(cx, absolute, interrupt),
            Action::RunStart => done = axis.start_run(cx, interrupt),
            Action::HomeStart => done = axis.home(cx, out, HomeStarter::Command),
            Action::Stop => done = axis.stop(cx, false),
            Action::QuickStop => done = axis.stop(cx, true),
            Action::Enable => done = self.power.order(true),
            Action::Release => done = self.power.order(false),
            Action::AlarmReset => done = self.power.reset(),
            Action::EncoderReset => done = self.power.reset_of(AlarmCause::Encoder),
            Action::ClearAlarmHistory => {
                self.registers.forget_alarms();
                self.effects.change(DriveEvent::AlarmHistoryCleared);
            }
            Action::ClearPosition => {
                axis.clear_position(cx);
                out.change(DriveEvent::PositionCleared);
            }
            Action::ClearTurns => {
                axis.clear_turns(cx);
                out.change(DriveEvent::TurnsCleared);
            }
            Action::StoreAll => self.registers.store_all(self.now, &mut self.effects),
            Action::RestoreFactory => {
                self.registers.restore_factory(self.now, &mut self.effects);
                // Input words are 0 then, so there is nothing left to fall back.
                self.inputs.stop_words();
                self.on_request();
                self.update(Update::Inputs);
                self.follow_line_settings();
            }
            Action::PowerCycle => self.restart = true,
        }
        self.report_power();
        self.report_axis(None);
        self.update(Update::Axis);
        done
    }

    /// Puts a new address, speed or format in force, as far as it does not wait for power-on.
    fn follow_line_settings(&mut self) {
        let changes = self.comms.follow_settings(&self.registers);
        changes.into_iter().flatten().for_each(|change| self.effects.change(change));
    }
}
