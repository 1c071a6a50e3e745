//! What is always the same or as a row says: codes in rows, and in hex digits of rows.

use crate::model::RowId;
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

    /// Everything that it can come to.
    pub fn all(&self) -> Vec<T> {
        match self {
            Self::Fixed(it) => vec![*it],
            Self::Row(coded) => coded.codes.values().copied().collect(),
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
    /// The row that decides.
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

/// A row, or one hex digit of it, whose values are codes for something.
#[derive(Debug)]
pub struct Coded<T> {
    /// The row that decides.
    pub row: RowId,
    /// Which hex digit from the right; `None` is the whole value.
    pub digit: Option<u8>,
    /// Meaning by code.
    pub codes: BTreeMap<i64, T>,
}

impl<T: Copy> Coded<T> {
    /// What `value` of the row stands for, if anything.
    pub fn decode(&self, value: i64) -> Option<T> {
        self.codes.get(&self.code_in(value)).copied()
    }

    /// The code in `value` of the row: the whole of it, or one digit.
    pub fn code_in(&self, value: i64) -> i64 {
        code_in(value, self.digit)
    }
}

/// The code in `value`: the whole of it, or one hex digit.
pub(in crate::model) fn code_in(value: i64, digit: Option<u8>) -> i64 {
    digit.map_or(value, |digit| value >> (4 * digit) & 0xF)
}
