//! What rows say about a homing.

use super::settings::{Moment, TakenSettings};
use crate::behaviour::{HomeOrder, Slope};
use crate::drive::registers::Registers;
use crate::event::Ignored;
use crate::model::{Choice, Finish, HomingRules};
use crate::motion::Index;
use crate::time::Duration;
use crate::vocabulary::{HomeStarter, OriginPosition, Setting};

/// What happens at the origin where a model says nothing.
pub(super) const FINISH: Finish =
    Finish { go: false, position: OriginPosition::Zero, of_origin: false };

/// A homing that rows ask for.
pub(super) struct HomeRequest {
    /// Number of the method.
    pub(super) method: i64,
    pub(super) order: HomeOrder,
    pub(super) finish: Finish,
    /// What the time limit is multiplied by.
    pub(super) factor: i64,
}

impl HomeRequest {
    /// What rows ask for when `starter` starts it.
    ///
    /// # Errors
    /// Why they ask for none: a row wants another starter, or a row holds a number that stands for nothing.
    pub(super) fn read(
        registers: &Registers,
        taken: &TakenSettings,
        by: HomeStarter,
    ) -> Result<Self, Ignored> {
        let homing = registers.model().wiring.homing.as_ref().ok_or(Ignored::NoMeaning)?;
        if let Some(row) = homing.starter.as_ref().map(|it| it.row)
            && starter(registers) != Some(by)
        {
            return Err(Ignored::Starter { row, value: registers.value(row) });
        }
        let method = match homing.method {
            Some(row) => Some(registers.value(row)),
            None => homing.methods.keys().next().copied(),
        };
        let method = method.ok_or(Ignored::NoMeaning)?;
        let unsupported = homing.method.filter(|_| !homing.methods.contains_key(&method));
        if let Some(row) = unsupported {
            return Err(Ignored::Unsupported { row, value: method });
        }
        let finish = or(registers, &homing.finish, FINISH).ok_or(Ignored::NoMeaning)?;
        let factor = time_factor(registers, homing);
        let order = order(registers, homing, method).ok_or(Ignored::NoMeaning)?;
        let order = with_numbers(order, registers, taken, (finish, factor), Moment::Start);
        Ok(Self { method, order, finish, factor })
    }
}

/// What the homing under way goes by from now on: what happens at its end, by what its time limit is multiplied, and its order. Of its choices
/// those count at once of which the manual says so.
pub(super) fn retuned(
    registers: &Registers,
    taken: &TakenSettings,
    course: (Finish, i64),
    order: &HomeOrder,
) -> Option<(Finish, i64, HomeOrder)> {
    let homing = registers.model().wiring.homing.as_ref()?;
    let (finish, factor) = course;
    let finish = live(registers, &homing.finish, finish);
    let factor = match homing.time_factor.is_some_and(|it| registers.is_live(it.row)) {
        true => time_factor(registers, homing),
        false => factor,
    };
    let numbers = with_numbers(order.clone(), registers, taken, (finish, factor), Moment::UnderWay);
    let order = HomeOrder {
        limit: live(registers, &homing.limit, order.limit),
        source: live(registers, &homing.source, order.source),
        index: live(registers, &homing.index, order.index),
        ..numbers
    };
    Some((finish, factor, order))
}

/// What starts a homing, if a row says so.
pub(super) fn starter(registers: &Registers) -> Option<HomeStarter> {
    let starter = registers.model().wiring.homing.as_ref()?.starter.as_ref()?;
    starter.decode(registers.value(starter.row))
}

/// May an input signal start a homing?
pub(in crate::drive) fn may_start_by_input(registers: &Registers) -> bool {
    let homing = registers.model().wiring.homing.as_ref();
    let rule = homing.and_then(|homing| homing.starter.as_ref());
    rule.is_none() || starter(registers) == Some(HomeStarter::Input)
}

/// The order of method `number`, without what settings hold.
fn order(registers: &Registers, homing: &HomingRules, number: i64) -> Option<HomeOrder> {
    let every = registers.per_rev(registers.model().wiring.axis.counts_per_rev) as i64;
    Some(HomeOrder {
        method: *homing.methods.get(&number)?,
        fast: 0.0,
        slow: 0.0,
        accel: Slope::Rate(0.0),
        limit: or(registers, &homing.limit, HomingRules::LIMIT)?,
        source: or(registers, &homing.source, HomingRules::SOURCE)?,
        index: or(registers, &homing.index, HomingRules::INDEX)?,
        marks: Index { every, offset: 0 },
        stop: homing.stop,
        way: 0,
        collision: 0,
        time_limit: None,
    })
}

/// `order` with the numbers that settings hold.
fn with_numbers(
    order: HomeOrder,
    registers: &Registers,
    taken: &TakenSettings,
    (finish, factor): (Finish, i64),
    moment: Moment,
) -> HomeOrder {
    let settings = taken.axis(registers, moment);
    let time = settings.value(Setting::HomeTimeLimit).filter(|time| *time > 0.0);
    HomeOrder {
        fast: settings.speed(Setting::HomeFast).abs(),
        slow: settings.speed(Setting::HomeSlow).abs(),
        accel: settings.slope(Setting::HomeAccel).unwrap_or(Slope::Rate(0.0)),
        way: settings.way(Setting::HomeOffset).filter(|_| finish.go).unwrap_or(0),
        collision: settings.counts(Setting::HomeCollision).unwrap_or(0),
        time_limit: time.and_then(|it| Duration::try_from_secs_f64(it * factor as f64).ok()),
        ..order
    }
}

/// What the time limit is multiplied by.
fn time_factor(registers: &Registers, homing: &HomingRules) -> i64 {
    let factor = homing.time_factor.map(|it| it.of(registers.value(it.row)));
    factor.filter(|it| *it > 0).unwrap_or(1)
}

/// What a choice comes to that counts at once, as printed; otherwise, and where it comes to nothing, what it has come to.
fn live<T: Copy>(registers: &Registers, choice: &Option<Choice<T>>, before: T) -> T {
    let live = choice.as_ref().and_then(Choice::row).is_some_and(|row| registers.is_live(row));
    registers.chosen(choice).filter(|_| live).unwrap_or(before)
}

/// What a choice comes to, or `default` where there is none.
fn or<T: Copy>(registers: &Registers, choice: &Option<Choice<T>>, default: T) -> Option<T> {
    if choice.is_none() { Some(default) } else { registers.chosen(choice) }
}
