//! Ready, enabled, tripped: whether the power stage is on, and why not.
//!
//! The power stage is on while somebody wants it on (a level, or a command that stays), the drive is
//! initialised, no level releases it and no alarm stands. A level can keep it from being switched on. Some alarms
//! leave it on until the axis has stopped.
//! When an alarm goes, a want that still holds switches it on again.

use crate::event::{Change, Ignored};
use crate::time::{Duration, Instant};
use crate::vocabulary::{AlarmCause, AlarmCauses};

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

/// The state of the power stage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Servo {
    /// Still initialising until then.
    starts_until: Option<Instant>,
    /// A level that asks for the power stage.
    wanted: bool,
    /// A level that forbids it, whatever asks for it.
    released: bool,
    /// A level that keeps it from being switched on.
    inhibited: bool,
    /// A command that asked for it and stays until another takes it back.
    latched: bool,
    alarm: Option<Trip>,
    /// The power stage stays on despite the alarm, until the axis stands.
    braking: bool,
    /// Causes that are still there, so that no reset helps.
    active_causes: AlarmCauses,
    was_enabled: bool,
}

impl Servo {
    /// Power comes on at `now`.
    pub fn power_on(now: Instant, ready_after: Duration, enabled: bool) -> Self {
        let starts_until = (!ready_after.is_zero()).then(|| now + ready_after);
        Self {
            starts_until,
            wanted: false,
            released: false,
            inhibited: false,
            latched: enabled,
            alarm: None,
            braking: false,
            active_causes: AlarmCauses::default(),
            was_enabled: false,
        }
    }

    /// Could it be enabled?
    pub fn is_ready(&self) -> bool {
        self.starts_until.is_none() && self.alarm.is_none() && !self.inhibited
    }

    /// Is the power stage on?
    pub fn is_enabled(&self) -> bool {
        let may = self.starts_until.is_none() && (self.alarm.is_none() || self.braking);
        let may = may && (self.was_enabled || !self.inhibited);
        may && (self.wanted || self.latched) && !self.released
    }

    /// Is the power stage on because a command asked for it, whatever levels say?
    pub fn is_latched_on(&self) -> bool {
        self.latched && self.is_enabled()
    }

    /// The alarm that stands.
    pub fn alarm(&self) -> Option<Trip> {
        self.alarm
    }

    /// What keeps the power stage off, while it is off.
    pub fn why_off(&self) -> Ignored {
        match () {
            () if self.starts_until.is_some() => Ignored::NotReady,
            () if self.alarm.is_some() => Ignored::Alarm,
            () if self.released => Ignored::Released,
            () if self.inhibited && (self.wanted || self.latched) => Ignored::Inhibited,
            () => Ignored::PowerOff,
        }
    }

    /// Is the power stage on for no more than the stop after an alarm?
    pub fn is_braking(&self) -> bool {
        self.braking
    }

    /// When initialising ends.
    pub fn deadline(&self) -> Option<Instant> {
        self.starts_until
    }

    /// Lets time pass up to `now`.
    pub fn advance(&mut self, now: Instant, tell: &mut impl FnMut(Change)) {
        if self.starts_until.is_some_and(|at| at <= now) {
            self.starts_until = None;
            tell(Change::Ready);
        }
        self.update(tell);
    }

    /// A level that keeps a power stage that is off from being switched on, whatever asks for it.
    pub fn inhibit(&mut self, inhibited: bool, tell: &mut impl FnMut(Change)) {
        self.inhibited = inhibited;
        self.update(tell);
    }

    /// The level that asks for the power stage, and the one that forbids it.
    pub fn want(&mut self, wanted: bool, released: bool, tell: &mut impl FnMut(Change)) {
        (self.wanted, self.released) = (wanted, released);
        self.update(tell);
    }

