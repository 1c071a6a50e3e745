//! What inputs and outputs have alike: function numbers that stand for signals or for something that is not simulated,
//! terminals, and words of signals.

use super::names::Names;
use super::uses::{Uses, one_word};
use crate::model::raw::{RawHold, RawShows, RawTerminals};
use crate::model::{Digit, HoldTime, Monitor, NotSimulated, RowId, Shows, Terminals};
use crate::problem::{At, Path, Problem, is_unread};
use crate::units::Dimension;
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

/// Terminals at `path`, whose function numbers stand for `codes`.
pub(super) fn compile<S>(
    raw: &RawTerminals,
    codes: Vec<(u16, S)>,
    path: &Path,
    names: &mut Names,
) -> Terminals<S> {
    let functions = names.row_list(&raw.functions, &path.key("functions"));
    if functions.len() > 16 {
        let what = "a word has 16 bits, one per terminal";
        names.report(Problem::value(path.key("functions"), what));
    }
    let normally_closed = raw.normally_closed.as_ref();
    let normally_closed =
        normally_closed.and_then(|it| names.row(it, &path.key("normally_closed")));
    let (prefix, first) = (raw.prefix.clone(), raw.first);
    Terminals { prefix, first, functions, normally_closed, codes }
}

/// The row that monitors the terminals at `path`, where there is one.
pub(super) fn monitor(
    raw: &RawTerminals,
    shows: fn(Monitor) -> Shows,
    path: &Path,
    uses: &mut Uses,
    names: &mut Names,
) {
    let Some(monitor) = &raw.monitor else { return };
    let path = path.key("monitor").key("register");
    let Some(row) = names.row(&monitor.register, &path) else { return };
    let kind = match monitor.shows {
        RawShows::Signal => Monitor::Signal,
        RawShows::NoSignal => Monitor::NoSignal,
        RawShows::Active => Monitor::Active,
    };
    uses.show(row, shows(kind), &path, At::Value, names);
}

/// Words of signals with their enable words: the rows of both.
pub(super) fn words(
    registers: &[String],
    enabled_by: &[String],
    path: &Path,
    names: &mut Names,
) -> (Vec<RowId>, Vec<RowId>) {
    let of_registers = path.key("registers");
    if registers.is_empty() && !is_unread(names.problems, &of_registers) {
        let what = "words of signals need at least one register";
        names.report(Problem::value(of_registers.clone(), what));
    }
    let rows = names.row_list(registers, &of_registers);
    for (i, row) in rows.iter().enumerate() {
        one_word(*row, &path.key("registers").index(i), names);
    }
    let path = path.key("enabled_by");
    if !enabled_by.is_empty() && enabled_by.len() != registers.len() {
        let what = format!("{} enable words, but {} words", enabled_by.len(), registers.len());
        names.report(Problem::value(path.clone(), what).advise("give one per word, or none"));
    }
    (rows, names.row_list(enabled_by, &path))
}

/// How the bits of words of signals are taken.
pub(super) struct Layout<'a> {
    /// Function numbers that stand at another position than their own.
    pub moved: &'a BTreeMap<u16, u16>,
    /// How many words.
    pub words: usize,
    /// Can a terminal have what is out of reach of the words?
    pub by_terminals: bool,
}

/// Where each of `codes` stands in the words at `path`.
pub(super) fn positions<S: Copy>(
    codes: &[(u16, S)],
    layout: &Layout<'_>,
    path: &Path,
    names: &mut Names,
) -> Vec<(u16, S)> {
    let Layout { moved, words, by_terminals } = *layout;
    // Words without registers: that is reported where they are read.
    if words == 0 {
        return Vec::new();
    }
    for code in moved.keys().filter(|code| !codes.iter().any(|(it, _)| it == *code)) {
        let what = format!("function number {code} has no signal in `codes`");
        names.report(Problem::key(path.key("positions").key(code), what));
    }
    let mut positions: Vec<(u16, S)> = Vec::new();
    for (code, signal) in codes {
        let position = moved.get(code).copied().unwrap_or(*code);
        let is_beyond = usize::from(position) >= 16 * words;
        if by_terminals && !moved.contains_key(code) && is_beyond {
            continue;
        }
        let what = if is_beyond {
            format!("position {position} is beyond the last word, which ends at {}", 16 * words - 1)
        } else if positions.iter().any(|(taken, _)| *taken == position) {
            format!("position {position} already has another signal")
        } else {
            positions.push((position, *signal));
            continue;
        };
        names.report(match moved.contains_key(code) {
            true => Problem::value(path.key("positions").key(code), what),
            false => {
                let path = path.parent().unwrap_or_default().key("codes").key(code);
                Problem::key(path, what).advise("give it a bit of its own in `words.positions`")
            }
        });
    }
    positions
}

/// The time at `path` in which a master must do something again.
pub(super) fn hold(raw: &RawHold, path: &Path, names: &mut Names) -> Option<HoldTime> {
    let row = names.row(&raw.register, &path.key("register"))?;
    let unit = names.get(row).unit;
    if unit.dimension != Dimension::Time {
        let what = format!("{} must be a time", raw.register);
        let problem = Problem::value(path.key("register"), what);
        names.report(problem.advise("give the row `unit: s` or `unit: ms`"));
    }
    let zero = names.duration(raw.zero.as_deref(), &path.key("zero"));
    Some(HoldTime { row, unit, zero })
}
