//! Why a drive trips. The model says which number stands for which cause and what clears it.

use super::named_terms;

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
