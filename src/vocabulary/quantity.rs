//! Numbers that the drive computes: a model says which row shows them.

use super::named_terms;
use crate::units::Dimension;

named_terms! {
    /// A number with a dimension.
    Quantity {
        PositionActual "position.actual" "actual position of the axis, in the coordinate of the drive",
        PositionCommand "position.command" "commanded position, in the coordinate of the drive: `position.feedback` plus `error.following`",
        PositionFeedback "position.feedback" "position of the encoder, in the coordinate of the drive and in counts of the command",
        CommandRate "command.rate" "rate of the position command in counts per second; negative in the negative direction",
        EncoderAngle "encoder.angle" "position of the encoder within one revolution, in counts from its zero mark",
        EncoderTurns "encoder.turns" "multi-turn count: whole revolutions of the encoder since it was cleared; negative in the negative direction",
        ElectricalAngle "encoder.electrical_angle" "electrical angle of the motor: the encoder angle times `axis.pole_pairs`, modulo one turn",
        SpeedActual "speed.actual" "actual speed of the axis; negative in the negative direction",
        SegmentRunning "segment.running" "number of the position segment started last; 0 after power-on",
        SegmentNext "segment.next" "number of the next position segment in the running chain; without a chain, of the selected one",
        ErrorFollowing "error.following" "following error: how far the axis lags behind the command of a move, in counts; negative in the negative direction",
        BusVoltage "bus.voltage" "DC bus voltage: the `init` of its row, or the `bus_voltage` of an alarm whose cause is present",
        AlarmCode "alarm.code" "the vendor's number of the present alarm; 0 if there is none",
        UnitInUse "unit.in_use" "the unit address in use",
        UnitSwitches "unit.switches" "the setting of the DIP switches",
    }
}

impl Quantity {
    /// What it measures; the row's unit must fit.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::PositionActual
            | Self::PositionCommand
            | Self::PositionFeedback
            | Self::EncoderAngle
            | Self::ErrorFollowing => Dimension::Position,
            Self::CommandRate => Dimension::Frequency,
            Self::BusVoltage => Dimension::Voltage,
            Self::EncoderTurns => Dimension::Turns,
            Self::ElectricalAngle => Dimension::Angle,
            Self::SpeedActual => Dimension::Speed,
            Self::SegmentRunning
            | Self::SegmentNext
            | Self::AlarmCode
            | Self::UnitInUse
            | Self::UnitSwitches => Dimension::None,
        }
    }
}
