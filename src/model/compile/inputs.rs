//! Signals into the drive, and rows that give it commands: terminals, words, bits, values.

use super::names::Names;
use super::terminals::{
    self, Codes, Layout, RawCodes, hold, monitor, not_simulated, place_of_bit, positions, split,
};
use super::uses::{Uses, has_bit, writable};
use crate::model::raw::{RawInputs, RawTriggers};
use crate::model::{
    BitOverride, CommandRows, InputWords, NotSimulated, Reaction, RowId, Shows, Terminals, Triggers,
};
use crate::problem::{At, Path, Problem};
use crate::vocabulary::{Action, Input, Modifier};

/// Rows whose bits are signals.
type BitRows = Vec<(RowId, Vec<(u8, Input)>)>;

pub(super) fn path() -> Path {
    Path::root().key("signals").key("inputs")
}

/// What function numbers of inputs stand for.
pub(super) fn codes(raw: &RawInputs, absent: &mut NotSimulated, names: &mut Names) -> Codes<Input> {
    let used = raw.terminals.is_some() || raw.words.is_some();
    let codes = RawCodes { codes: &raw.codes, terminals: raw.terminals.as_ref(), used };
    terminals::codes(&codes, &path(), signal, absent, names)
}

fn signal(names: &mut Names, name: &str, path: &Path) -> Option<Input> {
    names.word(name, "input signal", path)
}

/// Switches of the machine that reach the drive without a terminal.
pub(super) fn machine(raw: &RawInputs, names: &mut Names) -> Vec<Input> {
    let mut switches = Vec::new();
    for (i, name) in raw.machine.iter().enumerate() {
        let path = path().key("machine").index(i);
        if raw.machine[..i].contains(name) {
            names.report(Problem::value(path, format!("`{name}` is listed twice")));
            continue;
        }
        switches.extend(names.switch(name, &path));
    }
    switches
}

/// Input terminals, which master and bench make active.
pub(super) fn terminals(
    raw: &RawInputs,
    codes: &Codes<Input>,
    uses: &mut Uses,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Option<Terminals<Input>> {
    let (raw, path) = (raw.terminals.as_ref()?, path().key("terminals"));
    monitor(raw, Shows::InputTerminals, &path, uses, names);
    let signals = split(codes, &mut absent.input_codes);
    let terminals = terminals::compile(raw, signals, &path, names);
    for row in terminals.functions.iter().copied().chain(terminals.normally_closed) {
        uses.react(row, Reaction::Inputs, &path, At::Key, names);
    }
    Some(terminals)
}

/// Words that a master writes in place of terminals.
pub(super) fn words(
    raw: &RawInputs,
    codes: &Codes<Input>,
    uses: &mut Uses,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Option<InputWords> {
    let by_terminals = raw.terminals.is_some();
    let (raw, path) = (raw.words.as_ref()?, path().key("words"));
    let (rows, enabled_by) = terminals::words(&raw.registers, &raw.enabled_by, &path, names);
    for (i, row) in rows.iter().enumerate() {
        let path = path.key("registers").index(i);
        writable(*row, &path, At::Value, names);
        uses.react(*row, Reaction::InputWord(i as u16), &path, At::Value, names);
    }
    for (i, row) in enabled_by.iter().enumerate() {
        let path = path.key("enabled_by").index(i);
        uses.react(*row, Reaction::Inputs, &path, At::Value, names);
    }
    let layout = Layout { moved: &raw.positions, words: raw.registers.len(), by_terminals };
    let positions = positions(codes, &layout, &path, names);
    let positions = split(&positions, &mut absent.input_positions);
    let hold = raw.hold.as_ref().and_then(|raw| hold(raw, &path.key("hold"), names));
    Some(InputWords { rows, enabled_by, positions, hold })
}

/// Rows whose bits are signals.
pub(super) fn bits(
    raw: &RawInputs,
    uses: &mut Uses,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> BitRows {
    let mut rows = Vec::new();
    for (register, bits) in &raw.bits {
        let path = path().key("bits").key(register);
        let Some(row) = names.by_key(|names| names.row(register, &path)) else { continue };
        writable(row, &path, At::Key, names);
        let (mut signals, mut missing) = (Vec::new(), Vec::new());
        for (bit, name) in bits {
            let path = path.key(bit);
            has_bit(row, *bit, &path, names);
            let place = place_of_bit(row, *bit, names);
            match not_simulated(name, &place, &path, absent, names) {
                Some(index) => missing.push((*bit, index)),
                None => signals.extend(signal(names, name, &path).map(|it| (*bit, it))),
            }
        }
        uses.react(row, Reaction::Inputs, &path, At::Key, names);
        rows.push((row, signals));
        absent.input_bits.push((row, missing));
    }
    rows
}

/// Rows that show, bit by bit, what has come of `bits`.
pub(super) fn monitors(raw: &RawInputs, bits: &BitRows, uses: &mut Uses, names: &mut Names) {
    for (monitor, register) in &raw.monitors {
        let path = path().key("monitors").key(monitor);
        let Some(row) = names.by_key(|names| names.row(monitor, &path)) else { continue };
        let Some(of) = names.row(register, &path) else { continue };
        match bits.iter().position(|(row, _)| *row == of) {
            Some(index) => uses.show(row, Shows::InputBits(index), &path, At::Key, names),
            None => {
                let what = format!("{register} is not a row of `bits`");
                names.report(Problem::value(path, what));
            }
        }
    }
}

/// Settings that take the signals of bits away.
pub(super) fn overrides(raw: &RawInputs, uses: &mut Uses, names: &mut Names) -> Vec<BitOverride> {
    let mut overrides = Vec::new();
    for (register, bits) in &raw.bit_overrides {
        let path = path().key("bit_overrides").key(register);
        let Some(row) = names.by_key(|names| names.row(register, &path)) else { continue };
        for (bit, setting) in bits {
            let path = path.key(bit);
            if !raw.bits.get(register).is_some_and(|bits| bits.contains_key(bit)) {
                let what = format!("bit {bit} of {register} has no signal to override");
                names.report(Problem::key(path.clone(), what).advise("remove it"));
            }
            let Some(by) = names.digit(setting, &path) else { continue };
            uses.react(by.row, Reaction::Inputs, &path.key("register"), At::Value, names);
            overrides.push(BitOverride { row, bit: *bit, by });
        }
    }
    overrides
}

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
