//! Homing as its drive sees it: what rows say about it, and what the position register says when it is over.

use super::Drive;
use crate::behaviour::{HomeOrder, Stage};
use crate::event::{Change, Ignored, Ordered};
use crate::model::{Choice, Finish, Homing};
use crate::motion::Index;
use crate::time::Duration;
use crate::words::{
    Action, AlarmCause, HomeEnd, HomeStarter, Input, OriginPosition, RowId, Setting,
};

/// What happens at the origin where a model says nothing.
const FINISH: Finish = Finish { go: false, position: OriginPosition::Zero, of_origin: false };

impl Drive {
    /// Looks for the origin because `starter` says so.
    ///
    /// # Errors
    /// Why it does not: a row wants another starter, a row holds a number that stands for nothing, or the axis can't.
    pub(super) fn home(&mut self, starter: HomeStarter) -> Result<(), Ignored> {
        let model = self.model.clone();
        let Some(homing) = &model.wiring.homing else { return Err(Ignored::NoMeaning) };
        if let Some(row) = homing.starter.as_ref().map(|it| it.row)
            && self.home_starter() != Some(starter)
        {
            return Err(Ignored::Starter { row, value: self.bank.value(&model, row) });
        }
        let number = match homing.method {
            Some(row) => Some(self.bank.value(&model, row)),
            None => homing.methods.keys().next().copied(),
        };
        let number = number.ok_or(Ignored::NoMeaning)?;
        let unsupported = homing.method.filter(|_| !homing.methods.contains_key(&number));
        if let Some(row) = unsupported {
            return Err(Ignored::Unsupported { row, value: number });
        }
        let order = self.home_order(homing, number).ok_or(Ignored::NoMeaning)?;
        self.motor.start_home(self.now, order)?;
        (self.method, self.home_done) = (number, false);
        self.changes.push_back(Change::Homes { method: number });
        Ok(())
    }

    /// Looks for the origin if this is the first time that the power stage is on, and a row wants that.
    pub(super) fn home_at_first_enable(&mut self) {
        if self.never_enabled && self.servo.is_enabled() {
            self.never_enabled = false;
            if self.home_starter() == Some(HomeStarter::FirstEnable) {
                self.home_by(HomeStarter::FirstEnable);
            }
        }
    }

    /// May an input signal start a homing?
    pub(super) fn may_home_by_input(&self) -> bool {
        let homing = self.model.wiring.homing.as_ref();
        let starter = homing.and_then(|homing| homing.starter.as_ref());
        starter.is_none() || self.home_starter() == Some(HomeStarter::Input)
    }

    /// Looks for the origin, or tells why not.
    pub(super) fn home_by(&mut self, starter: HomeStarter) {
        let done = self.home(starter);
        self.tell_stages(None);
        match (starter, done) {
            (HomeStarter::Input, done) => self.heed(Input::HomeStart, done),
            (_, Err(why)) => self.ignore(Ordered::Action(Action::HomeStart), why),
            (_, Ok(())) => {}
        }
        self.settle();
    }

    /// Does what `stage` asks of the drive. Has that changed what is wanted of the axis?
    pub(super) fn follow_stage(&mut self, stage: Stage) -> bool {
        match stage {
            Stage::Homed(origin) => {
                self.finish_home(origin);
                true
            }
            Stage::Lost { why, forward, alarm } => {
                self.home_is_over();
                alarm
                    && self.trip(match (why, forward) {
                        (HomeEnd::TimeLimit, _) => AlarmCause::HomingTime,
                        (_, true) => AlarmCause::HomingLimitPos,
                        (_, false) => AlarmCause::HomingLimitNeg,
                    })
            }
            Stage::Deviates => self.trip(AlarmCause::PositionDeviation),
            _ => false,
        }
    }

