//! What the axis is doing: it stands, moves to a position, runs, jogs, looks for its origin, stops or coasts.
//!
//! An order becomes a trajectory and a phase; after that nothing happens until something on the way does (`transitions.rs`): the
//! trajectory ends, a switch changes, a limit or a hard stop is met. Speeds and slopes come with the order; others on
//! the way have the rest planned anew.
//!
//! Each part owns what it knows: [`PositionLoop`] where the axis is and is told to be, [`MotionState`] what is under way,
//! [`Homing`] how far the search for the origin has come, [`MotorLevels`] what levels ask for, [`MotorTimers`] what
//! happens next.

mod home_order;
mod homing;
mod levels;
mod motion_state;
mod position_loop;
mod timers;
mod transitions;

pub use home_order::HomeOrder;
pub use levels::{Commands, Jog, MotorLevels};
pub use motion_state::{Control, Phase, Ramp, Slope};
pub use timers::MotorTimer;

use super::effect::Effect;
use crate::event::Ignored;
use crate::motion::{Machine, State, Trajectory};
use crate::time::{Duration, Instant};
use crate::vocabulary::HomeEnd;
use homing::Homing;
use motion_state::{Goal, MotionState};
use position_loop::{PositionLoop, Release};
use std::collections::VecDeque;
use timers::MotorTimers;

