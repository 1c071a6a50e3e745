//! Names resolved, and the rules for what a row may be wired to.

use super::compile::Wirer;
use super::not_simulated::Function;
use super::{Reaction, Shown, Shows};
use crate::model::{Access, RowId, duration};
use crate::problem::{At, Path, Problem, suggest};
use crate::time::Duration;
use crate::vocabulary::{Named, Output};
use std::collections::BTreeMap;

/// Words and rows by name.
impl Wirer<'_> {
    pub(super) fn word<W: Named>(&mut self, name: &str, kind: &str, path: &Path) -> Option<W> {
        let found = W::parse(name);
        if found.is_none() {
            let all = W::ALL.iter().map(|word| word.name());
            let advice = suggest::did_you_mean(name, all.clone())
                .unwrap_or_else(|| format!("known: {}", all.collect::<Vec<_>>().join(", ")));
            let what = format!("unknown {kind} `{name}`");
            self.problems.push(Problem::value(path.clone(), what).advise(advice));
        }
        found
    }

    /// The word named by the key that ends `path`.
    pub(super) fn word_key<W: Named>(&mut self, name: &str, kind: &str, path: &Path) -> Option<W> {
        let before = self.problems.len();
        let word = self.word(name, kind, path);
        self.problems[before..].iter_mut().for_each(|problem| problem.at = At::Key);
        word
    }

    pub(super) fn shown(&mut self, text: &str, path: &Path) -> Option<Shown> {
        let (name, inverted) = match text.strip_prefix("not ") {
            Some(name) => (name.trim_start(), true),
            None => (text, false),
        };
        let signal = self.word::<Output>(name, "output signal", path)?;
        Some(Shown { signal, inverted })
    }

    /// What function numbers stand for; `prefix` is what the log writes before those that are not simulated.
    pub(super) fn codes<S>(
        &mut self,
        raw: &BTreeMap<u16, String>,
        prefix: &str,
        path: &Path,
        parse: fn(&mut Self, &str, &Path) -> Option<S>,
    ) -> Vec<(u16, Function<S>)> {
        let entry = |(code, name): (&u16, &String)| {
            let path = path.key(code);
            let function = match self.not_simulated(name, &format!("{prefix} {code}"), &path) {
                Some(index) => Function::NotSimulated(index),
                None => Function::Signal(parse(self, name, &path)?),
            };
            Some((*code, function))
        };
        raw.iter().filter_map(entry).collect()
    }

    pub(super) fn codes_used(&mut self, codes: &BTreeMap<u16, String>, used: bool, path: &Path) {
        if !used && !codes.is_empty() {
            let what = "`codes` has no effect without `terminals` or `words`";
            self.problems.push(Problem::key(path.key("codes"), what).advise("remove it"));
        }
    }

    pub(super) fn row(&mut self, id: &str, path: &Path) -> Option<RowId> {
        self.rows.find(id, path, self.problems)
    }

    /// The row named by the key that ends `path`.
    pub(super) fn row_key(&mut self, id: &str, path: &Path) -> Option<RowId> {
        let before = self.problems.len();
        let row = self.rows.find(id, path, self.problems);
        self.problems[before..].iter_mut().for_each(|problem| problem.at = At::Key);
        row
    }

    pub(super) fn row_list(&mut self, ids: &[String], path: &Path) -> Vec<RowId> {
        let row = |(i, id): (usize, &String)| self.row(id, &path.index(i));
        ids.iter().enumerate().filter_map(row).collect()
    }

    pub(super) fn enable_words(&mut self, ids: &[String], words: usize, path: &Path) -> Vec<RowId> {
        let path = path.key("enabled_by");
        if !ids.is_empty() && ids.len() != words {
            let what = format!("{} enable words, but {words} words", ids.len());
            self.problems
                .push(Problem::value(path.clone(), what).advise("give one per word, or none"));
        }
        self.row_list(ids, &path)
    }

    pub(super) fn positions<S: Copy>(
        &mut self,
        codes: &[(u16, S)],
        moved: &BTreeMap<u16, u16>,
        words: usize,
        by_terminals: bool,
        path: &Path,
    ) -> Vec<(u16, S)> {
        for code in moved.keys().filter(|code| !codes.iter().any(|(it, _)| it == *code)) {
            let what = format!("function number {code} has no signal in `codes`");
            self.problems.push(Problem::key(path.key("positions").key(code), what));
        }
        let mut positions: Vec<(u16, S)> = Vec::new();
        for (code, signal) in codes {
            let position = moved.get(code).copied().unwrap_or(*code);
            if by_terminals && !moved.contains_key(code) && usize::from(position) >= 16 * words {
                // Out of reach of the words, but a terminal can have it.
                continue;
            }
            let what = if usize::from(position) >= 16 * words {
                format!(
                    "position {position} is beyond the last word, which ends at {}",
                    16 * words - 1
                )
            } else if positions.iter().any(|(taken, _)| *taken == position) {
                format!("position {position} already has another signal")
            } else {
                positions.push((position, *signal));
                continue;
            };
            let problem = match moved.contains_key(code) {
                true => Problem::value(path.key("positions").key(code), what),
                false => {
                    let path = path.parent().unwrap_or_default().key("codes").key(code);
                    Problem::key(path, what).advise("give it a bit of its own in `words.positions`")
                }
            };
            self.problems.push(problem);
        }
        positions
    }
}

