//! Homing and limits of an axis.

use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// How the axis looks for its origin.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawHoming {
    /// The row with the number of the method; default: there is one method.
    pub method: Option<String>,
    /// The methods, by number. Each number that the row can hold is here or in `no_steps`.
    pub methods: BTreeMap<i64, RawMethod>,
    /// Numbers that the row can hold and that do nothing.
    #[serde(default)]
    pub no_steps: Vec<i64>,
    /// Where a row decides what starts a homing: `never`, `input`, `command` or `first_enable` by value.
    pub starter: Option<RawChosen<String>>,
    /// What a limit on the way means: `turn` (default) or `alarm`.
    pub limit: Option<RawChoice<String>>,
    /// What tells a homing that there is a limit: `switch` (default), `hard_stop` or `either`.
    pub limit_source: Option<RawChoice<String>>,
    /// Whether an index pulse refines the origin: `none` (default), `back` or `onward`.
    pub index: Option<RawChoice<String>>,
    /// How the axis stands at the origin: `at_once` (default) or `ramp`.
    pub stop: Option<String>,
    /// What happens when the origin is found; default: the position register says 0.
    pub finish: Option<RawChoice<RawFinish>>,
    /// A row, or a digit of it, by which `home.time_limit` is multiplied unless it is 0.
    pub time_factor: Option<RawDigit>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// Always the same, or as a row says.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawChoice<T> {
    /// As a row says.
    #[serde(rename = "a map with register or codes")]
    Row(RawChosen<T>),
    /// Always the same.
    #[serde(rename = "anything else")]
    Fixed(T),
}

/// A row, or one hex digit of it, whose values stand for something.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RawChosen<T> {
    /// The row.
    pub register: String,
    /// Which hex digit of it, from the right, from 0; default: the whole value.
    pub digit: Option<u8>,
    /// What its values stand for.
    pub codes: BTreeMap<i64, T>,
}

/// A row, or one hex digit of it.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawDigit {
    /// The row.
    pub register: String,
    /// Which hex digit of it, from the right, from 0; default: the whole value.
    pub digit: Option<u8>,
}

/// A homing method. Without any steps the origin is where the axis stands.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawMethod {
    /// The switch that decides where it begins: `home_switch`, `limit_pos` or `limit_neg`.
    pub by: Option<String>,
    /// The steps, where that switch is off at the start.
    pub steps: Vec<RawHomingStep>,
    /// The steps that follow when the way of the first one ends at a limit instead.
    pub at_limit: Vec<RawHomingStep>,
    /// The steps where the switch is on at the start.
    pub on: Vec<RawHomingStep>,
    /// Does `index` of the homing count for this method? Default no.
    pub index: bool,
}

/// A homing step: go until something happens.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawHomingStep {
    /// `pos` or `neg`.
    pub go: RawWay,
    /// `fast` or `slow`.
    pub at: String,
    /// Until what: a switch and `on` or `off` (`home_switch on`), `index`, `index after home_switch off`,
    /// `same index` (the one that ended an earlier step), or `collision`.
    pub to: String,
    /// `ramp`: stand, then the next step. `keep`: the next step without stopping. `origin`: this is it.
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
    /// Go on by `home.way`? Default no.
    #[serde(default)]
    pub go: bool,
    /// What the position register says then: `coordinate`, `zero`, `minus_coordinate`, `kept`,
    /// `kept_plus_coordinate` or `kept_minus_coordinate`.
    pub position: String,
    /// Does it say that of the origin, and not of where the axis stands in the end? Default no.
    #[serde(default)]
    pub of_origin: bool,
}

/// How limits stop the axis.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawLimits {
    /// How it stops: `coast`, `quick` (default) or `ramp`.
    pub stop: Option<RawChoice<String>>,
    /// When `limit.soft_pos` and `limit.soft_neg` are in force: `off`, `after_homing` or `always` (default).
    pub soft: Option<RawChoice<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}
