//! What each row is used for. A row shows one thing and sets off one thing; the second that asks for it is a problem,
//! and so is a row that nothing uses and that does not say so.

use super::names::Names;
use crate::model::{Access, Applies, LineRules, Reaction, RowId, Shows, Wiring};
use crate::problem::{At, Path, Problem};
use crate::vocabulary::{Named, Quantity};

/// What rows show, and what writes to them set off, by row.
pub(super) struct Uses {
    pub shows: Vec<Option<Shows>>,
    pub reactions: Vec<Reaction>,
}

impl Uses {
    /// No row of `len` is used for anything yet.
    pub fn new(len: usize) -> Self {
        Self { shows: vec![None; len], reactions: vec![Reaction::None; len] }
    }

    /// `row` shows this.
    pub fn show(&mut self, row: RowId, shows: Shows, path: &Path, at: At, names: &mut Names) {
        let shown = names.get(row);
        if shown.access != Access::Read {
            let what = format!("{} shows a computed value and cannot be written", shown.id);
            let problem = Problem { at, ..Problem::value(path.clone(), what) };
            names.report(problem.advise("give it `access: r`"));
        }
        let slot = &mut self.shows[usize::from(row.0)];
        if slot.is_some() {
            let what = format!("{} already shows another value", shown.id);
            names.report(Problem { at, ..Problem::value(path.clone(), what) });
            return;
        }
        *slot = Some(shows);
    }

    /// The first row that shows each quantity, by its place in the catalogue.
    pub fn quantity_rows(&self) -> Vec<Option<RowId>> {
        let row = |quantity: &Quantity| {
            let shows = Some(Shows::Quantity(*quantity));
            self.shows.iter().position(|it| *it == shows).map(|i| RowId(i as u16))
        };
        Quantity::ALL.iter().map(row).collect()
    }

    /// A write to `row` sets this off.
    pub fn react(
        &mut self,
        row: RowId,
        reaction: Reaction,
        path: &Path,
        at: At,
        names: &mut Names,
    ) {
        let slot = &mut self.reactions[usize::from(row.0)];
        if *slot != Reaction::None && *slot != reaction {
            let what = format!("{} is already wired to something else", names.get(row).id);
            names.report(Problem { at, ..Problem::value(path.clone(), what) });
            return;
        }
        *slot = reaction;
    }
}

/// A master can write `row`.
pub(super) fn writable(row: RowId, path: &Path, at: At, names: &mut Names) {
    let row = names.get(row);
    if row.access == Access::Read {
        let what = format!("{} is read-only, so no master can write it", row.id);
        let problem = Problem { at, ..Problem::value(path.clone(), what) };
        names.report(problem.advise("give it `access: rw`"));
    }
}

/// `row` has one word.
pub(super) fn one_word(row: RowId, path: &Path, names: &mut Names) {
    let row = names.get(row);
    if row.kind.words() != 1 {
        let what = format!("{} is a 32-bit row, but a 16-bit row is needed", row.id);
        names.report(Problem::value(path.clone(), what).advise("give it `type: u16`"));
    }
}

/// `row` has the bit named by the key that ends `path`.
pub(super) fn has_bit(row: RowId, bit: u8, path: &Path, names: &mut Names) {
    let row = names.get(row);
    if u16::from(bit) >= 16 * row.kind.words() {
        let what = format!("{} has no bit {bit}", row.id);
        names.report(Problem::key(path.clone(), what));
    }
}

/// `sim: none` is a promise: a row says it if, and only if, nothing is wired to it. One problem for each row (each path, where rows are folded) whose `sim` or `applies` says the wrong thing.
pub(super) fn check_unused(line: &LineRules, wiring: &Wiring, names: &mut Names) {
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
