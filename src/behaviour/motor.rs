//! What the axis is doing: it stands, moves to a position, runs, jogs, looks for its origin, stops or coasts.
//!
//! An order becomes a trajectory and a phase; after that nothing happens until something on the way does
//! (`wake.rs`): the trajectory ends, a switch changes, a limit or a hard stop is met. Speeds and slopes come with the
//! order; who wants others on the way says so, and the rest is planned anew (`replan.rs`).
//!
//! The trajectory is what the axis is told. Where it is can be less: a hard stop holds it, and in a move, where the
//! position is controlled, it runs behind by a lag, which goes along to the stop that may end the move. A run, a jog, a
//! homing or a coasting axis has no lag: it starts where the axis is. A move that takes its place commands as far ahead
//! as the axis is to be behind, so that it goes on at its speed.

mod block;
mod goal;
mod home;
mod limits;
mod observe;
mod replan;
mod suspend;
mod timers;
mod wake;

pub use goal::{Ramp, Slope};
pub use home::HomeOrder;
pub use observe::Control;
pub use suspend::Commands;
pub use timers::MotorTimer;

use super::effect::{Effect, Phase};
use crate::event::Ignored;
use crate::motion::{CrossingDirection, Lag, Machine, State, Trajectory};
use crate::time::{Duration, Instant};
use crate::vocabulary::{HomeEnd, Inputs, LimitStop};
use goal::Goal;
use home::Homing;
use std::cmp::Ordering;
use std::collections::VecDeque;
use timers::MotorTimers;

/// What the levels ask for right now.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Wants {
    /// Power stage on?
    pub power: bool,
    /// Stand, after a ramp.
    pub stop: bool,
    /// Stand at once.
    pub quick_stop: bool,
    /// Watchdog a move back, to go on later.
    pub pause: bool,
    /// What becomes of the commands of moves.
    pub commands: Commands,
    /// Jog; `None` for neither direction, or both.
    pub jog: Option<Jog>,
    /// How a stop slows down that begins now, or is under way; `None` as the motion says.
    pub decel: Option<Slope>,
    /// The signals of home switch and limits, among others.
    pub switches: Inputs,
    /// Positions of the machine that the axis must not leave, if such are in force.
    pub soft_limits: Option<[i64; 2]>,
    /// How a limit stops it.
    pub limit_stop: LimitStop,
    /// Most counts between the axis and its command.
    pub deviation: Option<f64>,
}

/// A run that a level asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jog {
    /// How it goes.
    pub ramp: Ramp,
    /// Does another level ask for it than for the one under way?
    pub takes_over: bool,
    /// Does it go by the position, and not by the speed?
    pub by_position: bool,
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
    /// Is its speed controlled, and not its position? Kept by a stop.
    by_speed: bool,
    /// Where the motion goes in the end: the positive direction?
    forward: bool,
    /// What the motion is to come to.
    goal: Goal,
    /// How long it runs out without power.
    coast: Duration,
    machine: Machine,
    /// Its hard stops, while others block the axis.
    blocked: Option<Option<[i64; 2]>>,
    wants: Wants,
    /// A level holds the move under way back.
    paused: bool,
    /// An order ended the jog; its level must go before it acts again.
    jog_spent: bool,
    /// The last move or homing has come to its end.
    arrived: bool,
    /// It has told that it is too far from its command, and still is.
    deviates: bool,
    homing: Option<Box<Homing>>,
    timers: MotorTimers,
    effects: VecDeque<Effect>,
}

impl Motor {
    /// Standing at `position` of `machine`, without power; `gain` is that of the position controller, 1/s.
    pub fn standing(
        now: Instant,
        position: f64,
        coast: Duration,
        machine: Machine,
        gain: Option<f64>,
    ) -> Self {
        Self {
            trajectory: Trajectory::rest(now, position),
            lag: Lag::NONE,
            gain,
            phase: Phase::Standing,
            by_speed: false,
            forward: true,
            goal: Goal::None,
            coast,
            machine,
            blocked: None,
            wants: Wants::default(),
            paused: false,
            jog_spent: false,
            arrived: false,
            deviates: false,
            homing: None,
            timers: MotorTimers::default(),
            effects: VecDeque::with_capacity(8),
        }
    }

