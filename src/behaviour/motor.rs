//! What the axis is doing: it stands, moves to a position, runs, jogs, stops or coasts.
//!
//! An order becomes a trajectory and a phase; after that nothing happens until the trajectory ends, which
//! is the only deadline. Speeds and slopes come with the order and hold until the next one, so a
//! deceleration written during a motion counts from the next motion on.
//!
//! In a move, where the position is controlled, the axis runs behind its trajectory by a lag, which goes along to the
//! stop that may end it. A run, a jog or a coasting axis has none: it starts where the axis is. A move that takes its
//! place commands as far ahead as the axis is to be behind, so that it goes on at its speed.
//!
//! Deliberately absent: limits, homing.

use super::phase::{Phase, Stage};
use crate::event::Ignored;
use crate::motion::{Lag, Move, State, Trajectory};
use crate::time::{Duration, Instant};

/// A speed and how to get to it and from it; counts per second, the sign is the direction, and counts per
/// second squared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Where to.
    pub speed: f64,
    /// Getting faster.
    pub accel: f64,
    /// Getting slower.
    pub decel: f64,
}

/// What the levels ask for right now.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Wants {
    /// Power stage on?
    pub power: bool,
    /// Stand, after a ramp.
    pub stop: bool,
    /// Stand at once.
    pub quick_stop: bool,
    /// Jog; `None` for neither direction, or both.
    pub jog: Option<Ramp>,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    trajectory: Trajectory,
    /// How far the axis is behind it.
    lag: Lag,
    /// How fast a move makes up for that, 1/s; `None` at once.
    gain: Option<f64>,
    phase: Phase,
    /// Slope of a stop, from the order that started the motion.
    decel: f64,
    /// How long it runs out without power.
    coast: Duration,
    power: bool,
    /// A level holds it still.
    held: bool,
    /// An order ended the jog; its level must go before it acts again.
    jog_spent: bool,
    in_position: bool,
}

impl Motor {
    /// Standing at `position`, without power.
    pub fn standing(now: Instant, position: f64, coast: Duration, gain: Option<f64>) -> Self {
        Self {
            trajectory: Trajectory::rest(now, position),
            lag: Lag::NONE,
            gain,
            phase: Phase::Standing,
            decel: 0.0,
            coast,
            power: false,
            held: false,
            jog_spent: false,
            in_position: false,
        }
    }

    /// Position and speed as they are commanded, not in whole counts.
    pub fn state(&self, now: Instant) -> State {
        self.trajectory.state(now)
    }

    /// Is a motion under way?
    pub fn is_moving(&self) -> bool {
        self.phase != Phase::Standing
    }

    /// When the motion ends by itself.
    pub fn deadline(&self) -> Option<Instant> {
        self.trajectory.end().filter(|_| self.is_moving())
    }

    /// Lets time pass up to `now`, which is not later than the deadline.
    pub fn advance(&mut self, now: Instant, tell: &mut impl FnMut(Stage)) {
        if self.deadline().is_some_and(|end| end <= now) {
            self.in_position = self.phase == Phase::Moving;
            self.phase = Phase::Standing;
            tell(Stage::Stands(self.trajectory.position(now)));
        }
    }

    /// Follows the levels. To be called whenever one of them may have changed, or a motion has ended.
    pub fn follow(&mut self, now: Instant, wants: Wants, tell: &mut impl FnMut(Stage)) {
        self.power = wants.power;
        self.held = wants.stop || wants.quick_stop;
        self.jog_spent &= wants.jog.is_some();
        if !wants.power {
            return self.coast(now, tell);
        }
        if wants.quick_stop {
            self.halt(now, tell);
        } else if wants.stop {
            self.brake(now, tell);
        }
        match wants.jog {
            None if matches!(self.phase, Phase::Jogging { .. }) => self.brake(now, tell),
            None => {}
            Some(ramp) => self.jog(now, ramp, tell),
        }
    }

    /// Goes to `target`, given where it is.
    ///
    /// # Errors
    /// Why it does not start: without power, while held, or while it moves and may not `interrupt`.
    pub fn start_move(
        &mut self,
        now: Instant,
        target: impl FnOnce(i64) -> i64,
        how: Move,
        interrupt: bool,
        tell: &mut impl FnMut(Stage),
    ) -> Result<(), Ignored> {
        self.may_start(interrupt)?;
        let target = target(self.trajectory.position(now));
        let trajectory = Trajectory::to_position(now, self.lead(now).0, target, how);
        self.decel = how.decel;
        self.begin(now, trajectory, Phase::Moving, Stage::Moves(target), tell);
        Ok(())
    }