/// Counts that are worth dropping: well above what positions are rounded to.
const LEAST_DEVIATION: f64 = 1e-3;

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    position_loop: PositionLoop,
    motion: MotionState,
    homing: Option<Box<Homing>>,
    levels: MotorLevels,
    timers: MotorTimers,
    /// How long it coasts without power.
    coast: Duration,
    /// An order ended the jog; its level must go before it acts again.
    jog_spent: bool,
    /// It has reported that it is too far from its command, and still is.
    deviates: bool,
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
        Self::new(PositionLoop::at_rest(now, position, machine, gain), coast)
    }

    /// The same axis when power comes on, standing where it is.
    #[must_use]
    pub fn switched_on(&self, now: Instant, coast: Duration, gain: Option<f64>) -> Self {
        Self::new(self.position_loop.switched_on(now, gain), coast)
    }

    fn new(position_loop: PositionLoop, coast: Duration) -> Self {
        Self {
            position_loop,
            motion: MotionState::standing(),
            homing: None,
            levels: MotorLevels::default(),
            timers: MotorTimers::default(),
            coast,
            jog_spent: false,
            deviates: false,
            effects: VecDeque::with_capacity(8),
        }
    }

    /// The next thing to be reported.
    pub fn poll_effect(&mut self) -> Option<Effect> {
        self.effects.pop_front()
    }

    /// What happens to it next by itself, and when.
    pub fn next_timer(&self) -> Option<(Instant, MotorTimer)> {
        self.timers.next()
    }

    /// All that will happen to it by itself if nothing comes between, and when.
    pub fn timers(&self) -> impl Iterator<Item = (Instant, MotorTimer)> {
        self.timers.set_ones()
    }

    /// Has a switch of the machine changed up to `now`? It says so once; the drive, which knows what the switches are
    /// wired to, reads them then, and before [`Motor::advance`].
    pub fn take_switch_edge(&mut self, now: Instant) -> bool {
        let expired = self.timers.take(MotorTimer::SwitchEdge, now);
        if expired {
            let next = self.position_loop.next_switch_edge(now);
            self.timers.set(MotorTimer::SwitchEdge, next);
        }
        expired
    }

    /// Lets time pass up to `now`, which is not later than the next timer.
    pub fn advance(&mut self, now: Instant) {
        while let Some(timer) = self.timers.take_expired(now) {
            self.on_timer(now, timer);
        }
    }

    /// What stands along the axis.
    pub fn machine(&self) -> &Machine {
        self.position_loop.machine()
    }

    /// What it is doing.
    pub fn phase(&self) -> Phase {
        self.motion.phase
    }

    /// Is a motion under way?
    pub fn is_moving(&self) -> bool {
        self.motion.phase.is_moving()
    }

    /// Is it looking for its origin?
    pub fn is_homing(&self) -> bool {
        self.motion.phase == Phase::Homing
    }

    /// Has an order ended what a level asks for? Then that must go before it acts again.
    pub fn is_jog_spent(&self) -> bool {
        self.jog_spent
    }

    /// Has its last move or homing come to its end?
    pub fn has_arrived(&self) -> bool {
        self.motion.arrived
    }

    /// What is controlled; `None` without power, and until an axis that coasts has stopped.
    pub fn control(&self) -> Option<Control> {
        let control = self.motion.control(self.position_loop.trajectory().last_speed());
        control.filter(|_| self.levels.power)
    }

    /// Position and speed as they are commanded, as far as a hard stop lets the axis go; not in whole counts.
    pub fn state(&self, now: Instant) -> State {
        self.position_loop.command(now)
    }

    /// Position and speed as they are, not in whole counts.
    pub fn feedback(&self, now: Instant) -> State {
        self.position_loop.feedback(now)
    }

    /// The last whole count reached, in the machine's coordinate.
    pub fn position(&self, now: Instant) -> i64 {
        self.position_loop.position(now)
    }

    /// Counts per second.
    pub fn speed(&self, now: Instant) -> f64 {
        self.position_loop.shown(now).speed
    }

    /// How far the axis is behind its command, in counts.
    pub fn deviation(&self, now: Instant) -> f64 {
        self.position_loop.deviation(now, self.control() == Some(Control::Position))
    }

    /// Counts per second of the command, as far as it is one of positions.
    pub fn command_rate(&self, now: Instant) -> f64 {
        let position = self.control() == Some(Control::Position);
        if position { self.position_loop.setpoint(now).speed } else { 0.0 }
    }

    /// Is it held back from its command?
    pub fn is_held_back(&self, now: Instant) -> bool {
        self.position_loop.is_held_back(now)
    }

    /// Instants after `now` between which what it shows changes in one direction only, if nothing happens to it.
    pub fn marks(&self, now: Instant) -> Vec<Instant> {
        self.position_loop.marks(now)
    }

    /// When the motion under way first shows `position`, a count of the machine; `now` if it is there.
    pub fn reaches(&self, now: Instant, position: i64) -> Option<Instant> {
        self.position_loop.reaches(now, position)
    }

    /// When the axis is within `window` counts of the end of its last move for good. That move has ended by
    /// `now`, and nothing holds the axis back.
    pub fn arrives_at(&self, now: Instant, window: f64) -> Option<Instant> {
        self.rests_at(now, window).filter(|_| self.motion.arrived)
    }

    /// When the axis is within `window` counts of its command for good, which is at rest. Nothing holds it back.
    pub fn rests_at(&self, now: Instant, window: f64) -> Option<Instant> {
        let rests = !self.is_moving() && !self.is_held_back(now);
        self.position_loop.settles_at(window).filter(|_| rests)
    }

    /// Counts the other way from now on, while it stands: the same place has the other sign.
    pub fn reverse_direction(&mut self, now: Instant) {
        self.position_loop.reverse(now);
        self.reset_timers(now);
    }

    /// Does something block it?
    pub fn is_blocked(&self) -> bool {
        self.position_loop.is_blocked()
    }

    /// Blocks it at the count where it is.
    pub fn block(&mut self, now: Instant) {
        self.position_loop.block(now);
        self.reset_timers(now);
        self.sample_home_switches(now);
    }

    /// Lets it go. Where its position is controlled it makes up for what it is behind; a run or a jog begins anew;
    /// anything else goes on from here, and what it did not go meanwhile is lost.
    pub fn free(&mut self, now: Instant) {
        let release = match (self.motion.phase.keeps_speed(), self.motion.goal) {
            (true, Goal::Speed(ramp)) => Release::Anew(ramp.keep(now, self.feedback(now))),
            (false, _) if self.levels.power => Release::CatchUp,
            _ => Release::GoOn,
        };
        if self.position_loop.unblock(now, release) {
            self.reset_timers(now);
        }
    }

    /// Follows the levels. To be called whenever one of them may have changed, or a motion has ended.
    pub fn follow(&mut self, now: Instant, levels: MotorLevels) {
        let before = std::mem::replace(&mut self.levels, levels);
        if (before.soft_limits, before.deviation) != (levels.soft_limits, levels.deviation) {
            self.reset_timers(now);
        }
        self.jog_spent &= levels.jog.is_some();
        if !levels.power {
            return self.power_off(now);
        }
        if levels.quick_stop {
            self.halt(now);
        } else if levels.stop {
            self.brake(now);
        }
        if self.is_homing() {
            self.sample_home_switches(now);
        } else {
            self.obey_limits(now);
        }
        self.suspend(now);
        match levels.jog {
            None if self.motion.phase.is_jogging() => self.brake(now),
            None => {}
            Some(jog) => self.jog(now, jog),
        }
        levels.decel.into_iter().for_each(|decel| self.retune_stop(now, decel));
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
        let here = self.position_loop.command_count(now);
        let target = target(here);
        self.may_go(now, target.saturating_sub(here) as f64)?;
        if ramp.speed == 0.0 {
            return Err(Ignored::NoSpeed);
        }
        self.motion.goal = Goal::Position(target, ramp);
        let from = self.position_loop.move_start(now);
        let trajectory = match self.levels.pause {
            true => self.pause_trajectory(now, from),
            false => ramp.reach(now, from, target),
        };
        self.lose_origin(HomeEnd::Replaced);
        self.motion.forward = target >= here;
        self.begin(now, trajectory, Phase::Moving);
        self.effects.push_back(Effect::MoveStarted(target));
        if self.levels.pause {
            self.motion.paused = true;
            self.reset_timers(now);
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
        match (ramp.speed == 0.0, self.motion.phase) {
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

    /// Looks for the origin.
    ///
    /// # Errors
    /// Why it does not start: without power, while held, while it moves, or at a speed of 0.
    pub fn start_home(&mut self, now: Instant, order: HomeOrder) -> Result<(), Ignored> {
        self.may_start(false)?;
        if order.stands_still() {
            return Err(Ignored::NoSpeed);
        }
        self.motion.goal = Goal::None;
        self.homing = Some(Box::new(Homing::begin(order, &self.homing_view(now))));
        let here = self.position_loop.shown(now);
        self.begin(now, Trajectory::halt(now, here), Phase::Homing);
        self.ask_homing(now, |homing, view, effects| Some(homing.seek(view, effects)));
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
        if self.levels.power && self.is_moving() {
            self.lose_origin(HomeEnd::Stopped);
            self.motion.goal = Goal::Stop(Slope::Rate(decel), 0.0);
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

    /// The move under way goes to `target`, a count of the machine, and as `ramp` says.
    pub fn retune_move(&mut self, now: Instant, target: i64, ramp: Ramp) {
        if self.motion.phase == Phase::Moving {
            self.retune(now, Goal::Position(target, ramp));
            self.advance(now);
        }
    }

    /// The run by order under way goes as `ramp` says.
    pub fn retune_run(&mut self, now: Instant, ramp: Ramp) {
        if self.motion.phase == Phase::Running {
            self.retune(now, Goal::Speed(ramp));
            self.advance(now);
        }
    }

    /// The order of the homing under way.
    pub fn home_order(&self) -> Option<&HomeOrder> {
        self.homing.as_ref().map(|it| it.order())
    }

    /// The homing under way goes as `order` says, the method apart.
    pub fn retune_home(&mut self, now: Instant, order: HomeOrder) {
        if self.home_order().is_some_and(|before| *before != order) {
            self.replan_homing(now, order);
            self.advance(now);
        }
    }

    /// Ends a homing, if there is one, because of something else, which then says how the axis goes on.
    pub fn lose_origin(&mut self, why: HomeEnd) {
        self.abort_homing(why, false);
    }

    /// May a motion start right now, or take the place of one under way where it may `interrupt`?
    ///
    /// # Errors
    /// Why not: without power, while held, or while it moves.
    pub fn may_start(&self, interrupt: bool) -> Result<(), Ignored> {
        match () {
            () if !self.levels.power => Err(Ignored::PowerOff),
            () if self.levels.hold() => Err(Ignored::Held),
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
        match self.levels.commands {
            Commands::Taken => Ok(()),
            Commands::Inhibited | Commands::Cleared => Err(Ignored::Inhibited),
        }
    }

    /// May a motion start in the direction of `way`?
    ///
    /// # Errors
    /// There is a limit.
    pub fn may_go(&self, now: Instant, way: f64) -> Result<(), Ignored> {
        match way != 0.0 && self.is_at_limit(now, way > 0.0) {
            true => Err(Ignored::Limit),
            false => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
