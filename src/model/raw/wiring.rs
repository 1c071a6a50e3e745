//! Wiring: which row, bit or terminal carries which signal. Roles by name, no addresses.

use super::{RawChoice, RawChosen, RawDigit, RawInterrupt, RawSegments};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Sources of input signals, and where output signals are shown.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawSignals {
    /// Signals into the drive.
    pub inputs: RawInputs,
    /// Signals out of the drive.
    pub outputs: RawOutputs,
}

/// Sources of input signals; a signal is active while any source of it is.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawInputs {
    /// Function number -> input signal, or `not_simulated` and the name of a function without effect; used by
    /// `terminals` and `words`.
    pub codes: BTreeMap<u16, String>,
    /// Switches of the machine with dedicated pins, not wired to one of `terminals`.
    pub machine: Vec<String>,
    /// Physical input terminals.
    pub terminals: Option<RawTerminals>,
    /// Words in which bit n of word w stands for function number 16 w + n.
    pub words: Option<RawInputWords>,
    /// Rows whose bits are signals: row -> bit -> signal, or `not_simulated` and the manual's name.
    pub bits: BTreeMap<String, BTreeMap<u8, String>>,
    /// Rows that show the effective state of such a row: monitor -> row of `bits`. A bit without a signal is shown as
    /// written.
    pub monitors: BTreeMap<String, String>,
    /// Settings that override such bits: row -> bit -> setting. While the setting is not 0, the bit has no effect.
    #[serde(alias = "claims")]
    pub bit_overrides: BTreeMap<String, BTreeMap<u8, RawDigit>>,
    /// Rows in which writing a value triggers an action: row -> value -> action. Every write triggers.
    pub commands: BTreeMap<String, BTreeMap<i64, String>>,
    /// Rows in which writing a 1 to a bit triggers an action. Every write triggers.
    pub triggers: BTreeMap<String, RawTriggers>,
}

/// A row whose bits trigger actions.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawTriggers {
    /// Bit -> action. If several bits are set, only the action listed first in the catalogue is executed.
    pub bits: BTreeMap<u8, String>,
    /// Bit -> modifier of the action.
    #[serde(default)]
    pub modifiers: BTreeMap<u8, String>,
}

/// Where output signals show.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawOutputs {
    /// Function number -> output signal, `not` and a signal, or `not_simulated` and the name of a function that is
    /// always off; used by `terminals` and `words`.
    pub codes: BTreeMap<u16, String>,
    /// Physical output terminals.
    pub terminals: Option<RawTerminals>,
    /// Words in which bit n of word w shows function number 16 w + n.
    pub words: Option<RawOutputWords>,
    /// Rows whose bits show signals: row -> bit -> signal, or `not` and a signal.
    pub bits: BTreeMap<String, BTreeMap<u8, String>>,
    /// The row whose bits 0, 1 and 2 are the signals `user_0`, `user_1` and `user_2`.
    pub user: Option<String>,
}

/// Physical terminals with assignable functions.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawTerminals {
    /// Prefix of the terminal names (`DI`), followed by the number.
    pub prefix: String,
    /// Number of the first terminal.
    pub first: u8,
    /// The rows that hold the terminals' function numbers, in order of the terminals.
    pub functions: Vec<String>,
    /// A row whose bit i makes terminal i normally closed: active without a signal.
    pub normally_closed: Option<String>,
    /// The row that monitors the terminals, bit i for terminal i.
    pub monitor: Option<RawMonitor>,
}

/// A row that monitors terminals.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawMonitor {
    /// The row.
    pub register: String,
    /// What a bit shows.
    pub shows: RawShows,
}

/// What a bit of a terminal monitor shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawShows {
    /// 1: the terminal carries a signal.
    Signal,
    /// 1: the terminal carries no signal.
    NoSignal,
    /// 1: the terminal is active, that is, a signal where normally open, none where normally closed.
    Active,
}

/// Input words that a master writes in place of terminals.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawInputWords {
    /// The rows, in order.
    pub registers: Vec<String>,
    /// Rows with one enable bit for each bit of the words; default: all enabled.
    #[serde(default)]
    pub enabled_by: Vec<String>,
    /// Function number -> position (16 times the word plus the bit), where it is not the number itself.
    #[serde(default)]
    pub positions: BTreeMap<u16, u16>,
    /// Hold time: the word is reset to 0 unless it is written again in time. Default: no watchdog.
    pub hold: Option<RawHold>,
}

/// A row with the time of a watchdog.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawHold {
    /// The row with the time, in its unit.
    pub register: String,
    /// The time that 0 stands for (`500ms`); by default 0 disables the watchdog.
    pub zero: Option<String>,
}

/// Output words that a master reads in place of terminals.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawOutputWords {
    /// The rows, in order.
    pub registers: Vec<String>,
    /// Rows with one enable bit for each bit of the words; default: all enabled.
    #[serde(default)]
    pub enabled_by: Vec<String>,
    /// Function number -> position (16 times the word plus the bit), where it is not the number itself.
    #[serde(default)]
    pub positions: BTreeMap<u16, u16>,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Models that were written before the key had its name still load.
    #[test]
    fn bit_overrides_were_claims() {
        let read = |text: &str| {
            let inputs: RawInputs = serde_yaml::from_str(text).expect("inputs");
            inputs.bit_overrides["P1"][&3].register.clone()
        };
        assert_eq!(read("claims: {P1: {3: {register: P2}}}"), "P2");
        assert_eq!(read("bit_overrides: {P1: {3: {register: P2}}}"), "P2");
    }
}
