//! Units as the manuals print them, and the dimension that each measures.
//!
//! A unit is a number and a symbol: `rpm`, `0.1 rpm`, `100 ms`. Only symbols listed here are known, so
//! that a typing error is found when the model is read and not when an axis runs ten times too fast.

use std::time::Duration;

/// What a number measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A count, a code, a set of bits: no unit.
    None,
    /// Position, in counts of the drive.
    Position,
    /// Position, in increments of the encoder.
    Increments,
    /// Counts for each revolution.
    Resolution,
    /// Speed of revolution.
    Speed,
    /// Change of speed with time.
    Acceleration,
    /// Durations, in seconds.
    Time,
    /// Part of a whole.
    Ratio,
    /// Angles, in degrees.
    Angle,
    /// Whole turns.
    Turns,
    /// Electric current.
    Current,
    /// Electric voltage.
    Voltage,
    /// Frequency of pulses.
    Frequency,
}

/// A unit: one of the known symbols, times a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub dimension: Dimension,
    /// How many base units of its dimension one step is (rpm, rpm/s, seconds, counts ...).
    pub scale: f64,
}

/// Symbol, dimension, base units for each.
const SYMBOLS: &[(&str, Dimension, f64)] = &[
    ("counts", Dimension::Position, 1.0),
    ("inc", Dimension::Increments, 1.0),
    ("counts/rev", Dimension::Resolution, 1.0),
    ("rpm", Dimension::Speed, 1.0),
    ("rpm/s", Dimension::Acceleration, 1.0),
    ("s", Dimension::Time, 1.0),
    ("ms", Dimension::Time, 1e-3),
    ("%", Dimension::Ratio, 0.01),
    ("deg", Dimension::Angle, 1.0),
    ("turn", Dimension::Turns, 1.0),
    ("mA", Dimension::Current, 1e-3),
    ("A", Dimension::Current, 1.0),
    ("V", Dimension::Voltage, 1.0),
    ("kHz", Dimension::Frequency, 1e3),
];

impl Unit {
    /// No unit.
    pub const NONE: Self = Self { dimension: Dimension::None, scale: 1.0 };

    /// Reads `rpm`, `0.1 rpm`, `100 ms`.
    pub fn parse(text: &str) -> Option<Self> {
        let (factor, symbol) = match text.split_once(' ') {
            Some((number, symbol)) => (number.parse::<f64>().ok()?, symbol.trim_matches(' ')),
            None => (1.0, text),
        };
        // Beyond this no row of 32 bits holds anything that a machine can have.
        if !(1e-9..=1e9).contains(&factor) {
            return None;
        }
        let (_, dimension, scale) = SYMBOLS.iter().find(|(name, ..)| *name == symbol)?;
        Some(Self { dimension: *dimension, scale: scale * factor })
    }

    /// The symbols that [`Unit::parse`] knows.
    pub fn symbols() -> impl Iterator<Item = &'static str> {
        SYMBOLS.iter().map(|(name, ..)| *name)
    }

    /// The symbols that measure `dimension`.
    pub fn symbols_of(dimension: Dimension) -> impl Iterator<Item = &'static str> {
        SYMBOLS
            .iter()
            .filter(move |(_, measured, _)| *measured == dimension)
            .map(|(name, ..)| *name)
    }

    /// `value` steps of this unit as a time, if it measures time and the value is not negative.
    pub fn duration(self, value: i64) -> Option<Duration> {
        if self.dimension != Dimension::Time {
            return None;
        }
        Duration::try_from_secs_f64(value as f64 * self.scale).ok()
    }
}

/// Reads a whole number as people write it: `100`, `-4`, `0x0C`, `0CH`. Only a decimal number has a sign.
pub fn parse_integer(text: &str) -> Option<i64> {
    let lower = text.to_ascii_lowercase();
    // A trailing H, as manuals write it; the digits stand for themselves.
    match lower.strip_prefix("0x").or_else(|| lower.strip_suffix('h')) {
        Some(hex) if hex.starts_with(['+', '-']) => None,
        Some(hex) => i64::from_str_radix(hex, 16).ok(),
        None => lower.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_a_factor_before_the_symbol() {
        assert_eq!(
            Unit::parse("100 ms").and_then(|u| u.duration(50)),
            Some(Duration::from_secs(5))
        );
        assert_eq!(Unit::parse("0.1 rpm").map(|u| u.scale), Some(0.1));
        for bad in ["", "rmp", "0 ms", "-1 s", "x ms", "1e999 s"] {
            assert_eq!(Unit::parse(bad), None, "{bad}");
        }
    }

    #[test]
    fn whole_numbers_as_people_write_them() {
        for (text, want) in [("100", 100), ("-4", -4), ("0x0C", 12), ("0CH", 12), ("ah", 10)] {
            assert_eq!(parse_integer(text), Some(want), "{text}");
        }
        for bad in ["", "h", "0x", "0x-5", "0x+5", "-5h", "1.5", "1e3", "NaN", "inf", "1 2"] {
            assert_eq!(parse_integer(bad), None, "{bad}");
        }
        assert_eq!(parse_integer("9223372036854775808"), None, "beyond 64 bits");
    }

    #[test]
    fn only_time_is_a_duration() {
        assert_eq!(Unit::parse("rpm").and_then(|u| u.duration(5)), None);
    }
}
