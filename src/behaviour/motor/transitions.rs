//! How the axis goes from one motion to the next: because of an order or a level, or because one of its timers expires.

use super::home_order::HomeOrder;
use super::homing::{Homing, HomingMove, HomingView};
use super::motion_state::{Goal, Phase, Ramp, Slope};
use super::position_loop::LagRule;
use super::{Commands, Jog, LEAST_DEVIATION, Motor, MotorTimer};
use crate::behaviour::effect::Effect;
use crate::motion::{State, Trajectory};
use crate::time::Instant;
use crate::vocabulary::{HomeEnd, LimitStop};
use std::collections::VecDeque;

// Beginning and ending.
impl Motor {
    pub(super) fn begin(&mut self, now: Instant, trajectory: Trajectory, phase: Phase) {
        // An order takes the place of a jog for good: its level may still be there when the order is done.
        self.jog_spent |= self.motion.phase.is_jogging() && phase == Phase::Moving;
        let by_speed = !self.levels.jog.is_some_and(|jog| jog.by_position);
        self.motion.begin(phase, by_speed);
        let rule = match phase {
            Phase::Moving => LagRule::Leads,
            Phase::Standing | Phase::Stopping => LagRule::Carried,
            Phase::Running | Phase::Jogging { .. } | Phase::Homing | Phase::Coasting => {
                LagRule::None
            }
        };
        let jumps = self.position_loop.begin(now, trajectory, rule);
        self.reset_timers(now);
        if jumps {
            self.expire_switch_edge(now);
        }
    }

    /// Goes on along `trajectory`, which starts where the present one is.
    fn go_on(&mut self, now: Instant, trajectory: Trajectory) {
        self.position_loop.go_on(now, trajectory);
        self.reset_timers(now);
    }

    pub(super) fn go(&mut self, now: Instant, ramp: Ramp, phase: Phase) {
        let forward = ramp.speed >= 0.0;
        let keeps_speed = self.motion.phase.keeps_speed();
        // A turn starts where the axis is; who goes on the same way stays as far beyond a hard stop as it was.
        let from = match keeps_speed && self.motion.forward == forward {
            true => self.position_loop.setpoint(now),
            false => self.feedback(now),
        };
        let trajectory = match keeps_speed {
            true => ramp.in_motion(from).keep(now, from),
            false => ramp.keep(now, from),
        };
        self.lose_origin(HomeEnd::Replaced);
        (self.motion.goal, self.motion.forward) = (Goal::Speed(ramp), forward);
        self.begin(now, trajectory, phase);
    }

    /// Nothing is under way any more.
    fn end_motion(&mut self, now: Instant, arrived: bool) {
        self.motion.end(arrived);
        self.reset_timers(now);
        // Where it is to stand: it may still be on its last counts.
        self.effects.push_back(Effect::Stopped(self.position_loop.command_count(now)));
    }
}

// Stops.
impl Motor {
    pub(super) fn brake(&mut self, now: Instant) {
        if self.is_moving() && !self.motion.phase.is_slowing() {
            self.lose_origin(HomeEnd::Stopped);
            let trajectory = self.slow_down(now);
            self.begin(now, trajectory, Phase::Stopping);
            self.effects.push_back(Effect::Stopping);
        }
    }

    /// Down to a standstill, as the motion under way is to stop.
    fn slow_down(&mut self, now: Instant) -> Trajectory {
        let (slope, change) = self.motion.goal.stop(self.levels.decel);
        self.motion.goal = Goal::Stop(slope, change);
        Trajectory::stop(now, self.state(now), slope.of(change))
    }

    pub(super) fn halt(&mut self, now: Instant) {
        if self.levels.power && self.is_moving() {
            self.lose_origin(HomeEnd::Stopped);
            self.stop_at_once(now);
            self.effects.push_back(Effect::Stopping);
        }
    }

    /// The command stands at once.
    fn stop_at_once(&mut self, now: Instant) {
        self.motion.goal = Goal::None;
        let trajectory = Trajectory::halt(now, self.state(now));
        self.begin(now, trajectory, Phase::Stopping);
    }

    pub(super) fn power_off(&mut self, now: Instant) {
        if self.is_moving() && self.motion.phase != Phase::Coasting {
            self.lose_origin(HomeEnd::PowerOff);
            let rests = self.speed(now) == 0.0;
            self.coast_to_rest(now);
            self.effects.extend((!rests).then_some(Effect::Coasting));
            self.advance(now);
        }
    }

    fn coast_to_rest(&mut self, now: Instant) {
        self.motion.goal = Goal::None;
        let trajectory = Trajectory::coast(now, self.feedback(now), self.coast);
        self.begin(now, trajectory, Phase::Coasting);
    }
}

