//! Wiring, compiled: which row, bit and terminal carries which word.

mod alarms;
mod axis;
mod bit_overrides;
mod chain;
mod choice;
mod compile;
mod homing;
mod interrupt;
mod limits;
mod names;
mod not_simulated;
mod orders;
mod quantities;
mod queries;
mod segment_rows;
mod segment_signals;
mod segments;
mod settings_taken;
mod thresholds;
mod unused_rows;
mod user;

pub use chain::{ChainLink, ChainRules};
pub use choice::{Choice, Digit};
pub(super) use compile::compile;
pub use homing::{Finish, HomingRules};
pub use interrupt::InterruptWiring;
pub use limits::Limits;
pub use not_simulated::NotSimulated;
pub use segments::{PositionSegment, PositionSegments, Segments, VelocitySegments};
pub(super) use unused_rows::check_inert;

use super::RowId;
use super::line::Coded;
use crate::time::Duration;
use crate::units::Unit;
use crate::vocabulary::{
    Action, AlarmCause, InhibitRule, Input, Modifier, Output, Quantity, Setting, Taken, Threshold,
};

/// What a model is wired to. Lists are in the order of the file, and short.
#[derive(Debug, Default)]
pub struct Wiring {
    /// Input terminals with the signal that each function number stands for.
    pub input_terminals: Option<Terminals<Input>>,
    /// Switches of the machine that reach the drive without a terminal.
    pub machine_inputs: Vec<Input>,
    /// Input words.
    pub input_words: Option<InputWords>,
    /// Rows whose bits are input signals.
    pub input_bits: Vec<(RowId, Vec<(u8, Input)>)>,
    /// What takes the signals of such bits away.
    pub bit_overrides: Vec<BitOverride>,
    /// Rows in which a written value triggers an action.
    pub commands: Vec<CommandRows>,
    /// Rows whose bits trigger actions.
    pub triggers: Vec<Triggers>,
    /// Output terminals with the signal that each function number shows.
    pub output_terminals: Option<Terminals<Shown>>,
    /// What rows show, by row; `None` for a row that holds what was written.
    pub shows: Vec<Option<Shows>>,
    /// Output words.
    pub output_words: Option<OutputWords>,
    /// The numbers that outputs go by.
    pub thresholds: Vec<(Threshold, Number)>,
    /// The row whose bits show as user-defined outputs.
    pub user_outputs: Option<RowId>,
    /// Functions that nothing emulates.
    pub not_simulated: NotSimulated,
    /// What a write to a row sets off, by row.
    pub reactions: Vec<Reaction>,
    /// When the drive is ready.
    pub servo: ServoWiring,
    /// The axis.
    pub axis: AxisWiring,
    /// How the axis looks for its origin.
    pub homing: Option<HomingRules>,
    /// What its limits do.
    pub limits: Limits,
    /// Alarms by cause.
    pub alarms: Vec<Alarm>,
    /// Rows with the numbers of the alarms that were raised, newest first.
    pub alarm_history: Vec<RowId>,
    /// How long the master may be silent; `None` for ever.
    pub timeout: Option<HoldTime>,
}

/// What a row shows instead of what was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Shows {
    /// A number that the drive computes.
    Quantity(Quantity),
    /// Output signals, bit by bit.
    Bits(Vec<(u8, Shown)>),
    /// Word `n` of the output words.
    OutputWord(u16),
    /// The signals of a row of `input_bits`, of this index, bit by bit.
    InputBits(usize),
    /// The input terminals.
    InputTerminals(Monitor),
    /// The output terminals.
    OutputTerminals(Monitor),
    /// The `n`th alarm of the past, from 0, the newest.
    PastAlarm(u16),
}

/// An output signal, or its opposite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// The signal.
    pub signal: Output,
    /// Show its opposite.
    pub inverted: bool,
}

/// A number that the model fixes, or that a row holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// One of this unit.
    Fixed(Unit),
    /// In the row's unit.
    Row(RowId),
}