    /// What stands along the axis.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Counts the other way from now on, while it stands: the same place has the other sign.
    pub fn turn_round(&mut self, now: Instant) {
        let command = self.state(now).position;
        self.lag = self.lag.with_deviation(self.feedback(now).position - command);
        self.trajectory = Trajectory::rest(now, 0.0 - command);
        self.machine = self.machine.mirrored();
        self.look_ahead(now);
    }

    /// Position and speed as they are commanded, as far as a hard stop lets the axis go; not in whole counts.
    pub fn state(&self, now: Instant) -> State {
        self.machine.hold(self.trajectory.state(now))
    }

    /// The last whole count of the command, as far as a hard stop lets the axis go.
    pub(super) fn commanded(&self, now: Instant) -> i64 {
        self.state(now).position.floor() as i64
    }

    /// Is a motion under way?
    pub fn is_moving(&self) -> bool {
        self.phase != Phase::Standing
    }

    /// Is it looking for its origin?
    pub fn is_homing(&self) -> bool {
        self.phase == Phase::Homing
    }

    /// Does it go at a speed while a level asks for it?
    pub fn is_jogging(&self) -> bool {
        matches!(self.phase, Phase::Jogging { .. })
    }

    /// Does it come to a standstill already?
    pub fn is_slowing(&self) -> bool {
        matches!(self.phase, Phase::Stopping | Phase::Coasting)
    }

    /// Has an order ended what a level asks for? Then that must go before it acts again.
    pub fn is_jog_spent(&self) -> bool {
        self.jog_spent
    }

    /// What it is doing.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// When the motion under way first shows `position`, a count of the machine; `now` if it is there.
    pub fn reaches(&self, now: Instant, position: i64) -> Option<Instant> {
        // A count is shown from its lower edge on, so from above it begins at the next one.
        let mark = |count: i64, way| self.trajectory.crossing(count as f64, way, now);
        match position.cmp(&self.commanded(now)) {
            Ordering::Equal => Some(now),
            Ordering::Greater => mark(position, CrossingDirection::Rising),
            Ordering::Less => mark(position.saturating_add(1), CrossingDirection::Falling),
        }
    }

    /// Has its last move or homing come to its end?
    pub fn has_arrived(&self) -> bool {
        self.arrived
    }

    /// The next thing to be told.
    pub fn poll_effect(&mut self) -> Option<Effect> {
        self.effects.pop_front()
    }

    /// Follows the levels. To be called whenever one of them may have changed, or a motion has ended.
    pub fn follow(&mut self, now: Instant, wants: Wants) {
        let before = std::mem::replace(&mut self.wants, wants);
        if (before.soft_limits, before.deviation) != (wants.soft_limits, wants.deviation) {
            self.look_ahead(now);
        }
        self.jog_spent &= wants.jog.is_some();
        if !wants.power {
            return self.power_off(now);
        }
        if wants.quick_stop {
            self.halt(now);
        } else if wants.stop {
            self.brake(now);
        }
        if self.is_homing() {
            self.home_look(now);
        } else {
            self.obey_limits(now);
        }
        self.suspend(now);
        match wants.jog {
            None if matches!(self.phase, Phase::Jogging { .. }) => self.brake(now),
            None => {}
            Some(jog) => self.jog(now, jog),
        }
        wants.decel.into_iter().for_each(|decel| self.retune_stop(now, decel));
        self.advance(now);
    }

    /// Goes to `target`, given where it is.
    ///
    /// # Errors
    /// Why it does not start: without power, while held, while it moves and may not `interrupt`, into a
    /// limit, or at a speed of 0.
    pub fn start_move(
        &mut self,
        now: Instant,
        target: impl FnOnce(i64) -> i64,
        ramp: Ramp,
        interrupt: bool,
    ) -> Result<(), Ignored> {
        self.may_move(interrupt)?;
        let here = self.commanded(now);
        let target = target(here);
        self.may_go(now, target.saturating_sub(here) as f64)?;
        if ramp.speed == 0.0 {
            return Err(Ignored::NoSpeed);
        }
        self.goal = Goal::Position(target, ramp);
        let lead = self.lead(now).0;
        let trajectory = match self.wants.pause {
            true => self.held_back(now, lead),
            false => ramp.reach(now, lead, target),
        };
        self.lose_origin(HomeEnd::Replaced);
        self.forward = target >= here;
        self.begin(now, trajectory, Phase::Moving);
        self.effects.push_back(Effect::MoveStarted(target));
        if self.wants.pause {
            self.paused = true;
            self.look_ahead(now);
            self.effects.push_back(Effect::MovePaused);
        }
        self.advance(now);
        Ok(())
    }

