//! How input signals act, and why one does not: what the log says of orders without effect.

use super::axis::{AxisView, may_home_by_input};
use super::context::DriveContext;
use super::view::View;
use crate::behaviour::{Control, Phase};
use crate::event::Ignored;
use crate::vocabulary::{Input, Inputs, RowId};

/// How an input signal acts.
pub(super) enum Acts {
    /// While active. Why it does not, if it does not.
    Level(Option<Ignored>),
    /// When it rises. Why it could not, if it rose now.
    Edge(Option<Ignored>),
    /// In a way that is told when it rises, or by itself not at all.
    Other,
}

/// How `input` acts as things are.
pub(super) fn acts(view: View<'_>, input: Input) -> Acts {
    let (axis, cx) = (view.axis(), view.axis().context());
    let edge = |may: Result<(), Ignored>| Acts::Edge(may.err().map(|why| cx.root_of(why)));
    match input {
        Input::ServoOn => Acts::Level((!cx.power.is_enabled()).then(|| cx.power.why_off())),
        Input::SegmentRun if axis.lasts_by_edge() => edge(axis.motor().may_start(false)),
        Input::HomeStart if !may_home_by_input(cx.registers) => Acts::Other,
        Input::HomeStart => edge(axis.motor().may_start(false)),
        Input::MoveStart | Input::SegmentStart => edge(axis.motor().may_move(false)),
        Input::InterruptStart => edge(axis.may_interrupt()),
        Input::ClearDeviation | Input::CommandInhibit => {
            Acts::Level(why_not_held_back(axis, input))
        }
        Input::AlarmReset => Acts::Edge(cx.power.may_reset().err()),
        _ if asks_for_run(input) => Acts::Level(why_no_run(axis, input)),
        _ => Acts::Other,
    }
}

/// Why `input` does not hold the command of the motion under way back, if there is one and it does not.
fn why_not_held_back(axis: AxisView<'_>, input: Input) -> Option<Ignored> {
    let by_position = axis.motor().control() == Some(Control::Position);
    match axis.motor().phase() {
        Phase::Homing => Some(Ignored::Homing),
        Phase::Jogging { .. } if by_position || input == Input::CommandInhibit => {
            Some(Ignored::Moving)
        }
        _ => None,
    }
}

/// Why the run that `input` asks for is not under way, if it is not.
fn why_no_run(axis: AxisView<'_>, input: Input) -> Option<Ignored> {
    let cx = axis.context();
    if axis.runs_by(input) {
        return None;
    }
    match axis.motor().may_start(false) {
        Err(Ignored::Moving) if axis.motor().phase().is_slowing() => {}
        Err(Ignored::Moving) if axis.motor().phase().is_jogging() => {}
        Err(why) => return Some(cx.root_of(why)),
        Ok(()) => {}
    }
    let Some(level) = axis.level() else {
        let alone = input == Input::SegmentRun && !axis.has_velocity_segment();
        return Some(if alone { Ignored::NoSegment } else { Ignored::Contradiction });
    };
    if level.input() != input {
        return Some(Ignored::Moving);
    }
    if cx.inputs.has(Input::ZeroSpeedClamp) {
        return Some(Ignored::Inhibited);
    }
    let Some((_, ramp)) = axis.wanted_run() else { return Some(Ignored::NoSpeed) };
    if axis.motor().is_jog_spent() {
        return Some(Ignored::Spent);
    }
    axis.motor().may_go(cx.now, ramp.speed).err()
}

/// Why another level on input terminal `index` has no effect on its signal, if it has none, while `before` were
/// active.
pub(super) fn why_no_signal(view: View<'_>, index: u8, before: Inputs) -> Option<Ignored> {
    let cx = view.axis().context();
    let terminals = cx.model().wiring.input_terminals.as_ref()?;
    let row = *terminals.functions.get(usize::from(index))?;
    let value = cx.registers.value(row);
    match terminals.meaning(cx.registers.raw(row)) {
        _ if !view.is_powered() => Some(Ignored::NoSupply),
        _ if view.inputs().is_stuck(index) => Some(Ignored::Stuck),
        None if is_absent(cx, row) => None,
        None => Some(Ignored::NoFunction { row, value }),
        Some(signal) => {
            (before.has(signal) == cx.inputs.has(signal)).then_some(Ignored::OtherSource(signal))
        }
    }
}

/// Does `row` give a terminal a function that is not simulated?
fn is_absent(cx: DriveContext<'_>, row: RowId) -> bool {
    let number = cx.registers.raw(row);
    cx.model().wiring.not_simulated.input_codes.iter().any(|(code, _)| u32::from(*code) == number)
}

/// Does it ask for a run as long as it is active?
pub(super) fn asks_for_run(input: Input) -> bool {
    matches!(
        input,
        Input::JogPos
            | Input::JogNeg
            | Input::InchPos
            | Input::InchNeg
            | Input::Run
            | Input::SegmentRun
    )
}
