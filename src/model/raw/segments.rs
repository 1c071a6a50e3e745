//! Motions by number: tables of segments that signals select and start, and chains of them.

use super::{RawChoice, RawQuantity};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Motions by number, which signals select and start.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawSegments {
    /// Moves: `segment_start` starts the one selected.
    pub position: Option<RawPositionSegments>,
    /// Runs: `segment_run` starts the one selected.
    pub velocity: Option<RawVelocitySegments>,
}

/// Moves by number.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawPositionSegments {
    /// Numbers of the first and of the last.
    pub n: [u16; 2],
    /// What a segment goes by, out of the settings of a move, each with its row; `{n}` in the name of a row
    /// is the number of the segment.
    pub quantities: BTreeMap<String, RawQuantity>,
    /// Are targets ways or positions: `relative` (default), `absolute` or, for an empty segment, `none`. In the
    /// name of a row `{n}` is the number of the segment; a value without a code is an empty segment too.
    pub kind: Option<RawChoice<String>>,
    /// How one segment follows another. Left out: none does.
    pub chain: Option<RawChain>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// Runs by number.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawVelocitySegments {
    /// Numbers of the first and of the last.
    pub n: [u16; 2],
    /// What a segment goes by, out of the settings of a run, each with its row; `{n}` in the name of a row
    /// is the number of the segment.
    pub quantities: BTreeMap<String, RawQuantity>,
    /// Does a segment last while `segment_run` is active, `level` (default), or from its edge on, `edge`?
    pub trigger: Option<RawChoice<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// How one segment follows another. In the name of each row `{n}` is the number of the segment.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawChain {
    /// The row with the number of the next segment; a number that no segment has ends the chain.
    pub next: String,
    /// The row that says what a segment waits for. While it says nothing, the chain ends.
    pub rule: String,
    /// The conditions of a segment.
    pub conditions: Vec<RawChainCondition>,
    /// Condition by code; any other code is none.
    pub codes: BTreeMap<u8, String>,
    /// Unit of a condition's value, by condition (`ms`, `1000 counts`).
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Bit of the rule: wait for all conditions, not for the first. Left out: for the first.
    pub all: Option<u8>,
    /// Bit of the rule: go on as soon as the conditions are met, in motion too. Without conditions, go on in
    /// position. Left out: go on from standstill.
    pub through: Option<u8>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// A condition of a segment.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawChainCondition {
    /// Which hex digit of the rule has its code, from the right, from 0.
    pub digit: u8,
    /// The row with its value.
    pub value: String,
}

/// Interrupt positioning: a move that takes the place of a motion under way when `interrupt_start` rises.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawInterrupt {
    /// What it goes by, out of the settings of a move, each with its row; the target is a way.
    pub quantities: BTreeMap<String, RawQuantity>,
    /// May it start: `off`, `free` (default) or `locks`.
    pub rule: Option<RawChoice<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}
