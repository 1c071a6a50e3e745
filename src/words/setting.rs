//! Numbers that a motion goes by: a model says which row holds them.

use super::words;
use crate::units::Dimension;

words! {
    /// A number that is read when a motion starts and holds until the next one.
    Setting {
        RunSpeed "run.speed" "speed of `run_start`; its sign is the direction",
        RunAccel "run.accel" "how a run speeds up",
        RunDecel "run.decel" "how a run slows down",
        JogSpeed "jog.speed" "speed of `jog_pos` and `jog_neg`; a sign does not count",
        JogAccel "jog.accel" "how a jog speeds up",
        JogDecel "jog.decel" "how a jog slows down",
        MoveTarget "move.target" "how far `move_start` goes, or where to",
        MoveSpeed "move.speed" "speed of `move_start`; a sign does not count",
        MoveStartSpeed "move.start_speed" "speed that a move takes at once and drops at once",
        MoveAccel "move.accel" "how a move speeds up",
        MoveDecel "move.decel" "how a move slows down",
        AlarmDecel "alarm.decel" "how an axis slows down that an alarm with `stop: ramp` stops; read when the alarm is raised",
    }
}

impl Setting {
    /// What it may measure; the row's unit must fit one of them.
    ///
    /// A ramp is an acceleration, or the time from standstill (a move: from its start speed) to the speed.
    pub fn dimensions(self) -> &'static [Dimension] {
        match self {
            Self::MoveTarget => &[Dimension::Position],
            Self::RunSpeed | Self::JogSpeed | Self::MoveSpeed | Self::MoveStartSpeed => {
                &[Dimension::Speed]
            }
            Self::AlarmDecel => &[Dimension::Acceleration],
            Self::RunAccel
            | Self::RunDecel
            | Self::JogAccel
            | Self::JogDecel
            | Self::MoveAccel
            | Self::MoveDecel => &[Dimension::Acceleration, Dimension::Time],
        }
    }
}
