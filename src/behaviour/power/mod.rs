//! Whether the power stage is on, and why not.
//!
//! What all drives have in common is here: they take a while to get ready, an alarm switches them off, some alarms only
//! once the axis has stopped, and a reset clears an alarm whose cause has gone. What asks for power differs from drive to
//! drive and is a [`PowerControl`] (`control.rs`). The states have the names of CiA 402; a machine of that standard would be
//! one more variant.

mod control;

pub use control::{CommandControl, LevelControl, PowerControl, PowerDemand, PowerLevels};

use super::effect::Effect;
use crate::event::Ignored;
use crate::time::{Duration, Instant};
use crate::vocabulary::{AlarmCause, AlarmCauses};
use std::collections::VecDeque;

/// An alarm as a drive raises it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trip {
    /// Why.
    pub cause: AlarmCause,
    /// The vendor's number.
    pub code: u16,
    /// Does a reset clear it?
    pub resettable: bool,
}

/// The state of a power stage, as CiA 402 calls it (IEC 61800-7-201).
///
/// `Switched on` is left out, because none of the machines here stops there, and so is `Quick stop active`: a quick stop
/// is a matter of the axis, and leaves the power stage as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PowerState {
    /// Initialising, or without supply.
    NotReadyToSwitchOn,
    /// Off, and something forbids to switch it on.
    SwitchOnDisabled,
    /// Off, because nothing asks for it.
    ReadyToSwitchOn,
    /// On.
    OperationEnabled,
    /// Still on, until the axis has stopped for an alarm.
    FaultReactionActive,
    /// Off because of an alarm.
    Fault,
}

impl PowerState {
    /// Does the motor have power?
    pub fn is_on(self) -> bool {
        matches!(self, Self::OperationEnabled | Self::FaultReactionActive)
    }
}

/// The power stage of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerStage {
    state: PowerState,
    control: PowerControl,
    /// Initialising until then.
    ready_at: Option<Instant>,
    alarm: Option<Trip>,
    /// Causes that are still there, so that no reset helps.
    active_causes: AlarmCauses,
    effects: VecDeque<Effect>,
}

impl PowerStage {
    /// Power comes on at `now`. Nothing is on before the signals are known, or the time is over.
    pub fn power_on(now: Instant, ready_after: Duration, control: PowerControl) -> Self {
        Self {
            state: PowerState::NotReadyToSwitchOn,
            control,
            ready_at: (!ready_after.is_zero()).then(|| now + ready_after),
            alarm: None,
            active_causes: AlarmCauses::default(),
            effects: VecDeque::with_capacity(4),
        }
    }

    /// Power goes off: nothing is left to report but that the motor has no power any more.
    pub fn power_off(&mut self) {
        self.alarm = None;
        self.ready_at = None;
        self.enter(PowerState::NotReadyToSwitchOn);
    }

    /// Is the power stage on?
    pub fn is_enabled(&self) -> bool {
        self.state.is_on()
    }

    /// Could it be enabled?
    pub fn is_ready(&self) -> bool {
        self.ready_at.is_none() && self.alarm.is_none() && !self.control.levels().inhibit
    }

    /// Is the power stage on for no more than the stop after an alarm?
    pub fn is_braking(&self) -> bool {
        self.state == PowerState::FaultReactionActive
    }

    /// Is the power stage on because a command asked for it, whatever levels say?
    pub fn is_latched_on(&self) -> bool {
        self.control.is_latched() && self.is_enabled()
    }

    /// The alarm that is active.
    pub fn alarm(&self) -> Option<Trip> {
        self.alarm
    }

    /// What keeps the power stage off, while it is off.
    pub fn why_off(&self) -> Ignored {
        match () {
            () if self.ready_at.is_some() => Ignored::NotReady,
            () if self.alarm.is_some() => Ignored::Alarm,
            () => self.control.why_off(),
        }
    }

    /// When initialising ends.
    pub fn ready_at(&self) -> Option<Instant> {
        self.ready_at
    }

    /// The next thing to be reported.
    pub fn poll_effect(&mut self) -> Option<Effect> {
        self.effects.pop_front()
    }

    /// Lets time pass up to `now`.
    pub fn advance(&mut self, now: Instant) {
        if self.ready_at.take_if(|at| *at <= now).is_some() {
            self.effects.push_back(Effect::Ready);
        }
        self.update(self.is_braking());
    }

    /// The levels as they are now.
    pub fn set_levels(&mut self, levels: PowerLevels) {
        self.control.set_levels(levels);
        self.update(self.is_braking());
    }

