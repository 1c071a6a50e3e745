//! What is always the same or as a row says: words resolved, whichever it is.

use super::compile::Wirer;
use super::{Choice, Digit};
use crate::model::line::{Coded, coded};
use crate::model::raw::{RawChoice, RawChosen, RawDigit};
use crate::problem::{At, Path, Problem};
use crate::words::Word;
use std::collections::BTreeMap;

impl Wirer<'_> {
    pub(super) fn words_chosen<W: Word>(
        &mut self,
        raw: &Option<RawChoice<String>>,
        kind: &str,
        path: &Path,
    ) -> Option<Choice<W>> {
        self.choice(raw, path, |wirer, name: &String, path| wirer.word(name, kind, path))
    }

    pub(super) fn choice<R, T: Copy>(
        &mut self,
        raw: &Option<RawChoice<R>>,
        path: &Path,
        read: impl Fn(&mut Self, &R, &Path) -> Option<T>,
    ) -> Option<Choice<T>> {
        Some(match raw.as_ref()? {
            RawChoice::Fixed(it) => Choice::Fixed(read(self, it, path)?),
            RawChoice::Row(it) => Choice::Row(self.chosen(it, path, read)?),
        })
    }

    pub(super) fn chosen<R, T: Copy>(
        &mut self,
        raw: &RawChosen<R>,
        path: &Path,
        read: impl Fn(&mut Self, &R, &Path) -> Option<T>,
    ) -> Option<Coded<T>> {
        let row = self.row(&raw.register, &path.key("register"));
        coded(row, raw.digit, &raw.codes, self.rows, path, self.problems);
        let mut codes = BTreeMap::new();
        for (code, it) in &raw.codes {
            let meaning = read(self, it, &path.key("codes").key(code));
            codes.extend(meaning.map(|meaning| (*code, meaning)));
        }
        Some(Coded { row: row?, digit: raw.digit, codes })
    }

    pub(super) fn digit(&mut self, raw: &RawDigit, path: &Path) -> Option<Digit> {
        let row = self.row(&raw.register, &path.key("register"))?;
        if raw.digit.is_some_and(|digit| digit > 3) {
            let what = "a word has hex digits 0 to 3, counted from the right";
            self.problems
                .push(Problem { at: At::Value, ..Problem::value(path.key("digit"), what) });
        }
        Some(Digit { row, digit: raw.digit })
    }
}

impl<T: Copy> Choice<T> {
    /// Everything that it can come to.
    pub(super) fn all(&self) -> Vec<T> {
        match self {
            Self::Fixed(it) => vec![*it],
            Self::Row(coded) => coded.codes.values().copied().collect(),
        }
    }
}