    /// Goes at a speed until stopped. A run at 0 that takes the place of another stops it.
    ///
    /// # Errors
    /// Why it does not start: without power, while held, while it moves and may not `interrupt`, into a
    /// limit, or at a speed of 0.
    pub fn start_run(&mut self, now: Instant, ramp: Ramp, interrupt: bool) -> Result<(), Ignored> {
        self.may_start(interrupt)?;
        self.may_go(now, ramp.speed)?;
        match (ramp.speed == 0.0, self.phase) {
            (true, Phase::Running) => {
                self.stop(now);
                return Ok(());
            }
            (true, _) => return Err(Ignored::NoSpeed),
            (false, _) => {}
        }
        self.go(now, ramp, Phase::Running);
        self.effects.push_back(Effect::RunStarted(ramp.speed));
        self.advance(now);
        Ok(())
    }

    /// Slows down to a standstill.
    pub fn stop(&mut self, now: Instant) {
        self.jog_spent = true;
        self.slow_to_rest(now);
    }

    /// Slows down to a standstill as the motion is to stop. A level that jogs goes on when it may.
    pub fn slow_to_rest(&mut self, now: Instant) {
        self.brake(now);
        self.advance(now);
    }

    /// Slows down to a standstill with a slope of its own, in counts per second squared. A level that jogs goes
    /// on when it may.
    pub fn stop_with(&mut self, now: Instant, decel: f64) {
        if self.wants.power && self.is_moving() {
            self.lose_origin(HomeEnd::Stopped);
            self.goal = Goal::Stop(Slope::Rate(decel), 0.0);
            let trajectory = Trajectory::stop(now, self.state(now), decel);
            self.begin(now, trajectory, Phase::Stopping);
            self.effects.push_back(Effect::Stopping);
            self.advance(now);
        }
    }

    /// Stands at once.
    pub fn quick_stop(&mut self, now: Instant) {
        self.jog_spent = true;
        self.halt(now);
        self.advance(now);
    }

    /// Where the command of a move starts, and how far the axis is behind it.
    fn lead(&self, now: Instant) -> (State, Lag) {
        let state = self.state(now);
        match self.gain {
            Some(gain) if self.lag == Lag::NONE => {
                let ahead = State { position: state.position + state.speed / gain, ..state };
                (ahead, Lag::at_speed(gain, state.speed))
            }
            _ => (state, self.carried_lag(now)),
        }
    }

    /// The lag as it goes along to the next trajectory, which starts where a hard stop lets the command be.
    fn carried_lag(&self, now: Instant) -> Lag {
        let behind = self.state(now).position - self.feedback(now).position;
        self.lag.with_deviation(behind)
    }

    /// May a motion start right now, or take the place of one under way where it may `interrupt`?
    ///
    /// # Errors
    /// Why not: without power, while held, or while it moves.
    pub fn may_start(&self, interrupt: bool) -> Result<(), Ignored> {
        match () {
            () if !self.wants.power => Err(Ignored::PowerOff),
            () if self.is_held() => Err(Ignored::Held),
            () if self.is_homing() && !interrupt => Err(Ignored::Homing),
            () if self.is_moving() && !interrupt => Err(Ignored::Moving),
            () => Ok(()),
        }
    }

    /// May a move start right now, or take the place of a motion under way where it may `interrupt`?
    ///
    /// # Errors
    /// Why not: as of [`Self::may_start`], or while its commands are inhibited.
    pub fn may_move(&self, interrupt: bool) -> Result<(), Ignored> {
        self.may_start(interrupt)?;
        match self.wants.commands {
            Commands::Taken => Ok(()),
            Commands::Inhibited | Commands::Cleared => Err(Ignored::Inhibited),
        }
    }

    /// Does a level hold it still?
    fn is_held(&self) -> bool {
        self.wants.stop || self.wants.quick_stop
    }

