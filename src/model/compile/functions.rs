//! Functions that the manual numbers or names: each stands for a signal, or for something that is not simulated.

use super::names::Names;
use crate::model::raw::RawTerminals;
use crate::model::{Digit, NotSimulated, RowId};
use crate::problem::{Path, Problem};
use std::collections::BTreeMap;

/// What stands before the name of a function that is not simulated.
const MARK: &str = "not_simulated ";

/// Most functions that are not simulated: one set of them has room for so many.
const MOST: usize = 64;

/// What a function number or a bit stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function<S> {
    /// This signal.
    Signal(S),
    /// A function that is not simulated, by its index in [`NotSimulated::labels`].
    NotSimulated(u8),
}

/// What each function number stands for.
pub(super) type Codes<S> = Vec<(u16, Function<S>)>;

/// Where `codes` of one direction stand, and whether anything there uses them.
pub(super) struct RawCodes<'a> {
    pub codes: &'a BTreeMap<u16, String>,
    pub terminals: Option<&'a RawTerminals>,
    pub used: bool,
}

/// The functions of `raw` at `path`; `read` takes the name of a signal.
pub(super) fn codes<S>(
    raw: &RawCodes<'_>,
    path: &Path,
    read: fn(&mut Names, &str, &Path) -> Option<S>,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Codes<S> {
    let path = path.key("codes");
    // What the log writes before a function number.
    let prefix = raw.terminals.map_or("function", |it| it.prefix.as_str());
    let mut codes = Vec::new();
    for (code, name) in raw.codes {
        let path = path.key(code);
        let function = match not_simulated(name, &format!("{prefix} {code}"), &path, absent, names)
        {
            Some(index) => Some(Function::NotSimulated(index)),
            None => read(names, name, &path).map(Function::Signal),
        };
        codes.extend(function.map(|it| (*code, it)));
    }
    if !raw.used && !raw.codes.is_empty() {
        let what = "`codes` has no effect without `terminals` or `words`";
        names.report(Problem::key(path, what).advise("remove it"));
    }
    codes
}

/// The function that `text` names as one that is not simulated; `place` is what stands before its name in the log.
pub(super) fn not_simulated(
    text: &str,
    place: &str,
    path: &Path,
    absent: &mut NotSimulated,
    names: &mut Names,
) -> Option<u8> {
    let name = text.strip_prefix(MARK)?.trim();
    Some(label(format!("{place} {name}"), path, absent, names))
}

/// The signals among `functions`, and those that are not simulated, which go to `absent`.
pub(super) fn split<S: Copy>(
    functions: &[(u16, Function<S>)],
    absent: &mut Vec<(u16, u8)>,
) -> Vec<(u16, S)> {
    let mut signals = Vec::new();
    for (key, function) in functions {
        match function {
            Function::Signal(signal) => signals.push((*key, *signal)),
            Function::NotSimulated(index) => absent.push((*key, *index)),
        }
    }
    signals
}

/// Digits of rows that ask for something that is not simulated.
pub(super) fn digits(absent: &mut NotSimulated, names: &mut Names) {
    let rows = names.rows;
    for ((id, row), path) in rows.map.rows().zip(&rows.paths) {
        for (digit, what) in &row.not_simulated {
            let path = path.key("not_simulated").key(digit);
            let index = label(format!("{}, {what}", row.id), &path, absent, names);
            absent.digits.push((Digit { row: id, digit: Some(*digit) }, index));
        }
    }
}

/// What the log calls a bit of a row.
pub(super) fn place_of_bit(row: RowId, bit: u8, names: &Names) -> String {
    format!("0x{:04X}", names.get(row).at) + &format!(" bit {bit}")
}

fn label(label: String, path: &Path, absent: &mut NotSimulated, names: &mut Names) -> u8 {
    if absent.labels.len() == MOST {
        let what = format!("more than {MOST} functions that are not simulated");
        names.report(Problem::key(path.clone(), what));
        return 0;
    }
    absent.labels.push(label);
    (absent.labels.len() - 1) as u8
}