/// What a row is used for.
impl Wirer<'_> {
    pub(super) fn show(&mut self, row: RowId, shows: Shows, path: &Path, at: At) {
        let shown = self.rows.map.row(row);
        if shown.access != Access::Read {
            let what = format!("{} shows a computed value and cannot be written", shown.id);
            let problem = Problem { at, ..Problem::value(path.clone(), what) };
            self.problems.push(problem.advise("give it `access: r`"));
        }
        let slot = &mut self.wiring.shows[usize::from(row.0)];
        if slot.is_some() {
            let what = format!("{} already shows another value", shown.id);
            self.problems.push(Problem { at, ..Problem::value(path.clone(), what) });
            return;
        }
        *slot = Some(shows);
    }

    pub(super) fn react(&mut self, row: RowId, reaction: Reaction, path: &Path, at: At) {
        let slot = &mut self.wiring.reactions[usize::from(row.0)];
        if *slot != Reaction::None && *slot != reaction {
            let what = format!("{} is already wired to something else", self.rows.map.row(row).id);
            self.problems.push(Problem { at, ..Problem::value(path.clone(), what) });
            return;
        }
        *slot = reaction;
    }

    pub(super) fn writable(&mut self, row: RowId, path: &Path, at: At) {
        let row = self.rows.map.row(row);
        if row.access == Access::Read {
            let what = format!("{} is read-only, so no master can write it", row.id);
            let problem = Problem { at, ..Problem::value(path.clone(), what) };
            self.problems.push(problem.advise("give it `access: rw`"));
        }
    }

    pub(super) fn one_word(&mut self, row: RowId, path: &Path) {
        let row = self.rows.map.row(row);
        if row.kind.words() != 1 {
            let what = format!("{} is a 32-bit row, but a 16-bit row is needed", row.id);
            self.problems.push(Problem::value(path.clone(), what).advise("give it `type: u16`"));
        }
    }

    pub(super) fn bit(&mut self, bit: u8, row: RowId, path: &Path) {
        let row = self.rows.map.row(row);
        if u16::from(bit) >= 16 * row.kind.words() {
            let what = format!("{} has no bit {bit}", row.id);
            self.problems.push(Problem::key(path.clone(), what));
        }
    }

    pub(super) fn duration(&mut self, text: Option<&str>, path: &Path) -> Option<Duration> {
        duration(text?, path, self.problems)
    }
}
