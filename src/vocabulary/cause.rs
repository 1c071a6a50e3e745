//! Causes: why a request is refused and what exactly was wrong, and why a drive trips.

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

named_terms! {
    /// A cause of an alarm.
    AlarmCause {
        OverCurrent "over_current" "motor current too high",
        OverVoltage "over_voltage" "DC bus voltage too high",
        UnderVoltage "under_voltage" "DC bus voltage too low",
        Overload "overload" "torque above the rating for too long",
        Encoder "encoder" "encoder feedback missing or implausible",
        PositionDeviation "position_deviation" "position deviation too large",
        HomingLimitPos "homing_limit_pos" "positive limit reached during homing",
        HomingLimitNeg "homing_limit_neg" "negative limit reached during homing",
        HomingTime "homing_time" "homing not complete within `home.time_limit`",
        CommTimeout "comm_timeout" "no request from a master in time",
        Forced "forced" "input `alarm_force` is active",
    }
}

/// A set of causes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AlarmCauses(u16);

impl AlarmCauses {
    /// Is `cause` one of them?
    pub fn has(self, cause: AlarmCause) -> bool {
        self.0 & (1 << cause as u8) != 0
    }

    /// With `cause` if `stands`, else without it.
    #[must_use]
    pub fn with(self, cause: AlarmCause, stands: bool) -> Self {
        let bit = 1 << cause as u8;
        Self(if stands { self.0 | bit } else { self.0 & !bit })
    }
}
