//! Numbers that the drive computes, and numbers that outputs and an alarm compare them with: a model says which rows hold them.

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

named_terms! {
    /// A number that something of the axis is held against at any time.
    Threshold {
        ZeroSpeed "zero.speed" "`zero_speed` is on up to this speed; default 0",
        TurningSpeed "turning.speed" "`turning` is on above this speed",
        ReachedSpeed "reached.speed" "the target speed of `speed_reached`",
        ReachedWindow "reached.window" "tolerance of `speed_reached` around `reached.speed`",
        PositionWindow "position.window" "in-position window: maximum distance from the target for `in_position` and `settled`; default 0",
        PositionSettle "position.settle" "minimum time within `position.window`; default 0",
        InterruptDoneTime "interrupt.done_time" "how long `interrupt_done` stays on",
        CoincidesWindow "coincides.window" "maximum following error for `coincides`",
        NearWindow "near.window" "maximum following error for `near`",
        AgreesWindow "agrees.window" "tolerance of `speed_agrees` around the commanded speed",
        CommandSpeed "command.speed" "`command_present` is on above this speed; default 0",
        Deviation "limit.deviation" "maximum following error before alarm `position_deviation`",
    }
}

impl Threshold {
    /// What it may measure; the row's unit must fit one of them.
    pub fn dimensions(self) -> &'static [Dimension] {
        match self {
            Self::ZeroSpeed
            | Self::TurningSpeed
            | Self::ReachedSpeed
            | Self::ReachedWindow
            | Self::AgreesWindow
            | Self::CommandSpeed => &[Dimension::Speed],
            Self::PositionWindow | Self::CoincidesWindow | Self::NearWindow => {
                &[Dimension::Position]
            }
            Self::Deviation => &[Dimension::Position, Dimension::Increments],
            Self::PositionSettle | Self::InterruptDoneTime => &[Dimension::Time],
        }
    }
}
