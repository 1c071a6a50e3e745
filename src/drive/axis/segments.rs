//! Moves and runs by number: which one is selected, which one is next, and when a segment of a chain gives way.

use super::levels::Velocity;
use super::origin::{Origin, Ratio};
use crate::behaviour::{Chain, ChainRule, MOST_WAITS, Motor, Wait};
use crate::drive::context::DriveContext;
use crate::drive::registers::Registers;
use crate::event::Ignored;
use crate::model::{ChainLink, ChainRules};
use crate::time::Duration;
use crate::vocabulary::{Condition, Input, Inputs, Lasts, Target};

/// The segments that are active, and the chain.
#[derive(Debug, Default)]
pub(super) struct SegmentState {
    /// The velocity segment that is active.
    pub(super) velocity: Option<Velocity>,
    /// Number of the position segment that started last.
    pub(super) number: u16,
    pub(super) chain: Chain,
}

impl SegmentState {
    /// The position segment that comes next.
    pub(super) fn next(&self, cx: DriveContext<'_>) -> u16 {
        let Some(segments) = &cx.model().wiring.axis.segments.position else { return 0 };
        let link = segments.get(self.number).and_then(|it| it.link.as_ref());
        match link.filter(|_| self.chain.is_under_way()) {
            Some(link) => u16::try_from(cx.registers.value(link.next)).unwrap_or(u16::MAX),
            None => selected(cx.inputs, segments.first),
        }
    }

    /// Is a velocity segment active that goes on when its signal falls?
    pub(super) fn runs_by_edge(&self) -> bool {
        self.velocity.is_some_and(|it| it.by_edge)
    }

    /// Follows the level of `segment_run`, and the selection while that lasts.
    pub(super) fn select_velocity(&mut self, cx: DriveContext<'_>) {
        let active = cx.has(Input::SegmentRun);
        match self.velocity {
            Some(it) if it.by_edge => {}
            before => {
                let lasts = || velocity_lasts(cx.registers) == Some(Lasts::Level);
                let by_level = active && (before.is_some() || lasts());
                self.velocity = by_level.then(|| selected_velocity(cx, false)).flatten();
            }
        }
    }

    /// A segment of a chain begins. Returns whether the chain goes on, or was none.
    pub(super) fn begin(
        &mut self,
        cx: DriveContext<'_>,
        motor: &Motor,
        origin: &Origin,
        number: u16,
    ) -> bool {
        self.number = number;
        let Some(segments) = &cx.model().wiring.axis.segments.position else { return true };
        let link = segments.get(number).and_then(|it| it.link.as_ref());
        match (&segments.chain, link) {
            (Some(rules), Some(link)) => {
                let rule = chain_rule(cx, motor, origin, rules, link);
                self.chain.begin(cx.now, rule)
            }
            _ => true,
        }
    }
}

/// The number that is selected, where the first is `first`.
pub(super) fn selected(inputs: Inputs, first: u16) -> u16 {
    let selects = [Input::Select0, Input::Select1, Input::Select2, Input::Select3];
    let bit = |(bit, input)| u16::from(inputs.has(input)) << bit;
    selects.into_iter().enumerate().map(bit).fold(first, u16::saturating_add)
}

/// How long a velocity segment lasts that begins now.
pub(super) fn velocity_lasts(registers: &Registers) -> Option<Lasts> {
    registers.choose(&registers.model().wiring.axis.segments.velocity.as_ref()?.trigger)
}

/// The velocity segment that is selected, if there is one.
pub(super) fn selected_velocity(cx: DriveContext<'_>, by_edge: bool) -> Option<Velocity> {
    let segments = cx.model().wiring.axis.segments.velocity.as_ref()?;
    let number = selected(cx.inputs, segments.first);
    segments.get(number).map(|_| Velocity { number, by_edge })
}

/// What the target of position segment `number` is, if there is such a segment and it is not empty.
///
/// # Errors
/// There is none.
pub(super) fn target_of(registers: &Registers, number: u16) -> Result<Target, Ignored> {
    let segments = registers.model().wiring.axis.segments.position.as_ref();
    let segment = segments.and_then(|it| it.get(number)).ok_or(Ignored::NoSegment)?;
    registers.choose(&segment.kind).filter(|it| *it != Target::None).ok_or(Ignored::NoSegment)
}

/// What the rows of a segment say about when it gives way.
fn chain_rule(
    cx: DriveContext<'_>,
    motor: &Motor,
    origin: &Origin,
    rules: &ChainRules,
    link: &ChainLink,
) -> ChainRule {
    let raw = cx.registers.raw(link.rule);
    let is_set = |bit: Option<u8>| bit.is_some_and(|bit| raw >> bit & 1 != 0);
    let mut waits = [None; MOST_WAITS];
    for (slot, (i, condition)) in waits.iter_mut().zip(rules.conditions(raw)) {
        let value = rules.value(condition, cx.registers.value(link.values[i]));
        *slot = Some(match condition {
            Condition::Delay => {
                // Where it is more than there is time for, it never comes.
                let time = Duration::try_from_secs_f64(value.max(0.0));
                Wait::Delay(time.unwrap_or(Duration::MAX))
            }
            Condition::Step => Wait::Step,
            Condition::Position => {
                let place = origin.place(Ratio::of(cx.registers), value.round() as i64);
                Wait::Position { place, at: motor.reaches(cx.now, place) }
            }
        });
    }
    ChainRule { waits, all: is_set(rules.all), through: is_set(rules.through) }
}
