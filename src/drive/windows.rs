//! Outputs that hold a number of the axis against another one: computed when somebody looks.

use super::Drive;
use crate::model::Number;
use crate::words::{Output, Outputs, Threshold};

impl Drive {
    /// `outputs` with those that are about speeds.
    pub(super) fn with_speeds(&self, outputs: Outputs) -> Outputs {
        let (speed, ordered) = (self.rpm(), self.rpm_ordered());
        let limit = |it| self.threshold(it);
        let reached = limit(Threshold::ReachedSpeed).zip(limit(Threshold::ReachedWindow));
        let agrees = ordered.zip(limit(Threshold::AgreesWindow));
        let agrees = agrees.is_some_and(|(to, window)| (speed - to).abs() < window);
        let arrived = if ordered.is_some() { agrees } else { self.motor.is_in_position() };
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

    /// The number in the base unit of its dimension.
    fn threshold(&self, threshold: Threshold) -> Option<f64> {
        Some(match self.model.wiring.threshold(threshold)? {
            Number::Fixed(number) => number,
            Number::Row(row) => {
                self.bank.value(&self.model, row) as f64 * self.model.map.row(row).unit.scale
            }
        })
    }
}
