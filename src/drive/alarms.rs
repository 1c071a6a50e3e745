//! What asks for the power stage of a drive, and its alarms: how the axis stops when one is raised, which ones were
//! raised before, and a cause of its own, the silence of the master.

use super::Drive;
use crate::behaviour::{CommandControl, LevelControl, PowerControl, Trip};
use crate::event::{Change, Ignored, Ordered};
use crate::model::AlarmStop;
use crate::vocabulary::{Action, AlarmCause, HomeEnd};

impl Drive {
    /// What asks for the power stage of this model: commands, where it has them, or signals alone.
    pub(super) fn power_control(&self) -> PowerControl {
        let wiring = &self.model.wiring;
        let is_order = |action: &Action| matches!(action, Action::Enable | Action::Release);
        let values = wiring.commands.iter().flat_map(|it| &it.actions).map(|(_, action)| action);
        let bits = wiring.triggers.iter().flat_map(|it| &it.actions).map(|(_, action)| action);
        let on = wiring.servo.enabled_at_power_on;
        match on || values.chain(bits).any(is_order) {
            true => PowerControl::Commands(CommandControl::new(on)),
            false => PowerControl::Levels(LevelControl::default()),
        }
    }

    /// Trips with `cause`, if the model has an alarm for it. Returns whether it has.
    pub(super) fn trip(&mut self, cause: AlarmCause) -> bool {
        let Some(alarm) = self.model.wiring.alarm(cause) else { return false };
        let trip = Trip { cause, code: alarm.code, resettable: alarm.resettable };
        let (is_first, was_braking) =
            (self.power_stage.alarm().is_none(), self.power_stage.is_braking());
        let brakes = alarm.stop != AlarmStop::Coast && self.motor.is_moving();
        self.motor.lose_origin(HomeEnd::Alarm);
        self.power_stage.trip(trip, brakes);
        self.report_power_stage();
        if is_first {
            self.remember(alarm.code);
        }
        if self.power_stage.is_braking() && !was_braking {
            self.brake(alarm.stop);
        }
        true
    }

    /// Trips with `cause` because of `order`, and says so where that has no effect: an alarm is active, and the axis
    /// stops for it as before. Returns whether the model has an alarm for it.
    pub(super) fn trip_by(&mut self, cause: AlarmCause, order: Option<Ordered>) -> bool {
        let (active, braking) = (self.power_stage.alarm().is_some(), self.power_stage.is_braking());
        let tripped = self.trip(cause);
        if let Some(order) =
            order.filter(|_| tripped && active && braking == self.power_stage.is_braking())
        {
            self.ignore(order, Ignored::Alarm);
        }
        tripped
    }

    /// Puts an alarm before those that were raised earlier. The oldest is lost where there is no room.
    fn remember(&mut self, code: u16) {
        let model = self.model.clone();
        let mut newer = u32::from(code);
        for row in &model.wiring.alarm_history {
            let older = self.bank.raw(*row);
            self.bank.preset(&model, *row, newer);
            newer = older;
        }
        self.memory.change(!model.wiring.alarm_history.is_empty());
    }

    /// Forgets the alarms that were raised earlier.
    pub(super) fn forget_alarms(&mut self) {
        let model = self.model.clone();
        model.wiring.alarm_history.iter().for_each(|row| self.bank.preset(&model, *row, 0));
        self.memory.change(true);
        self.changes.push_back(Change::AlarmHistoryCleared);
    }

    /// A master spoke to this drive: from now on it has the time in the row to speak again.
    pub(super) fn hear(&mut self) {
        let time = self.model.wiring.timeout.as_ref().and_then(|hold| self.time_in(hold));
        self.comms.hear(self.now, time);
    }

    /// Trips when no master has spoken in time. The next one who does starts the time anew.
    pub(super) fn end_silence(&mut self) {
        if self.comms.take_silence(self.now) {
            self.trip(AlarmCause::CommTimeout);
        }
    }
}