    /// A command that asks for the power stage, or takes that back. Under an alarm, or while a level releases it, nothing
    /// can ask for it: it stays off when that has gone, unless it was asked for before.
    ///
    /// # Errors
    /// Why the power stage stays as it is.
    pub fn latch(&mut self, on: bool, tell: &mut impl FnMut(Change)) -> Result<(), Ignored> {
        let before = self.is_enabled();
        if !on || !(self.released || self.alarm.is_some()) {
            self.latched = on;
        }
        self.update(tell);
        match (on, before, self.is_enabled()) {
            (true, true, _) => Err(Ignored::AlreadyOn),
            (true, false, false) => Err(self.why_off()),
            (false, false, _) => Err(Ignored::AlreadyOff),
            (false, true, true) => Err(Ignored::KeptOn),
            (true, false, true) | (false, true, false) => Ok(()),
        }
    }

    /// Trips; with `brakes` a power stage that is on stays on until [`Servo::braked`]. The first alarm stays
    /// until it is cleared, but any later one can end the braking.
    pub fn trip(&mut self, trip: Trip, brakes: bool, tell: &mut impl FnMut(Change)) {
        self.braking = brakes && self.is_enabled();
        if self.alarm.is_none() {
            self.alarm = Some(trip);
            tell(Change::Alarm { cause: trip.cause, code: trip.code });
        }
        self.update(tell);
    }

    /// The axis has stopped: nothing keeps the power stage on any longer.
    pub fn braked(&mut self, tell: &mut impl FnMut(Change)) {
        self.braking = false;
        self.update(tell);
    }

    /// The causes that stand: while one does, no reset clears its alarm.
    pub fn set_active_causes(&mut self, active_causes: AlarmCauses) {
        self.active_causes = active_causes;
    }

    /// Clears the alarm.
    ///
    /// # Errors
    /// Why it stays, or that there is none.
    pub fn reset(&mut self, tell: &mut impl FnMut(Change)) -> Result<(), Ignored> {
        self.may_reset()?;
        self.clear(tell);
        Ok(())
    }

