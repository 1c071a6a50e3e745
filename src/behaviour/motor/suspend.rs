//! Levels that hold the command of a move back: a pause, after which it goes on, and inhibited commands, which end it.

use super::goal::Goal;
use super::{Motor, Phase};
use crate::behaviour::effect::Effect;
use crate::motion::{State, Trajectory};
use crate::time::Instant;

/// What becomes of the commands of moves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Commands {
    /// The axis follows them.
    #[default]
    Taken,
    /// There are none; the axis makes up for what it is behind.
    Inhibited,
    /// There are none, and the axis gives up what it is behind.
    Cleared,
}

/// Counts that are worth dropping: well above what positions are rounded to.
const LEAST: f64 = 1e-3;

impl Motor {
    /// Does a level hold the move under way back?
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Holds back what levels hold back, and lets go on what they don't.
    pub(super) fn suspend(&mut self, now: Instant) {
        match self.wants.commands {
            Commands::Taken => {}
            Commands::Inhibited => self.end_command(now),
            Commands::Cleared => self.drop_deviation(now),
        }
        if self.phase == Phase::Moving && self.wants.pause != self.paused {
            match self.wants.pause {
                true => self.pause(now),
                false => self.resume(now),
            }
        }
    }

    /// The move under way slows down to a standstill, and is not over.
    fn pause(&mut self, now: Instant) {
        self.paused = true;
        let trajectory = self.held_back(now, self.trajectory.state(now));
        self.go_on(now, trajectory);
        self.effects.push_back(Effect::MovePaused);
    }

    /// The trajectory of a move that is held back, from a state of its command.
    pub(super) fn held_back(&self, now: Instant, from: State) -> Trajectory {
        let (slope, change) = self.goal.stop(self.wants.decel);
        Trajectory::stop(now, from, slope.of(change))
    }

    /// It goes on to where it was to go.
    fn resume(&mut self, now: Instant) {
        self.paused = false;
        let Goal::Position(target, ramp) = self.goal else { return };
        self.forward = target >= self.commanded(now);
        let from = self.trajectory.state(now);
        let trajectory = ramp.in_motion(from).reach(now, from, target);
        self.go_on(now, trajectory);
        self.effects.push_back(Effect::MoveResumed(target));
        self.obey_limits(now);
    }

    /// The command of a move stands at once; what the axis is behind it makes up for.
    fn end_command(&mut self, now: Instant) {
        if self.phase == Phase::Moving {
            self.goal = Goal::None;
            let trajectory = Trajectory::halt(now, self.state(now));
            self.begin(now, trajectory, Phase::Stopping);
            self.effects.push_back(Effect::Stopping);
        }
    }

    /// The axis gives up what it is behind its command: where its position is controlled it stands where it is, in a run
    /// or a jog the command goes on from there.
    fn drop_deviation(&mut self, now: Instant) {
        let here = self.feedback(now).position;
        let behind = self.trajectory.state(now).position - here;
        let moves = self.phase == Phase::Moving;
        match self.phase {
            Phase::Moving | Phase::Stopping if moves || self.lag.makes_up() => {
                self.goal = Goal::None;
                self.begin(now, Trajectory::rest(now, here), Phase::Stopping);
                self.effects.extend(moves.then_some(Effect::Stopping));
            }
            // Less is a rounding error, or what is left of a lag that decays.
            _ if behind.abs() < LEAST => return,
            Phase::Standing => self.trajectory = Trajectory::rest(now, here),
            Phase::Running | Phase::Jogging { .. } => {
                self.trajectory = self.trajectory.left(now, -behind);
            }
            Phase::Moving | Phase::Stopping | Phase::Homing | Phase::Coasting => return,
        }
        self.lag = self.lag.with_deviation(0.0);
        self.look_ahead(now);
        if behind.abs() >= LEAST {
            self.look_at_switches(now);
        }
        let counts = behind.round() as i64;
        self.effects.extend((counts != 0).then_some(Effect::DeviationCleared(counts)));
    }
}
