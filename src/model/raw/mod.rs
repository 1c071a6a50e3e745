//! A model file as it is written: the reference of the format.
//!
//! These structs mirror the file key for key and decide nothing; `compile` resolves them. Every key
//! that they accept changes something that a test can see.

mod homing;
mod line;
mod quantity;
mod row;
mod segments;
mod wiring;

pub use homing::*;
pub use line::*;
pub use quantity::*;
pub use row::*;
pub use segments::*;
pub use wiring::*;

use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// A model: a drive of one vendor, as tables, units, edges and names. No logic.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawModel {
    /// Version of this format: 1.
    pub format: u32,
    /// Who makes the drive and what it is called.
    pub model: RawIdentity,
    /// The manual that the tables were copied from.
    pub manual: RawManual,
    /// Readings to choose from where the manual contradicts itself or is silent, by name.
    #[serde(default)]
    pub options: BTreeMap<String, RawOption>,
    /// How the drive talks: functions, limits, word order, refusals.
    pub line: RawLine,
    /// Address windows onto the registers, by name. Without any there is one at 0 that writes RAM.
    #[serde(default)]
    pub windows: BTreeMap<String, RawWindow>,
    /// Several stations in one device, each with its own unit address and its own registers, in
    /// order. Without any the device is one station.
    #[serde(default)]
    pub stations: Vec<RawStation>,
    /// The rows of the manual's tables, by the manual's own name or, where it has none, by ours.
    #[serde(default)]
    pub registers: BTreeMap<String, RawRow>,
    /// Rows that repeat at a fixed stride, by name of the group.
    #[serde(default)]
    pub repeats: BTreeMap<String, RawRowRepeat>,
    /// One-word rows for every address of a span that no other row takes, by name of the area.
    #[serde(default)]
    pub fill: BTreeMap<String, RawFill>,
    /// Numbers that the drive computes or goes by, each with the row that holds it, by role. What an
    /// output goes by may be a number with its unit too (`20 rpm`).
    #[serde(default)]
    pub quantities: BTreeMap<String, RawQuantity>,
    /// When a value counts that is written to the row of a setting, where the manual prints no effect time
    /// (`applies` of the row) and `quantities` says no more: `live`, `at_order` (default) or `at_start`.
    /// Limits that are watched (`limit.soft_pos`, `limit.soft_neg`) are live then.
    pub settings_taken: Option<String>,
    /// Where signals come from and where they show.
    #[serde(default)]
    pub signals: RawSignals,
    /// When the drive is ready and what it does at power-on.
    #[serde(default)]
    pub servo: RawServo,
    /// The axis, where something can move it.
    pub axis: Option<RawAxis>,
    /// How the axis looks for its origin.
    pub homing: Option<RawHoming>,
    /// How limits stop the axis.
    pub limits: Option<RawLimits>,
    /// Alarms that the drive can raise, by cause.
    #[serde(default)]
    pub alarms: BTreeMap<String, RawAlarm>,
    /// Rows that show the numbers of the alarms that were raised, newest first.
    #[serde(default)]
    pub alarm_history: Vec<String>,
}

/// Who makes the drive and what it is called.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawIdentity {
    /// The maker.
    pub vendor: String,
    /// The name to ask for it by: lower case, digits and `-`.
    pub name: String,
    /// One line for the list of models.
    pub about: String,
    /// Product names that this model stands for; each is accepted wherever the model's name is.
    #[serde(default)]
    pub products: Vec<String>,
}

/// The manual that the tables were copied from.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawManual {
    /// Its title.
    pub title: String,
    /// Its revision, as printed.
    pub rev: String,
}

/// Two or more readings of the manual, of which a user picks one with `--set NAME=CHOICE`.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawOption {
    /// What the choice is about, in one line.
    pub about: String,
    /// Why the default is what it is: the printed evidence, or its absence.
    pub why: String,
    /// The choice in force unless the user says otherwise.
    pub default: String,
    /// The choices, by name: a fragment that is laid over this file when chosen (`{}`: the file as it
    /// is). Maps are merged, everything else is replaced, `null` removes.
    #[cfg_attr(
        feature = "cli",
        schemars(with = "BTreeMap<String, serde_json::Map<String, serde_json::Value>>")
    )]
    pub choices: BTreeMap<String, IgnoredAny>,
}

/// An address window: the same registers, reached at another base, with another effect of writing.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawWindow {
    /// Added to a register's address to reach it through this window.
    pub base: u16,
    /// First and last register address that the window shows; default: all of them.
    pub span: Option<[u16; 2]>,
    /// What a write changes: `[ram]` is lost at power-off, `[ram, store]` is kept.
    pub writes: Vec<RawLayer>,
}

/// Where a written value goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawLayer {
    /// The value in force, lost at power-off.
    Ram,
    /// The value that returns at power-on.
    Store,
}

/// One station of a device with several.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawStation {
    /// The manual's name of it (`A`).
    pub name: String,
    /// Start values that differ from the rows' own `init`, by row.
    #[serde(default)]
    pub init: BTreeMap<String, i64>,
}

/// JSON Schema of a model file, for editors.
#[cfg(feature = "cli")]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(RawModel).to_value()
}
