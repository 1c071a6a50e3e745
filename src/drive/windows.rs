//! Outputs that hold a number of the axis against another one: computed when somebody looks.

use super::Drive;
use crate::model::Number;
use crate::time::{Duration, Instant};
use crate::words::{Output, Outputs, Threshold};

impl Drive {
    /// `outputs` with those that are about speeds.
    pub(super) fn with_speeds(&self, outputs: Outputs) -> Outputs {
        let (speed, ordered) = (self.rpm(), self.rpm_ordered());
        let limit = |it| self.threshold(it);
        let reached = limit(Threshold::ReachedSpeed).zip(limit(Threshold::ReachedWindow));
        let agrees = ordered.zip(limit(Threshold::AgreesWindow));
        let agrees = agrees.is_some_and(|(to, window)| (speed - to).abs() < window);
        let arrived = if ordered.is_some() { agrees } else { self.is_in_position() };
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
            .with(Output::Arrived, arrived)
    }

    /// `outputs` with those that are about positions.
    pub(super) fn with_positions(&self, outputs: Outputs) -> Outputs {
        let deviation = self.motor.deviation(self.now).abs();
        let within = |it| self.threshold(it).is_some_and(|window| deviation <= window);
        outputs
            .with(Output::InPosition, self.is_in_position())
            .with(Output::Coincides, within(Threshold::CoincidesWindow))
            .with(Output::Near, within(Threshold::NearWindow))
    }

    fn is_in_position(&self) -> bool {
        self.in_position_at().is_some_and(|at| at <= self.now)
    }

    /// When the axis is, or will be, where its last move was to end, for as long as it takes to settle. That move
    /// has ended.
    pub(super) fn in_position_at(&self) -> Option<Instant> {
        let window = self.threshold(Threshold::PositionWindow).unwrap_or(0.0);
        let settle = self.threshold(Threshold::PositionSettle).unwrap_or(0.0);
        // Rows hold no times that are negative or beyond a few years.
        let settle = Duration::try_from_secs_f64(settle).unwrap_or_default();
        self.motor.arrives_at(self.now, window).map(|at| at + settle)
    }

    /// The number in the base unit of its dimension.
    fn threshold(&self, threshold: Threshold) -> Option<f64> {
        Some(match self.model.wiring.threshold(threshold)? {
            Number::Fixed(number) => number,
            Number::Row(row) => self.bank.value(&self.model, row) as f64 * self.unit_of(row).scale,
        })
    }
}
