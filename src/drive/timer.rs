//! What happens to a drive by itself, by name.
//!
//! A deadline belongs to one part of the drive and wakes that part alone. Parts whose deadlines fall on one instant are
//! woken in the order of [`Timer`]; after that the drive is brought up to date, once for all of them.

use crate::behaviour::MotorTimer;
use std::fmt;

/// A deadline of a drive. Of several at one instant the first one here comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Timer {
    /// Initialising is over.
    Ready,
    /// The next edge of a contact that bounces: that of this input terminal, from 0.
    Bounce(u8),
    /// The axis, or a switch that it moves.
    Axis(MotorTimer),
    /// An input word was not refreshed in time: this one, from 0.
    HoldWord(u8),
    /// No master has spoken in time.
    MasterSilence,
    /// A segment gives way to the next one of its chain.
    Chain,
}

/// A part of a drive that has deadlines, in the order in which they are woken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TimerOwner {
    PowerStage,
    Contacts,
    Switches,
    Axis,
    InputWords,
    Comms,
}

impl TimerOwner {
    pub(super) const ALL: [Self; 6] = [
        Self::PowerStage,
        Self::Contacts,
        Self::Switches,
        Self::Axis,
        Self::InputWords,
        Self::Comms,
    ];
}

impl Timer {
    /// The part that it wakes. A chain has none: it goes on when everything else is up to date.
    pub(super) fn wakes(self) -> Option<TimerOwner> {
        Some(match self {
            Self::Ready => TimerOwner::PowerStage,
            Self::Bounce(_) => TimerOwner::Contacts,
            Self::Axis(MotorTimer::SwitchEdge) => TimerOwner::Switches,
            Self::Axis(_) => TimerOwner::Axis,
            Self::HoldWord(_) => TimerOwner::InputWords,
            Self::MasterSilence => TimerOwner::Comms,
            Self::Chain => return None,
        })
    }

    /// Does a master keep it from expiring?
    pub fn is_watchdog(self) -> bool {
        matches!(self, Self::HoldWord(_) | Self::MasterSilence)
    }
}

impl fmt::Display for Timer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ready => f.write_str("ready"),
            Self::Bounce(index) => write!(f, "bounce of terminal {index}"),
            Self::Axis(timer) => f.write_str(axis_name(*timer)),
            Self::HoldWord(word) => write!(f, "hold time of input word {word}"),
            Self::MasterSilence => f.write_str("master silence"),
            Self::Chain => f.write_str("segment chain"),
        }
    }
}

fn axis_name(timer: MotorTimer) -> &'static str {
    match timer {
        MotorTimer::SwitchEdge => "switch edge",
        MotorTimer::HardStop => "hard stop",
        MotorTimer::HardStopLeft => "hard stop left",
        MotorTimer::Collision => "collision",
        MotorTimer::IndexPulse => "index pulse",
        MotorTimer::DeviationLimit => "deviation limit",
        MotorTimer::SoftLimit => "soft limit",
        MotorTimer::TargetReached => "target reached",
        MotorTimer::Standstill => "standstill",
        MotorTimer::HomingTimeLimit => "homing time limit",
    }
}
