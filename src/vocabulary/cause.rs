//! Why a drive refuses a request. The model says in which order causes answer and with which code.

use super::named_terms;

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