/// What a bit of a terminal monitor shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Monitor {
    /// 1 with a signal on the terminal.
    Signal,
    /// 1 without a signal.
    NoSignal,
    /// 1 while active.
    Active,
}

/// Terminals with assignable functions. `S` is what a function number stands for.
#[derive(Debug)]
pub struct Terminals<S> {
    /// What their names begin with.
    pub prefix: String,
    /// Number of the first.
    pub first: u8,
    /// The row with each terminal's function number.
    pub functions: Vec<RowId>,
    /// The row whose bits make terminals normally closed.
    pub normally_closed: Option<RowId>,
    /// Meaning of function numbers.
    pub codes: Vec<(u16, S)>,
}

impl<S: Copy> Terminals<S> {
    /// The name of terminal `index`, from 0.
    pub fn name(&self, index: usize) -> String {
        format!("{}{}", self.prefix, usize::from(self.first) + index)
    }

    /// What function number `number` stands for.
    pub fn meaning(&self, number: u32) -> Option<S> {
        self.codes.iter().find(|(code, _)| u32::from(*code) == number).map(|(_, signal)| *signal)
    }
}

/// A setting that takes the signal of a bit away, so that the bit does not act.
#[derive(Debug)]
pub struct BitOverride {
    /// The row with the bit.
    pub row: RowId,
    /// The bit.
    pub bit: u8,
    /// The setting: it is made while this is not 0.
    pub by: Digit,
}

/// Input words that a master writes in place of terminals.
#[derive(Debug)]
pub struct InputWords {
    /// The words.
    pub rows: Vec<RowId>,
    /// Their enable words, or none.
    pub enabled_by: Vec<RowId>,
    /// Position (16 times the word plus the bit) and signal.
    pub positions: Vec<(u16, Input)>,
    /// How long a write holds; `None` for ever.
    pub hold: Option<HoldTime>,
}

/// How long one write of an input word holds, or how long the master may be silent.
#[derive(Debug)]
pub struct HoldTime {
    /// The row with the time.
    pub row: RowId,
    /// Its unit.
    pub unit: Unit,
    /// What 0 stands for; `None` for ever.
    pub zero: Option<Duration>,
}

/// Output words that a master reads in place of terminals.
#[derive(Debug)]
pub struct OutputWords {
    /// Their enable words, or none.
    pub enabled_by: Vec<RowId>,
    /// Position (16 times the word plus the bit) and signal.
    pub positions: Vec<(u16, Shown)>,
}

/// A row in which a written value triggers an action.
#[derive(Debug)]
pub struct CommandRows {
    /// The row.
    pub row: RowId,
    /// Action by value.
    pub actions: Vec<(i64, Action)>,
}

/// A row whose bits trigger actions.
#[derive(Debug)]
pub struct Triggers {
    /// The row.
    pub row: RowId,
    /// Action by bit; of several bits that are set the first in here acts.
    pub actions: Vec<(u8, Action)>,
    /// Modifier by bit.
    pub modifiers: Vec<(u8, Modifier)>,
}

/// What a write to a row sets off, apart from changing its value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Reaction {
    /// Nothing: whoever needs the value reads it.
    #[default]
    None,
    /// Input signals may have changed.
    Inputs,
    /// Input word `n` was refreshed.
    InputWord(u16),
    /// Commands, by index.
    Command(u16),
    /// Triggers, by index.
    Trigger(u16),
    /// How the drive is reached: unit address, speed, format.
    Line,
    /// How long the master may be silent.
    Timeout,
}

/// When the drive is ready and what it does at power-on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ServoWiring {
    /// Time from power-on until ready.
    pub ready_after: Duration,
    /// Power stage on from the start.
    pub enabled_at_power_on: bool,
}

