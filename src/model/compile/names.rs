//! Names of the file looked up: rows, words and codes. What a name does not stand for is reported, with the nearest one.

use super::rows::Rows;
use crate::model::raw::{RawChoice, RawChosen, RawDigit};
use crate::model::wiring::code_in;
use crate::model::{Choice, Coded, Digit, Row, RowId};
use crate::problem::{At, Path, Problem, has_unread, suggest};
use crate::time::{Duration, parse_duration};
use crate::vocabulary::{Input, Named};
use std::collections::BTreeMap;

/// Signals that a machine moves, and that a homing step can wait for.
const SWITCHES: [Input; 3] = [Input::HomeSwitch, Input::LimitPos, Input::LimitNeg];

/// What every pass looks names up in, and where it reports.
pub(super) struct Names<'a> {
    /// The rows of the model.
    pub rows: &'a Rows,
    /// Everything that is wrong with the file.
    pub problems: &'a mut Vec<Problem>,
}

impl<'a> Names<'a> {
    /// Reports `problem`.
    pub fn report(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Reports `key` at `path`, which has no effect.
    pub fn without_effect(&mut self, key: &str, why: &str, path: &Path) {
        let what = format!("`{key}` has no effect: {why}");
        self.report(Problem::key(path.key(key), what).advise("remove it"));
    }

    /// What `look_up` finds by the key that ends its path: its problems are problems of that key.
    pub fn by_key<T>(&mut self, look_up: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.problems.len();
        let found = look_up(self);
        self.problems[before..].iter_mut().for_each(|problem| problem.at = At::Key);
        found
    }

    /// The row called `id`.
    pub fn row(&mut self, id: &str, path: &Path) -> Option<RowId> {
        self.rows.find(id, path, self.problems)
    }

    /// The rows called `ids`, without those that are not there.
    pub fn row_list(&mut self, ids: &[String], path: &Path) -> Vec<RowId> {
        let row = |(i, id): (usize, &String)| self.row(id, &path.index(i));
        ids.iter().enumerate().filter_map(row).collect()
    }

    /// What the manual says about `row`.
    pub fn get(&self, row: RowId) -> &'a Row {
        self.rows.map.row(row)
    }

    /// The word of a vocabulary called `name`.
    pub fn word<W: Named>(&mut self, name: &str, kind: &str, path: &Path) -> Option<W> {
        let all = || W::ALL.iter().map(|word| word.name());
        self.known(W::parse(name), name, kind, all, path)
    }

    /// The signal of a switch called `name`.
    pub fn switch(&mut self, name: &str, path: &Path) -> Option<Input> {
        let found = SWITCHES.into_iter().find(|it| it.name() == name);
        self.known(found, name, "switch", || SWITCHES.iter().map(|it| it.name()), path)
    }

    /// `found`, or a problem with the names that there are.
    fn known<'n, T, N: Iterator<Item = &'n str>>(
        &mut self,
        found: Option<T>,
        name: &str,
        kind: &str,
        all: impl Fn() -> N,
        path: &Path,
    ) -> Option<T> {
        if found.is_none() {
            let what = format!("unknown {kind} `{name}`");
            self.report(Problem::value(path.clone(), what).advise(nearest_or_all(name, all)));
        }
        found
    }

    /// The time that `text` says, if there is one.
    pub fn duration(&mut self, text: Option<&str>, path: &Path) -> Option<Duration> {
        duration(text?, path, self.problems)
    }

    /// Always the same, or as a row says; `read` takes what stands there or behind each code.
    pub fn choice<R, T: Copy>(
        &mut self,
        raw: &RawChoice<R>,
        path: &Path,
        read: impl Fn(&mut Self, &R, &Path) -> Option<T>,
    ) -> Option<Choice<T>> {
        Some(match raw {
            RawChoice::Fixed(it) => Choice::Fixed(read(self, it, path)?),
            RawChoice::Row(it) => Choice::Row(self.coded(it, path, read)?),
        })
    }

