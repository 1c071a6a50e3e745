//! How the drive talks.

use super::{RawHold, RawOrder};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Communication: functions, limits, word order, refusals.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawLine {
    /// Function codes that the drive supports; a request with another one is refused with cause `function`.
    pub functions: Vec<u8>,
    /// Where the unit address comes from.
    pub unit: RawUnit,
    /// The register that holds the baud rate, and what its values mean.
    pub baud: RawBaud,
    /// The register that holds framing and character format.
    pub format: RawFormat,
    /// Characters of silence that end an RTU frame when framing is strict; default 3.5.
    #[serde(default = "three_and_a_half")]
    pub silence: f64,
    /// Reply delay after that silence, at most 10 s; default 0. Only lines with `pacing: line` apply it.
    pub reply_after: Option<String>,
    /// Most registers in one read, 1..125; default 125.
    #[serde(default = "all_of_a_read")]
    pub max_read: u16,
    /// Most registers in one write, 1..123; default 123.
    #[serde(default = "all_of_a_write")]
    pub max_write: u16,
    /// Exception code returned for a frame with a bad CRC, 1 to 127. Default: no reply.
    pub crc_error: Option<u8>,
    /// How strictly the lengths in a 0x10 request are checked; default `strict`.
    #[serde(default)]
    pub length_check: RawLengthCheck,
    /// Which word of a 32-bit pair is at the lower address.
    pub word_order: RawWordOrder,
    /// Whether a request may access a single word of a pair; default `any`.
    #[serde(default)]
    pub long_access: RawLongAccess,
    /// Result of reading a write-only row; default `refused`.
    #[serde(default)]
    pub write_only_reads: RawWriteOnlyReads,
    /// Result of reading an unmapped address below the last row; default `refused`.
    #[serde(default)]
    pub unlisted_reads: RawUnlistedReads,
    /// Communication watchdog: each request to this unit, refused or not, and each broadcast restarts it; when it
    /// expires, alarm `comm_timeout` is raised. Default: none.
    pub timeout: Option<RawHold>,
    /// Refusal causes with their exception codes, in order of priority: of all causes that apply, the first in this
    /// list is reported.
    pub refuse: Vec<BTreeMap<String, u8>>,
}

fn three_and_a_half() -> f64 {
    3.5
}

fn all_of_a_read() -> u16 {
    125
}

fn all_of_a_write() -> u16 {
    123
}

/// Where the unit address comes from: the switches if the model has them and they are not 0, else the register, and if
/// that is 0 as well, `zero`.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawUnit {
    /// The row that holds the address.
    pub register: String,
    /// Number of DIP switches that can set the address; a bench sets them with `switches: N`, SW1 being its bit 0.
    pub switches: Option<u8>,
    /// The address if register and switches are 0; default 0, which receives broadcasts only.
    #[serde(default)]
    pub zero: u8,
}

/// The register that holds the baud rate.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBaud {
    /// The row.
    pub register: String,
    /// Hex digit of the row, counted from the right from 0; default: the whole value.
    pub digit: Option<u8>,
    /// Baud rate by code, 50 to 4000000.
    pub codes: BTreeMap<i64, u32>,
    /// Number of DIP switches, above those of the address, that set the code in place of the row. With them the rows
    /// of `baud` and `format` have no effect, and the format is its factory value. Default: none.
    pub switches: Option<u8>,
}

/// The register that holds framing and character format.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawFormat {
    /// The row.
    pub register: String,
    /// Hex digit of the row, counted from the right from 0; default: the whole value.
    pub digit: Option<u8>,
    /// `[ascii ]DPS` by code: data bits, parity N, E or O, stop bits (`8E1`, `ascii 7E1`).
    pub codes: BTreeMap<i64, String>,
}

/// How strictly the lengths in a 0x10 request are checked.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawLengthCheck {
    /// Byte count, register count and data must agree, else cause `length`.
    #[default]
    Strict,
    /// The register count decides; byte count and surplus data are ignored.
    CountOnly,
}

/// Which word of a pair is at the lower address: fixed, or selected by a register.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawWordOrder {
    /// Fixed.
    #[serde(rename = "a string (high_word_first or low_word_first)")]
    Fixed(RawOrder),
    /// Selected by a register.
    #[serde(rename = "a map (register, codes)")]
    Register {
        /// The row.
        register: String,
        /// The order by value.
        codes: BTreeMap<i64, RawOrder>,
    },
}

/// Whether a request may access a single word of a pair.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawLongAccess {
    /// Yes; words are accessed individually.
    #[default]
    Any,
    /// No: cause `split_long`.
    Whole,
}

/// Result of reading a write-only row.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawWriteOnlyReads {
    /// Always 0.
    Zero,
    /// Cause `write_only`.
    #[default]
    Refused,
}

/// Result of reading an unmapped address. A write to one, and a read above the last row, are always refused.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawUnlistedReads {
    /// 0, so that block reads can span gaps.
    Zero,
    /// Cause `address`.
    #[default]
    Refused,
}
