//! What rows say about motions, in counts, and from when on it counts.

use super::origin::Ratio;
use crate::behaviour::{Ramp, Slope};
use crate::drive::registers::Registers;
use crate::model::{Number, SettingRow};
use crate::units::Dimension;
use crate::vocabulary::{Setting, Taken, Threshold};

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
    /// Does the value count that the row holds then? Otherwise one that it held before.
    fn takes(self, it: &SettingRow) -> bool {
        match (it.taken, self) {
            (Taken::Live, _) | (_, Self::Start) | (Taken::AtOrder, Self::Order) => true,
            (Taken::AtOrder, Self::Stop) => it.setting.slows_down(),
            (Taken::AtOrder | Taken::AtStart, _) => false,
        }
    }
}

/// The values of settings that count, as far as they are not those of the rows.
#[derive(Debug)]
pub(super) struct TakenSettings {
    /// By slot, in the base unit of each.
    taken: Vec<f64>,
    /// Counts for one revolution: what the row says when the axis stands.
    counts_per_rev: f64,
}

impl TakenSettings {
    /// Nothing was taken yet; there is room for so many.
    pub(super) fn new(slots: u16) -> Self {
        Self { taken: vec![0.0; slots.into()], counts_per_rev: 1.0 }
    }

    /// From now on those values count that rows hold at `moment`.
    pub(super) fn take(&mut self, registers: &Registers, moment: Moment) {
        let settings = registers.model().wiring.axis.all_settings();
        for it in settings.filter(|it| moment.takes(it)) {
            self.taken[usize::from(it.slot)] = registers.in_base_unit(it.row);
        }
    }

    /// The counts for one revolution are those that the row says.
    pub(super) fn take_counts_per_rev(&mut self, registers: &Registers) {
        self.counts_per_rev = registers.per_rev(registers.model().wiring.axis.counts_per_rev);
    }

    pub(super) fn counts_per_rev(&self) -> f64 {
        self.counts_per_rev
    }

    /// What `rows` say to somebody who looks at `moment`.
    pub(super) fn of<'a>(
        &'a self,
        registers: &'a Registers,
        rows: &'a [SettingRow],
        moment: Moment,
    ) -> MotionSettings<'a> {
        MotionSettings { registers, taken: self, rows, moment }
    }

    /// What the rows of the axis say to somebody who looks at `moment`.
    pub(super) fn axis<'a>(
        &'a self,
        registers: &'a Registers,
        moment: Moment,
    ) -> MotionSettings<'a> {
        self.of(registers, &registers.model().wiring.axis.settings, moment)
    }

    /// A threshold in the base unit of its dimension, increments in counts.
    pub(super) fn threshold(&self, registers: &Registers, threshold: Threshold) -> Option<f64> {
        let (value, unit) = match registers.model().wiring.threshold(threshold)? {
            Number::Fixed(number) => (1.0, number),
            Number::Row(row) => (registers.value(row) as f64, registers.unit_of(row)),
        };
        let value = value * unit.scale;
        Some(match unit.dimension {
            Dimension::Increments => self.counts(registers, value),
            _ => value,
        })
    }

    /// Revolutions a minute.
    pub(super) fn rpm(&self, counts_per_s: f64) -> f64 {
        counts_per_s * 60.0 / self.counts_per_rev
    }

    /// Increments of the encoder in counts. They are counts where a row has none of them in a revolution.
    fn counts(&self, registers: &Registers, increments: f64) -> f64 {
        let encoder = registers.model().wiring.axis.encoder;
        let per_rev = encoder.map_or(0.0, |it| registers.per_rev(it));
        if per_rev > 0.0 { increments * self.counts_per_rev / per_rev } else { increments }
    }
}

/// The rows that a motion goes by, and the values that count of them.
#[derive(Clone, Copy)]
pub(super) struct MotionSettings<'a> {
    registers: &'a Registers,
    taken: &'a TakenSettings,
    rows: &'a [SettingRow],
    moment: Moment,
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

    /// What a row holds in counts, in units of position or in increments of the encoder.
    pub(super) fn counts(self, setting: Setting) -> Option<i64> {
        let value = self.value(setting)?;
        let row = self.row(setting)?.row;
        let counts = match self.registers.model().map.row(row).unit.dimension {
            Dimension::Increments => self.taken.counts(self.registers, value),
            _ => value,
        };
        Some(counts.round() as i64)
    }

    /// Counts for what a row holds in units of position.
    pub(super) fn way(self, setting: Setting) -> Option<i64> {
        self.counts(setting).map(|units| Ratio::of(self.registers).counts(units))
    }

    /// Counts per second.
    pub(super) fn speed(self, setting: Setting) -> f64 {
        self.per_second(self.value(setting).unwrap_or(0.0))
    }

    /// How a speed changes, if a row says so.
    pub(super) fn slope(self, setting: Setting) -> Option<Slope> {
        let value = self.value(setting)?;
        let row = self.row(setting)?;
        Some(match self.registers.model().map.row(row.row).unit.dimension {
            Dimension::Time => Slope::Time(value),
            _ => Slope::Rate(self.per_second(value)),
        })
    }

    /// How a homing changes its speed.
    pub(super) fn home_slope(self) -> Slope {
        let [fast, slow] = [Setting::HomeFast, Setting::HomeSlow].map(|it| self.speed(it).abs());
        let slope = self.slope(Setting::HomeAccel).unwrap_or(Slope::Rate(0.0));
        Slope::Rate(slope.of(if fast > 0.0 { fast } else { slow }))
    }

    /// The value of a setting in the base unit of its dimension.
    pub(super) fn value(self, setting: Setting) -> Option<f64> {
        let it = self.row(setting)?;
        Some(match self.moment.takes(it) {
            true => self.registers.in_base_unit(it.row),
            false => self.taken.taken[usize::from(it.slot)],
        })
    }

    fn row(&self, setting: Setting) -> Option<&SettingRow> {
        self.rows.iter().find(|it| it.setting == setting)
    }

    /// Revolutions a minute in counts per second.
    fn per_second(&self, rpm: f64) -> f64 {
        rpm * self.taken.counts_per_rev / 60.0
    }
}
