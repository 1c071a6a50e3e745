//! A refusal: the cause, the number that the model answers it with, and what exactly was wrong.

use super::Cause;

/// Index of a row in its model's map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct RowId(pub u16);

/// Why a request was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal {
    /// Why.
    pub cause: Cause,
    /// The exception code that the model gives it.
    pub code: u8,
    /// What exactly.
    pub detail: Detail,
}

/// What exactly was wrong: both numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// This function code.
    Function(u8),
    /// The request's length.
    Length {
        /// Bytes of PDU that came.
        got: usize,
        /// Bytes that should have.
        want: usize,
    },
    /// This many registers.
    Quantity {
        /// Asked for.
        got: u16,
        /// Allowed.
        most: u16,
    },
    /// This address.
    Address(u16),
    /// This row.
    Row(RowId),
    /// This value for this row.
    Value {
        /// The row.
        row: RowId,
        /// The value.
        got: i64,
    },
}
