//! Output signals: computed from what the axis and the power stage show.

use super::axis::AxisView;
use super::inputs::monitored;
use crate::behaviour::Control;
use crate::model::{Monitor, Shown};
use crate::vocabulary::{Input, Output, Outputs, Threshold};

impl Shown {
    /// Does it show as active while `outputs` are?
    pub(super) fn is_active(self, outputs: Outputs) -> bool {
        outputs.has(self.signal) != self.inverted
    }
}

/// The output signals of a drive that has supply.
pub(super) fn outputs(axis: AxisView<'_>) -> Outputs {
    let cx = axis.context();
    let enabled = cx.power.is_enabled();
    let [beyond_neg, beyond_pos] = axis.beyond_soft_limits();
    let motor = axis.motor();
    let segment = axis.segment();
    let user = cx.model().wiring.user_outputs.map_or(0, |row| cx.registers.raw(row));
    let outputs = Outputs::default()
        .with(Output::Powered, true)
        .with(Output::Ready, cx.power.is_ready())
        .with(Output::Enabled, enabled)
        .with(Output::Alarm, cx.power.alarm().is_some())
        .with(Output::BrakeOpen, enabled)
        .with(Output::Moving, motor.is_moving() || motor.speed(cx.now) != 0.0)
        .with(Output::HomeDone, axis.is_homed())
        .with(Output::AtLimitPos, cx.has(Input::LimitPos))
        .with(Output::AtLimitNeg, cx.has(Input::LimitNeg))
        .with(Output::BeyondPos, beyond_pos)
        .with(Output::BeyondNeg, beyond_neg)
        .with(Output::Selected0, cx.has(Input::Select0))
        .with(Output::Selected1, cx.has(Input::Select1))
        .with(Output::Selected2, cx.has(Input::Select2))
        .with(Output::Selected3, cx.has(Input::Select3))
        .with(Output::Segment0, segment & 1 != 0)
        .with(Output::Segment1, segment & 2 != 0)
        .with(Output::Segment2, segment & 4 != 0)
        .with(Output::Segment3, segment & 8 != 0)
        .with(Output::Segment4, segment & 16 != 0)
        .with(Output::User0, user & 1 != 0)
        .with(Output::User1, user >> 1 & 1 != 0)
        .with(Output::User2, user >> 2 & 1 != 0);
    with_positions(axis, with_speeds(axis, outputs))
}

/// `outputs` with those that are about speeds.
fn with_speeds(axis: AxisView<'_>, outputs: Outputs) -> Outputs {
    let (speed, ordered) = (axis.rpm(), axis.rpm_ordered());
    let limit = |it| axis.threshold(it);
    let reached = limit(Threshold::ReachedSpeed).zip(limit(Threshold::ReachedWindow));
    let agrees = ordered.zip(limit(Threshold::AgreesWindow));
    let agrees = agrees.is_some_and(|(to, window)| (speed - to).abs() < window);
    let settled = axis.is_settled();
    let arrived = if ordered.is_some() { agrees } else { settled };
    let from = limit(Threshold::CommandSpeed).unwrap_or(0.0);
    let present = match ordered {
        Some(to) => to.abs() > from,
        None => axis.motor().command_rate(axis.context().now) != 0.0,
    };
    outputs
        .with(Output::ZeroSpeed, speed.abs() <= limit(Threshold::ZeroSpeed).unwrap_or(0.0))
        .with(Output::Turning, limit(Threshold::TurningSpeed).is_some_and(|it| speed.abs() > it))
        .with(
            Output::SpeedReached,
            reached.is_some_and(|(to, window)| (speed.abs() - to).abs() <= window),
        )
        .with(Output::SpeedAgrees, agrees)
        .with(Output::Settled, settled)
        .with(Output::Arrived, arrived)
        .with(Output::CommandPresent, present)
}

/// `outputs` with those that are about positions.
fn with_positions(axis: AxisView<'_>, outputs: Outputs) -> Outputs {
    let now = axis.context().now;
    let deviation = axis.deviation().abs();
    let control = axis.motor().control();
    let follows = control == Some(Control::Position);
    let within = |it| follows && axis.threshold(it).is_some_and(|window| deviation <= window);
    let held = control.is_some() && axis.motor().is_held_back(now);
    let quarter = axis.seen_position().rem_euclid(4);
    let (active, done) = axis.interrupt_shows();
    outputs
        .with(Output::InPosition, axis.in_position_at().is_some_and(|at| at <= now))
        .with(Output::InterruptActive, active)
        .with(Output::InterruptDone, done)
        .with(Output::Coincides, within(Threshold::CoincidesWindow))
        .with(Output::Near, within(Threshold::NearWindow))
        .with(Output::TorqueLimited, held)
        .with(Output::EncoderA, quarter == 1 || quarter == 2)
        .with(Output::EncoderB, quarter >= 2)
        .with(Output::EncoderZ, axis.encoder_angle() == 0)
}

/// The output terminals of a drive whose `outputs` are active, as `monitor` shows them, bit by bit.
pub(super) fn monitor(axis: AxisView<'_>, outputs: Outputs, monitor: Monitor) -> u32 {
    let registers = axis.context().registers;
    let Some(terminals) = &registers.model().wiring.output_terminals else { return 0 };
    let mut active = 0;
    for (i, row) in terminals.functions.iter().enumerate() {
        let shown = terminals.meaning(registers.raw(*row));
        active |= u32::from(shown.is_some_and(|shown| shown.is_active(outputs))) << i;
    }
    monitored(monitor, active, registers.normally_closed(terminals), terminals)
}
