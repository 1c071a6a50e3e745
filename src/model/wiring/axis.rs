//! The axis that a drive moves, and the numbers that its motions and outputs go by.

use super::{Choice, Coded, InterruptWiring, Segments, SettingRow};
use crate::model::RowId;
use crate::time::Duration;
use crate::units::Unit;
use crate::vocabulary::{InhibitRule, LimitStop, Setting, SoftLimitRule};

/// The axis that the drive moves.
#[derive(Debug)]
pub struct AxisWiring {
    /// Counts for one revolution.
    pub counts_per_rev: Counts,
    /// Increments of the encoder for one revolution, where rows count them.
    pub encoder: Option<Counts>,
    /// How long it runs out without power.
    pub coast: Duration,
    /// How fast a move makes up for a deviation, 1/s; `None` where it has none.
    pub position_gain: Option<f64>,
    /// Pole pairs of the motor.
    pub pole_pairs: u16,
    /// While the row is not 0, positive counts go the machine's negative way.
    pub reversed: Option<RowId>,
    /// Between units of position and counts, where rows hold one.
    pub gear: Option<Gear>,
    /// What `rpm` in the units of rows stands for, in revolutions a minute, where a row says.
    pub speed_unit: Option<Coded<f64>>,
    /// The rows that motions go by.
    pub settings: Vec<SettingRow>,
    /// How many values of settings a drive keeps: one for each row of each setting, also of segments.
    pub slots: u16,
    /// Motions by number.
    pub segments: Segments,
    /// Interrupt positioning.
    pub interrupt: Option<InterruptWiring>,
    /// What becomes of what the axis is behind a command that is inhibited, where the model says.
    pub inhibit: Option<Choice<InhibitRule>>,
}

impl Default for AxisWiring {
    /// Nothing moves it.
    fn default() -> Self {
        let coast = Duration::from_millis(200);
        Self {
            counts_per_rev: Counts::Fixed(1),
            encoder: None,
            coast,
            position_gain: None,
            pole_pairs: 1,
            reversed: None,
            gear: None,
            speed_unit: None,
            settings: Vec::new(),
            slots: 0,
            segments: Segments::default(),
            interrupt: None,
            inhibit: None,
        }
    }
}

impl AxisWiring {
    /// Every row that it goes by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> + '_ {
        let counts = [Some(self.counts_per_rev), self.encoder].into_iter().flatten();
        let gear = self.gear.iter().flat_map(|it| [it.numerator, it.denominator]);
        counts
            .filter_map(Counts::row)
            .chain(gear)
            .chain(self.reversed)
            .chain(self.speed_unit.iter().map(|it| it.row))
            .chain(self.inhibit.iter().filter_map(Choice::row))
            .chain(self.settings.iter().map(|it| it.row))
            .chain(self.segments.rows())
            .chain(self.interrupt.iter().flat_map(InterruptWiring::rows))
    }

    /// The settings of all motions, those of segments too.
    pub fn all_settings(&self) -> impl Iterator<Item = &SettingRow> {
        let interrupt = self.interrupt.iter().flat_map(|it| &it.settings);
        self.settings.iter().chain(self.segments.settings()).chain(interrupt)
    }

    /// Gives each of all settings its slot.
    pub(in crate::model) fn number_slots(&mut self) {
        let interrupt = self.interrupt.iter_mut().flat_map(|it| &mut it.settings);
        let all = self.settings.iter_mut().chain(self.segments.settings_mut()).chain(interrupt);
        for (slot, setting) in (0..).zip(all) {
            setting.slot = slot;
            self.slots = slot + 1;
        }
    }

    /// The row that holds `setting`.
    pub fn setting(&self, setting: Setting) -> Option<RowId> {
        self.settings.iter().find(|it| it.setting == setting).map(|it| it.row)
    }
}

/// Counts or increments for one revolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counts {
    /// This many, not 0.
    Fixed(u32),
    /// As many as the row says. For counts it can't hold 0.
    Row(RowId),
}

impl Counts {
    /// The row that says how many, if one does.
    pub fn row(self) -> Option<RowId> {
        match self {
            Self::Fixed(_) => None,
            Self::Row(row) => Some(row),
        }
    }
}

/// The gear between units of position and counts: a unit is numerator by denominator counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gear {
    /// The row with the numerator, which can't hold 0.
    pub numerator: RowId,
    /// The row with the denominator, which can't hold 0.
    pub denominator: RowId,
}

/// A number that the model fixes, or that a row holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// One of this unit.
    Fixed(Unit),
    /// In the row's unit.
    Row(RowId),
}

impl Number {
    /// The row that holds it, if one does.
    pub fn row(self) -> Option<RowId> {
        match self {
            Self::Fixed(_) => None,
            Self::Row(row) => Some(row),
        }
    }
}

/// What limits do.
#[derive(Debug, Default)]
pub struct Limits {
    /// How the axis stops.
    pub stop: Option<Choice<LimitStop>>,
    /// When soft limits are in force; `None` is always.
    pub soft: Option<Choice<SoftLimitRule>>,
}

impl Limits {
    /// The rows that they go by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> + '_ {
        let stop = self.stop.as_ref().and_then(Choice::row);
        stop.into_iter().chain(self.soft.as_ref().and_then(Choice::row))
    }
}