// Levels.
impl Motor {
    pub(super) fn jog(&mut self, now: Instant, jog: Jog) {
        let Jog { ramp, takes_over, .. } = jog;
        let forward = ramp.speed >= 0.0;
        if !takes_over && self.motion.phase == (Phase::Jogging { forward }) {
            return self.retune(now, Goal::Speed(ramp));
        }
        let free = match self.motion.phase {
            Phase::Standing | Phase::Stopping | Phase::Coasting | Phase::Jogging { .. } => true,
            Phase::Moving | Phase::Running | Phase::Homing => false,
        };
        let may = !self.levels.hold() && !self.jog_spent && !self.is_at_limit(now, forward);
        if free && may {
            self.go(now, ramp, Phase::Jogging { forward });
            self.effects.push_back(Effect::JogStarted(ramp.speed));
        } else if self.motion.phase.is_jogging() {
            self.brake(now);
        }
    }

    /// Is the axis at the limit in that direction?
    pub(super) fn is_at_limit(&self, now: Instant, forward: bool) -> bool {
        self.levels.limit_at(self.state(now).position, forward)
    }

    /// Ends a motion that goes into a limit.
    pub(super) fn obey_limits(&mut self, now: Instant) {
        let forward = self.motion.forward;
        if self.motion.obeys_limits() && self.is_at_limit(now, forward) {
            let soft = !self.levels.has_limit_switch(forward);
            self.effects.push_back(Effect::LimitReached { forward, soft });
            self.stop_at_limit(now);
        }
    }

    /// Ends a motion as a limit does.
    fn stop_at_limit(&mut self, now: Instant) {
        match self.levels.limit_stop {
            LimitStop::Coast => self.coast_to_rest(now),
            LimitStop::Quick => self.stop_at_once(now),
            LimitStop::Ramp => {
                let trajectory = self.slow_down(now);
                self.begin(now, trajectory, Phase::Stopping);
            }
        }
    }

    /// Holds back what levels hold back, and lets go on what they don't.
    pub(super) fn suspend(&mut self, now: Instant) {
        match self.levels.commands {
            Commands::Taken => {}
            Commands::Inhibited => self.end_command(now),
            Commands::Cleared => self.clear_deviation(now),
        }
        if self.motion.phase == Phase::Moving && self.levels.pause != self.motion.paused {
            match self.levels.pause {
                true => self.pause(now),
                false => self.resume(now),
            }
        }
    }

    /// The move under way slows down to a standstill, and is not over.
    fn pause(&mut self, now: Instant) {
        self.motion.paused = true;
        let trajectory = self.pause_trajectory(now, self.position_loop.setpoint(now));
        self.go_on(now, trajectory);
        self.effects.push_back(Effect::MovePaused);
    }

    /// The trajectory of a move that is held back, from a state of its command.
    pub(super) fn pause_trajectory(&self, now: Instant, from: State) -> Trajectory {
        let (slope, change) = self.motion.goal.stop(self.levels.decel);
        Trajectory::stop(now, from, slope.of(change))
    }

    /// It goes on to where it was to go.
    fn resume(&mut self, now: Instant) {
        self.motion.paused = false;
        let Goal::Position(target, ramp) = self.motion.goal else { return };
        self.motion.forward = target >= self.position_loop.command_count(now);
        let from = self.position_loop.setpoint(now);
        let trajectory = ramp.in_motion(from).reach(now, from, target);
        self.go_on(now, trajectory);
        self.effects.push_back(Effect::MoveResumed(target));
        self.obey_limits(now);
    }

    /// The command of a move stands at once; what the axis is behind it makes up for.
    fn end_command(&mut self, now: Instant) {
        if self.motion.phase == Phase::Moving {
            self.stop_at_once(now);
            self.effects.push_back(Effect::Stopping);
        }
    }

    /// The axis gives up what it is behind its command: where its position is controlled it stands where it is, in a run
    /// or a jog the command goes on from there.
    fn clear_deviation(&mut self, now: Instant) {
        let behind = self.position_loop.behind(now);
        let moves = self.motion.phase == Phase::Moving;
        match self.motion.phase {
            Phase::Moving | Phase::Stopping if moves || self.position_loop.makes_up() => {
                self.motion.goal = Goal::None;
                let here = self.feedback(now).position;
                self.begin(now, Trajectory::rest(now, here), Phase::Stopping);
                self.effects.extend(moves.then_some(Effect::Stopping));
            }
            // Less is a rounding error, or what is left of a lag that decays.
            _ if behind.abs() < LEAST_DEVIATION => return,
            Phase::Standing => self.position_loop.rest_here(now),
            Phase::Running | Phase::Jogging { .. } => self.position_loop.shift(now, -behind),
            Phase::Moving | Phase::Stopping | Phase::Homing | Phase::Coasting => return,
        }
        self.position_loop.forget_lag();
        self.reset_timers(now);
        if behind.abs() >= LEAST_DEVIATION {
            self.expire_switch_edge(now);
        }
        let counts = behind.round() as i64;
        self.effects.extend((counts != 0).then_some(Effect::DeviationCleared(counts)));
    }
}