    /// Clears the alarm that was raised for `cause`, also where no other reset clears it.
    ///
    /// # Errors
    /// Why it stays, or that there is none.
    pub fn reset_of(
        &mut self,
        cause: AlarmCause,
        tell: &mut impl FnMut(Change),
    ) -> Result<(), Ignored> {
        match self.alarm.ok_or(Ignored::NoAlarm)?.cause {
            other if other != cause => Err(Ignored::OtherAlarm(other)),
            _ if self.active_causes.has(cause) => Err(Ignored::CauseStands(cause)),
            _ => {
                self.clear(tell);
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

    fn clear(&mut self, tell: &mut impl FnMut(Change)) {
        (self.alarm, self.braking) = (None, false);
        tell(Change::AlarmCleared);
        self.update(tell);
    }

    fn update(&mut self, tell: &mut impl FnMut(Change)) {
        let enabled = self.is_enabled();
        // Whoever switches it off meanwhile ends the braking for good.
        self.braking &= enabled;
        if enabled != self.was_enabled {
            self.was_enabled = enabled;
            tell(Change::Enabled(enabled));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORCED: Trip = Trip { cause: AlarmCause::Forced, code: 9, resettable: true };

    fn after(act: impl FnOnce(&mut Servo, &mut dyn FnMut(Change))) -> (Servo, Vec<Change>) {
        let mut servo = Servo::power_on(Instant::ZERO, Duration::ZERO, false);
        let mut changes = Vec::new();
        act(&mut servo, &mut |change| changes.push(change));
        (servo, changes)
    }

    #[test]
    fn not_enabled_before_it_is_ready() {
        let mut servo = Servo::power_on(Instant::ZERO, Duration::from_secs(1), false);
        let mut changes = Vec::new();
        servo.want(true, false, &mut |change| changes.push(change));
        assert!(!servo.is_enabled());
        servo.advance(Instant::from_millis(1000), &mut |change| changes.push(change));
        assert_eq!(changes, [Change::Ready, Change::Enabled(true)]);
    }

    #[test]
    fn a_want_that_still_holds_enables_again_after_a_reset() {
        let (servo, changes) = after(|servo, mut tell| {
            servo.want(true, false, &mut tell);
            servo.trip(FORCED, false, &mut tell);
            assert_eq!(servo.reset(&mut tell), Ok(()));
        });
        let alarm = Change::Alarm { cause: AlarmCause::Forced, code: 9 };
        let want = [
            Change::Enabled(true),
            alarm,
            Change::Enabled(false),
            Change::AlarmCleared,
            Change::Enabled(true),
        ];
        assert_eq!((servo.is_enabled(), changes.as_slice()), (true, &want[..]));
    }

    #[test]
    fn no_reset_while_the_cause_stands_or_where_none_helps() {
        let (servo, _) = after(|servo, mut tell| {
            servo.set_active_causes(AlarmCauses::default().with(AlarmCause::Forced, true));
            servo.trip(FORCED, false, &mut tell);
            let stands = Err(Ignored::CauseStands(AlarmCause::Forced));
            assert_eq!(servo.reset(&mut tell), stands);
        });
        assert_eq!(servo.alarm(), Some(FORCED));
        let (servo, _) = after(|servo, mut tell| {
            servo.trip(Trip { resettable: false, ..FORCED }, false, &mut tell);
            let fixed = Err(Ignored::NotResettable(AlarmCause::Forced));
            assert_eq!(servo.reset(&mut tell), fixed);
        });
        assert!(servo.alarm().is_some());
    }

    #[test]
    fn what_is_inhibited_stays_on_and_is_not_switched_on() {
        let (servo, changes) = after(|servo, mut tell| {
            servo.inhibit(true, &mut tell);
            servo.want(true, false, &mut tell);
            assert!(!servo.is_enabled() && !servo.is_ready());
            assert_eq!(servo.why_off(), Ignored::Inhibited);
            servo.inhibit(false, &mut tell);
            assert!(servo.is_enabled());
            servo.inhibit(true, &mut tell);
            assert!(servo.is_enabled());
            servo.trip(FORCED, false, &mut tell);
            assert_eq!(servo.reset(&mut tell), Ok(()));
        });
        assert!(!servo.is_enabled());
        let enabled = changes.iter().filter(|it| matches!(it, Change::Enabled(_)));
        assert!(enabled.eq([&Change::Enabled(true), &Change::Enabled(false)]));
    }

    #[test]
    fn power_stays_on_until_it_has_braked() {
        let (servo, changes) = after(|servo, mut tell| {
            servo.want(true, false, &mut tell);
            servo.trip(FORCED, true, &mut tell);
            assert!(servo.is_enabled() && servo.is_braking() && !servo.is_ready());
            servo.braked(&mut tell);
        });
        let alarm = Change::Alarm { cause: AlarmCause::Forced, code: 9 };
        assert_eq!(changes, [Change::Enabled(true), alarm, Change::Enabled(false)]);
        assert!(!servo.is_enabled());
    }

    #[test]
    fn braking_ends_for_good() {
        for released in [true, false] {
            let (servo, _) = after(|servo, mut tell| {
                servo.want(true, false, &mut tell);
                servo.trip(FORCED, true, &mut tell);
                match released {
                    true => servo.want(true, true, &mut tell),
                    false => servo.trip(FORCED, false, &mut tell),
                }
                servo.want(true, false, &mut tell);
            });
            assert!(!servo.is_enabled() && !servo.is_braking());
        }
    }

    #[test]
    fn a_reset_of_one_cause_leaves_the_others() {
        let fixed = Trip { resettable: false, ..FORCED };
        let (servo, _) = after(|servo, mut tell| {
            assert_eq!(servo.reset_of(AlarmCause::Forced, &mut tell), Err(Ignored::NoAlarm));
            servo.trip(fixed, false, &mut tell);
            let other = Err(Ignored::OtherAlarm(AlarmCause::Forced));
            assert_eq!(servo.reset_of(AlarmCause::Encoder, &mut tell), other);
        });
        assert_eq!(servo.alarm(), Some(fixed));
        let (servo, _) = after(|servo, mut tell| {
            servo.trip(fixed, false, &mut tell);
            assert_eq!(servo.reset_of(AlarmCause::Forced, &mut tell), Ok(()));
        });
        assert_eq!(servo.alarm(), None);
    }
}
