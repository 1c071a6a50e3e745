//! What rows say about motions, in counts.

use super::Drive;
use crate::behaviour::Ramp;
use crate::model::{Choice, Counts};
use crate::motion::Move;
use crate::units::{Dimension, Unit};
use crate::words::{RowId, Setting};

/// The rows that a motion goes by, and the drive that holds their values.
#[derive(Clone, Copy)]
pub(super) struct Settings<'a> {
    drive: &'a Drive,
    rows: &'a [(Setting, RowId)],
}

impl Drive {
    /// What `rows` say.
    pub(super) fn settings<'a>(&'a self, rows: &'a [(Setting, RowId)]) -> Settings<'a> {
        Settings { drive: self, rows }
    }

    /// What the rows of the axis say.
    pub(super) fn axis(&self) -> Settings<'_> {
        self.settings(&self.model.wiring.axis.settings)
    }

    /// What a choice comes to, if there is one.
    pub(super) fn chosen<T: Copy>(&self, choice: &Option<Choice<T>>) -> Option<T> {
        choice.as_ref()?.get(|row| self.bank.value(&self.model, row))
    }

    /// The unit of a row. That of a speed may be finer than the model says, where a row decides.
    pub fn unit_of(&self, row: RowId) -> Unit {
        let unit = self.model.map.row(row).unit;
        let rule = self.model.wiring.axis.speed_unit.as_ref();
        let rule = rule.filter(|_| unit.dimension == Dimension::Speed);
        let rpm = rule.and_then(|it| it.decode(self.bank.value(&self.model, it.row)));
        Unit { scale: unit.scale * rpm.unwrap_or(1.0), ..unit }
    }

    /// Counts for one revolution.
    pub(super) fn counts_per_rev(&self) -> f64 {
        self.per_rev(self.model.wiring.axis.counts_per_rev)
    }

    /// Increments of the encoder in counts. They are counts where a row has none of them in a revolution.
    pub(super) fn counts(&self, increments: f64) -> f64 {
        let per_rev = self.model.wiring.axis.encoder.map_or(0.0, |it| self.per_rev(it));
        if per_rev > 0.0 { increments * self.counts_per_rev() / per_rev } else { increments }
    }

    fn per_rev(&self, counts: Counts) -> f64 {
        match counts {
            Counts::Fixed(counts) => counts.into(),
            Counts::Row(row) => self.bank.value(&self.model, row) as f64,
        }
    }
}

impl Settings<'_> {
    /// How far, or where to, and how.
    pub(super) fn next_move(self) -> (i64, Move) {
        let target = self.value(Setting::MoveTarget).map_or(0.0, |(value, _)| value.round());
        let speed = self.speed(Setting::MoveSpeed).abs();
        let start = Some(Setting::MoveStartSpeed);
        let Ramp { accel, decel, start_speed, .. } =
            self.ramp(speed, start, Setting::MoveAccel, Setting::MoveDecel);
        (target as i64, Move { start_speed, speed, accel, decel })
    }

    /// How a run goes: at its speed, or the opposite.
    pub(super) fn run(self, reverse: bool) -> Ramp {
        let speed = self.speed(Setting::RunSpeed);
        let speed = if reverse { -speed } else { speed };
        self.ramp(speed, Some(Setting::RunStartSpeed), Setting::RunAccel, Setting::RunDecel)
    }

    /// Is the setting wired, and not 0?
    pub(super) fn is_set(self, setting: Setting) -> bool {
        self.value(setting).is_some_and(|(value, _)| value != 0.0)
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
        let change = (speed.abs() - start_speed).max(0.0);
        let accel = self.slope(accel, change);
        let decel = self.slope(decel, change).or(accel);
        let (accel, decel) = (accel.unwrap_or(0.0), decel.unwrap_or(0.0));
        Ramp { speed, accel, decel, start_speed }
    }

    /// What a row holds in counts, in units of position or in increments of the encoder.
    pub(super) fn counts(self, setting: Setting) -> Option<i64> {
        let (value, dimension) = self.value(setting)?;
        let counts = match dimension {
            Dimension::Increments => self.drive.counts(value),
            _ => value,
        };
        Some(counts.round() as i64)
    }

    /// Counts for what a row holds in units of position.
    pub(super) fn way(self, setting: Setting) -> Option<i64> {
        self.counts(setting).map(|units| self.drive.gear().counts(units))
    }

    /// Counts per second.
    pub(super) fn speed(self, setting: Setting) -> f64 {
        let rpm = self.value(setting).map_or(0.0, |(value, _)| value);
        counts_per_s(rpm, self.drive.counts_per_rev())
    }

    /// Counts per second squared.
    pub(super) fn slope(self, setting: Setting, change: f64) -> Option<f64> {
        let (value, dimension) = self.value(setting)?;
        Some(match dimension {
            Dimension::Time => change / value,
            _ => counts_per_s(value, self.drive.counts_per_rev()),
        })
    }

    /// The value of a setting in the base unit of its dimension.
    pub(super) fn value(self, setting: Setting) -> Option<(f64, Dimension)> {
        let (_, row) = *self.rows.iter().find(|(it, _)| *it == setting)?;
        let Drive { model, bank, .. } = self.drive;
        let unit = self.drive.unit_of(row);
        Some((bank.value(model, row) as f64 * unit.scale, unit.dimension))
    }
}

fn counts_per_s(rpm: f64, counts_per_rev: f64) -> f64 {
    rpm * counts_per_rev / 60.0
}
