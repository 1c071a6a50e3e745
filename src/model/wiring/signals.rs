//! Where signals come from and where they show: terminals, words, bits, and values that are commands.

use super::Digit;
use crate::model::RowId;
use crate::time::Duration;
use crate::units::Unit;
use crate::vocabulary::{Action, Input, Modifier, Output, Quantity};

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
    /// Unit of the value.
    pub unit: Unit,
    /// What 0 stands for; `None` for ever.
    pub zero: Option<Duration>,
}

/// A setting that takes the signal of a bit away, so that the bit does not act.
#[derive(Debug)]
pub struct BitOverride {
    /// The row with the bit.
    pub row: RowId,
    /// Number of the bit, from 0.
    pub bit: u8,
    /// The setting: it is made while this is not 0.
    pub by: Digit,
}

/// A row in which a written value triggers an action.
#[derive(Debug)]
pub struct CommandRows {
    /// The row that masters write.
    pub row: RowId,
    /// Action by value.
    pub actions: Vec<(i64, Action)>,
}

/// A row whose bits trigger actions.
#[derive(Debug)]
pub struct Triggers {
    /// The row that masters write.
    pub row: RowId,
    /// Action by bit; of several bits that are set the first in here acts.
    pub actions: Vec<(u8, Action)>,
    /// Modifier by bit.
    pub modifiers: Vec<(u8, Modifier)>,
}

/// An output word that a master reads in place of terminals.
#[derive(Debug)]
pub struct OutputWord {
    /// The word.
    pub row: RowId,
    /// Its enable word: a bit shows while its bit there is 1. `None` for all of them.
    pub enabled_by: Option<RowId>,
    /// What each bit shows.
    pub bits: Vec<(u8, Shown)>,
}

/// An output signal, or its opposite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// The signal that is shown, or whose opposite is.
    pub signal: Output,
    /// Show its opposite.
    pub inverted: bool,
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
    /// The state of the input terminals, one bit each.
    InputTerminals(Monitor),
    /// The state of the output terminals, one bit each.
    OutputTerminals(Monitor),
    /// The `n`th alarm of the past, from 0, the newest.
    PastAlarm(u16),
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

/// What a write to a row sets off, apart from changing its value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Reaction {
    /// None: the value is read when it is needed.
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

/// Functions that are not simulated. Each stands for its index in `labels`.
#[derive(Debug, Default)]
pub struct NotSimulated {
    /// What the log calls them.
    pub labels: Vec<String>,
    /// By function number of input terminals.
    pub input_codes: Vec<(u16, u8)>,
    /// By position in the input words.
    pub input_positions: Vec<(u16, u8)>,
    /// By row and bit.
    pub input_bits: Vec<(RowId, Vec<(u8, u8)>)>,
    /// By function number of output terminals.
    pub output_codes: Vec<(u16, u8)>,
    /// By position in the output words.
    pub output_positions: Vec<(u16, u8)>,
    /// By digit of a row, which asks for it while it is not 0.
    pub digits: Vec<(Digit, u8)>,
}

impl NotSimulated {
    /// Is there no such function?
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// What may be asked for through `row`: by its bits or digits, or by a terminal whose function it holds.
    pub fn of_row(&self, row: RowId, is_input: bool, is_output: bool) -> Vec<&str> {
        let bits = self.input_bits.iter().filter(|(it, _)| *it == row).flat_map(|(_, bits)| bits);
        let digits = self.digits.iter().filter(|(it, _)| it.row == row).map(|(_, index)| *index);
        let inputs = self.input_codes.iter().filter(|_| is_input).map(|(_, index)| *index);
        let outputs = self.output_codes.iter().filter(|_| is_output).map(|(_, index)| *index);
        let all = bits.map(|(_, index)| *index).chain(digits).chain(inputs).chain(outputs);
        all.map(|index| self.labels[usize::from(index)].as_str()).collect()
    }
}
