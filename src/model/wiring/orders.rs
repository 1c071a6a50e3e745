//! Rows that set something off: values that are commands, and bits that are triggers.

use super::compile::Wirer;
use super::{CommandRows, Reaction, Triggers};
use crate::model::raw::RawTriggers;
use crate::problem::{At, Path, Problem};
use crate::vocabulary::{Action, Modifier};
use std::collections::BTreeMap;

impl Wirer<'_> {
    pub(super) fn commands(&mut self, raw: &BTreeMap<String, BTreeMap<i64, String>>, path: &Path) {
        for (register, values) in raw {
            let path = path.key(register);
            let Some(row) = self.row_key(register, &path) else { continue };
            self.writable(row, &path, At::Key);
            let mut actions = Vec::new();
            for (value, name) in values {
                let path = path.key(value);
                if !self.rows.map.row(row).admits(*value) {
                    let what = format!("{register} does not accept {value}");
                    self.problems.push(Problem::key(path.clone(), what));
                }
                actions.extend(self.word::<Action>(name, "action", &path).map(|it| (*value, it)));
            }
            let index = self.wiring.commands.len() as u16;
            self.react(row, Reaction::Command(index), &path, At::Key);
            self.wiring.commands.push(CommandRows { row, actions });
        }
    }

    pub(super) fn triggers(&mut self, raw: &BTreeMap<String, RawTriggers>, path: &Path) {
        for (register, raw) in raw {
            let path = path.key(register);
            let Some(row) = self.row_key(register, &path) else { continue };
            self.writable(row, &path, At::Key);
            let mut actions = Vec::new();
            for (bit, name) in &raw.bits {
                let path = path.key("bits").key(bit);
                self.bit(*bit, row, &path);
                actions.extend(self.word::<Action>(name, "action", &path).map(|it| (*bit, it)));
            }
            actions.sort_by_key(|(_, action)| *action);
            let mut modifiers = Vec::new();
            for (bit, name) in &raw.modifiers {
                let path = path.key("modifiers").key(bit);
                self.bit(*bit, row, &path);
                if raw.bits.contains_key(bit) {
                    let what = format!("bit {bit} already triggers an action");
                    self.problems.push(Problem::key(path.clone(), what));
                }
                let Some(modifier) = self.word::<Modifier>(name, "modifier", &path) else {
                    continue;
                };
                if !actions.iter().any(|(_, action)| *action == Action::MoveStart) {
                    let what =
                        format!("`{name}` has no effect without `move_start` among the bits");
                    self.problems.push(Problem::value(path, what).advise("remove it"));
                }
                modifiers.push((*bit, modifier));
            }
            let index = self.wiring.triggers.len() as u16;
            self.react(row, Reaction::Trigger(index), &path, At::Key);
            self.wiring.triggers.push(Triggers { row, actions, modifiers });
        }
    }
}