/// The axis that the drive moves.
#[derive(Debug)]
pub struct AxisWiring {
    /// Counts for one revolution.
    pub counts_per_rev: Counts,
    /// Increments of the encoder for one revolution, where rows count them.
    pub encoder: Option<Counts>,
    /// How long it runs out without power.
    pub coast: Duration,
    /// How fast a move makes up for a deviation, 1/s; `None` where it has none.
    pub position_gain: Option<f64>,
    /// Pole pairs of the motor.
    pub pole_pairs: u16,
    /// While the row is not 0, positive counts go the machine's negative way.
    pub reversed: Option<RowId>,
    /// Between units of position and counts, where rows hold one.
    pub gear: Option<Gear>,
    /// What `rpm` in the units of rows stands for, in revolutions a minute, where a row says.
    pub speed_unit: Option<Coded<f64>>,
    /// The rows that motions go by.
    pub settings: Vec<SettingRow>,
    /// How many values of settings a drive keeps: one for each row of each setting, also of segments.
    pub slots: u16,
    /// Motions by number.
    pub segments: Segments,
    /// Interrupt positioning.
    pub interrupt: Option<InterruptWiring>,
    /// What becomes of what the axis is behind a command that is inhibited, where the model says.
    pub inhibit: Option<Choice<InhibitRule>>,
}

/// The gear between units of position and counts: a unit is numerator by denominator counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gear {
    /// The row with the numerator, which can't hold 0.
    pub numerator: RowId,
    /// The row with the denominator, which can't hold 0.
    pub denominator: RowId,
}

/// The row of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SettingRow {
    /// What for.
    pub setting: Setting,
    /// The row.
    pub row: RowId,
    /// When a value counts that is written to it.
    pub taken: Taken,
    /// Where a drive keeps the value that counts, from 0 on.
    pub slot: u16,
}

/// Counts or increments for one revolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counts {
    /// This many, not 0.
    Fixed(u32),
    /// As many as the row says. For counts it can't hold 0.
    Row(RowId),
}

impl Default for AxisWiring {
    /// Nothing moves it.
    fn default() -> Self {
        let coast = Duration::from_millis(200);
        Self {
            counts_per_rev: Counts::Fixed(1),
            encoder: None,
            coast,
            position_gain: None,
            pole_pairs: 1,
            reversed: None,
            gear: None,
            speed_unit: None,
            settings: Vec::new(),
            slots: 0,
            segments: Segments::default(),
            interrupt: None,
            inhibit: None,
        }
    }
}

impl AxisWiring {
    /// The settings of all motions, those of segments too.
    pub fn all_settings(&self) -> impl Iterator<Item = &SettingRow> {
        let interrupt = self.interrupt.iter().flat_map(|it| &it.settings);
        self.settings.iter().chain(self.segments.settings()).chain(interrupt)
    }

    /// The row that holds `setting`.
    pub fn setting(&self, setting: Setting) -> Option<RowId> {
        self.settings.iter().find(|it| it.setting == setting).map(|it| it.row)
    }
}

/// An alarm of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alarm {
    /// Why.
    pub cause: AlarmCause,
    /// The vendor's number.
    pub code: u16,
    /// Does a reset clear it?
    pub resettable: bool,
    /// The voltage of the bus while its cause stands, if that is another one.
    pub bus_voltage: Option<f64>,
    /// What the axis does.
    pub stop: AlarmStop,
}

/// What an axis that moves does when an alarm is raised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlarmStop {
    /// It runs out: the power stage goes off.
    Coast,
    /// It slows down, then the power stage goes off.
    Ramp,
    /// It stands at once, then the power stage goes off.
    Quick,
}

impl Wiring {
    /// The alarm for `cause`, if the model has one.
    pub fn alarm(&self, cause: AlarmCause) -> Option<Alarm> {
        self.alarms.iter().find(|alarm| alarm.cause == cause).copied()
    }

    /// The number that `threshold` stands for.
    pub fn threshold(&self, threshold: Threshold) -> Option<Number> {
        self.thresholds.iter().find(|(it, _)| *it == threshold).map(|(_, number)| *number)
    }

    /// What `row` shows, or `None` if it holds what was written.
    pub fn shows(&self, row: RowId) -> Option<&Shows> {
        self.shows[usize::from(row.0)].as_ref()
    }

    /// What a write to `row` sets off.
    pub fn reaction(&self, row: RowId) -> Reaction {
        self.reactions[usize::from(row.0)]
    }
}
