//! Why a drive refuses a request. The model says in which order causes answer and with which code.

use super::named_terms;

named_terms! {
    /// A cause of refusal.
    Cause {
        Function "function" "the function code is not one of the drive's",
        Length "length" "byte count, register count and data of the request do not agree",
        Quantity "quantity" "no register, or more than one request may name",
        AddressBeyond "address_beyond" "an address above the highest that is mapped; `address` where the model does not tell them apart",
        Address "address" "an address that is not mapped",
        SplitLong "split_long" "one word of a 32-bit pair without the other",
        ReadOnly "read_only" "a write to a row that can only be read",
        WriteOnly "write_only" "a read of a row that can only be written",
        Range "range" "a value outside the row's range",
        State "state" "a write that the drive's present state forbids",
    }
}
