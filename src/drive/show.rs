//! What a row shows: what was written, or what the drive computes when somebody looks.

use super::Drive;
use crate::model::Shows;
use crate::words::{Output, Quantity, RowId};

impl Drive {
    /// The bits of what `row` shows right now.
    pub fn show(&self, row: RowId) -> u32 {
        match self.model.wiring.shows(row) {
            None | Some(Shows::PastAlarm(_)) => self.bank.raw(row),
            Some(Shows::Quantity(quantity)) => self.show_quantity(row, *quantity),
            Some(Shows::Bits(bits)) => {
                let outputs = self.outputs();
                let bit = |(bit, shown): &(u8, crate::model::Shown)| {
                    u32::from(shown.is_active(outputs)) << bit
                };
                bits.iter().map(bit).sum()
            }
            Some(Shows::OutputWord(word)) => self.output_word(*word),
            Some(Shows::InputTerminals(monitor)) => self.monitor_inputs(*monitor),
            Some(Shows::OutputTerminals(monitor)) => self.monitor_outputs(*monitor),
        }
    }

    /// Is the output signal active?
    pub fn output(&self, signal: Output) -> bool {
        self.outputs().has(signal)
    }

    /// A number that the drive computes, in the base unit of its dimension, rounded.
    pub fn quantity(&self, quantity: Quantity) -> i64 {
        match quantity {
            Quantity::PositionActual => self.position(),
            Quantity::SpeedActual => self.rpm().round() as i64,
            Quantity::SegmentRunning => self.segment.into(),
            Quantity::SegmentNext => self.next_segment().into(),
            Quantity::ErrorFollowing => self.motor.deviation(self.now).round() as i64,
            Quantity::AlarmCode => self.servo.alarm().map_or(0, |trip| trip.code.into()),
            Quantity::UnitInUse => self.unit.into(),
            Quantity::UnitSwitches => self.switches.into(),
        }
    }

    fn show_quantity(&self, row: RowId, quantity: Quantity) -> u32 {
        let unit = self.unit_of(row);
        let row = self.model.map.row(row);
        match quantity {
            Quantity::SpeedActual => row.kind.raw((self.rpm() / unit.scale).round() as i64),
            // A counter that is full begins anew; it does not stick.
            Quantity::PositionActual => row.kind.wrapped(self.position()),
            _ => row.kind.raw(self.quantity(quantity)),
        }
    }

    fn output_word(&self, word: u16) -> u32 {
        let Some(words) = &self.model.wiring.output_words else { return 0 };
        let outputs = self.outputs();
        let enabled =
            words.enabled_by.get(usize::from(word)).map_or(0xFFFF, |row| self.bank.raw(*row));
        let mine = words.positions.iter().filter(|(position, _)| position / 16 == word);
        let bit = |(position, shown): &(u16, crate::model::Shown)| {
            u32::from(shown.is_active(outputs)) << (position % 16)
        };
        mine.map(bit).sum::<u32>() & enabled
    }
}
