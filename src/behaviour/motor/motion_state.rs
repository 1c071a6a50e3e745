//! The motion under way: what the axis is doing, what that is to come to and how, and what is controlled meanwhile.

use crate::behaviour::effect::Replan;
use crate::motion::{Move, State, Trajectory};
use crate::time::Instant;

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

/// How fast a speed changes. 0 of either is at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slope {
    /// Counts per second squared.
    Rate(f64),
    /// Seconds for the whole change, that is from the start speed to the speed.
    Time(f64),
}

impl Slope {
    /// In counts per second squared, where the whole change is `change` counts per second. Not a number above
    /// 0 is at once.
    pub fn of(self, change: f64) -> f64 {
        match self {
            Self::Rate(rate) => rate,
            Self::Time(time) => change / time,
        }
    }
}

/// A speed and how to get to it and from it; counts per second, the sign is the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Where to.
    pub speed: f64,
    /// Getting faster.
    pub accel: Slope,
    /// Getting slower.
    pub decel: Slope,
    /// A magnitude that is taken at once.
    pub start_speed: f64,
}

impl Ramp {
    /// The change of speed that a ramp in time is about.
    pub fn change(&self) -> f64 {
        (self.speed.abs() - self.start_speed).max(0.0)
    }

    /// The trajectory that keeps its speed. A speed above it is part of the change.
    pub(super) fn keep(&self, now: Instant, from: State) -> Trajectory {
        let Move { start_speed, accel, decel, .. } = self.plan(from);
        Trajectory::to_speed_with_start(now, from, self.speed, accel, decel, start_speed)
    }

    /// The trajectory that ends at `target`.
    pub(super) fn reach(&self, now: Instant, from: State, target: i64) -> Trajectory {
        Trajectory::to_position(now, from, target, self.plan(from))
    }

    /// The same for an axis that moves already: it takes no start speed at once.
    #[must_use]
    pub(super) fn in_motion(&self, from: State) -> Self {
        let start_speed = match from.speed {
            0.0 => self.start_speed,
            speed => self.start_speed.min(speed.abs()),
        };
        Self { start_speed, ..*self }
    }

    fn plan(&self, from: State) -> Move {
        let start_speed = self.start_speed;
        let change = (self.speed.abs().max(from.speed.abs()) - start_speed).max(0.0);
        let [accel, decel] = [self.accel, self.decel].map(|it| it.of(change));
        Move { start_speed, speed: self.speed.abs(), accel, decel }
    }
}

/// What a motion is to come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// Nothing that settings could change.
    None,
    /// To keep a speed.
    Speed(Ramp),
    /// To stand at a count of the machine.
    Position(i64, Ramp),
    /// To stand, after a ramp from a speed of so many counts per second at most.
    Stop(Slope, f64),
}

impl Goal {
    /// How a stop slows down, and from which change of speed, in counts per second squared.
    pub(super) fn stop(&self, decel: Option<Slope>) -> (Slope, f64) {
        match self {
            Self::None => (decel.unwrap_or(Slope::Rate(0.0)), 0.0),
            Self::Speed(ramp) | Self::Position(_, ramp) => {
                (decel.unwrap_or(ramp.decel), ramp.change())
            }
            Self::Stop(slope, change) => (decel.unwrap_or(*slope), *change),
        }
    }

    /// What is different in `other`, a goal of the same kind.
    pub(super) fn replans(&self, other: &Self) -> impl Iterator<Item = Replan> + use<> {
        let ramps = |was: &Ramp, is: &Ramp| {
            [
                (was.speed != is.speed).then_some(Replan::Speed(is.speed)),
                (was.start_speed != is.start_speed).then_some(Replan::StartSpeed(is.start_speed)),
                (was.accel != is.accel).then(|| Replan::Accel(is.accel.of(is.change()))),
                (was.decel != is.decel).then(|| Replan::Decel(is.decel.of(is.change()))),
            ]
        };
        let (target, others) = match (self, other) {
            (Self::Speed(was), Self::Speed(is)) => (None, ramps(was, is)),
            (Self::Position(from, was), Self::Position(to, is)) => {
                ((from != to).then_some(Replan::Target(*to)), ramps(was, is))
            }
            (_, Self::Stop(decel, change)) => (Some(Replan::Decel(decel.of(*change))), [None; 4]),
            _ => (None, [None; 4]),
        };
        target.into_iter().chain(others.into_iter().flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMP: Ramp =
        Ramp { speed: 100.0, accel: Slope::Rate(1e3), decel: Slope::Time(0.5), start_speed: 20.0 };

    fn replans(was: Goal, is: Goal) -> Vec<Replan> {
        was.replans(&is).collect()
    }

    #[test]
    fn tells_what_is_different_and_nothing_else() {
        let faster = Ramp { speed: 120.0, ..RAMP };
        assert_eq!(replans(Goal::Speed(RAMP), Goal::Speed(RAMP)), []);
        assert_eq!(replans(Goal::Speed(RAMP), Goal::Speed(faster)), [Replan::Speed(120.0)]);
        let moved = replans(Goal::Position(5, RAMP), Goal::Position(7, faster));
        assert_eq!(moved, [Replan::Target(7), Replan::Speed(120.0)]);
        // A time is that of the whole change, from the start speed to the speed.
        let longer = Ramp { decel: Slope::Time(2.0), ..RAMP };
        assert_eq!(replans(Goal::Speed(RAMP), Goal::Speed(longer)), [Replan::Decel(40.0)]);
    }

    #[test]
    fn a_stop_slows_down_as_the_motion_does_or_as_it_is_told() {
        assert_eq!(Goal::Speed(RAMP).stop(None), (Slope::Time(0.5), 80.0));
        assert_eq!(Goal::Speed(RAMP).stop(Some(Slope::Rate(9.0))), (Slope::Rate(9.0), 80.0));
        assert_eq!(Goal::Stop(Slope::Rate(3.0), 7.0).stop(None), (Slope::Rate(3.0), 7.0));
        assert_eq!(Goal::None.stop(None).0.of(80.0), 0.0);
    }
}
