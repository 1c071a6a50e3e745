//! Serial settings as people write them: `9600-8N2`.

use crate::time::Duration;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// Speed and character format of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Bits per second.
    pub baud: u32,
    /// The shape of a character.
    pub format: Format,
}

/// How a serial line talks: its transmission mode (serial line, 2.5), speed and format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mode {
    /// ASCII instead of RTU.
    pub ascii: bool,
    /// Speed and format.
    pub settings: Settings,
}

/// The shape of a character: `8N1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Format {
    /// 7 or 8.
    pub data_bits: u8,
    /// None, even or odd.
    pub parity: Parity,
    /// 1 or 2.
    pub stop_bits: u8,
}

/// Parity of a character.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// No parity bit.
    None,
    /// The parity bit makes the number of ones even.
    Even,
    /// The parity bit makes the number of ones odd.
    Odd,
}

impl Parity {
    /// `N`, `E` or `O`.
    pub fn letter(self) -> char {
        match self {
            Self::None => 'N',
            Self::Even => 'E',
            Self::Odd => 'O',
        }
    }
}

impl Format {
    /// Bits of one character on the wire: start, data, parity, stop.
    pub fn bits(self) -> u32 {
        let parity = u32::from(self.parity != Parity::None);
        1 + u32::from(self.data_bits) + parity + u32::from(self.stop_bits)
    }
}

impl Settings {
    /// What the standard asks of every device (serial line, 2.5.1): 19200-8E1.
    pub const STANDARD: Self =
        Self { baud: 19_200, format: Format { data_bits: 8, parity: Parity::Even, stop_bits: 1 } };

    /// Time that `characters` take on the wire.
    pub fn characters(self, characters: f64) -> Duration {
        Duration::from_secs_f64(characters * f64::from(self.format.bits()) / f64::from(self.baud))
    }

    /// Silence that ends an RTU frame: `characters` of it, and above 19200 baud never less than half
    /// of what it is there (serial line, 2.5.1.1: 1.75 ms for t3.5).
    pub fn silence(self, characters: f64) -> Duration {
        let floor = Duration::from_secs_f64(0.000_5 * characters);
        if self.baud > 19_200 {
            self.characters(characters).max(floor)
        } else {
            self.characters(characters)
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}{}", self.data_bits, self.parity.letter(), self.stop_bits)
    }
}

impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.baud, self.format)
    }
}

impl fmt::Display for Mode {
    /// `9600-8N2 RTU`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.settings, if self.ascii { "ASCII" } else { "RTU" })
    }
}

/// As people write it.
macro_rules! serialize_as_text {
    ($type:ident, $pattern:literal) => {
        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        #[cfg(feature = "cli")]
        impl schemars::JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({ "type": "string", "pattern": $pattern })
            }
        }
    };
}

serialize_as_text!(Settings, "^[0-9]+-[78][NEO][12]$");
serialize_as_text!(Mode, "^[0-9]+-[78][NEO][12] (RTU|ASCII)$");

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || {
            format!("`{text}` is not a character format; write data bits, parity, stop bits: 8N1")
        };
        let &[data, parity, stop] = text.as_bytes() else { return Err(bad()) };
        let parity = match parity {
            b'N' => Parity::None,
            b'E' => Parity::Even,
            b'O' => Parity::Odd,
            _ => return Err(bad()),
        };
        match (data, stop) {
            (b'7' | b'8', b'1' | b'2') => {
                Ok(Self { data_bits: data - b'0', parity, stop_bits: stop - b'0' })
            }
            _ => Err(bad()),
        }
    }
}

impl FromStr for Settings {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad =
            || format!("`{text}` is not a line setting; write baud rate and format: 9600-8N2");
        let (baud, format) = text.split_once('-').ok_or_else(bad)?;
        let baud = baud.parse().ok().filter(|baud| *baud > 0).ok_or_else(bad)?;
        Ok(Self { baud, format: format.parse()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(baud: u32, format: &str) -> Settings {
        Settings { baud, format: format.parse().expect("a format") }
    }

    #[test]
    fn silence_in_time() {
        let table = [
            (9600, "8N2", 3.5, 4_010_416),
            (19200, "8E1", 3.5, 2_005_208),
            (115_200, "8N1", 3.5, 1_750_000),
            (9600, "7E1", 4.0, 4_166_666),
        ];
        for (baud, format, characters, ns) in table {
            let got = settings(baud, format).silence(characters).as_nanos();
            assert!(got.abs_diff(ns) <= 1, "{baud}-{format}: {got}");
        }
    }

    #[test]
    fn there_and_back() {
        for format in ["8N1", "8N2", "7E1", "8O1"] {
            assert_eq!(format.parse::<Format>().map(|f| f.to_string()), Ok(format.to_string()));
        }
        for bad in ["", "8N", "9N1", "8X1", "8N3", "8n1", "８N1"] {
            assert!(bad.parse::<Format>().is_err(), "{bad}");
        }
    }
}
