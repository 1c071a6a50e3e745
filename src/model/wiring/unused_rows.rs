//! `sim: none` is a promise: a row says it if, and only if, nothing is wired to it.

use super::{Choice, Counts, HomingRules, InterruptWiring, Number, Reaction, Wiring};
use crate::model::line::{LineRules, WordOrder};
use crate::model::rows::Compiled;
use crate::model::{Applies, RowId};
use crate::problem::{Path, Problem};

/// One problem for each row (each path, where rows are folded) whose `sim` says the wrong thing.
pub(in crate::model) fn check_inert(
    rows: &Compiled,
    line: &LineRules,
    wiring: &Wiring,
    problems: &mut Vec<Problem>,
) {
    let used = used(rows.map.len(), line, wiring);
    let mut told: Vec<&Path> = Vec::new();
    for ((id, row), path) in rows.map.rows().zip(&rows.paths) {
        let wired = used[usize::from(id.0)];
        let fits = match row.applies {
            None | Some(Applies::Now) => true,
            Some(Applies::AtStop) => takes_standstill(wiring).any(|it| it == id),
            Some(Applies::PowerOn) => false,
        };
        let waits = !fits && wiring.reaction(id) != Reaction::Line;
        if wired && waits && !told.contains(&path) {
            told.push(path);
            let what = format!("{} takes effect immediately, so `applies` must be `now`", row.id);
            problems.push(Problem::key(path.key("applies"), what).advise("remove it"));
        }
        if wired != row.inert || told.contains(&path) {
            continue;
        }
        told.push(path);
        problems.push(match wired {
            true => {
                let what = format!("{} is wired, so `sim: none` is wrong", row.id);
                Problem::key(path.key("sim"), what).advise("remove it")
            }
            false => {
                let what = format!("{} is not wired", row.id);
                Problem::key(path.clone(), what).advise("add `sim: none`")
            }
        });
    }
}

/// Rows whose values can count from a standstill on: an axis turns round there and takes settings, and a
/// homing starts.
fn takes_standstill(wiring: &Wiring) -> impl Iterator<Item = RowId> {
    let counts = match wiring.axis.counts_per_rev {
        Counts::Row(row) => Some(row),
        Counts::Fixed(_) => None,
    };
    let settings = wiring.axis.all_settings().map(|it| it.row);
    let homing = wiring.homing.iter().flat_map(HomingRules::rows);
    settings.chain(homing).chain(wiring.axis.reversed).chain(counts)
}

fn used(len: usize, line: &LineRules, wiring: &Wiring) -> Vec<bool> {
    let mut used = vec![false; len];
    let mut mark = |row: RowId| used[usize::from(row.0)] = true;
    mark(line.unit.row);
    if line.baud_switches == 0 {
        [line.baud.row, line.format.row].into_iter().for_each(&mut mark);
    }
    if let WordOrder::Row { row, .. } = line.word_order {
        mark(row);
    }
    for counts in [Some(wiring.axis.counts_per_rev), wiring.axis.encoder].into_iter().flatten() {
        if let Counts::Row(row) = counts {
            mark(row);
        }
    }
    wiring.axis.reversed.into_iter().for_each(&mut mark);
    wiring.axis.gear.iter().flat_map(|it| [it.numerator, it.denominator]).for_each(&mut mark);
    wiring.axis.speed_unit.iter().for_each(|it| mark(it.row));
    wiring.axis.settings.iter().for_each(|it| mark(it.row));
    wiring.homing.iter().flat_map(HomingRules::rows).for_each(&mut mark);
    wiring.limits.rows().for_each(&mut mark);
    wiring.axis.segments.rows().for_each(&mut mark);
    wiring.axis.inhibit.iter().filter_map(Choice::row).for_each(&mut mark);
    wiring.axis.interrupt.iter().flat_map(InterruptWiring::rows).for_each(&mut mark);
    wiring.user_outputs.iter().copied().for_each(&mut mark);
    for (_, number) in &wiring.thresholds {
        if let Number::Row(row) = number {
            mark(*row);
        }
    }
    for (i, shows) in wiring.shows.iter().enumerate() {
        if shows.is_some() || wiring.reactions[i] != Reaction::None {
            mark(RowId(i as u16));
        }
    }
    if let Some(words) = &wiring.input_words {
        words.hold.iter().for_each(|hold| mark(hold.row));
    }
    if let Some(words) = &wiring.output_words {
        words.enabled_by.iter().copied().for_each(&mut mark);
    }
    if let Some(terminals) = &wiring.output_terminals {
        terminals.functions.iter().copied().chain(terminals.normally_closed).for_each(&mut mark);
    }
    used
}