    /// Goes at a speed until stopped.
    ///
    /// # Errors
    /// Why it does not start: without power, while held, or while it moves.
    pub fn start_run(
        &mut self,
        now: Instant,
        ramp: Ramp,
        tell: &mut impl FnMut(Stage),
    ) -> Result<(), Ignored> {
        self.may_start(false)?;
        self.go(now, ramp, Phase::Running, Stage::Runs(ramp.speed), tell);
        Ok(())
    }

    /// Slows down to a standstill.
    pub fn stop(&mut self, now: Instant, tell: &mut impl FnMut(Stage)) {
        self.jog_spent = true;
        self.brake(now, tell);
    }

    /// Slows down to a standstill with a slope of its own.
    pub fn stop_with(&mut self, now: Instant, decel: f64, tell: &mut impl FnMut(Stage)) {
        self.jog_spent = true;
        if self.power && self.is_moving() {
            let trajectory = Trajectory::stop(now, self.state(now), decel);
            self.begin(now, trajectory, Phase::Stopping, Stage::Stops, tell);
        }
    }

    /// Stands at once.
    pub fn quick_stop(&mut self, now: Instant, tell: &mut impl FnMut(Stage)) {
        self.jog_spent = true;
        self.halt(now, tell);
    }

    /// Where the command of a move starts, and how far the axis is behind it.
    fn lead(&self, now: Instant) -> (State, Lag) {
        let state = self.state(now);
        match self.gain {
            Some(gain) if self.lag == Lag::NONE => {
                let ahead = State { position: state.position + state.speed / gain, ..state };
                (ahead, Lag::at_speed(gain, state.speed))
            }
            _ => (state, self.lag.carried(&self.trajectory, now)),
        }
    }

    fn may_start(&self, interrupt: bool) -> Result<(), Ignored> {
        match () {
            () if !self.power => Err(Ignored::PowerOff),
            () if self.held => Err(Ignored::Held),
            () if self.is_moving() && !interrupt => Err(Ignored::Moving),
            () => Ok(()),
        }
    }

    fn jog(&mut self, now: Instant, ramp: Ramp, tell: &mut impl FnMut(Stage)) {
        let forward = ramp.speed >= 0.0;
        let free = match self.phase {
            Phase::Standing | Phase::Stopping | Phase::Coasting => true,
            Phase::Jogging { forward: now } => now != forward,
            Phase::Moving | Phase::Running => false,
        };
        if free && !self.held && !self.jog_spent {
            self.go(now, ramp, Phase::Jogging { forward }, Stage::Jogs(ramp.speed), tell);
        }
    }

    fn go(
        &mut self,
        now: Instant,
        ramp: Ramp,
        phase: Phase,
        stage: Stage,
        tell: &mut impl FnMut(Stage),
    ) {
        let Ramp { speed, accel, decel } = ramp;
        let trajectory = Trajectory::to_speed(now, self.feedback(now), speed, accel, decel);
        self.decel = decel;
        self.begin(now, trajectory, phase, stage, tell);
    }

    fn brake(&mut self, now: Instant, tell: &mut impl FnMut(Stage)) {
        if matches!(self.phase, Phase::Moving | Phase::Running | Phase::Jogging { .. }) {
            let trajectory = Trajectory::stop(now, self.state(now), self.decel);
            self.begin(now, trajectory, Phase::Stopping, Stage::Stops, tell);
        }
    }

    fn halt(&mut self, now: Instant, tell: &mut impl FnMut(Stage)) {
        if self.power && self.is_moving() {
            let trajectory = Trajectory::halt(now, self.state(now));
            self.begin(now, trajectory, Phase::Stopping, Stage::Stops, tell);
        }
    }

    fn coast(&mut self, now: Instant, tell: &mut impl FnMut(Stage)) {
        if self.is_moving() && self.phase != Phase::Coasting {
            let trajectory = Trajectory::coast(now, self.feedback(now), self.coast);
            self.begin(now, trajectory, Phase::Coasting, Stage::Coasts, tell);
        }
    }

    fn begin(
        &mut self,
        now: Instant,
        trajectory: Trajectory,
        phase: Phase,
        stage: Stage,
        tell: &mut impl FnMut(Stage),
    ) {
        // An order takes the place of a jog for good: its level may still be there when the order is done.
        self.jog_spent |= matches!(self.phase, Phase::Jogging { .. }) && phase == Phase::Moving;
        self.lag = match phase {
            Phase::Moving => self.lead(now).1,
            Phase::Standing | Phase::Stopping => self.lag.carried(&self.trajectory, now),
            Phase::Running | Phase::Jogging { .. } | Phase::Coasting => Lag::NONE,
        };
        (self.trajectory, self.phase, self.in_position) = (trajectory, phase, false);
        tell(stage);
        // What takes no time is over.
        self.advance(now, tell);
    }
}

mod look;
#[cfg(test)]
mod tests;
