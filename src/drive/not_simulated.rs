//! Functions that nothing emulates: the first time that one is asked for after power-on, the log says so.

use super::Drive;
use crate::event::{Ignored, Ordered};

impl Drive {
    /// Tells of what is asked for and not simulated, once each.
    pub(super) fn tell_not_simulated(&mut self) {
        if self.model.wiring.not_simulated.is_empty() || !self.powered {
            return;
        }
        let asked = self.inputs_not_simulated() | self.settings_not_simulated();
        let mut new = asked & !self.told_not_simulated;
        self.told_not_simulated |= asked;
        while new != 0 {
            let function = new.trailing_zeros() as u8;
            self.ignore(Ordered::Function(function), Ignored::NotSimulated);
            new &= new - 1;
        }
    }

    /// Input functions that are active, as bits by index.
    fn inputs_not_simulated(&self) -> u64 {
        let absent = &self.model.wiring.not_simulated;
        let mut asked = 0;
        let mut ask = |index: u8| asked |= 1 << index;
        self.active_codes(self.now, &absent.input_codes, &mut ask);
        self.active_positions(&absent.input_positions, &mut ask);
        self.active_bits(&absent.input_bits, &mut ask);
        asked
    }

    /// Output functions that something is to show, and digits of rows that are not 0, as bits by index.
    fn settings_not_simulated(&self) -> u64 {
        let wiring = &self.model.wiring;
        let absent = &wiring.not_simulated;
        let mut asked = 0;
        let functions = wiring.output_terminals.iter().flat_map(|it| &it.functions);
        for number in functions.map(|row| self.bank.raw(*row)) {
            let of_number = absent.output_codes.iter().filter(|it| u32::from(it.0) == number);
            of_number.for_each(|(_, index)| asked |= 1 << index);
        }
        for (position, index) in &absent.output_positions {
            let word = wiring.output_words.get(usize::from(position / 16));
            let row = word.and_then(|it| it.enabled_by);
            let enabled = row.is_some_and(|row| self.bank.raw(row) >> (position % 16) & 1 != 0);
            asked |= u64::from(enabled) << index;
        }
        for (digit, index) in &absent.digits {
            let is_set = digit.of(self.bank.value(&self.model, digit.row)) != 0;
            asked |= u64::from(is_set) << index;
        }
        asked
    }
}
