//! A drive as it is at an instant: computed for whoever looks at it, from closed forms, and stored nowhere.

use super::axis::AxisView;
use super::comms::Comms;
use super::inputs::InputSignals;
use super::outputs;
use crate::bank::{Bank, Kept};
use crate::model::{Model, Shown, Shows};
use crate::motion::{Machine, State};
use crate::time::Instant;
use crate::vocabulary::{Output, Outputs, Quantity, RowId};
use std::sync::Arc;

/// A drive as it is at an instant that is not before the last thing that happened to it, and not after the next one that
/// will happen by itself.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    axis: AxisView<'a>,
    inputs: &'a InputSignals,
    comms: &'a Comms,
    powered: bool,
}

impl<'a> View<'a> {
    pub(super) fn new(
        axis: AxisView<'a>,
        inputs: &'a InputSignals,
        comms: &'a Comms,
        powered: bool,
    ) -> Self {
        Self { axis, inputs, comms, powered }
    }

    /// The instant.
    pub fn now(self) -> Instant {
        self.axis.context().now
    }

    /// Its model.
    pub fn model(self) -> &'a Arc<Model> {
        self.axis.context().registers.model()
    }

    /// The cells of its registers, which do not hold what the drive computes.
    pub fn bank(self) -> &'a Bank {
        self.axis.context().registers.bank()
    }

    /// What it keeps over power-off.
    pub fn kept(self) -> Kept {
        self.axis.context().registers.kept()
    }

    /// The unit address in force.
    pub fn unit(self) -> u8 {
        self.comms.unit()
    }

    /// Has it supply?
    pub fn is_powered(self) -> bool {
        self.powered
    }

    /// Position and speed of the axis in the machine's coordinate, in counts and counts per second. No register shows
    /// that coordinate, and it stays as it is when positive counts go the other way.
    pub fn axis_state(self) -> State {
        self.axis.state()
    }

    /// What stands along the axis.
    pub fn machine(self) -> Machine {
        self.axis.machine()
    }

    /// Is the output signal active?
    pub fn output(self, signal: Output) -> bool {
        self.outputs().has(signal)
    }

    /// The number that `row` shows.
    pub fn value(self, row: RowId) -> i64 {
        self.model().map.row(row).kind.value(self.show(row))
    }

    /// The bits that `row` shows: what was written, or what the drive computes.
    pub fn show(self, row: RowId) -> u32 {
        let registers = self.axis.context().registers;
        match registers.model().wiring.shows(row) {
            None | Some(Shows::PastAlarm(_)) => registers.raw(row),
            Some(Shows::Quantity(quantity)) => self.show_quantity(row, *quantity),
            Some(Shows::Bits(bits)) => self.show_bits(bits),
            Some(Shows::OutputWord(word)) => {
                let word = &registers.model().wiring.output_words[usize::from(*word)];
                let enabled = word.enabled_by.map_or(0xFFFF, |row| registers.raw(row));
                self.show_bits(&word.bits) & enabled
            }
            Some(Shows::InputBits(of)) => self.inputs.bits(registers, *of),
            Some(Shows::InputTerminals(monitor)) => self.inputs.monitor(self.axis, *monitor),
            Some(Shows::OutputTerminals(monitor)) => {
                outputs::monitor(self.axis, self.outputs(), *monitor)
            }
        }
    }

    /// A number that the drive computes, in the base unit of its dimension, rounded.
    pub fn quantity(self, quantity: Quantity) -> i64 {
        match quantity {
            Quantity::PositionActual => self.axis.position(),
            Quantity::PositionFeedback => self.axis.feedback(),
            Quantity::PositionCommand => self.axis.feedback().saturating_add(self.deviation()),
            Quantity::CommandRate
            | Quantity::SpeedActual
            | Quantity::ElectricalAngle
            | Quantity::BusVoltage => self.measure(quantity).round() as i64,
            Quantity::EncoderAngle => self.axis.encoder_angle(),
            Quantity::EncoderTurns => self.axis.encoder_turns(),
            Quantity::SegmentRunning => self.axis.segment().into(),
            Quantity::SegmentNext => self.axis.next_segment().into(),
            Quantity::ErrorFollowing => self.deviation(),
            Quantity::AlarmCode => {
                self.axis.context().power.alarm().map_or(0, |trip| trip.code.into())
            }
            Quantity::UnitInUse => self.comms.unit().into(),
            Quantity::UnitSwitches => self.comms.switches().into(),
        }
    }

    pub(super) fn axis(self) -> AxisView<'a> {
        self.axis
    }

    pub(super) fn inputs(self) -> &'a InputSignals {
        self.inputs
    }

    fn show_bits(self, bits: &[(u8, Shown)]) -> u32 {
        let outputs = self.outputs();
        bits.iter().map(|(bit, shown)| u32::from(shown.is_active(outputs)) << bit).sum()
    }

    fn outputs(self) -> Outputs {
        if self.powered { outputs::outputs(self.axis) } else { Outputs::default() }
    }

    /// Counts that the encoder, as far as the drive sees it, is behind the command.
    fn deviation(self) -> i64 {
        self.axis.deviation().round() as i64
    }

    /// A number that comes in parts of its base unit.
    fn measure(self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::SpeedActual => self.axis.rpm(),
            Quantity::CommandRate => self.axis.motor().command_rate(self.now()),
            Quantity::ElectricalAngle => {
                let poles = f64::from(self.model().wiring.axis.pole_pairs);
                (self.axis.encoder_turn() * poles).fract() * 360.0
            }
            Quantity::BusVoltage => self.bus_voltage(),
            _ => self.quantity(quantity) as f64,
        }
    }

    /// In volts: what an alarm says whose cause is there, or the nominal one.
    fn bus_voltage(self) -> f64 {
        let cx = self.axis.context();
        let causes = cx.faults.active_causes(cx.inputs);
        let mut alarms = cx.model().wiring.alarms.iter().filter(|it| causes.has(it.cause));
        let nominal = || {
            let row = cx.model().wiring.row_of(Quantity::BusVoltage)?;
            let row = cx.model().map.row(row);
            Some(row.kind.value(row.init) as f64 * row.unit.scale)
        };
        alarms.find_map(|it| it.bus_voltage).or_else(nominal).unwrap_or(0.0)
    }

    fn show_quantity(self, row: RowId, quantity: Quantity) -> u32 {
        let unit = self.axis.context().registers.unit_of(row);
        let row = self.model().map.row(row);
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
}
