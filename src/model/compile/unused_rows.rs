//! `sim: none` is a promise: a row says it if, and only if, nothing is wired to it.

use super::names::Names;
use crate::model::{Applies, LineRules, Reaction, Wiring};
use crate::problem::{Path, Problem};

/// One problem for each row (each path, where rows are folded) whose `sim` or `applies` says the wrong thing.
pub(super) fn check(line: &LineRules, wiring: &Wiring, names: &mut Names) {
    let rows = names.rows;
    let mut used = vec![false; rows.map.len()];
    for row in line.rows().chain(wiring.rows()) {
        used[usize::from(row.0)] = true;
    }
    let mut told: Vec<&Path> = Vec::new();
    for ((id, row), path) in rows.map.rows().zip(&rows.paths) {
        let used = used[usize::from(id.0)];
        let fits = match row.applies {
            None | Some(Applies::Now) => true,
            Some(Applies::AtStop) => wiring.counts_from_standstill(id),
            Some(Applies::PowerOn) => false,
        };
        let waits = !fits && wiring.reaction(id) != Reaction::Line;
        if used && waits && !told.contains(&path) {
            told.push(path);
            let what = format!("{} takes effect immediately, so `applies` must be `now`", row.id);
            names.report(Problem::key(path.key("applies"), what).advise("remove it"));
        }
        if used != row.inert || told.contains(&path) {
            continue;
        }
        told.push(path);
        names.report(match used {
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
