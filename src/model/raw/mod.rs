//! A model file as it is written: the reference of the format.
//!
//! These structs mirror the file key for key and decide nothing; `compile` resolves them. Every key
//! that they accept changes something that a test can see.

mod axis;
mod homing;
mod line;
mod row;
mod signals;

pub use axis::*;
pub use homing::*;
pub use line::*;
pub use row::*;
pub use signals::*;

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
    /// Vendor, name and products of the drive.
    pub model: RawIdentity,
    /// The manual that the tables were copied from.
    pub manual: RawManual,
    /// Choices between readings where the manual contradicts itself or is silent, by name.
    #[serde(default)]
    pub options: BTreeMap<String, RawOption>,
    /// Communication: functions, limits, word order, refusals.
    pub line: RawLine,
    /// Address windows, by name. Without any there is one at base 0 that writes RAM.
    #[serde(default)]
    pub windows: BTreeMap<String, RawWindow>,
    /// Stations of a device, in order, each with its own unit address and registers. Without any, the device is a
    /// single station.
    #[serde(default)]
    pub stations: Vec<RawStation>,
    /// Rows of the register tables, by the name in the manual or, where it has none, by a name of your own.
    #[serde(default)]
    pub registers: BTreeMap<String, RawRow>,
    /// Rows that repeat at a fixed stride, by name of the group.
    #[serde(default)]
    pub repeats: BTreeMap<String, RawRowRepeat>,
    /// 16-bit rows for all addresses of a range that no other row uses, by name of the area.
    #[serde(default)]
    pub fill: BTreeMap<String, RawFill>,
    /// Computed values, settings and thresholds, by role, each with the row that holds it. A threshold can also be a
    /// number with its unit (`20 rpm`).
    #[serde(default)]
    pub quantities: BTreeMap<String, RawQuantity>,
    /// Effect time of settings whose row has no `applies` and which have no `taken` in `quantities`: `live`,
    /// `at_order` (default) or `at_start`. Soft limits (`limit.soft_pos`, `limit.soft_neg`) are then live.
    pub settings_taken: Option<String>,
    /// Sources of input signals, and where output signals are shown.
    #[serde(default)]
    pub signals: RawSignals,
    /// When the drive is ready and what it does at power-on.
    #[serde(default)]
    pub servo: RawServo,
    /// The axis, if something can move it.
    pub axis: Option<RawAxis>,
    /// Homing: how the axis finds its origin.
    pub homing: Option<RawHoming>,
    /// How limits stop the axis.
    pub limits: Option<RawLimits>,
    /// Alarms that the drive can raise, by cause.
    #[serde(default)]
    pub alarms: BTreeMap<String, RawAlarm>,
    /// Rows with the numbers of past alarms, newest first.
    #[serde(default)]
    pub alarm_history: Vec<String>,
}

/// Vendor, name and products of the drive.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawIdentity {
    /// The maker.
    pub vendor: String,
    /// Model name: lower-case letters, digits and `-`.
    pub name: String,
    /// One line for the list of models.
    pub about: String,
    /// Product names; each is accepted in place of the model name.
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

/// Two or more readings of the manual, selected with `--set NAME=CHOICE`.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawOption {
    /// What the choice is about, in one line.
    pub about: String,
    /// Why the default is what it is: the printed evidence, or its absence.
    pub why: String,
    /// The choice that applies by default.
    pub default: String,
    /// The choices, by name: each a fragment that is merged into this file (`{}`: no change). Maps are merged,
    /// everything else is replaced, `null` removes.
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
    /// First and last register address in the window; default: all of them.
    pub span: Option<[u16; 2]>,
    /// Where a write goes: `[ram]` is lost at power-off, `[ram, store]` is also stored in non-volatile memory.
    pub writes: Vec<RawLayer>,
}

/// Where a written value goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawLayer {
    /// RAM: the value in force, lost at power-off.
    Ram,
    /// Non-volatile memory: the value restored at power-on.
    Store,
}

/// When the drive is ready and what it does at power-on.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawServo {
    /// Time from power-on until the drive is ready (`1s`); default 0.
    pub ready_after: Option<String>,
    /// Whether the power stage is on from power-on, without a signal; default no.
    pub enabled_at_power_on: bool,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// An alarm that the drive can raise.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawAlarm {
    /// The vendor's alarm number, as shown by `alarm.code`; not 0.
    pub code: u16,
    /// Whether a reset clears it; otherwise only a power cycle does. Default yes.
    #[serde(default = "yes")]
    pub resettable: bool,
    /// Value of `bus.voltage` while the cause is present (`180 V`); default: unchanged.
    pub bus_voltage: Option<String>,
    /// Reaction of a moving axis to the alarm; default `coast`.
    #[serde(default)]
    pub stop: RawAlarmStop,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// Reaction of a moving axis to an alarm.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawAlarmStop {
    /// The power stage is switched off, and the axis coasts.
    #[default]
    Coast,
    /// The axis decelerates with `alarm.decel`, or without such a row like the motion itself; then the power stage is
    /// switched off.
    Ramp,
    /// The axis stops immediately; then the power stage is switched off.
    Quick,
}

fn yes() -> bool {
    true
}

/// One station of a device with several.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawStation {
    /// Name in the manual (`A`).
    pub name: String,
    /// Factory values that differ from the `init` of the row, by row.
    #[serde(default)]
    pub init: BTreeMap<String, i64>,
}

/// JSON Schema of a model file, for editors.
#[cfg(feature = "cli")]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(RawModel).to_value()
}