// Settings that change on the way: planned anew, from where the axis is told to be and as fast as it is told to go.
impl Motor {
    /// The stop under way slows down like this.
    pub(super) fn retune_stop(&mut self, now: Instant, decel: Slope) {
        if let (Phase::Stopping, Goal::Stop(_, change)) = (self.motion.phase, self.motion.goal) {
            self.retune(now, Goal::Stop(decel, change));
        }
    }

    /// The motion under way comes to `goal` instead, which is of the same kind as the one so far.
    pub(super) fn retune(&mut self, now: Instant, goal: Goal) {
        let before = std::mem::replace(&mut self.motion.goal, goal);
        if before == goal {
            return;
        }
        let from = self.position_loop.setpoint(now);
        let trajectory = match goal {
            // It goes on as it says once it is not held back any more.
            _ if self.motion.paused => None,
            Goal::None => return,
            Goal::Speed(ramp) => {
                self.motion.forward = ramp.speed >= 0.0;
                Some(ramp.in_motion(from).keep(now, from))
            }
            Goal::Position(target, ramp) => {
                self.motion.forward = target >= self.position_loop.command_count(now);
                Some(ramp.in_motion(from).reach(now, from, target))
            }
            Goal::Stop(decel, change) => Some(Trajectory::stop(now, from, decel.of(change))),
        };
        trajectory.into_iter().for_each(|it| self.go_on(now, it));
        self.effects.extend(before.replans(&goal).map(Effect::Replanned));
    }
}

// What happens by itself.
impl Motor {
    /// Solves anew for what will happen to it by itself.
    pub(super) fn reset_timers(&mut self, now: Instant) {
        self.deviates &= self.is_deviating(now);
        let waits = self.homing.as_ref().map(|it| it.waits()).unwrap_or_default();
        let at = &self.position_loop;
        let forward = self.motion.forward;
        let soft_limit = self.levels.soft_limit(forward);
        // What was over before is over now.
        let end = at.trajectory().end().map(|end| end.max(now));
        let (target, standstill) = match self.motion.phase {
            // A move that is held back waits for its level.
            Phase::Moving => (end.filter(|_| !self.motion.paused), None),
            // A run at a speed that has become 0 waits for another.
            Phase::Standing | Phase::Running => (None, None),
            Phase::Jogging { .. } | Phase::Homing | Phase::Stopping | Phase::Coasting => {
                (None, end)
            }
        };
        let deadlines = [
            (MotorTimer::SwitchEdge, at.next_switch_edge(now)),
            (
                MotorTimer::HardStopLeft,
                waits.limits_by_stop.then(|| at.leaves_hard_stop_at(now)).flatten(),
            ),
            (MotorTimer::Collision, waits.collision.and_then(|it| at.pressed_at(it as f64, now))),
            (MotorTimer::DeviationLimit, self.deviates_at(now)),
            (
                MotorTimer::SoftLimit,
                soft_limit.and_then(|limit| at.passes_limit_at(limit, forward, now)),
            ),
            (MotorTimer::TargetReached, target),
            (MotorTimer::Standstill, standstill),
            (MotorTimer::HomingTimeLimit, waits.until),
        ];
        let (hit, pulse) = (at.next_hit(now), waits.index.and_then(|it| at.next_index(now, it)));
        self.timers.set_hard_stop(hit);
        self.timers.set_index_pulse(pulse);
        deadlines.into_iter().for_each(|(timer, at)| self.timers.set(timer, at));
    }

    /// The axis is elsewhere than its command was, so that any switch may have changed.
    fn expire_switch_edge(&mut self, now: Instant) {
        self.timers.set(MotorTimer::SwitchEdge, Some(now));
    }

    /// When the axis gets to be farther from its command than is allowed.
    fn deviates_at(&self, now: Instant) -> Option<Instant> {
        let most = self.levels.deviation.filter(|_| self.levels.power && !self.deviates)?;
        match self.is_deviating(now) {
            true => Some(now),
            false => self.position_loop.exceeds_at(most, now),
        }
    }

