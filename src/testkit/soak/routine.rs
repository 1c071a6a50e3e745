//! What a PLC does to have an axis move: alarms away, power on, a few settings, a start. Left to chance it would
//! hardly ever happen.

use super::draw::Draws;
use super::master::{one, setting};
use super::step::{FrameDamage, SoakStep};
use crate::bus::{Command, DriveOrder};
use crate::event::DriveId;
use crate::model::Model;
use crate::time::Duration;
use crate::vocabulary::{Action, Input, RowId};

/// Whom a routine is for.
#[derive(Debug, Clone, Copy)]
pub struct RoutineAxis<'a> {
    pub model: &'a Model,
    pub drive: DriveId,
    pub unit: u8,
}

/// The steps of a routine.
pub fn routine(axis: RoutineAxis<'_>, draws: &mut Draws) -> Vec<SoakStep> {
    let mut steps = Vec::new();
    if draws.one_in(3) {
        steps.extend(axis.order(Action::AlarmReset, Input::AlarmReset));
    }
    steps.extend(axis.order(Action::Enable, Input::ServoOn));
    steps.extend((0..draws.between(0, 4)).map(|_| axis.ask(setting(axis.model, draws))));
    let starts = [
        (Action::MoveStart, Input::MoveStart),
        (Action::MoveStart, Input::SegmentStart),
        (Action::RunStart, Input::JogPos),
        (Action::RunStart, Input::JogNeg),
        (Action::HomeStart, Input::HomeStart),
        (Action::RunStart, Input::SegmentRun),
    ];
    let (action, input) = *draws.pick(&starts).expect("there are some");
    steps.extend(axis.order(action, input));
    steps.push(SoakStep::Wait(draws.pause(Duration::from_secs(3))));
    steps
}

impl RoutineAxis<'_> {
    /// What gives `action`, or else `input`, by the first way that the model has.
    fn order(self, action: Action, input: Input) -> Vec<SoakStep> {
        let wiring = &self.model.wiring;
        let commands = wiring.commands.iter();
        let commands =
            commands.flat_map(|it| it.actions.iter().map(|(v, a)| (it.row, *v as u16, *a)));
        let triggers = wiring.triggers.iter();
        let triggers =
            triggers.flat_map(|it| it.actions.iter().map(|(b, a)| (it.row, 1 << *b, *a)));
        match commands.chain(triggers).find(|(.., it)| *it == action) {
            Some((row, value, _)) => vec![self.write(row, value)],
            None => self.signal(input),
        }
    }

    /// What makes `input` active.
    fn signal(self, input: Input) -> Vec<SoakStep> {
        let wiring = &self.model.wiring;
        let words = wiring.input_words.iter();
        let word = words.flat_map(|it| {
            let mine = it.positions.iter().filter(|(_, signal)| *signal == input);
            mine.map(move |(position, _)| (it, usize::from(position / 16), 1 << (position % 16)))
        });
        if let Some((words, word, bit)) = word.into_iter().next() {
            let enabled = words.enabled_by.get(word).map(|row| self.write(*row, u16::MAX));
            return enabled.into_iter().chain([self.write(words.rows[word], bit)]).collect();
        }
        let bits = wiring.input_bits.iter();
        let mut bits = bits.flat_map(|(row, bits)| bits.iter().map(|(bit, it)| (*row, *bit, *it)));
        if let Some((row, bit, _)) = bits.find(|(.., it)| *it == input) {
            return vec![self.write(row, 1 << bit)];
        }
        let Some(terminals) = &wiring.input_terminals else { return Vec::new() };
        let init = |row: &RowId| terminals.meaning(self.model.map.row(*row).init);
        let index = terminals.functions.iter().position(|row| init(row) == Some(input));
        let set = |index: usize| {
            let (drive, index) = (self.drive, index as u8);
            let put = |signal| {
                SoakStep::Do(Command::Drive(drive, DriveOrder::Terminal { index, signal }))
            };
            [put(false), put(true)]
        };
        index.map(set).into_iter().flatten().collect()
    }

    fn write(self, row: RowId, value: u16) -> SoakStep {
        self.ask(one(self.model.map.row(row).at, value))
    }

    fn ask(self, pdu: Vec<u8>) -> SoakStep {
        SoakStep::Ask { unit: self.unit, pdu, damage: FrameDamage::Whole }
    }
}
