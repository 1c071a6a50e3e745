//! The motion under way: what the axis is doing, what that is to come to, and what is controlled meanwhile.

use super::goal::Goal;

/// What an axis is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Nothing.
    Standing,
    /// Going to a position.
    Moving,
    /// Going at a speed by order.
    Running,
    /// Going at a speed while a level asks for it.
    Jogging {
        /// In the positive direction?
        forward: bool,
    },
    /// Looking for its origin.
    Homing,
    /// Slowing down.
    Stopping,
    /// Coasting without power.
    Coasting,
}

impl Phase {
    /// Is a motion under way?
    pub fn is_moving(self) -> bool {
        self != Self::Standing
    }

    /// Going at a speed while a level asks for it?
    pub fn is_jogging(self) -> bool {
        matches!(self, Self::Jogging { .. })
    }

    /// Coming to a standstill already?
    pub fn is_slowing(self) -> bool {
        matches!(self, Self::Stopping | Self::Coasting)
    }

    /// Going at a speed, by order or by a level?
    pub(super) fn keeps_speed(self) -> bool {
        matches!(self, Self::Running | Self::Jogging { .. })
    }
}

/// What the drive holds to its command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Control {
    /// The position; at a standstill and in a homing too.
    Position,
    /// The speed, which was ordered to be so many counts per second.
    Speed(f64),
}

/// The motion under way, if there is one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MotionState {
    pub(super) phase: Phase,
    /// What it is to come to.
    pub(super) goal: Goal,
    /// Where it goes in the end: the positive direction?
    pub(super) forward: bool,
    /// Is the speed controlled, and not the position? Kept by a stop.
    by_speed: bool,
    /// A level holds the move under way back.
    pub(super) paused: bool,
    /// The last move or homing has come to its end.
    pub(super) arrived: bool,
}

impl MotionState {
    /// None.
    pub(super) fn standing() -> Self {
        Self {
            phase: Phase::Standing,
            goal: Goal::None,
            forward: true,
            by_speed: false,
            paused: false,
            arrived: false,
        }
    }

    /// Another phase begins; a jog is one `by_speed`, or by position.
    pub(super) fn begin(&mut self, phase: Phase, by_speed: bool) {
        self.by_speed = match phase {
            Phase::Running => true,
            Phase::Jogging { .. } => by_speed,
            Phase::Stopping => self.by_speed,
            Phase::Standing | Phase::Moving | Phase::Homing | Phase::Coasting => false,
        };
        (self.phase, self.paused, self.arrived) = (phase, false, false);
    }

    /// Nothing is under way any more, because a move or homing `arrived` or something else came to its end.
    pub(super) fn end(&mut self, arrived: bool) {
        (self.phase, self.arrived) = (Phase::Standing, arrived);
    }

    /// What is controlled where the axis has power and goes on at `last_speed` in the end; `None` until an axis that
    /// coasts has stopped.
    pub(super) fn control(&self, last_speed: f64) -> Option<Control> {
        match self.phase {
            Phase::Coasting => None,
            Phase::Standing => Some(Control::Position),
            _ if self.by_speed => Some(Control::Speed(last_speed)),
            _ => Some(Control::Position),
        }
    }

    /// Does a limit end it?
    pub(super) fn obeys_limits(&self) -> bool {
        self.phase == Phase::Moving || self.phase.keeps_speed()
    }
}
