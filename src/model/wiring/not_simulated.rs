//! Functions that the manual has and nothing emulates: where they are asked for, so that the log can say so.

use super::Digit;
use super::compile::Wirer;
use crate::model::RowId;
use crate::problem::{Path, Problem};

/// What stands before the name of a function that is not simulated.
const MARK: &str = "not_simulated ";

/// As many as one set of them has room for.
const MOST: usize = 64;

/// What a function number or a bit stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function<S> {
    /// This signal.
    Signal(S),
    /// A function that is not simulated, by its index in [`NotSimulated::labels`].
    NotSimulated(u8),
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

impl Wirer<'_> {
    /// The function that `text` names as one that is not simulated; `place` is what stands before its name in the log.
    pub(super) fn not_simulated(&mut self, text: &str, place: &str, path: &Path) -> Option<u8> {
        let name = text.strip_prefix(MARK)?.trim();
        Some(self.absent(format!("{place} {name}"), path))
    }

    /// What the log calls a bit of a row.
    pub(super) fn place_of_bit(&self, row: RowId, bit: u8) -> String {
        format!("0x{:04X}", self.rows.map.row(row).at) + &format!(" bit {bit}")
    }

    /// Digits of rows that ask for something that is not simulated.
    pub(super) fn digits_not_simulated(&mut self) {
        let rows = self.rows;
        for ((id, row), path) in rows.map.rows().zip(&rows.paths) {
            for (digit, what) in &row.not_simulated {
                let label = format!("{}, {what}", row.id);
                let index = self.absent(label, &path.key("not_simulated").key(digit));
                let digit = Digit { row: id, digit: Some(*digit) };
                self.wiring.not_simulated.digits.push((digit, index));
            }
        }
    }

    fn absent(&mut self, label: String, path: &Path) -> u8 {
        let labels = &mut self.wiring.not_simulated.labels;
        if labels.len() == MOST {
            let what = format!("more than {MOST} functions that are not simulated");
            self.problems.push(Problem::key(path.clone(), what));
            return 0;
        }
        labels.push(label);
        (labels.len() - 1) as u8
    }
}

/// The signals among `functions`, and those that are not simulated, which go to `absent`.
pub(super) fn split<S: Copy>(
    functions: &[(u16, Function<S>)],
    absent: &mut Vec<(u16, u8)>,
) -> Vec<(u16, S)> {
    let mut signals = Vec::new();
    for (key, function) in functions {
        match function {
            Function::Signal(signal) => signals.push((*key, *signal)),
            Function::NotSimulated(index) => absent.push((*key, *index)),
        }
    }
    signals
}
