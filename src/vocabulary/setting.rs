//! Numbers that a motion goes by: a model says which row holds them, and when a new value counts.

use super::named_terms;
use crate::units::Dimension;

named_terms! {
    /// A number that a motion goes by.
    Setting {
        RunSpeed "run.speed" "speed of `run_start` and `run`; its sign is the direction",
        RunStartSpeed "run.start_speed" "speed that a run takes at once; a sign does not count",
        RunAccel "run.accel" "how a run speeds up",
        RunDecel "run.decel" "how a run slows down",
        JogSpeed "jog.speed" "speed of `jog_pos` and `jog_neg`; a sign does not count",
        JogAccel "jog.accel" "how a jog speeds up",
        JogDecel "jog.decel" "how a jog slows down",
        InchSpeed "inch.speed" "speed of `inch_pos` and `inch_neg`; a sign does not count",
        InchAccel "inch.accel" "how an inching axis speeds up",
        InchDecel "inch.decel" "how an inching axis slows down",
        MoveTarget "move.target" "how far `move_start` goes, or where to",
        MoveSpeed "move.speed" "speed of `move_start`; a sign does not count",
        MoveAbsolute "move.absolute" "with input `move_start`: `move.target` is a position while this is not 0, else a way",
        MoveStartSpeed "move.start_speed" "speed that a move takes at once and drops at once",
        MoveAccel "move.accel" "how a move speeds up",
        MoveDecel "move.decel" "how a move slows down",
        HomeFast "home.speed_fast" "speed of fast homing steps, and of the way on from the origin",
        HomeSlow "home.speed_slow" "speed of slow homing steps",
        HomeAccel "home.accel" "how a homing changes its speed; a time is that up to `home.speed_fast`",
        HomeWay "home.way" "how far to go on from the origin",
        HomeCoordinate "home.coordinate" "what the position register is to say when a homing is over",
        HomeCollision "home.collision" "counts that a hard stop holds the axis back until a homing takes it for the end of its way",
        HomeTimeLimit "home.time_limit" "most time that a homing may take; 0 is no limit",
        SoftLimitPos "limit.soft_pos" "greatest position, where soft limits are in force",
        SoftLimitNeg "limit.soft_neg" "least position, where soft limits are in force",
        AlarmDecel "alarm.decel" "how an axis slows down that an alarm with `stop: ramp` stops, if not as its motion would",
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
            | Self::HomeWay
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
