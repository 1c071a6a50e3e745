//! A power stage that a command switches on and another one off. Signals can switch it off, and on, besides.
//!
//! ```text
//! CiA 402 state         how it gets there
//! Switch on disabled    the signal `release`, or `inhibit` while it is off
//! Ready to switch on    the command `release`, and no signal asks for power
//! Operation enabled     the command `enable`, or the signal; some drives have it from power-on
//! ```

use super::{PowerDemand, PowerLevels, PowerState};
use crate::event::Ignored;

/// On from one command to another.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CommandControl {
    latched: bool,
    levels: PowerLevels,
}

impl CommandControl {
    /// With the power stage on from the start, or not.
    pub fn new(on: bool) -> Self {
        Self { latched: on, levels: PowerLevels::default() }
    }

    pub(super) fn set_levels(&mut self, levels: PowerLevels) {
        self.levels = levels;
    }

    /// Under an alarm, or while a signal releases it, nothing can ask for the power stage: it stays off when that has
    /// gone, unless it was asked for before.
    pub(super) fn order(&mut self, on: bool, has_alarm: bool) {
        if !on || !(self.levels.release || has_alarm) {
            self.latched = on;
        }
    }

    pub(super) fn levels(&self) -> PowerLevels {
        self.levels
    }

    pub(super) fn is_latched(&self) -> bool {
        self.latched
    }

    pub(super) fn demand(&self, state: PowerState) -> PowerDemand {
        self.levels.demand(state, self.latched)
    }

    pub(super) fn why_off(&self) -> Ignored {
        self.levels.why_off(self.latched)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{AlarmCause, PowerControl, PowerStage, Trip};
    use super::*;
    use crate::time::{Duration, Instant};

    const FORCED: Trip = Trip { cause: AlarmCause::Forced, code: 9, resettable: true };

    fn stage(on: bool) -> PowerStage {
        let control = PowerControl::Commands(CommandControl::new(on));
        let mut stage = PowerStage::power_on(Instant::ZERO, Duration::ZERO, control);
        stage.set_levels(PowerLevels::default());
        stage
    }

    fn release(release: bool) -> PowerLevels {
        PowerLevels { release, ..PowerLevels::default() }
    }

    #[test]
    fn each_command_and_its_state() {
        assert_eq!(stage(true).state(), PowerState::OperationEnabled);
        let mut stage = stage(false);
        assert_eq!(stage.state(), PowerState::ReadyToSwitchOn);
        assert_eq!(stage.order(true), Ok(()));
        assert_eq!(stage.order(true), Err(Ignored::AlreadyOn));
        assert!(stage.is_latched_on());
        assert_eq!(stage.order(false), Ok(()));
        assert_eq!(stage.order(false), Err(Ignored::AlreadyOff));
        assert_eq!(stage.state(), PowerState::ReadyToSwitchOn);
    }

    #[test]
    fn a_command_while_released_or_under_an_alarm_is_lost() {
        let mut stage = stage(false);
        stage.set_levels(release(true));
        assert_eq!(stage.order(true), Err(Ignored::Released));
        stage.set_levels(release(false));
        assert_eq!(stage.state(), PowerState::ReadyToSwitchOn);
        stage.trip(FORCED, false);
        assert_eq!(stage.order(true), Err(Ignored::Alarm));
        assert_eq!(stage.reset(), Ok(()));
        assert_eq!(stage.state(), PowerState::ReadyToSwitchOn);
    }

    #[test]
    fn a_command_from_before_outlasts_release_and_alarm() {
        let mut stage = stage(true);
        stage.set_levels(release(true));
        assert_eq!(stage.state(), PowerState::SwitchOnDisabled);
        stage.set_levels(release(false));
        assert_eq!(stage.state(), PowerState::OperationEnabled);
        stage.trip(FORCED, false);
        assert_eq!(stage.reset(), Ok(()));
        assert_eq!(stage.state(), PowerState::OperationEnabled);
    }

    #[test]
    fn a_signal_keeps_on_what_a_command_switches_off() {
        let mut stage = stage(true);
        stage.set_levels(PowerLevels { enable: true, ..PowerLevels::default() });
        assert_eq!(stage.order(false), Err(Ignored::KeptOn));
        assert!(stage.is_enabled() && !stage.is_latched_on());
    }
}
