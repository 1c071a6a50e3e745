//! Wiring, compiled: which row, bit and terminal carries which word.

mod axis;
mod choice;
mod homing;
mod queries;
mod segments;
mod signals;

pub use axis::{AxisWiring, Counts, Gear, Limits, Number};
pub(super) use choice::code_in;
pub use choice::{Choice, Coded, Digit};
pub use homing::{Finish, HomingRules};
pub use segments::{
    ChainLink, ChainRules, InterruptWiring, PositionSegment, PositionSegments, Segments,
    SettingRow, VelocitySegments,
};
pub use signals::{
    BitOverride, CommandRows, HoldTime, InputWords, Monitor, NotSimulated, OutputWord, Reaction,
    Shown, Shows, Terminals, Triggers,
};

use super::RowId;
use crate::time::Duration;
use crate::vocabulary::{AlarmCause, Input, Quantity, Threshold};

/// What a model is wired to. Lists are in the order of the file, and short.
#[derive(Debug, Default)]
pub struct Wiring {
    /// Input terminals with the signal that each function number stands for.
    pub input_terminals: Option<Terminals<Input>>,
    /// Switches of the machine that reach the drive without a terminal.
    pub machine_inputs: Vec<Input>,
    /// Words of input functions that a master writes, if the model has any.
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
    /// The first row that shows each quantity, by its place in the catalogue.
    pub(super) quantity_rows: Vec<Option<RowId>>,
    /// Output words, in order.
    pub output_words: Vec<OutputWord>,
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
    /// Units, settings and segments of the axis.
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

    /// The first row that shows `quantity`.
    pub fn row_of(&self, quantity: Quantity) -> Option<RowId> {
        self.quantity_rows[quantity as usize]
    }

    /// What a write to `row` sets off.
    pub fn reaction(&self, row: RowId) -> Reaction {
        self.reactions[usize::from(row.0)]
    }
}

/// When the drive is ready and what it does at power-on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ServoWiring {
    /// Time from power-on until ready.
    pub ready_after: Duration,
    /// Power stage on from the start.
    pub enabled_at_power_on: bool,
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
