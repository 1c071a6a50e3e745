//! Numbers: what a motion goes by, what the drive computes, and what outputs and an alarm compare that with. A model says which
//! rows hold them.

use super::named_terms;
use crate::units::Dimension;

named_terms! {
    /// A number that a motion goes by.
    Setting {
        RunSpeed "run.speed" "speed of `run_start` and `run`; the sign gives the direction",
        RunStartSpeed "run.start_speed" "start speed of a run, reached without a ramp; the sign is ignored",
        RunAccel "run.accel" "acceleration of a run",
        RunDecel "run.decel" "deceleration of a run",
        JogSpeed "jog.speed" "speed of `jog_pos` and `jog_neg`; the sign is ignored",
        JogAccel "jog.accel" "acceleration of a jog",
        JogDecel "jog.decel" "deceleration of a jog",
        InchSpeed "inch.speed" "speed of `inch_pos` and `inch_neg`; the sign is ignored",
        InchAccel "inch.accel" "acceleration of an inch",
        InchDecel "inch.decel" "deceleration of an inch",
        MoveTarget "move.target" "distance of `move_start`, or its target position",
        MoveSpeed "move.speed" "speed of `move_start`; the sign is ignored",
        MoveAbsolute "move.absolute" "with input `move_start`: not 0 if `move.target` is an absolute position, 0 if it is a distance",
        MoveStartSpeed "move.start_speed" "start and stop speed of a move, reached and left without a ramp",
        MoveAccel "move.accel" "acceleration of a move",
        MoveDecel "move.decel" "deceleration of a move",
        HomeFast "home.speed_fast" "speed of fast homing steps, and of the final move away from the origin",
        HomeSlow "home.speed_slow" "speed of slow homing steps",
        HomeAccel "home.accel" "acceleration and deceleration of a homing; a ramp time is the time up to `home.speed_fast`",
        HomeOffset "home.way" "home offset: distance of the final move away from the origin",
        HomeCoordinate "home.coordinate" "value of the position register when homing is complete",
        HomeCollision "home.collision" "following error at a hard stop, in counts, that a homing takes as the collision",
        HomeTimeLimit "home.time_limit" "maximum duration of a homing; 0 means no limit",
        SoftLimitPos "limit.soft_pos" "positive soft limit: the greatest permitted position",
        SoftLimitNeg "limit.soft_neg" "negative soft limit: the least permitted position",
        AlarmDecel "alarm.decel" "deceleration after an alarm with `stop: ramp`, in place of that of the motion",
    }
}

impl Setting {
    /// Does it say how an axis slows down? An order to stop takes it then.
    pub fn slows_down(self) -> bool {
        matches!(
            self,
            Self::RunDecel | Self::JogDecel | Self::InchDecel | Self::MoveDecel | Self::AlarmDecel
        )
    }

    /// Is it a bound that is watched, and no part of an order?
    pub fn is_bound(self) -> bool {
        matches!(self, Self::SoftLimitPos | Self::SoftLimitNeg)
    }

    /// What it may measure; the row's unit must fit one of them.
    ///
    /// A ramp is an acceleration, or the time from standstill (a move or run: from its start speed) to the speed.
    pub fn dimensions(self) -> &'static [Dimension] {
        match self {
            Self::MoveTarget
            | Self::HomeOffset
            | Self::HomeCoordinate
            | Self::SoftLimitPos
            | Self::SoftLimitNeg => &[Dimension::Position],
            Self::HomeCollision => &[Dimension::Position, Dimension::Increments],
            Self::MoveAbsolute => &[Dimension::None],
            Self::RunSpeed
            | Self::RunStartSpeed
            | Self::JogSpeed
            | Self::InchSpeed
            | Self::MoveSpeed
            | Self::MoveStartSpeed
            | Self::HomeFast
            | Self::HomeSlow => &[Dimension::Speed],
            Self::HomeTimeLimit => &[Dimension::Time],
            Self::AlarmDecel => &[Dimension::Acceleration],
            Self::RunAccel
            | Self::RunDecel
            | Self::JogAccel
            | Self::JogDecel
            | Self::InchAccel
            | Self::InchDecel
            | Self::MoveAccel
            | Self::MoveDecel
            | Self::HomeAccel => &[Dimension::Acceleration, Dimension::Time],
        }
    }
}

named_terms! {
    /// When a value that somebody writes to the row of a setting counts.
    Taken {
        Live "live" "immediately: a motion in progress that uses it is planned again from the current position and speed",
        AtOrder "at_order" "with the next command, including one given during motion; a stop, and a level signal that changes, count as commands",
        AtStart "at_start" "at the next start from standstill",
    }
}

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
