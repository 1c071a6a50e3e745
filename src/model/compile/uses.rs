//! What each row is used for. A row shows one thing and sets off one thing; the second that asks for it is a problem.

use super::names::Names;
use crate::model::{Access, Reaction, RowId, Shows};
use crate::problem::{At, Path, Problem};

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
