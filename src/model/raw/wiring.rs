//! Wiring: which row, bit or terminal carries which signal. Roles by name, no addresses.

use super::{RawChoice, RawChosen, RawDigit, RawInterrupt, RawSegments};
use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Where signals come from and where they show.
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
    /// Function number -> input signal, or `not_simulated` and the manual's name of a function that does nothing; used by
    /// `terminals` and `words`.
    pub codes: BTreeMap<u16, String>,
    /// Switches of the machine that reach the drive by a way of their own, not by one of `terminals`.
    pub machine: Vec<String>,
    /// Physical input terminals.
    pub terminals: Option<RawTerminals>,
    /// Words in which bit n of word w stands for function number 16 w + n.
    pub words: Option<RawInputWords>,
    /// Rows whose bits are signals: row -> bit -> signal, or `not_simulated` and the manual's name.
    pub bits: BTreeMap<String, BTreeMap<u8, String>>,
    /// Rows that show, bit by bit, what has come of such a row: monitor -> row of `bits`. A bit without a signal shows as it
    /// was written.
    pub monitors: BTreeMap<String, String>,
    /// Settings that take the signals of such bits away: row -> bit -> setting. While that is not 0, the bit does not act.
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
    /// Bit -> action. Of several bits at once, the action that stands first in the catalogue acts alone.
    pub bits: BTreeMap<u8, String>,
    /// Bit -> what a 1 there says about the action.
    #[serde(default)]
    pub modifiers: BTreeMap<u8, String>,
}

/// Where output signals show.
#[derive(Debug, Clone, Default, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawOutputs {
    /// Function number -> output signal, `not` and a signal, or `not_simulated` and the manual's name of a function that
    /// never shows; used by `terminals` and `words`.
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
    /// What a terminal's name begins with (`DI`); its number follows.
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
    /// How long one write of a word holds; after that the word returns to 0. Default: for ever.
    pub hold: Option<RawHold>,
}

/// A row with the time in which a master must do something again.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawHold {
    /// The row with the time, in its unit.
    pub register: String,
    /// The time that 0 stands for (`500ms`); default: for ever.
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
    /// Is the power stage on from the start, without a signal? default no.
    pub enabled_at_power_on: bool,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// The axis that the drive moves.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawAxis {
    /// Counts of the drive for one revolution: a number, or the row that holds it.
    pub counts_per_rev: RawCounts,
    /// Increments of the encoder for one revolution, of which rows in `inc` count: a number, or the row that holds it.
    /// While that holds 0 they are counts.
    pub encoder: Option<RawCounts>,
    /// How long the axis runs out when its power stage goes off while it moves, from whatever speed
    /// (`200ms`, which is the default); `0s` stands at once.
    pub coast: Option<String>,
    /// Motions by number, which signals select and start.
    #[serde(default)]
    pub segments: RawSegments,
    /// A move that takes the place of a motion under way.
    pub interrupt: Option<RawInterrupt>,
    /// What becomes of what the axis is behind its command when `command_inhibit` rises: `clears` (default) or `keeps`.
    pub inhibit: Option<RawChoice<String>>,
    /// Gain of the position controller, 1/s: in a move at constant speed the axis is that speed divided by
    /// this behind its command. Default: it follows without delay, as a motor without an encoder is taken to.
    pub position_gain: Option<f64>,
    /// Pole pairs of the motor, for `encoder.electrical_angle`.
    pub pole_pairs: Option<u16>,
    /// A row: while it is not 0, positive counts go the negative way of a bench's machine. A change counts once
    /// the axis stands.
    pub reversed: Option<String>,
    /// The gear between units of position and counts. Default: 1 to 1.
    pub gear: Option<RawGear>,
    /// Where a row decides what `rpm` in the units of rows stands for: `rpm` or `0.1 rpm`, say, by value.
    pub speed_unit: Option<RawChosen<String>>,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// The gear between units of position, in which targets and positions are, and counts: a unit is numerator by
/// denominator counts. Neither row can hold 0.
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
    /// This many.
    #[serde(rename = "a number of counts")]
    Number(u32),
    /// As many as the row says.
    #[serde(rename = "a string (a row)")]
    Row(String),
}

/// An alarm that the drive can raise.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawAlarm {
    /// The vendor's number, as `alarm.code` shows it.
    pub code: u16,
    /// Does a reset clear it? Otherwise only a power cycle does. Default yes.
    #[serde(default = "yes")]
    pub resettable: bool,
    /// What `bus.voltage` shows while the cause stands (`180 V`); default: what it shows anyway.
    pub bus_voltage: Option<String>,
    /// What an axis that moves does when the alarm is raised; default `coast`.
    #[serde(default)]
    pub stop: RawAlarmStop,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}

/// What an axis that moves does when an alarm is raised.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawAlarmStop {
    /// Its power stage goes off and it runs out.
    #[default]
    Coast,
    /// It slows down with `alarm.decel`, or without such a row as the motion itself would; then its power stage goes off.
    Ramp,
    /// It stands at once; then its power stage goes off.
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
