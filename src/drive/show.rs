//! What a row shows: what was written, or what the drive computes when somebody looks.

use super::Drive;
use crate::model::Shows;
use crate::vocabulary::{Output, Quantity, RowId};

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
            Some(Shows::InputBits(of)) => self.input_bits(*of),
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
            Quantity::PositionFeedback => self.feedback(),
            Quantity::PositionCommand => self.feedback().saturating_add(self.deviation()),
            Quantity::CommandRate
            | Quantity::SpeedActual
            | Quantity::ElectricalAngle
            | Quantity::BusVoltage => self.measure(quantity).round() as i64,
            Quantity::EncoderAngle => self.encoder_angle(),
            Quantity::EncoderTurns => self.encoder_turns(),
            Quantity::SegmentRunning => self.segment.into(),
            Quantity::SegmentNext => self.next_segment().into(),
            Quantity::ErrorFollowing => self.deviation(),
            Quantity::AlarmCode => self.power_stage.alarm().map_or(0, |trip| trip.code.into()),
            Quantity::UnitInUse => self.unit.into(),
            Quantity::UnitSwitches => self.switches.into(),
        }
    }

    /// Where the encoder is, in the drive's coordinate and in counts, whatever the gear.
    fn feedback(&self) -> i64 {
        self.seen_position().saturating_sub(self.zero)
    }

    /// `position` as the row of the actual position shows it, which has fewer bits than an axis has counts.
    pub(super) fn wrapped(&self, position: i64) -> i64 {
        let row = self.model.row_showing(&Shows::Quantity(Quantity::PositionActual));
        row.map_or(position, |row| {
            let kind = self.model.map.row(row).kind;
            kind.value(kind.wrapped(position))
        })
    }

    /// A number that comes in parts of its base unit.
    fn measure(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::SpeedActual => self.rpm(),
            Quantity::CommandRate => self.motor.command_rate(self.now),
            Quantity::ElectricalAngle => {
                let poles = f64::from(self.model.wiring.axis.pole_pairs);
                let turn = self.encoder_angle() as f64 / self.counts_per_rev;
                (turn * poles).fract() * 360.0
            }
            Quantity::BusVoltage => self.bus_voltage(),
            _ => self.quantity(quantity) as f64,
        }
    }

    /// In volts.
    fn bus_voltage(&self) -> f64 {
        let standing = self.standing_causes();
        let mut alarms = self.model.wiring.alarms.iter().filter(|it| standing.has(it.cause));
        let nominal = || {
            let shows = Shows::Quantity(Quantity::BusVoltage);
            let row = self.model.row_showing(&shows)?;
            let row = self.model.map.row(row);
            Some(row.kind.value(row.init) as f64 * row.unit.scale)
        };
        alarms.find_map(|it| it.bus_voltage).or_else(nominal).unwrap_or(0.0)
    }

    /// Counts that the encoder, as far as the drive sees it, is behind the command.
    fn deviation(&self) -> i64 {
        self.deviation_seen().round() as i64
    }

    /// Counts from the zero mark of the encoder, below a revolution.
    pub(super) fn encoder_angle(&self) -> i64 {
        self.seen_position().rem_euclid(self.counts_per_rev as i64)
    }

    fn encoder_turns(&self) -> i64 {
        self.full_turns() - self.cleared_turns
    }

    /// Whole revolutions of the encoder, whatever was cleared.
    pub(super) fn full_turns(&self) -> i64 {
        self.seen_position().div_euclid(self.counts_per_rev as i64)
    }

    fn show_quantity(&self, row: RowId, quantity: Quantity) -> u32 {
        let unit = self.unit_of(row);
        let row = self.model.map.row(row);
        match quantity {
            Quantity::SpeedActual
            | Quantity::CommandRate
            | Quantity::ElectricalAngle
            | Quantity::BusVoltage => {
                row.kind.raw((self.measure(quantity) / unit.scale).round() as i64)
            }
            // A counter that is full begins anew; it does not stick.
            Quantity::PositionActual
            | Quantity::PositionFeedback
            | Quantity::PositionCommand
            | Quantity::EncoderTurns => row.kind.wrapped(self.quantity(quantity)),
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
