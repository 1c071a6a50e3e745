//! What asks for power: a signal, as drives with a servo-on terminal have it, or one command to switch the power stage on and
//! another one for off, besides which signals can switch it off, and on.
//!
//! ```text
//! CiA 402 state         by levels                              by commands
//! Switch on disabled    `release`, or `inhibit` while it is off, for both
//! Ready to switch on    nothing asks for it                    the command for off, and no signal asks for power
//! Operation enabled     `enable`: the level, not its edge      the command for on, or the signal; some have it from power-on
//! ```

use super::PowerState;
use crate::event::Ignored;

/// What a machine says about the power stage, all alarms apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PowerDemand {
    /// To be off, whatever asks for it.
    Forbidden,
    /// Nothing asks for it.
    Off,
    /// To be on.
    On,
}

/// What asks for power: one of the machines that drives have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PowerControl {
    /// On while a signal asks for it.
    Levels(LevelControl),
    /// On from one command to another.
    Commands(CommandControl),
}

impl PowerControl {
    pub(super) fn demand(&self, state: PowerState) -> PowerDemand {
        match self {
            Self::Levels(it) => it.demand(state),
            Self::Commands(it) => it.demand(state),
        }
    }

    pub(super) fn set_levels(&mut self, levels: PowerLevels) {
        match self {
            Self::Levels(it) => it.set(levels),
            Self::Commands(it) => it.set_levels(levels),
        }
    }

    pub(super) fn order(&mut self, on: bool, has_alarm: bool) {
        match self {
            // Such a drive has no command for it.
            Self::Levels(_) => {}
            Self::Commands(it) => it.order(on, has_alarm),
        }
    }

    pub(super) fn levels(&self) -> PowerLevels {
        match self {
            Self::Levels(it) => it.levels(),
            Self::Commands(it) => it.levels(),
        }
    }

    /// Why the power stage is off although nothing but the machine keeps it off.
    pub(super) fn why_off(&self) -> Ignored {
        match self {
            Self::Levels(it) => it.why_off(),
            Self::Commands(it) => it.why_off(),
        }
    }

    pub(super) fn is_latched(&self) -> bool {
        matches!(self, Self::Commands(it) if it.is_latched())
    }
}

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
    use super::super::{PowerStage, Trip};
    use super::*;
    use crate::time::{Duration, Instant};
    use crate::vocabulary::AlarmCause;

    const FORCED: Trip = Trip { cause: AlarmCause::Forced, code: 9, resettable: true };

    fn by_commands(on: bool) -> PowerStage {
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
        assert_eq!(by_commands(true).state, PowerState::OperationEnabled);
        let mut stage = by_commands(false);
        assert_eq!(stage.state, PowerState::ReadyToSwitchOn);
        assert_eq!(stage.order(true), Ok(()));
        assert_eq!(stage.order(true), Err(Ignored::AlreadyOn));
        assert!(stage.is_latched_on());
        assert_eq!(stage.order(false), Ok(()));
        assert_eq!(stage.order(false), Err(Ignored::AlreadyOff));
        assert_eq!(stage.state, PowerState::ReadyToSwitchOn);
    }

    #[test]
    fn a_command_while_released_or_under_an_alarm_is_lost() {
        let mut stage = by_commands(false);
        stage.set_levels(release(true));
        assert_eq!(stage.order(true), Err(Ignored::Released));
        stage.set_levels(release(false));
        assert_eq!(stage.state, PowerState::ReadyToSwitchOn);
        stage.trip(FORCED, false);
        assert_eq!(stage.order(true), Err(Ignored::Alarm));
        assert_eq!(stage.reset(), Ok(()));
        assert_eq!(stage.state, PowerState::ReadyToSwitchOn);
    }

    #[test]
    fn a_command_from_before_outlasts_release_and_alarm() {
        let mut stage = by_commands(true);
        stage.set_levels(release(true));
        assert_eq!(stage.state, PowerState::SwitchOnDisabled);
        stage.set_levels(release(false));
        assert_eq!(stage.state, PowerState::OperationEnabled);
        stage.trip(FORCED, false);
        assert_eq!(stage.reset(), Ok(()));
        assert_eq!(stage.state, PowerState::OperationEnabled);
    }

    #[test]
    fn a_signal_keeps_on_what_a_command_switches_off() {
        let mut stage = by_commands(true);
        stage.set_levels(PowerLevels { enable: true, ..PowerLevels::default() });
        assert_eq!(stage.order(false), Err(Ignored::KeptOn));
        assert!(stage.is_enabled() && !stage.is_latched_on());
    }

    fn by_levels() -> PowerStage {
        let control = PowerControl::Levels(LevelControl::default());
        PowerStage::power_on(Instant::ZERO, Duration::ZERO, control)
    }

    fn levels(enable: bool, release: bool, inhibit: bool) -> PowerLevels {
        PowerLevels { enable, release, inhibit }
    }

    #[test]
    fn each_level_and_its_state() {
        let state = |levels| {
            let mut stage = by_levels();
            stage.set_levels(levels);
            (stage.state, stage.why_off())
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
        let mut stage = by_levels();
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
        let mut stage = by_levels();
        stage.set_levels(levels(true, false, true));
        stage.set_levels(levels(false, false, false));
        assert_eq!(stage.poll_effect(), None);
    }

    #[test]
    fn no_command_reaches_it() {
        let mut stage = by_levels();
        assert_eq!(stage.order(true), Err(Ignored::PowerOff));
        assert_eq!(stage.order(false), Err(Ignored::AlreadyOff));
        stage.set_levels(levels(true, false, false));
        assert_eq!(stage.order(false), Err(Ignored::KeptOn));
        assert!(stage.is_enabled() && !stage.is_latched_on());
    }
}