    fn jog(&mut self, now: Instant, jog: Jog) {
        let Jog { ramp, takes_over, .. } = jog;
        let forward = ramp.speed >= 0.0;
        if !takes_over && self.phase == (Phase::Jogging { forward }) {
            return self.retune(now, Goal::Speed(ramp));
        }
        let free = match self.phase {
            Phase::Standing | Phase::Stopping | Phase::Coasting | Phase::Jogging { .. } => true,
            Phase::Moving | Phase::Running | Phase::Homing => false,
        };
        let may = !self.is_held() && !self.jog_spent && !self.is_at_limit(now, forward);
        if free && may {
            self.go(now, ramp, Phase::Jogging { forward });
            self.effects.push_back(Effect::JogStarted(ramp.speed));
        } else if matches!(self.phase, Phase::Jogging { .. }) {
            self.brake(now);
        }
    }

    fn go(&mut self, now: Instant, ramp: Ramp, phase: Phase) {
        let forward = ramp.speed >= 0.0;
        let by_speed = matches!(self.phase, Phase::Running | Phase::Jogging { .. });
        // A turn starts where the axis is; who goes on the same way stays as far beyond a hard stop as it was.
        let from = match by_speed && self.forward == forward {
            true => self.trajectory.state(now),
            false => self.feedback(now),
        };
        let trajectory = match by_speed {
            true => ramp.in_motion(from).keep(now, from),
            false => ramp.keep(now, from),
        };
        self.lose_origin(HomeEnd::Replaced);
        (self.goal, self.forward) = (Goal::Speed(ramp), forward);
        self.begin(now, trajectory, phase);
    }

    fn brake(&mut self, now: Instant) {
        if self.is_moving() && !matches!(self.phase, Phase::Stopping | Phase::Coasting) {
            self.lose_origin(HomeEnd::Stopped);
            let trajectory = self.slow_down(now);
            self.begin(now, trajectory, Phase::Stopping);
            self.effects.push_back(Effect::Stopping);
        }
    }

    /// Down to a standstill, as the motion under way is to stop.
    fn slow_down(&mut self, now: Instant) -> Trajectory {
        let (slope, change) = self.goal.stop(self.wants.decel);
        self.goal = Goal::Stop(slope, change);
        Trajectory::stop(now, self.state(now), slope.of(change))
    }

    fn halt(&mut self, now: Instant) {
        if self.wants.power && self.is_moving() {
            self.lose_origin(HomeEnd::Stopped);
            self.goal = Goal::None;
            let trajectory = Trajectory::halt(now, self.state(now));
            self.begin(now, trajectory, Phase::Stopping);
            self.effects.push_back(Effect::Stopping);
        }
    }

    fn power_off(&mut self, now: Instant) {
        if self.is_moving() && self.phase != Phase::Coasting {
            self.lose_origin(HomeEnd::PowerOff);
            let rests = self.speed(now) == 0.0;
            self.run_out(now);
            self.effects.extend((!rests).then_some(Effect::Coasting));
            self.advance(now);
        }
    }

    fn run_out(&mut self, now: Instant) {
        self.goal = Goal::None;
        let trajectory = Trajectory::coast(now, self.feedback(now), self.coast);
        self.begin(now, trajectory, Phase::Coasting);
    }

    fn begin(&mut self, now: Instant, trajectory: Trajectory, phase: Phase) {
        // An order takes the place of a jog for good: its level may still be there when the order is done.
        self.jog_spent |= matches!(self.phase, Phase::Jogging { .. }) && phase == Phase::Moving;
        self.lag = match phase {
            Phase::Moving => self.lead(now).1,
            Phase::Standing | Phase::Stopping => self.carried_lag(now),
            Phase::Running | Phase::Jogging { .. } | Phase::Homing | Phase::Coasting => Lag::NONE,
        };
        self.by_speed = match phase {
            Phase::Running => true,
            Phase::Jogging { .. } => !self.wants.jog.is_some_and(|jog| jog.by_position),
            Phase::Stopping => self.by_speed,
            Phase::Standing | Phase::Moving | Phase::Homing | Phase::Coasting => false,
        };
        let jumps = trajectory.state(now).position != self.state(now).position;
        (self.trajectory, self.phase, self.arrived) = (trajectory, phase, false);
        self.paused = false;
        self.look_ahead(now);
        if jumps {
            self.look_at_switches(now);
        }
    }
}

#[cfg(test)]
mod tests;