    /// A choice of words out of one vocabulary, if there is one.
    pub fn word_choice<W: Named>(
        &mut self,
        raw: Option<&RawChoice<String>>,
        kind: &str,
        path: &Path,
    ) -> Option<Choice<W>> {
        self.choice(raw?, path, |names, name: &String, path| names.word(name, kind, path))
    }

    /// What the values of a row stand for; `read` takes what stands behind each code.
    pub fn coded<R, T: Copy>(
        &mut self,
        raw: &RawChosen<R>,
        path: &Path,
        read: impl Fn(&mut Self, &R, &Path) -> Option<T>,
    ) -> Option<Coded<T>> {
        let row = self.row(&raw.register, &path.key("register"));
        code_rules(row, raw.digit, &raw.codes, path, self);
        let mut codes = BTreeMap::new();
        for (code, it) in &raw.codes {
            let meaning = read(self, it, &path.key("codes").key(code));
            codes.extend(meaning.map(|meaning| (*code, meaning)));
        }
        Some(Coded { row: row?, digit: raw.digit, codes })
    }

    /// A row, or a digit of it.
    pub fn digit(&mut self, raw: &RawDigit, path: &Path) -> Option<Digit> {
        has_digit(raw.digit, path, self);
        let row = self.row(&raw.register, &path.key("register"))?;
        Some(Digit { row, digit: raw.digit })
    }
}

/// The name that `name` is nearest to, or all that there are, as advice.
pub(super) fn nearest_or_all<'n, N: Iterator<Item = &'n str>>(
    name: &str,
    all: impl Fn() -> N,
) -> String {
    suggest::did_you_mean(name, all())
        .unwrap_or_else(|| format!("known: {}", all().collect::<Vec<_>>().join(", ")))
}

/// Reads `500ms` at `path`.
pub fn duration(text: &str, path: &Path, problems: &mut Vec<Problem>) -> Option<Duration> {
    let duration = parse_duration(text);
    if duration.is_none() {
        let what = format!("`{text}` is not a duration");
        let advice = "write a number with us, ms, s or min: 500ms";
        problems.push(Problem::value(path.clone(), what).advise(advice));
    }
    duration
}

/// Is there such a hex digit in a word?
fn has_digit(digit: Option<u8>, path: &Path, names: &mut Names) -> bool {
    let is_there = digit.is_none_or(|digit| digit <= 3);
    if !is_there {
        let what = "a word has hex digits 0 to 3, counted from the right";
        names.report(Problem::value(path.key("digit"), what));
    }
    is_there
}

/// Each code has a value of the row, or of one hex digit of it, and the factory value a code.
pub(super) fn code_rules<T>(
    row: Option<RowId>,
    digit: Option<u8>,
    codes: &BTreeMap<i64, T>,
    path: &Path,
    names: &mut Names,
) {
    if !has_digit(digit, path, names) {
        return;
    }
    let Some(row) = row.map(|row| names.get(row)) else { return };
    let holds = |code: i64| match digit {
        None => row.admits(code),
        Some(_) => {
            let words = |(low, high): &(i64, i64)| (*low.max(&0))..=(*high.min(&0xFFFF));
            row.spans.iter().flat_map(words).any(|value| code_in(value, digit) == code)
        }
    };
    for code in codes.keys().filter(|code| !holds(**code)) {
        let what = format!("{} is never {code}", row.id);
        names.report(Problem::key(path.key("codes").key(code), what));
    }
    let factory = row.kind.value(row.init);
    let init = code_in(factory, digit);
    let is_whole = !has_unread(names.problems, &path.key("codes"));
    if row.admits(factory) && !codes.contains_key(&init) && is_whole {
        let what = format!("the factory value of {}, {init}, is not in `codes`", row.id);
        names.report(Problem::key(path.key("codes"), what));
    }
}
