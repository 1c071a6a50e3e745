//! Segments: numbered motions, selected and started by signals, and chains of them.

use super::{RawChoice, RawQuantity};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Numbered motions, selected and started by signals.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawSegments {
    /// Moves, started by `segment_start`.
    pub position: Option<RawPositionSegments>,
    /// Runs, started by `segment_run`.
    pub velocity: Option<RawVelocitySegments>,
}

/// Moves by number.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawPositionSegments {
    /// Numbers of the first and the last segment.
    pub n: [u16; 2],
    /// Settings of a segment, under the names of those of a move, each with its row; `{n}` in the name of a row is the
    /// number of the segment.
    pub quantities: BTreeMap<String, RawQuantity>,
    /// Whether targets are distances or positions: `relative` (default), `absolute` or, for an empty segment, `none`.
    /// In the name of a row `{n}` is the number of the segment; a value without a code also means an empty segment.
    pub kind: Option<RawChoice<String>>,
    /// When the next segment follows. Default: never.
    pub chain: Option<RawChain>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// Runs by number.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawVelocitySegments {
    /// Numbers of the first and the last segment.
    pub n: [u16; 2],
    /// Settings of a segment, under the names of those of a run, each with its row; `{n}` in the name of a row is the
    /// number of the segment.
    pub quantities: BTreeMap<String, RawQuantity>,
    /// Whether a segment runs while `segment_run` is active, `level` (default), or from its rising edge on, `edge`.
    pub trigger: Option<RawChoice<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// When the next segment follows. In the name of each row `{n}` is the number of the segment.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawChain {
    /// The row with the number of the next segment; a number that no segment has ends the chain.
    pub next: String,
    /// The row with the conditions for the next segment. Without any condition, the chain ends.
    pub rule: String,
    /// The conditions of a segment.
    pub conditions: Vec<RawChainCondition>,
    /// Condition by code; any other code is none.
    pub codes: BTreeMap<u8, String>,
    /// Unit of a condition's value, by condition (`ms`, `1000 counts`).
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Bit of the rule: wait for all conditions instead of any one. Default: any one.
    pub all: Option<u8>,
    /// Bit of the rule: continue as soon as the conditions are met, also during motion; without conditions, continue
    /// in position. Default: continue from standstill.
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

/// Interrupt positioning: a move that replaces the motion in progress when `interrupt_start` rises.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawInterrupt {
    /// Its settings, under the names of those of a move, each with its row; the target is a distance.
    pub quantities: BTreeMap<String, RawQuantity>,
    /// Whether it is locked: `off`, `free` (default) or `locks`.
    pub rule: Option<RawChoice<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}
