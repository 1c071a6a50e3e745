//! What a row shows: what was written, or what the drive computes when somebody looks.

use super::Drive;
use crate::model::{Shown, Shows};
use crate::time::Instant;
use crate::vocabulary::{Output, Quantity, RowId};

impl Drive {
    /// The bits of what `row` shows right now.
    pub(super) fn show(&self, now: Instant, row: RowId) -> u32 {
        match self.model.wiring.shows(row) {
            None | Some(Shows::PastAlarm(_)) => self.bank.raw(row),
            Some(Shows::Quantity(quantity)) => self.show_quantity(now, row, *quantity),
            Some(Shows::Bits(bits)) => self.show_bits(now, bits),
            Some(Shows::OutputWord(word)) => {
                let word = &self.model.wiring.output_words[usize::from(*word)];
                let enabled = word.enabled_by.map_or(0xFFFF, |row| self.bank.raw(row));
                self.show_bits(now, &word.bits) & enabled
            }
            Some(Shows::InputBits(of)) => self.input_bits(*of),
            Some(Shows::InputTerminals(monitor)) => self.monitor_inputs(now, *monitor),
            Some(Shows::OutputTerminals(monitor)) => self.monitor_outputs(now, *monitor),
        }
    }

    /// Is the output signal active?
    pub(super) fn output(&self, now: Instant, signal: Output) -> bool {
        self.outputs(now).has(signal)
    }

    /// A number that the drive computes, in the base unit of its dimension, rounded.
    pub(super) fn quantity(&self, now: Instant, quantity: Quantity) -> i64 {
        match quantity {
            Quantity::PositionActual => self.position(now),
            Quantity::PositionFeedback => self.feedback(now),
            Quantity::PositionCommand => self.feedback(now).saturating_add(self.deviation(now)),
            Quantity::CommandRate
            | Quantity::SpeedActual
            | Quantity::ElectricalAngle
            | Quantity::BusVoltage => self.measure(now, quantity).round() as i64,
            Quantity::EncoderAngle => self.encoder_angle(now),
            Quantity::EncoderTurns => self.encoder_turns(now),
            Quantity::SegmentRunning => self.segment.into(),
            Quantity::SegmentNext => self.next_segment().into(),
            Quantity::ErrorFollowing => self.deviation(now),
            Quantity::AlarmCode => self.power_stage.alarm().map_or(0, |trip| trip.code.into()),
            Quantity::UnitInUse => self.comms.unit().into(),
            Quantity::UnitSwitches => self.comms.switches().into(),
        }
    }

    /// Where the encoder is, in the drive's coordinate and in counts, whatever the gear.
    fn feedback(&self, now: Instant) -> i64 {
        self.seen_position(now).saturating_sub(self.zero)
    }

    /// `position` as the row of the actual position shows it, which has fewer bits than an axis has counts.
    pub(super) fn wrapped(&self, position: i64) -> i64 {
        let row = self.model.wiring.row_of(Quantity::PositionActual);
        row.map_or(position, |row| {
            let kind = self.model.map.row(row).kind;
            kind.value(kind.wrapped(position))
        })
    }

    /// A number that comes in parts of its base unit.
    fn measure(&self, now: Instant, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::SpeedActual => self.rpm(now),
            Quantity::CommandRate => self.motor.command_rate(now),
            Quantity::ElectricalAngle => {
                let poles = f64::from(self.model.wiring.axis.pole_pairs);
                let turn = self.encoder_angle(now) as f64 / self.counts_per_rev;
                (turn * poles).fract() * 360.0
            }
            Quantity::BusVoltage => self.bus_voltage(),
            _ => self.quantity(now, quantity) as f64,
        }
    }

    /// In volts.
    fn bus_voltage(&self) -> f64 {
        let standing = self.standing_causes();
        let mut alarms = self.model.wiring.alarms.iter().filter(|it| standing.has(it.cause));
        let nominal = || {
            let row = self.model.wiring.row_of(Quantity::BusVoltage)?;
            let row = self.model.map.row(row);
            Some(row.kind.value(row.init) as f64 * row.unit.scale)
        };
        alarms.find_map(|it| it.bus_voltage).or_else(nominal).unwrap_or(0.0)
    }

    /// Counts that the encoder, as far as the drive sees it, is behind the command.
    fn deviation(&self, now: Instant) -> i64 {
        self.deviation_seen(now).round() as i64
    }

    /// Counts from the zero mark of the encoder, below a revolution.
    pub(super) fn encoder_angle(&self, now: Instant) -> i64 {
        self.seen_position(now).rem_euclid(self.counts_per_rev as i64)
    }

    fn encoder_turns(&self, now: Instant) -> i64 {
        self.full_turns(now) - self.cleared_turns
    }

    /// Whole revolutions of the encoder, whatever was cleared.
    pub(super) fn full_turns(&self, now: Instant) -> i64 {
        self.seen_position(now).div_euclid(self.counts_per_rev as i64)
    }

    fn show_quantity(&self, now: Instant, row: RowId, quantity: Quantity) -> u32 {
        let unit = self.unit_of(row);
        let row = self.model.map.row(row);
        match quantity {
            Quantity::SpeedActual
            | Quantity::CommandRate
            | Quantity::ElectricalAngle
            | Quantity::BusVoltage => {
                row.kind.raw((self.measure(now, quantity) / unit.scale).round() as i64)
            }
            // A counter that is full begins anew; it does not stick.
            Quantity::PositionActual
            | Quantity::PositionFeedback
            | Quantity::PositionCommand
            | Quantity::EncoderTurns => row.kind.wrapped(self.quantity(now, quantity)),
            _ => row.kind.raw(self.quantity(now, quantity)),
        }
    }

    fn show_bits(&self, now: Instant, bits: &[(u8, Shown)]) -> u32 {
        let outputs = self.outputs(now);
        bits.iter().map(|(bit, shown)| u32::from(shown.is_active(outputs)) << bit).sum()
    }
}
