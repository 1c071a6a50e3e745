//! Signals out of the drive: terminals, words and bits that show them.

use super::names::Names;
use super::terminals::{self, Codes, Layout, RawCodes, monitor, positions, split};
use super::uses::{Uses, has_bit, writable};
use super::wired::Wired;
use crate::model::raw::RawOutputs;
use crate::model::{NotSimulated, OutputWord, RowId, Shown, Shows, Terminals};
use crate::problem::{At, Path, Problem};
use crate::vocabulary::{Named, Output};

pub(super) fn path() -> Path {
    Path::root().key("signals").key("outputs")
}

/// What function numbers of outputs stand for.
pub(super) fn codes(
    raw: &RawOutputs,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Codes<Shown> {
    let used = raw.terminals.is_some() || raw.words.is_some();
    let codes = RawCodes { codes: &raw.codes, terminals: raw.terminals.as_ref(), used };
    terminals::codes(&codes, &path(), shown, absent, names)
}

/// A signal, or `not` and a signal.
fn shown(names: &mut Names, text: &str, path: &Path) -> Option<Shown> {
    let (name, inverted) = match text.strip_prefix("not ") {
        Some(name) => (name.trim_start(), true),
        None => (text, false),
    };
    let signal = names.word::<Output>(name, "output signal", path)?;
    Some(Shown { signal, inverted })
}

/// Output terminals.
pub(super) fn terminals(
    raw: &RawOutputs,
    codes: &Codes<Shown>,
    uses: &mut Uses,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Option<Terminals<Shown>> {
    let (raw, path) = (raw.terminals.as_ref()?, path().key("terminals"));
    monitor(raw, Shows::OutputTerminals, &path, uses, names);
    let signals = split(codes, &mut absent.output_codes);
    Some(terminals::compile(raw, signals, &path, names))
}

/// Words that a master reads in place of terminals.
pub(super) fn words(
    raw: &RawOutputs,
    codes: &Codes<Shown>,
    uses: &mut Uses,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Vec<OutputWord> {
    let by_terminals = raw.terminals.is_some();
    let Some(raw) = raw.words.as_ref() else { return Vec::new() };
    let path = path().key("words");
    let (rows, enabled_by) = terminals::words(&raw.registers, &raw.enabled_by, &path, names);
    for (i, row) in rows.iter().enumerate() {
        let path = path.key("registers").index(i);
        uses.show(*row, Shows::OutputWord(i as u16), &path, At::Value, names);
    }
    let layout = Layout { moved: &raw.positions, words: raw.registers.len(), by_terminals };
    let positions = positions(codes, &layout, &path, names);
    let positions = split(&positions, &mut absent.output_positions);
    let word = |(i, row): (usize, &RowId)| {
        let of_word = positions.iter().filter(|(position, _)| usize::from(position / 16) == i);
        let bits = of_word.map(|(position, shown)| ((position % 16) as u8, *shown)).collect();
        OutputWord { row: *row, enabled_by: enabled_by.get(i).copied(), bits }
    };
    rows.iter().enumerate().map(word).collect()
}

/// Rows whose bits show signals.
pub(super) fn bits(raw: &RawOutputs, uses: &mut Uses, names: &mut Names) {
    for (register, bits) in &raw.bits {
        let path = path().key("bits").key(register);
        let Some(row) = names.by_key(|names| names.row(register, &path)) else { continue };
        let mut signals = Vec::new();
        for (bit, name) in bits {
            let path = path.key(bit);
            has_bit(row, *bit, &path, names);
            signals.extend(shown(names, name, &path).map(|it| (*bit, it)));
        }
        uses.show(row, Shows::Bits(signals), &path, At::Key, names);
    }
}

/// The row whose bits a master sets to show them as outputs.
pub(super) fn user(raw: &RawOutputs, wired: &Wired, names: &mut Names) -> Option<RowId> {
    let signals = [Output::User0, Output::User1, Output::User2];
    let shown = signals.into_iter().find(|it| wired.shows(*it)).map(Named::name);
    let (register, at) = (raw.user.as_deref(), path().key("user"));
    match (register, shown) {
        (Some(_), None) => {
            let what = "`user` has no effect: none of `user_0`, `user_1`, `user_2` is shown";
            names.report(Problem::key(at.clone(), what).advise("show one"));
        }
        (None, Some(name)) => {
            let what = format!("`{name}` is shown, but no row holds it");
            names.report(Problem::key(path(), what).advise("add `user: ROW` to `outputs`"));
        }
        _ => {}
    }
    let row = names.row(register?, &at)?;
    writable(row, &at, At::Value, names);
    Some(row)
}
