//! Signals: which row, bit or terminal carries which one. Roles by name, no addresses.

use super::RawDigit;
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
