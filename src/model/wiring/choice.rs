//! What is always the same or as a row says: words resolved, whichever it is.

use super::compile::Wirer;
use crate::model::RowId;
use crate::model::line::{Coded, code_in, coded, has_digit};
use crate::model::raw::{RawChoice, RawChosen, RawDigit};
use crate::problem::Path;
use crate::vocabulary::Named;
use std::collections::BTreeMap;

/// Always the same, or as a row says.
#[derive(Debug)]
pub enum Choice<T> {
    /// Always the same.
    Fixed(T),
    /// As a row says.
    Row(Coded<T>),
}

impl<T: Copy> Choice<T> {
    /// What it comes to, given the values of rows; `None` where a row holds a code that stands for nothing.
    pub fn get(&self, value: impl FnOnce(RowId) -> i64) -> Option<T> {
        match self {
            Self::Fixed(it) => Some(*it),
            Self::Row(coded) => coded.decode(value(coded.row)),
        }
    }

    /// The row that decides, if one does.
    pub fn row(&self) -> Option<RowId> {
        match self {
            Self::Fixed(_) => None,
            Self::Row(coded) => Some(coded.row),
        }
    }
}

/// A row, or one hex digit of it.
#[derive(Debug, Clone, Copy)]
pub struct Digit {
    /// The row.
    pub row: RowId,
    /// Which hex digit from the right; `None` is the whole value.
    pub digit: Option<u8>,
}

impl Digit {
    /// The number in `value` of the row.
    pub fn of(self, value: i64) -> i64 {
        code_in(value, self.digit)
    }
}

impl Wirer<'_> {
    pub(super) fn words_chosen<W: Named>(
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
        has_digit(raw.digit, path, self.problems);
        let row = self.row(&raw.register, &path.key("register"))?;
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
