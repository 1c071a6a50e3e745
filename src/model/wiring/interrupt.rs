//! Interrupt positioning and inhibited commands, compiled: the rows that they go by, and whether their signals go with them.

use super::SettingRow;
use super::choice::Choice;
use super::compile::Wirer;
use super::segment_rows::MOVE;
use crate::model::raw::{RawChoice, RawInterrupt};
use crate::problem::{Path, Problem};
use crate::vocabulary::{Input, InterruptRule, Named, Output, RowId};

/// A move that takes the place of a motion under way.
#[derive(Debug)]
pub struct InterruptWiring {
    /// The rows that it goes by.
    pub settings: Vec<SettingRow>,
    /// May it start?
    pub rule: Choice<InterruptRule>,
}

impl InterruptWiring {
    /// Every row of it.
    pub(super) fn rows(&self) -> impl Iterator<Item = RowId> {
        self.settings.iter().map(|it| it.row).chain(self.rule.row())
    }
}

impl Wirer<'_> {
    /// What becomes of a deviation when commands are inhibited, where something inhibits them.
    pub(super) fn inhibit(
        &mut self,
        raw: &Option<RawChoice<String>>,
        path: &Path,
        inputs: &[Input],
    ) {
        if raw.is_some() && !inputs.contains(&Input::CommandInhibit) {
            let what = "has no effect: no input is `command_inhibit`";
            self.problems.push(Problem::key(path.clone(), what).advise("wire it, or remove this"));
        }
        self.wiring.axis.inhibit = self.words_chosen(raw, "rule for inhibited commands", path);
    }

    pub(super) fn interrupt(&mut self, raw: Option<&RawInterrupt>, path: &Path, inputs: &[Input]) {
        if let Some(raw) = raw {
            let settings = self.segment_settings(&raw.quantities, 0, &MOVE, path);
            let rule = match &raw.rule {
                None => Some(Choice::Fixed(InterruptRule::Free)),
                raw => self.words_chosen(raw, "rule for interrupt positioning", &path.key("rule")),
            };
            self.wiring.axis.interrupt = rule.map(|rule| InterruptWiring { settings, rule });
        }
        let starts = inputs.contains(&Input::InterruptStart);
        if raw.is_some() && !starts {
            let what = "has no effect: no input is `interrupt_start`";
            self.problems.push(Problem::key(path.clone(), what).advise("wire it, or remove this"));
        }
        let others = [Input::InterruptStart, Input::InterruptUnlock, Input::InterruptInhibit];
        let others = others.into_iter().filter(|it| inputs.contains(it)).map(Named::name);
        let outputs = [Output::InterruptActive, Output::InterruptDone];
        let outputs = outputs.into_iter().filter(|it| self.is_shown(*it)).map(Named::name);
        let names: Vec<_> = others.chain(outputs).collect();
        if raw.is_none() {
            for name in names {
                let what = format!("`{name}` has no effect without axis.interrupt");
                let path = Path::root().key("signals");
                self.problems.push(Problem::key(path, what).advise("remove it"));
            }
        }
    }
}
