//! Runs that last while a level asks for them: jogs, and runs and velocity segments by terminals.

use super::Drive;
use super::course::Course;
use super::settings::Moment;
use crate::behaviour::{Jog, Ramp};
use crate::vocabulary::{Input, Lasts, Setting};

/// What a level asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Level {
    pub(super) kind: LevelKind,
    reverse: bool,
    /// It goes the opposite way of what its signals say.
    turned: bool,
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

/// The velocity segment that its signal asks for.
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

    /// Does it ask for position control?
    pub(super) fn by_position(self) -> bool {
        self.kind == LevelKind::Inch
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
    /// The run that levels ask for, at the speed that counts. Levels that contradict each other ask for none.
    pub(super) fn wanted_run(&self) -> Option<(Level, Ramp)> {
        let level = self.level().filter(|_| !self.inputs.has(Input::ZeroSpeedClamp))?;
        let moment = match self.is_under_way(level) {
            true => Moment::UnderWay,
            false => self.order_moment(),
        };
        // Without a speed there is nothing to begin, and nothing to end again and again.
        let ramp = self.level_ramp(level, moment).filter(|ramp| ramp.speed != 0.0)?;
        Some((level, ramp))
    }

    /// What the axis is to hear of it.
    pub(super) fn jog(&self, run: Option<(Level, Ramp)>) -> Option<Jog> {
        run.map(|(level, ramp)| {
            let takes_over = !self.is_under_way(level);
            Jog { ramp, takes_over, by_position: level.by_position() }
        })
    }

    /// How a run goes that `level` asks for.
    pub(super) fn level_ramp(&self, level: Level, moment: Moment) -> Option<Ramp> {
        let axis = &self.model.wiring.axis;
        let settings = self.settings(&axis.settings, moment);
        let jog = |[speed, accel, decel]: [Setting; 3]| {
            let speed = settings.speed(speed).abs();
            let speed = if level.reverse != level.turned { -speed } else { speed };
            settings.ramp(speed, None, accel, decel)
        };
        Some(match level.kind {
            LevelKind::Jog => jog([Setting::JogSpeed, Setting::JogAccel, Setting::JogDecel]),
            LevelKind::Inch => jog([Setting::InchSpeed, Setting::InchAccel, Setting::InchDecel]),
            LevelKind::Run => settings.run(level.turned),
            LevelKind::Velocity(number) => {
                let rows = axis.segments.velocity.as_ref()?.get(number)?;
                self.settings(rows, moment).run(level.reverse != level.turned)
            }
        })
    }

    /// Does the axis run because of this level?
    fn is_under_way(&self, level: Level) -> bool {
        self.motor.phase().is_jogging() && self.course == Some(Course::Level(level))
    }

    /// Does the axis run because `input` asks for it?
    pub(super) fn runs_by(&self, input: Input) -> bool {
        let by = matches!(self.course, Some(Course::Level(level)) if level.input() == input);
        by && self.motor.phase().is_jogging()
    }

    /// Follows the level of `segment_run`, and the selection while it stands.
    pub(super) fn select_velocity(&mut self) {
        let active = self.inputs.has(Input::SegmentRun);
        match self.velocity {
            Some(it) if it.by_edge => {}
            before => {
                let lasts = || self.velocity_lasts() == Some(Lasts::Level);
                let by_level = active && (before.is_some() || lasts());
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
        let turned = has(Input::ReverseSpeed);
        let velocity = self.velocity.map(|it| {
            let kind = LevelKind::Velocity(it.number);
            Level { kind, reverse: has(Input::SegmentReverse), turned }
        });
        if self.velocity.is_some_and(|it| it.by_edge) {
            return velocity;
        }
        let level = |input, kind, reverse| has(input).then_some(Level { kind, reverse, turned });
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
