//! Outputs that hold a number of the axis against another one: computed when somebody looks.

use super::Drive;
use crate::behaviour::Control;
use crate::model::Number;
use crate::time::{Duration, Instant};
use crate::units::Dimension;
use crate::vocabulary::{Output, Outputs, Threshold};

impl Drive {
    /// `outputs` with those that are about speeds.
    pub(super) fn with_speeds(&self, now: Instant, outputs: Outputs) -> Outputs {
        let (speed, ordered) = (self.rpm(now), self.rpm_ordered());
        let limit = |it| self.threshold(it);
        let reached = limit(Threshold::ReachedSpeed).zip(limit(Threshold::ReachedWindow));
        let agrees = ordered.zip(limit(Threshold::AgreesWindow));
        let agrees = agrees.is_some_and(|(to, window)| (speed - to).abs() < window);
        let settled = self.is_settled(now);
        let arrived = if ordered.is_some() { agrees } else { settled };
        let from = limit(Threshold::CommandSpeed).unwrap_or(0.0);
        let present = match ordered {
            Some(to) => to.abs() > from,
            None => self.motor.command_rate(now) != 0.0,
        };
        outputs
            .with(Output::ZeroSpeed, speed.abs() <= limit(Threshold::ZeroSpeed).unwrap_or(0.0))
            .with(
                Output::Turning,
                limit(Threshold::TurningSpeed).is_some_and(|it| speed.abs() > it),
            )
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
    pub(super) fn with_positions(&self, now: Instant, outputs: Outputs) -> Outputs {
        let deviation = self.deviation_seen(now).abs();
        let control = self.motor.control();
        let follows = control == Some(Control::Position);
        let within = |it| follows && self.threshold(it).is_some_and(|window| deviation <= window);
        let held = control.is_some() && self.motor.is_held_back(now);
        let encoder = self.seen_position(now);
        let quarter = encoder.rem_euclid(4);
        let (active, done) = self.interrupt_shows(now);
        outputs
            .with(Output::InPosition, self.is_in_position(now))
            .with(Output::InterruptActive, active)
            .with(Output::InterruptDone, done)
            .with(Output::Coincides, within(Threshold::CoincidesWindow))
            .with(Output::Near, within(Threshold::NearWindow))
            .with(Output::TorqueLimited, held)
            .with(Output::EncoderA, quarter == 1 || quarter == 2)
            .with(Output::EncoderB, quarter >= 2)
            .with(Output::EncoderZ, self.encoder_angle(now) == 0)
    }

    /// Counts that the encoder is behind the command: of a frozen one all that it has missed, in position control.
    pub(super) fn deviation_seen(&self, now: Instant) -> f64 {
        let deviation = self.motor.deviation(now);
        match self.motor.control() {
            Some(Control::Position) => {
                let missed = self.motor.position(now).saturating_sub(self.seen_position(now));
                deviation + missed as f64
            }
            _ => deviation,
        }
    }

    fn is_in_position(&self, now: Instant) -> bool {
        self.in_position_at(now).is_some_and(|at| at <= now)
    }

    /// Is the command at rest in position control, and the axis with it for as long as it takes to update_axis?
    fn is_settled(&self, now: Instant) -> bool {
        let at = self.motor.rests_at(now, self.position_window());
        let follows = self.motor.control() == Some(Control::Position);
        follows && at.is_some_and(|at| at + self.settling_time() <= now)
    }

    /// When the axis is, or will be, where its last move was to end, for as long as it takes to update_axis. That move
    /// has ended.
    pub(super) fn in_position_at(&self, now: Instant) -> Option<Instant> {
        let at = self.motor.arrives_at(now, self.position_window())?;
        Some(at + self.settling_time())
    }

    fn position_window(&self) -> f64 {
        self.threshold(Threshold::PositionWindow).unwrap_or(0.0)
    }

    fn settling_time(&self) -> Duration {
        let update_axis = self.threshold(Threshold::PositionSettle).unwrap_or(0.0);
        // Rows hold no times that are negative or beyond a few years.
        Duration::try_from_secs_f64(update_axis).unwrap_or_default()
    }

    /// The number in the base unit of its dimension, increments in counts.
    pub(super) fn threshold(&self, threshold: Threshold) -> Option<f64> {
        let (value, unit) = match self.model.wiring.threshold(threshold)? {
            Number::Fixed(number) => (1.0, number),
            Number::Row(row) => (self.bank.value(&self.model, row) as f64, self.unit_of(row)),
        };
        let value = value * unit.scale;
        Some(if unit.dimension == Dimension::Increments { self.counts(value) } else { value })
    }
}
