//! Terminals and words of signals, which inputs and outputs have alike.

use super::names::Names;
use super::uses::{Uses, one_word};
use crate::model::raw::{RawHold, RawShows, RawTerminals};
use crate::model::{HoldTime, Monitor, RowId, Shows, Terminals};
use crate::problem::{At, Path, Problem};
use crate::units::Dimension;
use std::collections::BTreeMap;

/// Terminals at `path`, whose function numbers stand for `codes`.
pub(super) fn terminals<S>(
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
    let rows = names.row_list(registers, &path.key("registers"));
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
