//! Rows that set something off: values that are commands, and bits that are triggers.

use super::inputs::path;
use super::names::Names;
use super::uses::{Uses, has_bit, writable};
use crate::model::raw::{RawInputs, RawTriggers};
use crate::model::{CommandRows, Reaction, RowId, Triggers};
use crate::problem::{At, Path, Problem};
use crate::vocabulary::{Action, Modifier};

/// Rows in which a written value triggers an action.
pub(super) fn commands(raw: &RawInputs, uses: &mut Uses, names: &mut Names) -> Vec<CommandRows> {
    let mut commands = Vec::new();
    for (register, values) in &raw.commands {
        let path = path().key("commands").key(register);
        let Some(row) = names.by_key(|names| names.row(register, &path)) else { continue };
        writable(row, &path, At::Key, names);
        let mut actions = Vec::new();
        for (value, name) in values {
            let path = path.key(value);
            if !names.get(row).admits(*value) {
                let what = format!("{register} does not accept {value}");
                names.report(Problem::key(path.clone(), what));
            }
            actions.extend(names.word::<Action>(name, "action", &path).map(|it| (*value, it)));
        }
        uses.react(row, Reaction::Command(commands.len() as u16), &path, At::Key, names);
        commands.push(CommandRows { row, actions });
    }
    commands
}

/// Rows whose bits trigger actions.
pub(super) fn triggers(raw: &RawInputs, uses: &mut Uses, names: &mut Names) -> Vec<Triggers> {
    let mut triggers = Vec::new();
    for (register, raw) in &raw.triggers {
        let path = path().key("triggers").key(register);
        let Some(row) = names.by_key(|names| names.row(register, &path)) else { continue };
        writable(row, &path, At::Key, names);
        let mut actions = Vec::new();
        for (bit, name) in &raw.bits {
            let path = path.key("bits").key(bit);
            has_bit(row, *bit, &path, names);
            actions.extend(names.word::<Action>(name, "action", &path).map(|it| (*bit, it)));
        }
        actions.sort_by_key(|(_, action)| *action);
        let modifiers = modifiers(raw, row, &actions, &path, names);
        uses.react(row, Reaction::Trigger(triggers.len() as u16), &path, At::Key, names);
        triggers.push(Triggers { row, actions, modifiers });
    }
    triggers
}

/// Bits that say more about an action of the same row.
fn modifiers(
    raw: &RawTriggers,
    row: RowId,
    actions: &[(u8, Action)],
    path: &Path,
    names: &mut Names,
) -> Vec<(u8, Modifier)> {
    let mut modifiers = Vec::new();
    for (bit, name) in &raw.modifiers {
        let path = path.key("modifiers").key(bit);
        has_bit(row, *bit, &path, names);
        if raw.bits.contains_key(bit) {
            let what = format!("bit {bit} already triggers an action");
            names.report(Problem::key(path.clone(), what));
        }
        let Some(modifier) = names.word::<Modifier>(name, "modifier", &path) else { continue };
        if !actions.iter().any(|(_, action)| *action == Action::MoveStart) {
            let what = format!("`{name}` has no effect without `move_start` among the bits");
            names.report(Problem::value(path, what).advise("remove it"));
        }
        modifiers.push((*bit, modifier));
    }
    modifiers
}
