//! Runs that last while a level asks for them: jogs, and runs and velocity segments by terminals.

use super::Drive;
use crate::behaviour::{Phase, Ramp};
use crate::words::{Input, Lasts, Setting};

/// What a level asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Level {
    pub(super) kind: LevelKind,
    reverse: bool,
}

/// Which settings a level goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LevelKind {
    Jog,
    Inch,
    Run,
    /// The velocity segment of this number.
    Velocity(u16),
}

/// The velocity segment that was selected when its signal rose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Velocity {
    number: u16,
    /// It goes on when the signal falls.
    pub(super) by_edge: bool,
}

impl Level {
    /// The signal that asks for it.
    pub(super) fn input(self) -> Input {
        match (self.kind, self.reverse) {
            (LevelKind::Jog, false) => Input::JogPos,
            (LevelKind::Jog, true) => Input::JogNeg,
            (LevelKind::Inch, false) => Input::InchPos,
            (LevelKind::Inch, true) => Input::InchNeg,
            (LevelKind::Run, _) => Input::Run,
            (LevelKind::Velocity(_), _) => Input::SegmentRun,
        }
    }

    /// The velocity segment that it asks for.
    pub(super) fn segment(self) -> Option<u16> {
        match self.kind {
            LevelKind::Velocity(number) => Some(number),
            _ => None,
        }
    }
}

impl Drive {
    /// The run that levels ask for. Levels that contradict each other ask for none.
    ///
    /// A run that is under way keeps the ramp that it began with.
    pub(super) fn wanted_run(&self) -> Option<(Level, Ramp)> {
        let level = self.level()?;
        let jogs = matches!(self.motor.phase(), Phase::Jogging { .. });
        if let Some(present) = self.run.filter(|(it, _)| jogs && *it == level) {
            return Some(present);
        }
        let axis = &self.model.wiring.axis;
        let settings = self.settings(&axis.settings);
        let jog = |[speed, accel, decel]: [Setting; 3]| {
            let speed = settings.speed(speed).abs();
            let speed = if level.reverse { -speed } else { speed };
            settings.ramp(speed, None, accel, decel)
        };
        let ramp = match level.kind {
            LevelKind::Jog => jog([Setting::JogSpeed, Setting::JogAccel, Setting::JogDecel]),
            LevelKind::Inch => jog([Setting::InchSpeed, Setting::InchAccel, Setting::InchDecel]),
            LevelKind::Run => settings.run(false),
            LevelKind::Velocity(number) => {
                let rows = axis.segments.velocity.as_ref()?.get(number)?;
                self.settings(rows).run(level.reverse)
            }
        };
        // Without a speed there is nothing to begin, and nothing to end again and again.
        (ramp.speed != 0.0).then_some((level, ramp))
    }

    /// Does `run` take the place of another that is under way? That one ends first, or the axis would keep
    /// its speed where both go the same way.
    pub(super) fn changes_over(&self, run: Option<(Level, Ramp)>) -> bool {
        let jogs = matches!(self.motor.phase(), Phase::Jogging { .. });
        let kinds = [self.run, run].map(|run| run.map(|(level, _)| level.kind));
        jogs && kinds.iter().all(Option::is_some) && kinds[0] != kinds[1]
    }

    /// Follows the level of `segment_run`: which segment it is about is settled when it rises.
    pub(super) fn select_velocity(&mut self) {
        let active = self.inputs.has(Input::SegmentRun);
        match self.velocity {
            Some(it) if it.by_edge || active => {}
            _ => {
                let by_level = active && self.velocity_lasts() == Some(Lasts::Level);
                self.velocity = by_level.then(|| self.selected_velocity(false)).flatten();
            }
        }
    }

    /// How long a velocity segment lasts that begins now.
    pub(super) fn velocity_lasts(&self) -> Option<Lasts> {
        let segments = self.model.wiring.axis.segments.velocity.as_ref()?;
        segments.trigger.get(|row| self.bank.value(&self.model, row))
    }

    /// The velocity segment that is selected, if there is one.
    pub(super) fn selected_velocity(&self, by_edge: bool) -> Option<Velocity> {
        let segments = self.model.wiring.axis.segments.velocity.as_ref()?;
        let number = self.selected(segments.first);
        segments.get(number).map(|_| Velocity { number, by_edge })
    }

    /// What levels ask for, if they ask for one thing.
    pub(super) fn level(&self) -> Option<Level> {
        let has = |input| self.inputs.has(input);
        let velocity = self.velocity.map(|it| {
            let kind = LevelKind::Velocity(it.number);
            Level { kind, reverse: has(Input::SegmentReverse) }
        });
        if self.velocity.is_some_and(|it| it.by_edge) {
            return velocity;
        }
        let level = |input, kind, reverse| has(input).then_some(Level { kind, reverse });
        let levels = [
            level(Input::JogPos, LevelKind::Jog, false),
            level(Input::JogNeg, LevelKind::Jog, true),
            level(Input::InchPos, LevelKind::Inch, false),
            level(Input::InchNeg, LevelKind::Inch, true),
            level(Input::Run, LevelKind::Run, false),
            velocity,
        ];
        let mut levels = levels.into_iter().flatten();
        levels.next().filter(|_| levels.next().is_none())
    }
}
