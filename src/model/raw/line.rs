//! How the drive talks.

use super::{RawHold, RawOrder};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// How the drive talks: functions, limits, word order, refusals.
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
    /// How long the drive takes to begin its reply once that silence is over; default 0. It counts where
    /// a line paces replies.
    pub reply_after: Option<String>,
    /// Most registers in one read, 1..125; default 125.
    #[serde(default = "all_of_a_read")]
    pub max_read: u16,
    /// Most registers in one write, 1..123; default 123.
    #[serde(default = "all_of_a_write")]
    pub max_write: u16,
    /// Exception code that answers a frame with a wrong CRC. Default: no answer.
    pub crc_error: Option<u8>,
    /// How far the lengths inside a 0x10 request must agree; default `strict`.
    #[serde(default)]
    pub length_check: RawLengthCheck,
    /// Which word of a 32-bit pair stands at the lower address.
    pub word_order: RawWordOrder,
    /// May a request touch one word of a pair alone? default `any`.
    #[serde(default)]
    pub long_access: RawLongAccess,
    /// What reading a write-only row gives; default `refused`.
    #[serde(default)]
    pub write_only_reads: RawWriteOnlyReads,
    /// What reading an address without a row gives, where rows follow above it; default `refused`.
    #[serde(default)]
    pub unlisted_reads: RawUnlistedReads,
    /// How long the master may be silent: each request to this unit, refused or not, and each broadcast
    /// starts the time anew; at its end alarm `comm_timeout` is raised. Default: for ever.
    pub timeout: Option<RawHold>,
    /// Causes of refusal with the exception code that each answers with, tried top to bottom: of all
    /// the causes that hold, the first in this list answers.
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

/// Where the unit address comes from: switches if the model has them and they are not 0, else the
/// register, and if that holds 0 as well, `zero`.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawUnit {
    /// The row that holds the address.
    pub register: String,
    /// Number of DIP switches that can set the address; a bench sets them with `switches: N`, SW1 being its bit 0.
    pub switches: Option<u8>,
    /// The address when register and switches say 0; default 0, which hears broadcasts only.
    #[serde(default)]
    pub zero: u8,
}

/// The register that holds the baud rate.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBaud {
    /// The row.
    pub register: String,
    /// Which hex digit of it, from the right, from 0; default: the whole value.
    pub digit: Option<u8>,
    /// Bits per second by code.
    pub codes: BTreeMap<i64, u32>,
    /// Number of DIP switches above those of the address that hold the code in place of the row. With them the row does
    /// nothing, nor does that of `format`, which stays as it leaves the factory. Default: none.
    pub switches: Option<u8>,
}

/// The register that holds framing and character format.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawFormat {
    /// The row.
    pub register: String,
    /// Which hex digit of it, from the right, from 0; default: the whole value.
    pub digit: Option<u8>,
    /// `[ascii ]DPS` by code: data bits, parity N, E or O, stop bits (`8E1`, `ascii 7E1`).
    pub codes: BTreeMap<i64, String>,
}

/// How far the lengths inside a 0x10 request must agree.
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

/// Which word of a pair stands at the lower address: always the same, or as a register says.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawWordOrder {
    /// Always the same.
    #[serde(rename = "a string (high_word_first or low_word_first)")]
    Fixed(RawOrder),
    /// As a register says.
    #[serde(rename = "a map (register, codes)")]
    Register {
        /// The row.
        register: String,
        /// The order by value.
        codes: BTreeMap<i64, RawOrder>,
    },
}

/// May a request touch one word of a pair alone?
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawLongAccess {
    /// Yes; each word stands for itself.
    #[default]
    Any,
    /// No: cause `split_long`.
    Whole,
}

/// What reading a write-only row gives.
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

/// What reading an address without a row gives. A write to one, and a read beyond the last row, are refused in any case.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawUnlistedReads {
    /// 0, so that a block may reach across it.
    Zero,
    /// Cause `address`.
    #[default]
    Refused,
}