    /// The value of `row` that has set off what is still at work.
    pub(super) fn at_work(&self, row: RowId) -> Option<u32> {
        let commands = self.model.wiring.commands.iter().find(|it| it.row == row)?;
        let start = commands.actions.iter().find(|(_, action)| *action == Action::HomeStart)?;
        self.motor.is_homing().then(|| self.model.map.row(row).kind.raw(start.0))
    }

    fn home_order(&self, homing: &Homing, number: i64) -> Option<HomeOrder> {
        let method = *homing.methods.get(&number)?;
        let fast = self.axis().speed(Setting::HomeFast).abs();
        let finish = self.finish(homing)?;
        let way = self.axis().way(Setting::HomeWay).filter(|_| finish.go);
        Some(HomeOrder {
            method,
            fast,
            slow: self.axis().speed(Setting::HomeSlow).abs(),
            accel: self.axis().slope(Setting::HomeAccel, fast).unwrap_or(0.0),
            limit: self.or(&homing.limit, Homing::LIMIT)?,
            source: self.or(&homing.source, Homing::SOURCE)?,
            index: self.or(&homing.index, Homing::INDEX)?,
            marks: Index { every: self.counts_per_rev() as i64, offset: 0 },
            stop: homing.stop,
            way: way.unwrap_or(0),
            collision: self.axis().counts(Setting::HomeCollision).unwrap_or(0),
            time_limit: self.home_time_limit(homing),
        })
    }

    fn home_time_limit(&self, homing: &Homing) -> Option<Duration> {
        let (seconds, _) =
            self.axis().value(Setting::HomeTimeLimit).filter(|(time, _)| *time > 0.0)?;
        let factor = homing.time_factor.map(|it| it.of(self.bank.value(&self.model, it.row)));
        let factor = factor.filter(|it| *it > 0).unwrap_or(1);
        Duration::try_from_secs_f64(seconds * factor as f64).ok()
    }

    fn home_starter(&self) -> Option<HomeStarter> {
        let starter = self.model.wiring.homing.as_ref()?.starter.as_ref()?;
        starter.decode(self.bank.value(&self.model, starter.row))
    }

    fn finish(&self, homing: &Homing) -> Option<Finish> {
        self.or(&homing.finish, FINISH)
    }

    /// What a choice comes to, or `default` where there is none.
    fn or<T: Copy>(&self, choice: &Option<Choice<T>>, default: T) -> Option<T> {
        if choice.is_none() { Some(default) } else { self.chosen(choice) }
    }

    /// The homing is done: the position register says from now on what it is set to say.
    fn finish_home(&mut self, origin: i64) {
        let model = self.model.clone();
        let finish = model.wiring.homing.as_ref().and_then(|homing| self.finish(homing));
        let finish = finish.unwrap_or(FINISH);
        let way = self.axis().way(Setting::HomeWay).unwrap_or(0);
        let goes_on = finish.go && !finish.of_origin;
        let point = if goes_on { origin.saturating_add(way) } else { origin };
        let coordinate = self.axis().way(Setting::HomeCoordinate).unwrap_or(0);
        let says = |position: i64| point.saturating_sub(position);
        self.zero = match finish.position {
            OriginPosition::Coordinate => says(coordinate),
            OriginPosition::Zero => says(0),
            OriginPosition::MinusCoordinate => says(coordinate.saturating_neg()),
            OriginPosition::Kept => self.zero,
            OriginPosition::KeptPlus => self.zero.saturating_sub(coordinate),
            OriginPosition::KeptMinus => self.zero.saturating_add(coordinate),
        };
        self.home_done = true;
        let position = self.wrapped(self.position());
        self.changes.push_back(Change::Homed { method: self.method, position });
        self.home_is_over();
    }

    /// Rows that started it say so no longer.
    fn home_is_over(&mut self) {
        for commands in &self.model.wiring.commands {
            let starts = |(_, action): &(i64, Action)| *action == Action::HomeStart;
            if self.model.map.row(commands.row).clears && commands.actions.iter().any(starts) {
                self.bank.set(commands.row, 0);
            }
        }
    }
}