    /// A command asks for the power stage, or takes that back.
    ///
    /// # Errors
    /// Why the power stage stays as it is.
    pub fn order(&mut self, on: bool) -> Result<(), Ignored> {
        let before = self.is_enabled();
        self.control.order(on, self.alarm.is_some());
        self.update(self.is_braking());
        match (on, before, self.is_enabled()) {
            (true, true, _) => Err(Ignored::AlreadyOn),
            (true, false, false) => Err(self.why_off()),
            (false, false, _) => Err(Ignored::AlreadyOff),
            (false, true, true) => Err(Ignored::KeptOn),
            (true, false, true) | (false, true, false) => Ok(()),
        }
    }

    /// Trips; with `brakes` a power stage that is on stays on until [`Self::braked`]. The first alarm stays
    /// until it is cleared, but any later one can end the braking.
    pub fn trip(&mut self, trip: Trip, brakes: bool) {
        if self.alarm.is_none() {
            self.alarm = Some(trip);
            self.effects.push_back(Effect::AlarmRaised { cause: trip.cause, code: trip.code });
        }
        self.update(brakes && self.is_enabled());
    }

    /// The axis has stopped: nothing keeps the power stage on any longer.
    pub fn braked(&mut self) {
        self.update(false);
    }

    /// The causes that are there: while one is, no reset clears its alarm.
    pub fn set_active_causes(&mut self, causes: AlarmCauses) {
        self.active_causes = causes;
    }

    /// Clears the alarm.
    ///
    /// # Errors
    /// Why it stays, or that there is none.
    pub fn reset(&mut self) -> Result<(), Ignored> {
        self.may_reset()?;
        self.clear();
        Ok(())
    }

    /// Clears the alarm that was raised for `cause`, also where no other reset clears it.
    ///
    /// # Errors
    /// Why it stays, or that there is none.
    pub fn reset_of(&mut self, cause: AlarmCause) -> Result<(), Ignored> {
        match self.alarm.ok_or(Ignored::NoAlarm)?.cause {
            other if other != cause => Err(Ignored::OtherAlarm(other)),
            _ if self.active_causes.has(cause) => Err(Ignored::CauseStands(cause)),
            _ => {
                self.clear();
                Ok(())
            }
        }
    }

    /// Would a reset clear the alarm?
    ///
    /// # Errors
    /// Why not, or that there is none.
    pub fn may_reset(&self) -> Result<(), Ignored> {
        let Trip { cause, resettable, .. } = self.alarm.ok_or(Ignored::NoAlarm)?;
        match () {
            () if !resettable => Err(Ignored::NotResettable(cause)),
            () if self.active_causes.has(cause) => Err(Ignored::CauseStands(cause)),
            () => Ok(()),
        }
    }

    /// A demand that still holds switches the power stage on again.
    fn clear(&mut self) {
        self.alarm = None;
        self.effects.push_back(Effect::AlarmCleared);
        self.update(false);
    }

    /// Enters the state that follows from everything; after an alarm the one in which it `brakes`, if it is to be on.
    fn update(&mut self, brakes: bool) {
        let demand = self.control.demand(self.state);
        self.enter(match (self.ready_at, self.alarm, demand) {
            (Some(_), _, _) => PowerState::NotReadyToSwitchOn,
            (None, Some(_), PowerDemand::On) if brakes => PowerState::FaultReactionActive,
            (None, Some(_), _) => PowerState::Fault,
            (None, None, PowerDemand::Forbidden) => PowerState::SwitchOnDisabled,
            (None, None, PowerDemand::Off) => PowerState::ReadyToSwitchOn,
            (None, None, PowerDemand::On) => PowerState::OperationEnabled,
        });
    }

