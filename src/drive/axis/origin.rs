//! The drive's coordinate: where its position register says 0, which way it counts, and its gear.

use crate::drive::registers::Registers;
use crate::model::Finish;
use crate::vocabulary::OriginPosition;

/// A unit of position is `numerator` by `denominator` counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ratio {
    numerator: i128,
    denominator: i128,
}

impl Ratio {
    /// The gear as its rows say, 1 to 1 without any.
    pub(super) fn of(registers: &Registers) -> Self {
        // No row of a gear takes 0; but what an older model has stored is not held against the range.
        let whole = |row| i128::from(registers.value(row).max(1));
        let gear = registers.model().wiring.axis.gear;
        let [numerator, denominator] =
            gear.map_or([1, 1], |it| [whole(it.numerator), whole(it.denominator)]);
        Self { numerator, denominator }
    }

    /// Units of position for so many counts: the last whole one reached.
    pub(super) fn units(self, counts: i64) -> i64 {
        saturated((i128::from(counts) * self.denominator).div_euclid(self.numerator))
    }

    /// Counts for so many units of position: the first at which that unit is reached.
    pub(super) fn counts(self, units: i64) -> i64 {
        saturated(-(-i128::from(units) * self.numerator).div_euclid(self.denominator))
    }
}

fn saturated(number: i128) -> i64 {
    number.clamp(i64::MIN.into(), i64::MAX.into()) as i64
}

/// Where the drive's coordinate lies in that of its motor.
#[derive(Debug)]
pub(super) struct Origin {
    /// Where the motor is when the position register says 0.
    pub(super) zero: i64,
    /// Do its positive counts go the machine's negative way? Then so do those of its motor.
    pub(super) reversed: bool,
    /// Revolutions of the encoder when its turns were cleared; a battery keeps them over power-off.
    pub(super) cleared_turns: i64,
    /// Has an origin been found since power came on?
    pub(super) found: bool,
    /// What the position is called whenever power comes on, in units of position: there is no absolute encoder.
    at_power_on: i64,
}

impl Origin {
    pub(super) fn new(at_power_on: i64) -> Self {
        Self { zero: 0, reversed: false, cleared_turns: 0, found: false, at_power_on }
    }

    /// Power comes on while the motor seems to be at `position`.
    pub(super) fn power_on(&mut self, gear: Ratio, position: i64) {
        self.found = false;
        self.zero = position.saturating_sub(gear.counts(self.at_power_on));
    }

    /// A position of the motor in units of the drive's coordinate.
    pub(super) fn shown(&self, gear: Ratio, position: i64) -> i64 {
        gear.units(position.saturating_sub(self.zero))
    }

    /// A position in units of the drive's coordinate, in that of the motor.
    pub(super) fn place(&self, gear: Ratio, position: i64) -> i64 {
        gear.counts(position).saturating_add(self.zero)
    }

    /// An origin was found: at `point` the position register says what `finish` makes of `coordinate`, in counts.
    pub(super) fn find(&mut self, finish: Finish, point: i64, coordinate: i64) {
        let says = |position: i64| point.saturating_sub(position);
        self.zero = match finish.position {
            OriginPosition::Coordinate => says(coordinate),
            OriginPosition::Zero => says(0),
            OriginPosition::MinusCoordinate => says(coordinate.saturating_neg()),
            OriginPosition::Kept => self.zero,
            OriginPosition::KeptPlus => self.zero.saturating_sub(coordinate),
            OriginPosition::KeptMinus => self.zero.saturating_add(coordinate),
        };
        self.found = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for (numerator, denominator) in [(1, 1), (3, 2), (7, 7), (65_535, 1), (10_000, 3_600)] {
            let gear = Ratio { numerator, denominator };
            for units in [0, 1, 2, 3, -1, -2, -3, 12_345, -2_147_483_648, 2_147_483_647] {
                assert_eq!(gear.units(gear.counts(units)), units, "{numerator}:{denominator}");
            }
        }
        // A unit that is less than a count can't be met.
        let fine = Ratio { numerator: 1, denominator: 10 };
        assert_eq!(
            [fine.counts(25), fine.units(3), fine.counts(-25), fine.units(-2)],
            [3, 30, -2, -20]
        );
    }
}
