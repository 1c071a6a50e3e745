//! A fault rule as it is written: the reference of the format, in bench files and on the command line.

use super::FaultKind;
use serde::Deserialize;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// One rule. Of all rules of a line that hold for a request, the first acts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawFault {
    /// Its name in the log, and what its random numbers depend on besides the seed. Default: its kind, with a
    /// number behind it where that is taken.
    pub name: Option<String>,
    /// What it does.
    #[serde(rename = "do")]
    pub act: FaultKind,
    /// Only requests to this unit.
    pub unit: Option<u8>,
    /// Only requests with this function code, or with one of these.
    pub function: Option<RawFunctions>,
    /// Only requests that touch this register: an address, a span of addresses, or the name of a row.
    pub register: Option<RawFaultRegister>,
    /// Only from this second of emulated time on.
    pub from: Option<f64>,
    /// Only before this second of emulated time.
    pub until: Option<f64>,
    /// Let so many requests pass first.
    pub skip: Option<u64>,
    /// Then act on every so manieth: 2 is the 2nd, the 4th ...
    pub every: Option<u64>,
    /// Act with this probability, where it is a request's turn.
    pub probability: Option<f64>,
    /// Act so many times and no more.
    pub count: Option<u64>,
    /// `delay`: how long, in milliseconds; `50-200` draws it anew each time.
    pub ms: Option<RawMillis>,
    /// `exception`: its code.
    pub code: Option<u8>,
    /// `truncate`: how many bytes are cut off; one at least is left. `extra`, `garbage`: how many are
    /// added. Default 1.
    pub bytes: Option<u8>,
    /// `flip_bits`: how many; default 1.
    pub bits: Option<u8>,
    /// `split`: bytes in the first piece; default half of them.
    pub at: Option<u16>,
    /// `split`: milliseconds between the pieces; default 20.
    pub gap_ms: Option<u32>,
    /// `wrong_unit`, `wrong_function`: the number that the reply names; default the next one.
    pub to: Option<u8>,
}

/// One function code, or several.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(untagged, expecting = "expected a function code from 1 to 127, or a list of them")]
pub enum RawFunctions {
    /// One.
    One(u8),
    /// Several.
    Many(Vec<u8>),
}

/// Registers.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(
    untagged,
    expecting = "expected an address, a range such as 0x20-0x25, or the name of a register"
)]
pub enum RawFaultRegister {
    /// One address.
    Address(u16),
    /// A span, or the name of a row.
    Name(String),
}

/// A time in milliseconds.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(untagged, expecting = "expected milliseconds, or a range such as 50-200")]
pub enum RawMillis {
    /// Always the same.
    Fixed(u32),
    /// Drawn between two.
    Range(String),
}

/// Every key of a rule, for advice on unknown ones.
pub const KEYS: &[&str] = &[
    "at",
    "bits",
    "bytes",
    "code",
    "count",
    "do",
    "every",
    "from",
    "function",
    "gap_ms",
    "ms",
    "name",
    "probability",
    "register",
    "skip",
    "to",
    "unit",
    "until",
];
