//! The gear between units of position, in which registers and the log speak, and counts, in which the axis moves.

use super::Drive;

/// A unit of position is `numerator` by `denominator` counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ratio {
    numerator: i128,
    denominator: i128,
}

impl Ratio {
    /// Units of position for so many counts: the last whole one reached.
    pub(super) fn units(self, counts: i64) -> i64 {
        saturated((i128::from(counts) * self.denominator).div_euclid(self.numerator))
    }

    /// Counts for so many units of position: the first at which that unit is reached.
    pub(super) fn counts(self, units: i64) -> i64 {
        saturated(-(-i128::from(units) * self.numerator).div_euclid(self.denominator))
    }
}

impl Drive {
    /// The gear as its rows say, 1 to 1 without any.
    pub(super) fn gear(&self) -> Ratio {
        // No row of a gear takes 0; but what an older model has stored is not held against the range.
        let whole = |row| i128::from(self.bank.value(&self.model, row).max(1));
        let gear = self.model.wiring.axis.gear;
        let [numerator, denominator] =
            gear.map_or([1, 1], |it| [whole(it.numerator), whole(it.denominator)]);
        Ratio { numerator, denominator }
    }
}

fn saturated(number: i128) -> i64 {
    number.clamp(i64::MIN.into(), i64::MAX.into()) as i64
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
