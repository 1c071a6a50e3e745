//! The axis: its counts and gear, the numbers that motions go by, and motions by number.

use super::{RawChoice, RawChosen};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// The axis that the drive moves.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawAxis {
    /// Counts per revolution: a number, or the row that holds it.
    pub counts_per_rev: RawCounts,
    /// Encoder increments per revolution, the unit `inc` of rows: a number, or the row that holds it. If it is 0,
    /// increments are counts.
    pub encoder: Option<RawCounts>,
    /// How long the axis coasts, from any speed, when its power stage is switched off during motion; default `200ms`;
    /// with `0s` it stops immediately.
    pub coast: Option<String>,
    /// Numbered motions, selected and started by signals.
    #[serde(default)]
    pub segments: RawSegments,
    /// A move that replaces the motion in progress.
    pub interrupt: Option<RawInterrupt>,
    /// What happens to the following error when `command_inhibit` rises: `clears` (default) or `keeps`.
    pub inhibit: Option<RawChoice<String>>,
    /// Gain of the position controller, 0.1 to 10000 1/s: in a move at constant speed the following error is the speed
    /// divided by the gain. Default: no following error, as for a motor without an encoder.
    pub position_gain: Option<f64>,
    /// Pole pairs of the motor, for `encoder.electrical_angle`.
    pub pole_pairs: Option<u16>,
    /// A row: while it is not 0, positive counts move in the negative direction of the machine. A change takes effect
    /// at standstill.
    pub reversed: Option<String>,
    /// Electronic gear between units of position and counts. Default: 1 to 1.
    pub gear: Option<RawGear>,
    /// A row that selects the meaning of `rpm` in the units of rows, by value: `rpm`, `0.1 rpm`.
    pub speed_unit: Option<RawChosen<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// Electronic gear: one unit of position is numerator / denominator counts. Neither row can be 0.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawGear {
    /// The row with the numerator.
    pub numerator: String,
    /// The row with the denominator.
    pub denominator: String,
}

/// Counts for one revolution.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawCounts {
    /// A number.
    #[serde(rename = "a number of counts")]
    Number(u32),
    /// The value of a row.
    #[serde(rename = "a string (a row)")]
    Row(String),
}

/// The row that holds a value, or for a threshold a number with its unit.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawQuantity {
    /// The row, or the number.
    #[serde(rename = "a string (a row)")]
    Register(String),
    /// The row of a setting, and its effect time.
    #[serde(rename = "a map (register, taken)")]
    Setting(RawSetting),
}

/// The row of a setting, and its effect time.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RawSetting {
    /// The row.
    pub register: String,
    /// Effect time: `live`, `at_order` or `at_start`. Default: from `applies` of the row (`now` is `live`, `at_stop`
    /// is `at_start`), else `settings_taken`.
    pub taken: Option<String>,
}

impl RawQuantity {
    /// The row, or the number.
    pub fn register(&self) -> &str {
        match self {
            Self::Register(it) => it,
            Self::Setting(it) => &it.register,
        }
    }

    /// When values count, where it says so.
    pub fn taken(&self) -> Option<&str> {
        match self {
            Self::Register(_) => None,
            Self::Setting(it) => it.taken.as_deref(),
        }
    }
}

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
