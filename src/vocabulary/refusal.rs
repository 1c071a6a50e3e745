//! Refusals: their causes, the code that the model answers with, and what exactly was wrong.

use super::named_terms;

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

named_terms! {
    /// A cause of refusal.
    Cause {
        Function "function" "the drive does not support the function code",
        Length "length" "byte count, register count and data length of the request do not match",
        Quantity "quantity" "the register count is 0 or above the maximum for one request",
        AddressBeyond "address_beyond" "an address above the highest mapped one; reported as `address` where the model does not list it",
        Address "address" "an unmapped address",
        SplitLong "split_long" "an access to one word of a 32-bit pair without the other",
        ReadOnly "read_only" "a write to a read-only row",
        WriteOnly "write_only" "a read of a write-only row",
        Range "range" "a value outside the row's range",
        State "state" "a write that the present state of the drive does not permit",
    }
}
