//! Why a drive trips. The model says which number stands for which cause and what clears it.

use super::named_terms;

named_terms! {
    /// A cause of an alarm.
    AlarmCause {
        OverCurrent "over_current" "too much motor current",
        OverVoltage "over_voltage" "bus voltage too high",
        UnderVoltage "under_voltage" "bus voltage too low",
        Overload "overload" "too much torque for too long",
        Encoder "encoder" "no or implausible feedback",
        PositionDeviation "position_deviation" "command and feedback too far apart",
        HomingLimitPos "homing_limit_pos" "the positive limit ended the way of a homing",
        HomingLimitNeg "homing_limit_neg" "the negative limit ended the way of a homing",
        HomingTime "homing_time" "no origin within `home.time_limit`",
        CommTimeout "comm_timeout" "no master spoke to the drive in time",
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
