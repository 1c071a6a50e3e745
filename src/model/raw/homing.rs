//! Homing and limits of an axis.

use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Homing: how the axis finds its origin.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawHoming {
    /// The row that selects the method by number; without it there is exactly one method.
    pub method: Option<String>,
    /// The methods, by number. Each value of the row must be listed here or in `no_steps`.
    pub methods: BTreeMap<i64, RawMethod>,
    /// Values of the row without any effect.
    #[serde(default)]
    pub no_steps: Vec<i64>,
    /// A row that selects what starts a homing: `never`, `input`, `command` or `first_enable` by value.
    pub starter: Option<RawChosen<String>>,
    /// Reaction to a limit: `turn` (default) or `alarm`.
    pub limit: Option<RawChoice<String>>,
    /// How a limit is detected: `switch` (default), `hard_stop` or `either`.
    pub limit_source: Option<RawChoice<String>>,
    /// Whether an index pulse refines the origin: `none` (default), `back` or `onward`.
    pub index: Option<RawChoice<String>>,
    /// How the axis stops at the origin: `at_once` (default) or `ramp`.
    pub stop: Option<String>,
    /// What happens when the origin is found; default: the position register is set to 0.
    pub finish: Option<RawChoice<RawFinish>>,
    /// A row, or a digit of it, by which `home.time_limit` is multiplied unless it is 0.
    pub time_factor: Option<RawDigit>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// A fixed choice, or one made by a row.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawChoice<T> {
    /// Selected by a row.
    #[serde(rename = "a map with register or codes")]
    Row(RawChosen<T>),
    /// Fixed.
    #[serde(rename = "anything else")]
    Fixed(T),
}

/// A row, or one hex digit of it, and the meaning of its values.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RawChosen<T> {
    /// The row.
    pub register: String,
    /// Hex digit of the row, counted from the right from 0; default: the whole value.
    pub digit: Option<u8>,
    /// Meaning of its values.
    pub codes: BTreeMap<i64, T>,
}

/// A row, or one hex digit of it.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawDigit {
    /// The row.
    pub register: String,
    /// Hex digit of the row, counted from the right from 0; default: the whole value.
    pub digit: Option<u8>,
}

/// A homing method. Without any steps the origin is the current position.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawMethod {
    /// The switch that decides how it begins: `home_switch`, `limit_pos` or `limit_neg`.
    pub by: Option<String>,
    /// The steps if that switch is off at the start.
    pub steps: Vec<RawHomingStep>,
    /// The steps that follow if the first step ends at a limit.
    pub at_limit: Vec<RawHomingStep>,
    /// The steps if the switch is on at the start.
    pub on: Vec<RawHomingStep>,
    /// Whether `index` of the homing applies to this method; default no.
    pub index: bool,
}

/// A homing step: move until an end condition is met.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawHomingStep {
    /// Direction, `pos` or `neg`.
    pub go: RawWay,
    /// Speed, `fast` (`home.speed_fast`) or `slow` (`home.speed_slow`).
    pub at: String,
    /// End condition: a switch and `on` or `off` (`home_switch on`), `index`, `index after home_switch off`, `same
    /// index` (the one that ended an earlier step), or `collision`.
    pub to: String,
    /// `ramp`: stop, then the next step. `keep`: the next step without stopping. `origin`: this is the origin.
    pub then: String,
}

/// A direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawWay {
    /// Positive.
    Pos,
    /// Negative.
    Neg,
}

/// What happens when the origin is found.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RawFinish {
    /// Whether the axis then moves by `home.way`; default no.
    #[serde(default)]
    pub go: bool,
    /// Value of the position register afterwards: `coordinate`, `zero`, `minus_coordinate`, `kept`,
    /// `kept_plus_coordinate` or `kept_minus_coordinate`.
    pub position: String,
    /// Whether that value is assigned to the origin, not to the final position; default no.
    #[serde(default)]
    pub of_origin: bool,
}

/// How limits stop the axis.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawLimits {
    /// How the axis stops: `coast`, `quick` (default) or `ramp`.
    pub stop: Option<RawChoice<String>>,
    /// When `limit.soft_pos` and `limit.soft_neg` are in force: `off`, `after_homing` or `always` (default).
    pub soft: Option<RawChoice<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}
