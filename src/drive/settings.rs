//! What rows say about motions, in counts, and from when on it counts.

use super::Drive;
use crate::behaviour::{Ramp, Slope};
use crate::model::{Applies, Choice, Counts, SettingRow};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{RowId, Setting, Taken};

/// When settings are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    /// A motion is ordered at a standstill.
    Start,
    /// A motion is ordered while another is under way.
    Order,
    /// A stop is ordered.
    Stop,
    /// A motion is under way, or none, and nothing is ordered.
    UnderWay,
}

impl Moment {
    /// Does the value count that the row word_watchdogs then? Otherwise one that it held before.
    fn takes(self, it: &SettingRow) -> bool {
        match (it.taken, self) {
            (Taken::Live, _) | (_, Self::Start) | (Taken::AtOrder, Self::Order) => true,
            (Taken::AtOrder, Self::Stop) => it.setting.slows_down(),
            (Taken::AtOrder | Taken::AtStart, _) => false,
        }
    }
}

/// The rows that a motion goes by, and the drive that word_watchdogs their values.
#[derive(Clone, Copy)]
pub(super) struct MotionSettings<'a> {
    drive: &'a Drive,
    rows: &'a [SettingRow],
    moment: Moment,
}

impl Drive {
    /// What `rows` say to somebody who looks at `moment`.
    pub(super) fn settings<'a>(
        &'a self,
        rows: &'a [SettingRow],
        moment: Moment,
    ) -> MotionSettings<'a> {
        MotionSettings { drive: self, rows, moment }
    }

    /// What the rows of the axis say to somebody who looks at `moment`.
    pub(super) fn axis(&self, moment: Moment) -> MotionSettings<'_> {
        self.settings(&self.model.wiring.axis.settings, moment)
    }

    /// The moment of an order that is issued now.
    pub(super) fn order_moment(&self) -> Moment {
        if self.motor.is_moving() { Moment::Order } else { Moment::Start }
    }

    /// From now on those values count that rows hold at `moment`.
    pub(super) fn take_settings(&mut self, moment: Moment) {
        let model = self.model.clone();
        for it in model.wiring.axis.all_settings().filter(|it| moment.takes(it)) {
            self.taken[usize::from(it.slot)] = self.in_row(it.row);
        }
    }

    /// What a choice comes to, if there is one.
    pub(super) fn chosen<T: Copy>(&self, choice: &Option<Choice<T>>) -> Option<T> {
        choice.as_ref()?.get(|row| self.bank.value(&self.model, row))
    }

    /// Does a value of `row` count at once, as printed?
    pub(super) fn is_live(&self, row: RowId) -> bool {
        self.model.map.row(row).applies == Some(Applies::Now)
    }

    /// The unit of a row. That of a speed may be finer than the model says, where a row decides.
    pub fn unit_of(&self, row: RowId) -> Unit {
        let unit = self.model.map.row(row).unit;
        let rule = self.model.wiring.axis.speed_unit.as_ref();
        let rule = rule.filter(|_| unit.dimension == Dimension::Speed);
        let rpm = rule.and_then(|it| it.decode(self.bank.value(&self.model, it.row)));
        Unit { scale: unit.scale * rpm.unwrap_or(1.0), ..unit }
    }

    /// Counts for one revolution, as its row says.
    pub(super) fn counts_asked_for(&self) -> f64 {
        self.per_rev(self.model.wiring.axis.counts_per_rev)
    }

    /// Increments of the encoder in counts. They are counts where a row has none of them in a revolution.
    pub(super) fn counts(&self, increments: f64) -> f64 {
        let per_rev = self.model.wiring.axis.encoder.map_or(0.0, |it| self.per_rev(it));
        if per_rev > 0.0 { increments * self.counts_per_rev / per_rev } else { increments }
    }

    fn per_rev(&self, counts: Counts) -> f64 {
        match counts {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => self.bank.value(&self.model, row) as f64,
        }
    }

    /// The value of a row in the base unit of its dimension.
    fn in_row(&self, row: RowId) -> f64 {
        self.bank.value(&self.model, row) as f64 * self.unit_of(row).scale
    }
}

impl MotionSettings<'_> {
    /// How far, or where to, and how.
    pub(super) fn next_move(self) -> (i64, Ramp) {
        let target = self.counts(Setting::MoveTarget).unwrap_or(0);
        let speed = self.speed(Setting::MoveSpeed).abs();
        let start = Some(Setting::MoveStartSpeed);
        (target, self.ramp(speed, start, Setting::MoveAccel, Setting::MoveDecel))
    }

    /// How a run goes: at its speed, or the opposite.
    pub(super) fn run(self, reverse: bool) -> Ramp {
        let speed = self.speed(Setting::RunSpeed);
        let speed = if reverse { -speed } else { speed };
        self.ramp(speed, Some(Setting::RunStartSpeed), Setting::RunAccel, Setting::RunDecel)
    }

    /// Is the setting wired, and not 0?
    pub(super) fn is_set(self, setting: Setting) -> bool {
        self.value(setting).is_some_and(|value| value != 0.0)
    }

    /// Slopes that reach `speed` from the start speed; what slows down is what speeds up where no row says
    /// more, and without either the speed changes at once.
    pub(super) fn ramp(
        self,
        speed: f64,
        start: Option<Setting>,
        accel: Setting,
        decel: Setting,
    ) -> Ramp {
        let start_speed = start.map_or(0.0, |start| self.speed(start).abs());
        let accel = self.slope(accel);
        let decel = self.slope(decel).or(accel);
        let [accel, decel] = [accel, decel].map(|it| it.unwrap_or(Slope::Rate(0.0)));
        Ramp { speed, accel, decel, start_speed }
    }

    /// What a row word_watchdogs in counts, in units of position or in increments of the encoder.
    pub(super) fn counts(self, setting: Setting) -> Option<i64> {
        let value = self.value(setting)?;
        let row = self.row(setting)?.row;
        let counts = match self.drive.model.map.row(row).unit.dimension {
            Dimension::Increments => self.drive.counts(value),
            _ => value,
        };
        Some(counts.round() as i64)
    }

    /// Counts for what a row word_watchdogs in units of position.
    pub(super) fn way(self, setting: Setting) -> Option<i64> {
        self.counts(setting).map(|units| self.drive.gear().counts(units))
    }

    /// Counts per second.
    pub(super) fn speed(self, setting: Setting) -> f64 {
        self.per_second(self.value(setting).unwrap_or(0.0))
    }

    /// How a speed changes, if a row says so.
    pub(super) fn slope(self, setting: Setting) -> Option<Slope> {
        let value = self.value(setting)?;
        let row = self.row(setting)?;
        Some(match self.drive.model.map.row(row.row).unit.dimension {
            Dimension::Time => Slope::Time(value),
            _ => Slope::Rate(self.per_second(value)),
        })
    }

    /// The value of a setting in the base unit of its dimension.
    pub(super) fn value(self, setting: Setting) -> Option<f64> {
        let it = self.row(setting)?;
        Some(match self.moment.takes(it) {
            true => self.drive.in_row(it.row),
            false => self.drive.taken[usize::from(it.slot)],
        })
    }

    fn row(&self, setting: Setting) -> Option<&SettingRow> {
        self.rows.iter().find(|it| it.setting == setting)
    }

    /// Revolutions a minute in counts per second.
    fn per_second(&self, rpm: f64) -> f64 {
        rpm * self.drive.counts_per_rev / 60.0
    }
}
