//! Runs that last while a level asks for them: jogs, and runs and velocity segments by terminals.

use super::settings::{Moment, TakenSettings};
use crate::behaviour::Ramp;
use crate::drive::registers::Registers;
use crate::vocabulary::{Input, Inputs, Setting};

/// What a level asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) struct Level {
    kind: LevelKind,
    reverse: bool,
    /// It goes the opposite way of what its signals say.
    turned: bool,
}

/// Which settings a level goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LevelKind {
    Jog,
    Inch,
    Run,
    /// The velocity segment of this number.
    Velocity(u16),
}

/// The velocity segment that its signal asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) struct Velocity {
    pub(super) number: u16,
    /// It goes on when the signal falls.
    pub(super) by_edge: bool,
}

impl Level {
    /// What levels ask for while `inputs` are active, if they ask for one thing.
    pub(super) fn asked_for(inputs: Inputs, velocity: Option<Velocity>) -> Option<Self> {
        let turned = inputs.has(Input::ReverseSpeed);
        let by_segment = velocity.map(|it| {
            let kind = LevelKind::Velocity(it.number);
            Self { kind, reverse: inputs.has(Input::SegmentReverse), turned }
        });
        if velocity.is_some_and(|it| it.by_edge) {
            return by_segment;
        }
        let level =
            |input, kind, reverse| inputs.has(input).then_some(Self { kind, reverse, turned });
        let levels = [
            level(Input::JogPos, LevelKind::Jog, false),
            level(Input::JogNeg, LevelKind::Jog, true),
            level(Input::InchPos, LevelKind::Inch, false),
            level(Input::InchNeg, LevelKind::Inch, true),
            level(Input::Run, LevelKind::Run, false),
            by_segment,
        ];
        let mut levels = levels.into_iter().flatten();
        levels.next().filter(|_| levels.next().is_none())
    }

    /// The signal that asks for it.
    pub(in crate::drive) fn input(self) -> Input {
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

    /// How a run goes that it asks for.
    pub(super) fn ramp(
        self,
        registers: &Registers,
        taken: &TakenSettings,
        moment: Moment,
    ) -> Option<Ramp> {
        let axis = &registers.model().wiring.axis;
        let settings = taken.axis(registers, moment);
        let jog = |[speed, accel, decel]: [Setting; 3]| {
            let speed = settings.speed(speed).abs();
            let speed = if self.reverse != self.turned { -speed } else { speed };
            settings.ramp(speed, None, accel, decel)
        };
        Some(match self.kind {
            LevelKind::Jog => jog([Setting::JogSpeed, Setting::JogAccel, Setting::JogDecel]),
            LevelKind::Inch => jog([Setting::InchSpeed, Setting::InchAccel, Setting::InchDecel]),
            LevelKind::Run => settings.run(self.turned),
            LevelKind::Velocity(number) => {
                let rows = axis.segments.velocity.as_ref()?.get(number)?;
                taken.of(registers, rows, moment).run(self.reverse != self.turned)
            }
        })
    }
}
