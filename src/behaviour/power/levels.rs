//! A power stage that is on while a signal asks for it, as drives with a servo-on terminal have it.
//!
//! ```text
//! CiA 402 state         how it gets there
//! Switch on disabled    `release`, or `inhibit` while it is off
//! Ready to switch on    nothing asks for it
//! Operation enabled     `enable`, at any time: the level counts, not its edge
//! ```

use super::{PowerDemand, PowerState};
use crate::event::Ignored;

/// Signals that a power stage goes by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PowerLevels {
    /// Asks for power.
    pub enable: bool,
    /// Switches the power stage off, whatever asks for it.
    pub release: bool,
    /// Keeps a power stage that is off from being switched on.
    pub inhibit: bool,
}

/// On while a signal asks for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LevelControl {
    levels: PowerLevels,
}

impl LevelControl {
    pub(super) fn set(&mut self, levels: PowerLevels) {
        self.levels = levels;
    }

    pub(super) fn levels(&self) -> PowerLevels {
        self.levels
    }

    pub(super) fn demand(&self, state: PowerState) -> PowerDemand {
        self.levels.demand(state, false)
    }

    pub(super) fn why_off(&self) -> Ignored {
        self.levels.why_off(false)
    }
}

impl PowerLevels {
    /// What comes of the levels where something else asks for power `too`.
    pub(super) fn demand(self, state: PowerState, too: bool) -> PowerDemand {
        match () {
            () if self.release || self.inhibit && !state.is_on() => PowerDemand::Forbidden,
            () if self.enable || too => PowerDemand::On,
            () => PowerDemand::Off,
        }
    }

    pub(super) fn why_off(self, too: bool) -> Ignored {
        match () {
            () if self.release => Ignored::Released,
            () if self.inhibit && (self.enable || too) => Ignored::Inhibited,
            () => Ignored::PowerOff,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{AlarmCause, PowerControl, PowerStage, Trip};
    use super::*;
    use crate::time::{Duration, Instant};

    fn stage() -> PowerStage {
        let control = PowerControl::Levels(LevelControl::default());
        PowerStage::power_on(Instant::ZERO, Duration::ZERO, control)
    }

    fn levels(enable: bool, release: bool, inhibit: bool) -> PowerLevels {
        PowerLevels { enable, release, inhibit }
    }

    #[test]
    fn each_level_and_its_state() {
        let state = |levels| {
            let mut stage = stage();
            stage.set_levels(levels);
            (stage.state(), stage.why_off())
        };
        let off = (PowerState::ReadyToSwitchOn, Ignored::PowerOff);
        assert_eq!(state(levels(false, false, false)), off);
        assert_eq!(state(levels(true, false, false)).0, PowerState::OperationEnabled);
        let released = (PowerState::SwitchOnDisabled, Ignored::Released);
        assert_eq!(state(levels(true, true, false)), released);
        let inhibited = (PowerState::SwitchOnDisabled, Ignored::Inhibited);
        assert_eq!(state(levels(true, false, true)), inhibited);
        let idle = (PowerState::SwitchOnDisabled, Ignored::PowerOff);
        assert_eq!(state(levels(false, false, true)), idle);
    }

    #[test]
    fn what_is_inhibited_stays_on_and_is_not_switched_on() {
        let mut stage = stage();
        stage.set_levels(levels(true, false, true));
        assert!(!stage.is_enabled() && !stage.is_ready());
        stage.set_levels(levels(true, false, false));
        assert!(stage.is_enabled() && stage.is_ready());
        stage.set_levels(levels(true, false, true));
        assert!(stage.is_enabled());
        stage.trip(Trip { cause: AlarmCause::Forced, code: 9, resettable: true }, false);
        assert_eq!(stage.reset(), Ok(()));
        assert!(!stage.is_enabled());
    }

    #[test]
    fn levels_that_change_at_once_count_at_once() {
        let mut stage = stage();
        stage.set_levels(levels(true, false, true));
        stage.set_levels(levels(false, false, false));
        assert_eq!(stage.poll_effect(), None);
    }

    #[test]
    fn no_command_reaches_it() {
        let mut stage = stage();
        assert_eq!(stage.order(true), Err(Ignored::PowerOff));
        assert_eq!(stage.order(false), Err(Ignored::AlreadyOff));
        stage.set_levels(levels(true, false, false));
        assert_eq!(stage.order(false), Err(Ignored::KeptOn));
        assert!(stage.is_enabled() && !stage.is_latched_on());
    }
}