    fn enter(&mut self, state: PowerState) {
        let before = std::mem::replace(&mut self.state, state);
        if before.is_on() != state.is_on() {
            self.effects.push_back(Effect::Enabled(state.is_on()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORCED: Trip = Trip { cause: AlarmCause::Forced, code: 9, resettable: true };
    const ALARM: Effect = Effect::AlarmRaised { cause: AlarmCause::Forced, code: 9 };
    const NOTHING: PowerLevels = PowerLevels { enable: false, release: false, inhibit: false };
    const ENABLE: PowerLevels = PowerLevels { enable: true, ..NOTHING };

    fn stage(ready_after: Duration) -> PowerStage {
        let control = PowerControl::Levels(LevelControl::default());
        PowerStage::power_on(Instant::ZERO, ready_after, control)
    }

    /// A power stage that a level has switched on, and nothing to report.
    fn enabled() -> PowerStage {
        let mut stage = stage(Duration::ZERO);
        stage.set_levels(ENABLE);
        assert_eq!(effects(&mut stage), [Effect::Enabled(true)]);
        stage
    }

    fn effects(stage: &mut PowerStage) -> Vec<Effect> {
        std::iter::from_fn(|| stage.poll_effect()).collect()
    }

    #[test]
    fn not_enabled_before_it_is_ready() {
        let mut stage = stage(Duration::from_secs(1));
        stage.set_levels(ENABLE);
        assert_eq!(stage.state, PowerState::NotReadyToSwitchOn);
        assert_eq!((stage.is_ready(), stage.why_off()), (false, Ignored::NotReady));
        assert_eq!(stage.ready_at(), Some(Instant::from_millis(1000)));
        stage.advance(Instant::from_millis(1000));
        assert_eq!(effects(&mut stage), [Effect::Ready, Effect::Enabled(true)]);
    }

    #[test]
    fn a_demand_that_still_holds_enables_again_after_a_reset() {
        let mut stage = enabled();
        stage.trip(FORCED, false);
        assert_eq!(stage.state, PowerState::Fault);
        assert_eq!(stage.reset(), Ok(()));
        let all = [ALARM, Effect::Enabled(false), Effect::AlarmCleared, Effect::Enabled(true)];
        assert_eq!(effects(&mut stage), all);
        assert_eq!(stage.state, PowerState::OperationEnabled);
    }

    #[test]
    fn no_reset_while_the_cause_stands_or_where_none_helps() {
        let mut stage = enabled();
        stage.set_active_causes(AlarmCauses::default().with(AlarmCause::Forced, true));
        stage.trip(FORCED, false);
        assert_eq!(stage.reset(), Err(Ignored::CauseStands(AlarmCause::Forced)));
        assert_eq!(stage.alarm(), Some(FORCED));
        let mut stage = enabled();
        stage.trip(Trip { resettable: false, ..FORCED }, false);
        assert_eq!(stage.reset(), Err(Ignored::NotResettable(AlarmCause::Forced)));
        assert!(stage.alarm().is_some());
    }

    #[test]
    fn power_stays_on_until_it_has_braked() {
        let mut stage = enabled();
        stage.trip(FORCED, true);
        assert_eq!(stage.state, PowerState::FaultReactionActive);
        assert!(stage.is_enabled() && stage.is_braking() && !stage.is_ready());
        stage.braked();
        assert_eq!(effects(&mut stage), [ALARM, Effect::Enabled(false)]);
        assert_eq!(stage.state, PowerState::Fault);
    }

    #[test]
    fn a_reset_while_it_brakes_leaves_it_on() {
        let mut stage = enabled();
        stage.trip(FORCED, true);
        assert_eq!(stage.reset(), Ok(()));
        assert_eq!(effects(&mut stage), [ALARM, Effect::AlarmCleared]);
        assert_eq!(stage.state, PowerState::OperationEnabled);
    }

    #[test]
    fn braking_ends_for_good() {
        for released in [true, false] {
            let mut stage = enabled();
            stage.trip(FORCED, true);
            match released {
                true => stage.set_levels(PowerLevels { release: true, ..ENABLE }),
                false => stage.trip(FORCED, false),
            }
            stage.set_levels(ENABLE);
            assert_eq!(stage.state, PowerState::Fault);
        }
    }

    #[test]
    fn without_power_nothing_brakes() {
        let mut stage = stage(Duration::ZERO);
        stage.trip(FORCED, true);
        stage.set_levels(ENABLE);
        assert_eq!(stage.state, PowerState::Fault);
        assert_eq!(effects(&mut stage), [ALARM]);
    }

    #[test]
    fn a_reset_of_one_cause_leaves_the_others() {
        let fixed = Trip { resettable: false, ..FORCED };
        let mut stage = enabled();
        assert_eq!(stage.reset_of(AlarmCause::Forced), Err(Ignored::NoAlarm));
        stage.trip(fixed, false);
        let other = Err(Ignored::OtherAlarm(AlarmCause::Forced));
        assert_eq!(stage.reset_of(AlarmCause::Encoder), other);
        assert_eq!(stage.alarm(), Some(fixed));
        assert_eq!(stage.reset_of(AlarmCause::Forced), Ok(()));
        assert_eq!(stage.alarm(), None);
    }

    #[test]
    fn supply_that_goes_takes_the_alarm_with_it() {
        let mut stage = enabled();
        stage.trip(FORCED, true);
        stage.power_off();
        assert_eq!(effects(&mut stage), [ALARM, Effect::Enabled(false)]);
        assert_eq!((stage.state, stage.alarm()), (PowerState::NotReadyToSwitchOn, None));
    }
}