    fn is_deviating(&self, now: Instant) -> bool {
        self.levels.deviation.is_some_and(|most| self.deviation(now).abs() > most)
    }

    pub(super) fn on_timer(&mut self, now: Instant, timer: MotorTimer) {
        match timer {
            // Not the axis's to look at.
            MotorTimer::SwitchEdge => {}
            MotorTimer::HardStop => {
                self.effects.push_back(Effect::HardStopHit(self.timers.hit_at()));
                self.sample_home_switches(now);
            }
            MotorTimer::HardStopLeft => self.sample_home_switches(now),
            MotorTimer::Collision => self.home_found(now, self.position(now)),
            MotorTimer::IndexPulse => self.home_found(now, self.timers.mark()),
            MotorTimer::DeviationLimit => {
                self.deviates = true;
                self.effects.push_back(Effect::DeviationExceeded);
            }
            MotorTimer::SoftLimit => self.obey_limits(now),
            MotorTimer::TargetReached => self.end_motion(now, true),
            MotorTimer::Standstill if self.is_homing() => {
                self.ask_homing(now, |homing, view, effects| homing.stopped(view, effects));
            }
            MotorTimer::Standstill => self.end_motion(now, false),
            MotorTimer::HomingTimeLimit => {
                let (why, alarm, by_limit) = (HomeEnd::TimeLimit, true, false);
                self.make_homing_move(now, HomingMove::Abort { why, alarm, by_limit });
            }
        }
    }
}

// Homing: it decides, the axis moves.
impl Motor {
    /// Asks the homing under way what comes next, and does it.
    pub(super) fn ask_homing(
        &mut self,
        now: Instant,
        ask: impl FnOnce(&mut Homing, &HomingView, &mut VecDeque<Effect>) -> Option<HomingMove>,
    ) {
        let view = self.homing_view(now);
        let Some(homing) = &mut self.homing else { return };
        let mut next = ask(homing, &view, &mut self.effects);
        // Each step is taken once, and a limit turns a homing round only once.
        while let Some(it) = next {
            next = self.make_homing_move(now, it);
        }
    }

    /// Looks whether a switch that a homing waits for has changed.
    pub(super) fn sample_home_switches(&mut self, now: Instant) {
        self.ask_homing(now, |homing, view, effects| homing.sample(view, effects));
    }

    fn home_found(&mut self, now: Instant, at: i64) {
        self.ask_homing(now, |homing, view, effects| homing.found(view, at, effects));
    }

    fn make_homing_move(&mut self, now: Instant, next: HomingMove) -> Option<HomingMove> {
        match next {
            HomingMove::ResetTimers => self.reset_timers(now),
            HomingMove::Go { trajectory, forward } => {
                self.motion.forward = forward;
                self.begin(now, trajectory, Phase::Homing);
                let view = self.homing_view(now);
                return self.homing.as_mut()?.begun(&view, &mut self.effects);
            }
            HomingMove::Brake(trajectory) => self.begin(now, trajectory, Phase::Homing),
            HomingMove::Abort { why, alarm, by_limit } => {
                self.abort_homing(why, alarm);
                match by_limit {
                    true => self.stop_at_limit(now),
                    false => self.brake(now),
                }
            }
            HomingMove::Done { origin } => {
                self.homing = None;
                self.effects.push_back(Effect::HomingDone(origin));
                self.end_motion(now, true);
            }
        }
        None
    }

    /// Ends a homing, if there is one, and has a stop slow down as it would have.
    pub(super) fn abort_homing(&mut self, why: HomeEnd, alarm: bool) {
        if let Some(homing) = self.homing.take() {
            self.motion.goal = Goal::Stop(Slope::Rate(homing.order().slope()), 0.0);
            let forward = homing.heading().unwrap_or(self.motion.forward);
            self.effects.push_back(Effect::HomingAborted { why, forward, alarm });
        }
    }

    pub(super) fn homing_view(&self, now: Instant) -> HomingView {
        HomingView {
            now,
            command: self.state(now),
            position: self.position(now),
            switches: self.levels.switches,
            hard_stop: self.machine().hard_stop,
        }
    }

    /// The homing under way goes as `order` says, the method apart.
    pub(super) fn replan_homing(&mut self, now: Instant, order: HomeOrder) {
        let from = self.position_loop.setpoint(now);
        let Some(homing) = &mut self.homing else { return };
        let trajectory = homing.retune(now, order, from, &mut self.effects);
        self.go_on(now, trajectory);
        self.ask_homing(now, |homing, view, effects| homing.retuned(view, effects));
    }
}
