//! Numbers that the drive computes: a model says which row shows them.

use super::named_terms;
use crate::units::Dimension;

named_terms! {
    /// A number with a dimension.
    Quantity {
        PositionActual "position.actual" "where the axis stands, in the drive's coordinate",
        PositionCommand "position.command" "where the command of the axis is, in the drive's coordinate: `position.feedback` and `error.following`",
        PositionFeedback "position.feedback" "where the encoder is, in the drive's coordinate and in counts of the command",
        CommandRate "command.rate" "counts a second of the command in position control; negative in the negative direction",
        EncoderAngle "encoder.angle" "where the encoder is in its revolution, in counts from its zero mark",
        EncoderTurns "encoder.turns" "whole revolutions of the encoder since its turns were cleared; negative in the negative direction",
        ElectricalAngle "encoder.electrical_angle" "the angle of the motor's field: that of the encoder times `axis.pole_pairs`, below a whole turn",
        SpeedActual "speed.actual" "how fast the axis goes; negative in the negative direction",
        SegmentRunning "segment.running" "number of the position segment that started last; 0 after power-on",
        SegmentNext "segment.next" "number of the position segment that comes next in the chain under way; without one, of the one selected",
        ErrorFollowing "error.following" "how far the axis is behind the command of a move, in counts; negative in the negative direction",
        BusVoltage "bus.voltage" "the voltage of the bus: the `init` of its row, or the `bus_voltage` of an alarm whose cause stands",
        AlarmCode "alarm.code" "the vendor's number of the present alarm, 0 without one",
        UnitInUse "unit.in_use" "the unit address that the drive answers to",
        UnitSwitches "unit.switches" "the DIP switches as they are set",
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
