//! What the motion under origin goes by, and how it follows when that changes.

use super::Drive;
use super::gear::Ratio;
use super::levels::Level;
use super::settings::Moment;
use crate::behaviour::{Phase, Ramp, Slope};
use crate::model::{Finish, SettingRow};
use crate::vocabulary::{Input, Setting};

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
    AxisWiring,
    /// Those of the position segment of this number.
    Segment(u16),
    /// Those of interrupt positioning.
    Interrupt,
}

impl MoveRows {
    /// The position segment.
    pub(super) fn segment(self) -> Option<u16> {
        match self {
            Self::Segment(number) => Some(number),
            Self::AxisWiring | Self::Interrupt => None,
        }
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
    /// Does it go the other origin?
    pub(super) reverse: bool,
}

impl MoveOrigin {
    /// Where a move ends, in counts of the machine, that goes `by` units of position.
    pub(super) fn target(&self, by: i64) -> i64 {
        let by = if self.reverse { by.saturating_neg() } else { by };
        self.gear.counts(self.from.saturating_add(by)).saturating_add(self.zero)
    }
}

impl Drive {
    /// Has the motion under origin go by what its settings say now.
    pub(super) fn follow_settings(&mut self) {
        if !self.motor.is_moving() {
            self.course = None;
            self.counts_per_rev = self.counts_asked_for();
        }
        match self.course {
            Some(Course::Run) => {
                let ramp = self.run_by_order(Moment::UnderWay);
                self.motor.retune_run(self.now, ramp);
            }
            Some(Course::Move { rows, origin }) => {
                let (by, ramp) = self.settings(self.move_rows(rows), Moment::UnderWay).next_move();
                self.motor.retune_move(self.now, origin.target(by), ramp);
            }
            Some(Course::Home { .. }) => self.follow_home_settings(),
            // What a level asks for is followed with the levels.
            Some(Course::Level(_) | Course::Alarm) | None => {}
        }
    }

    /// How a run by order goes: turned round, or kept at rest, while signals say so.
    pub(super) fn run_by_order(&self, moment: Moment) -> Ramp {
        let ramp = self.axis(moment).run(self.inputs.has(Input::ReverseSpeed));
        match self.inputs.has(Input::ZeroSpeedClamp) {
            true => Ramp { speed: 0.0, ..ramp },
            false => ramp,
        }
    }

    /// How the motion under origin slows down: as a stop that begins now would, or the one that has begun does.
    pub(super) fn decel(&self) -> Option<Slope> {
        let moment = match self.motor.phase() {
            Phase::Stopping => Moment::UnderWay,
            _ => Moment::Stop,
        };
        Some(match self.course? {
            Course::Run => self.axis(moment).run(false).decel,
            Course::Level(level) => self.level_ramp(level, moment)?.decel,
            Course::Move { rows, .. } => {
                let (_, Ramp { decel, .. }) =
                    self.settings(self.move_rows(rows), moment).next_move();
                decel
            }
            Course::Home { .. } => self.home_slope(),
            Course::Alarm => self.axis(moment).slope(Setting::AlarmDecel)?,
        })
    }

    /// The rows that a move goes by.
    pub(super) fn move_rows(&self, rows: MoveRows) -> &[SettingRow] {
        let axis = &self.model.wiring.axis;
        let segments = axis.segments.position.as_ref();
        let settings = match rows {
            MoveRows::AxisWiring => Some(&axis.settings),
            MoveRows::Segment(number) => {
                segments.and_then(|it| it.get(number)).map(|it| &it.settings)
            }
            MoveRows::Interrupt => axis.interrupt.as_ref().map(|it| &it.settings),
        };
        settings.map_or(&[], Vec::as_slice)
    }
}
