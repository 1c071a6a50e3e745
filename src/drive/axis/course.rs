//! What the motion under way goes by.

use super::levels::Level;
use super::origin::Ratio;
use super::settings::{Moment, TakenSettings};
use crate::behaviour::{Phase, Slope};
use crate::drive::registers::Registers;
use crate::model::{Finish, Model, SettingRow};
use crate::vocabulary::Setting;

/// What a motion goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    /// The settings of runs, by order.
    Run,
    /// What a level asks for.
    Level(Level),
    /// Settings of a move.
    Move { rows: MoveRows, origin: MoveOrigin },
    /// The settings of a homing, with what happens at its end and by what its time limit is multiplied.
    Home { finish: Finish, factor: i64 },
    /// The stop after an alarm.
    Alarm,
}

/// Which settings a move goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MoveRows {
    /// Those of moves.
    Axis,
    /// Those of the position segment of this number.
    Segment(u16),
    /// Those of interrupt positioning.
    Interrupt,
}

impl MoveRows {
    /// The rows.
    pub(super) fn of(self, model: &Model) -> &[SettingRow] {
        let axis = &model.wiring.axis;
        let segments = axis.segments.position.as_ref();
        let settings = match self {
            Self::Axis => Some(&axis.settings),
            Self::Segment(number) => segments.and_then(|it| it.get(number)).map(|it| &it.settings),
            Self::Interrupt => axis.interrupt.as_ref().map(|it| &it.settings),
        };
        settings.map_or(&[], Vec::as_slice)
    }
}

/// Where the target of a move counts from, as it was when the move was ordered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MoveOrigin {
    /// In units of position.
    pub(super) from: i64,
    /// Where the position register says 0, in counts of the machine.
    pub(super) zero: i64,
    pub(super) gear: Ratio,
    /// Does it go the other way?
    pub(super) reverse: bool,
}

impl MoveOrigin {
    /// Where a move ends, in counts of the machine, that goes `by` units of position.
    pub(super) fn target(&self, by: i64) -> i64 {
        let by = if self.reverse { by.saturating_neg() } else { by };
        self.gear.counts(self.from.saturating_add(by)).saturating_add(self.zero)
    }
}

impl Course {
    /// How the motion slows down, which is in `phase`: as a stop that begins now would, or the one that has begun does.
    pub(super) fn decel(
        self,
        registers: &Registers,
        taken: &TakenSettings,
        phase: Phase,
    ) -> Option<Slope> {
        let moment = match phase {
            Phase::Stopping => Moment::UnderWay,
            _ => Moment::Stop,
        };
        let axis = taken.axis(registers, moment);
        Some(match self {
            Self::Run => axis.run(false).decel,
            Self::Level(level) => level.ramp(registers, taken, moment)?.decel,
            Self::Move { rows, .. } => {
                taken.of(registers, rows.of(registers.model()), moment).next_move().1.decel
            }
            Self::Home { .. } => taken.axis(registers, Moment::UnderWay).home_slope(),
            Self::Alarm => axis.slope(Setting::AlarmDecel)?,
        })
    }
}
