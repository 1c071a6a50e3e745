//! Homing as its drive sees it: what rows say about it, and what the position register says when it is over.

use super::Drive;
use super::course::Course;
use super::settings::Moment;
use crate::behaviour::{Effect, HomeOrder, Slope};
use crate::event::{Change, Ignored, Ordered};
use crate::model::{Choice, Finish, HomingRules};
use crate::motion::Index;
use crate::time::Duration;
use crate::vocabulary::{
    Action, AlarmCause, HomeEnd, HomeStarter, Input, OriginPosition, RowId, Setting,
};

/// What happens at the origin where a model says nothing.
const FINISH: Finish = Finish { go: false, position: OriginPosition::Zero, of_origin: false };

impl Drive {
    /// Looks for the origin because `starter` says so.
    ///
    /// # Errors
    /// Why it does not: a row wants another starter, a row word_watchdogs a number that stands for nothing, or the axis can't.
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
        let finish = self.finish(homing).ok_or(Ignored::NoMeaning)?;
        let factor = self.home_time_factor(homing);
        let order = self.home_order(homing, number, finish, factor).ok_or(Ignored::NoMeaning)?;
        self.motor.start_home(self.now, order)?;
        self.take_settings(Moment::Start);
        self.course = Some(Course::Home { finish, factor });
        (self.method, self.home_done) = (number, false);
        self.changes.push_back(Change::Homes { method: number });
        Ok(())
    }

    /// Looks for the origin if this is the first time that the power stage is on, and a row wants that.
    pub(super) fn home_at_first_enable(&mut self) {
        if self.never_enabled && self.power_stage.is_enabled() {
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
        self.update_axis();
    }

    /// Does what `stage` asks of the drive. Has that changed what is wanted of the axis?
    pub(super) fn follow_stage(&mut self, stage: Effect) -> bool {
        match stage {
            Effect::HomingDone(origin) => {
                self.finish_home(origin);
                true
            }
            Effect::HomingAborted { why, forward, alarm } => {
                self.home_is_over();
                alarm
                    && self.trip(match (why, forward) {
                        (HomeEnd::TimeLimit, _) => AlarmCause::HomingTime,
                        (_, true) => AlarmCause::HomingLimitPos,
                        (_, false) => AlarmCause::HomingLimitNeg,
                    })
            }
            Effect::DeviationExceeded => self.trip(AlarmCause::PositionDeviation),
            Effect::Stopping | Effect::LimitReached { .. } => {
                self.take_settings(Moment::Stop);
                false
            }
            Effect::Replanned(_) | Effect::MovePaused | Effect::MoveResumed(_) => {
                self.look_at_places();
                false
            }
            _ => false,
        }
    }

    /// The value of `row` that has set off what is still at work.
    pub(super) fn at_work(&self, row: RowId) -> Option<u32> {
        let commands = self.model.wiring.commands.iter().find(|it| it.row == row)?;
        let start = commands.actions.iter().find(|(_, action)| *action == Action::HomeStart)?;
        self.motor.is_homing().then(|| self.model.map.row(row).kind.raw(start.0))
    }

    /// Has the homing under way go by what its settings say now. Of its choices those count at once of which
    /// the manual says so.
    pub(super) fn follow_home_settings(&mut self) {
        let model = self.model.clone();
        let (Some(homing), Some(order)) = (&model.wiring.homing, self.motor.home_order()) else {
            return;
        };
        let Some(Course::Home { finish, factor }) = self.course else { return };
        let finish = self.live(&homing.finish, finish);
        let factor = match homing.time_factor.is_some_and(|it| self.is_live(it.row)) {
            true => self.home_time_factor(homing),
            false => factor,
        };
        let order = HomeOrder {
            limit: self.live(&homing.limit, order.limit),
            source: self.live(&homing.source, order.source),
            index: self.live(&homing.index, order.index),
            ..self.home_numbers(order.clone(), finish, factor, Moment::UnderWay)
        };
        self.course = Some(Course::Home { finish, factor });
        self.motor.retune_home(self.now, order);
    }

    /// How a homing changes its speed.
    pub(super) fn home_slope(&self) -> Slope {
        let settings = self.axis(Moment::UnderWay);
        let [fast, slow] =
            [Setting::HomeFast, Setting::HomeSlow].map(|it| settings.speed(it).abs());
        let slope = settings.slope(Setting::HomeAccel).unwrap_or(Slope::Rate(0.0));
        Slope::Rate(slope.of(if fast > 0.0 { fast } else { slow }))
    }

    fn home_order(
        &self,
        homing: &HomingRules,
        number: i64,
        finish: Finish,
        factor: i64,
    ) -> Option<HomeOrder> {
        let order = HomeOrder {
            method: *homing.methods.get(&number)?,
            fast: 0.0,
            slow: 0.0,
            accel: Slope::Rate(0.0),
            limit: self.or(&homing.limit, HomingRules::LIMIT)?,
            source: self.or(&homing.source, HomingRules::SOURCE)?,
            index: self.or(&homing.index, HomingRules::INDEX)?,
            marks: Index { every: self.counts_asked_for() as i64, offset: 0 },
            stop: homing.stop,
            way: 0,
            collision: 0,
            time_limit: None,
        };
        Some(self.home_numbers(order, finish, factor, Moment::Start))
    }

    /// `order` with the numbers that settings hold.
    fn home_numbers(
        &self,
        order: HomeOrder,
        finish: Finish,
        factor: i64,
        moment: Moment,
    ) -> HomeOrder {
        let settings = self.axis(moment);
        let time = settings.value(Setting::HomeTimeLimit).filter(|time| *time > 0.0);
        HomeOrder {
            fast: settings.speed(Setting::HomeFast).abs(),
            slow: settings.speed(Setting::HomeSlow).abs(),
            accel: settings.slope(Setting::HomeAccel).unwrap_or(Slope::Rate(0.0)),
            way: settings.way(Setting::HomeWay).filter(|_| finish.go).unwrap_or(0),
            collision: settings.counts(Setting::HomeCollision).unwrap_or(0),
            time_limit: time.and_then(|it| Duration::try_from_secs_f64(it * factor as f64).ok()),
            ..order
        }
    }

    /// What the time limit is multiplied by.
    fn home_time_factor(&self, homing: &HomingRules) -> i64 {
        let factor = homing.time_factor.map(|it| it.of(self.bank.value(&self.model, it.row)));
        factor.filter(|it| *it > 0).unwrap_or(1)
    }

    /// What a choice comes to that counts at once, as printed; otherwise, and where it comes to nothing, what it
    /// has come to.
    fn live<T: Copy>(&self, choice: &Option<Choice<T>>, before: T) -> T {
        let live = choice.as_ref().and_then(Choice::row).is_some_and(|row| self.is_live(row));
        self.chosen(choice).filter(|_| live).unwrap_or(before)
    }

    fn home_starter(&self) -> Option<HomeStarter> {
        let starter = self.model.wiring.homing.as_ref()?.starter.as_ref()?;
        starter.decode(self.bank.value(&self.model, starter.row))
    }

    fn finish(&self, homing: &HomingRules) -> Option<Finish> {
        self.or(&homing.finish, FINISH)
    }

    /// What a choice comes to, or `default` where there is none.
    fn or<T: Copy>(&self, choice: &Option<Choice<T>>, default: T) -> Option<T> {
        if choice.is_none() { Some(default) } else { self.chosen(choice) }
    }

    /// The homing is done: the position register says from now on what it is set to say.
    fn finish_home(&mut self, origin: i64) {
        let finish = match self.course {
            Some(Course::Home { finish, .. }) => finish,
            _ => FINISH,
        };
        let settings = self.axis(Moment::UnderWay);
        let way = settings.way(Setting::HomeWay).unwrap_or(0);
        let goes_on = finish.go && !finish.of_origin;
        let point = if goes_on { origin.saturating_add(way) } else { origin };
        let coordinate = settings.way(Setting::HomeCoordinate).unwrap_or(0);
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
        let position = self.wrapped(self.position(self.now));
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
