//! Homing: the steps of a method one after the other, until one of them finds the origin.
//!
//! A step goes in one direction until a switch changes, an index pulse comes or a hard stop holds the axis. It sees
//! switches as the drive does, so it doesn't matter whether a terminal, a master or the machine moves them. What the
//! position register says of the origin is not decided here.

mod replan;

use super::goal::{Goal, Slope};
use super::limits::limit;
use super::{Effect, Motor, Phase};
use crate::event::Ignored;
use crate::motion::{CrossingDirection, Index, IndexPulse, Machine, Move, State, Trajectory};
use crate::time::{Duration, Instant};
use crate::vocabulary::{
    HomeEnd, HomingStep, IndexRule, Input, Inputs, LimitRule, LimitSource, Method, OriginStop,
    Pace, SignalEdge, Steps, Then, Until,
};

/// Everything that a homing goes by.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeOrder {
    /// The steps.
    pub method: Method,
    /// Counts per second.
    pub fast: f64,
    /// Counts per second.
    pub slow: f64,
    /// Slope of all changes of speed; a time is that up to `fast`.
    pub accel: Slope,
    /// What a limit on the way means.
    pub limit: LimitRule,
    /// What tells that there is one.
    pub source: LimitSource,
    /// Is the origin refined by an index pulse?
    pub index: IndexRule,
    /// Index marks, where the machine has none of its own.
    pub marks: Index,
    /// How it stands at the origin.
    pub stop: OriginStop,
    /// Counts to go on from the origin.
    pub way: i64,
    /// Counts of pressing that make a collision.
    pub collision: i64,
    /// Most time that it may take.
    pub time_limit: Option<Duration>,
}

impl HomeOrder {
    /// Slope of all changes of speed, counts per second squared.
    fn slope(&self) -> f64 {
        self.accel.of(if self.fast > 0.0 { self.fast } else { self.slow })
    }

    /// From the origin to where it ends.
    fn onward(&self, now: Instant, from: State, origin: i64) -> Trajectory {
        let (speed, accel) = (self.fast, self.slope());
        let how = Move { start_speed: 0.0, speed, accel, decel: accel };
        Trajectory::to_position(now, from, origin.saturating_add(self.way), how)
    }

    /// Is there a part of the way that it would never go, because its speed is 0?
    fn stands_still(&self) -> bool {
        let paces = |pace| self.method.all_steps().any(|step| step.pace == pace);
        let refines = self.method.index && self.index != IndexRule::None;
        (self.fast == 0.0 && (paces(Pace::Fast) || self.way != 0))
            || (self.slow == 0.0 && (paces(Pace::Slow) || refines))
    }
}

/// A homing under way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Homing {
    order: HomeOrder,
    /// The steps that are being taken.
    steps: Steps,
    at: usize,
    /// No step has been finished, and no limit met.
    fresh: bool,
    doing: HomingState,
    /// The switches as the last look found them.
    seen: Inputs,
    /// The last index mark that ended a step.
    mark: Option<i64>,
    origin: i64,
    began: Instant,
    until: Option<Instant>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum HomingState {
    /// On the way; for an index pulse after an edge: has the edge come?
    Seeking { armed: bool },
    /// Slowing down before the next step.
    Braking,
    /// Standing at a limit until time is over.
    Stuck,
    /// Looking for the index pulse that refines the origin.
    Refining { forward: bool },
    /// On the way from the origin to where it ends.
    Ending,
}

/// What a homing waits for that only the trajectory can tell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Waits {
    pub(super) index: Option<WaitsForIndex>,
    pub(super) collision: Option<i64>,
    pub(super) limits_by_stop: bool,
    pub(super) until: Option<Instant>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct WaitsForIndex {
    pub(super) forward: bool,
    pub(super) marks: Index,
    /// The mark it has to be, if not any will do.
    pub(super) only: Option<i64>,
}

impl Homing {
    fn step(&self) -> Option<HomingStep> {
        self.steps.get(self.at)
    }

    /// The direction in which it goes, and whether it goes at all.
    fn heading(&self) -> Option<bool> {
        match self.doing {
            HomingState::Seeking { .. } => self.step().map(|step| step.forward),
            HomingState::Refining { forward } => Some(forward),
            HomingState::Ending if self.order.way != 0 => Some(self.order.way > 0),
            HomingState::Braking | HomingState::Stuck | HomingState::Ending => None,
        }
    }

    /// How fast it goes, in counts per second.
    fn speed(&self) -> f64 {
        match (self.doing, self.step().map(|step| step.pace)) {
            (HomingState::Seeking { .. }, Some(Pace::Fast)) => self.order.fast,
            _ => self.order.slow,
        }
    }

    pub(super) fn waits_for(&self) -> Waits {
        let step = self.step().filter(|_| matches!(self.doing, HomingState::Seeking { .. }));
        let index = match (self.doing, step.map(|step| step.until)) {
            (HomingState::Refining { .. }, _) => true,
            (HomingState::Seeking { armed }, Some(Until::Index(_) | Until::SameIndex)) => armed,
            _ => false,
        };
        let marks = self.order.marks;
        let same = step.is_some_and(|step| step.until == Until::SameIndex);
        let only = self.mark.filter(|_| same);
        let forward = self.heading().filter(|_| index);
        let collides = step.is_some_and(|step| step.until == Until::Collision);
        Waits {
            index: forward.map(|forward| WaitsForIndex { forward, marks, only }),
            collision: collides.then_some(self.order.collision),
            limits_by_stop: self.order.source != LimitSource::Switch,
            until: self.until,
        }
    }
}

impl Motor {
    /// Looks for the origin.
    ///
    /// # Errors
    /// Why it does not start: without power, while held, while it moves, or at a speed of 0.
    pub fn start_home(&mut self, now: Instant, order: HomeOrder) -> Result<(), Ignored> {
        self.may_start(false)?;
        if order.stands_still() {
            return Err(Ignored::NoSpeed);
        }
        let mut homing = Homing {
            steps: order.method.steps,
            at: 0,
            fresh: true,
            doing: HomingState::Ending,
            seen: Inputs::default(),
            mark: None,
            origin: 0,
            began: now,
            until: order.time_limit.map(|time| now + time),
            order,
        };
        let by = homing.order.method.by;
        if by.is_some_and(|by| self.home_switches(now, homing.order.source).has(by)) {
            homing.steps = homing.order.method.on;
        }
        self.goal = Goal::None;
        self.homing = Some(Box::new(homing));
        self.begin(now, Trajectory::halt(now, self.whereabouts(now)), Phase::Homing);
        self.seek(now);
        self.advance(now);
        Ok(())
    }

    /// Looks whether a switch has changed.
    pub(super) fn home_look(&mut self, now: Instant) {
        let Some(source) = self.homing.as_ref().map(|it| it.order.source) else { return };
        let switches = self.home_switches(now, source);
        let Some(homing) = &mut self.homing else { return };
        let before = std::mem::replace(&mut homing.seen, switches);
        let changed = |edge: SignalEdge| {
            before.has(edge.signal) != edge.on && switches.has(edge.signal) == edge.on
        };
        let armed = matches!(homing.doing, HomingState::Seeking { armed: true });
        let step = homing.step().filter(|_| matches!(homing.doing, HomingState::Seeking { .. }));
        match step.map(|step| step.until) {
            Some(Until::Edge(edge)) if changed(edge) => {
                return self.home_found(now, self.position(now));
            }
            Some(Until::Index(Some(edge))) if changed(edge) && !armed => {
                homing.doing = HomingState::Seeking { armed: true };
                self.look_ahead(now);
            }
            _ => {}
        }
        self.home_limit(now);
    }

    /// What the present step waits for is at `at`.
    pub(super) fn home_found(&mut self, now: Instant, at: i64) {
        let Some(homing) = &mut self.homing else { return };
        if matches!(homing.doing, HomingState::Refining { .. }) {
            homing.origin = at;
            self.effects.push_back(Effect::IndexFound(at));
            return self.home_end(now);
        }
        let Some(step) = homing.step() else { return };
        homing.fresh = false;
        if matches!(step.until, Until::Index(_)) {
            homing.mark = Some(at);
        }
        self.effects.push_back(Effect::HomingStepDone(step, at));
        match step.then {
            Then::Ramp => {
                homing.at += 1;
                homing.doing = HomingState::Braking;
                self.home_brake(now);
            }
            Then::Keep => {
                homing.at += 1;
                self.seek(now);
            }
            Then::Origin => {
                homing.origin = at;
                self.refine(now);
            }
        }
    }

    /// The trajectory is over.
    pub(super) fn home_stands(&mut self, now: Instant) {
        let Some(homing) = &self.homing else { return };
        match homing.doing {
            HomingState::Braking => self.seek(now),
            HomingState::Ending => {
                let origin = homing.origin;
                self.homing = None;
                self.arrived = true;
                self.effects.push_back(Effect::HomingDone(origin));
                self.stand(now);
            }
            HomingState::Seeking { .. } | HomingState::Stuck | HomingState::Refining { .. } => {}
        }
    }

    /// The time is over.
    pub(super) fn home_late(&mut self, now: Instant) {
        self.lose(HomeEnd::TimeLimit, true);
        self.brake(now);
    }

    /// Ends a homing, if there is one, because of something else, which then says how the axis goes on.
    pub fn lose_origin(&mut self, why: HomeEnd) {
        self.lose(why, false);
    }

    fn lose(&mut self, why: HomeEnd, alarm: bool) {
        if let Some(homing) = self.homing.take() {
            self.goal = Goal::Stop(Slope::Rate(homing.order.slope()), 0.0);
            let forward = homing.heading().unwrap_or(self.forward);
            self.effects.push_back(Effect::HomingAborted { why, forward, alarm });
        }
    }

    /// Begins the present step. Without one the origin is here.
    fn seek(&mut self, now: Instant) {
        let here = self.position(now);
        let Some(homing) = &mut self.homing else { return };
        let Some(step) = homing.step() else {
            homing.origin = here;
            return self.home_end(now);
        };
        let armed = matches!(step.until, Until::Index(None) | Until::SameIndex);
        homing.doing = HomingState::Seeking { armed };
        let speed = homing.speed();
        let source = homing.order.source;
        let speed = if step.forward { speed } else { -speed };
        self.effects.push_back(Effect::HomingStepStarted(step, speed));
        self.home_go(now, self.state(now), speed);
        let seen = self.home_switches(now, source);
        if let Some(homing) = &mut self.homing {
            homing.seen = seen;
        }
        self.home_limit(now);
    }

    /// Ends the present way if there is a limit ahead that it does not look for.
    fn home_limit(&mut self, now: Instant) {
        let at = self.position(now);
        let Some(homing) = &mut self.homing else { return };
        let Some(forward) = homing.heading() else { return };
        let ahead = limit(forward);
        if !homing.seen.has(ahead) {
            return;
        }
        let edge = SignalEdge { signal: ahead, on: true };
        let seeking = matches!(homing.doing, HomingState::Seeking { .. });
        match homing.step().map(|step| step.until) {
            // It stands there already.
            Some(Until::Edge(it)) if seeking && it == edge => return self.home_found(now, at),
            // It passes the limit, or has started there: the index pulse lies beyond.
            Some(Until::Index(Some(it))) if seeking && it == edge => {
                homing.doing = HomingState::Seeking { armed: true };
                return self.look_ahead(now);
            }
            // It goes back to where it has just been.
            Some(Until::SameIndex) if seeking => return,
            // The origin is this very limit, and the index pulse may lie beyond it.
            _ if !seeking && homing.order.method.by == Some(ahead) => return,
            _ => {}
        }
        if homing.order.limit == LimitRule::Alarm {
            self.lose(HomeEnd::Limit, true);
            return self.brake(now);
        }
        let turns = homing.fresh && !homing.order.method.at_limit.is_empty();
        if !turns && homing.until.is_none() {
            self.lose(HomeEnd::Limit, false);
            return self.stop_at_limit(now);
        }
        if turns {
            (homing.steps, homing.at, homing.fresh) = (homing.order.method.at_limit, 0, false);
        }
        homing.doing = if turns { HomingState::Braking } else { HomingState::Stuck };
        self.effects.push_back(Effect::HomingLimit { forward, turns, at });
        self.home_brake(now);
    }

    /// Goes on from the origin for an index pulse, if there is one to look for.
    fn refine(&mut self, now: Instant) {
        let Some(homing) = &mut self.homing else { return };
        let method = homing.order.method;
        // The last step may have gone either way, so back and onward are seen from the first.
        let onward = method.steps.get(0).is_none_or(|step| step.forward);
        let forward = match homing.order.index {
            IndexRule::Back if method.index => !onward,
            IndexRule::Onward if method.index => onward,
            _ => return self.home_end(now),
        };
        homing.doing = HomingState::Refining { forward };
        let (from, slow) = (State::at_rest(homing.origin as f64), homing.order.slow);
        self.effects.push_back(Effect::IndexSearchStarted { forward });
        self.home_go(now, from, if forward { slow } else { -slow });
        self.home_limit(now);
    }

    /// The origin is found: goes to where the homing ends.
    fn home_end(&mut self, now: Instant) {
        let state = self.state(now);
        let Some(homing) = &mut self.homing else { return };
        homing.doing = HomingState::Ending;
        let HomeOrder { way, stop, .. } = homing.order;
        let origin = homing.origin;
        let from = match stop {
            OriginStop::AtOnce => State::at_rest(origin as f64),
            OriginStop::Ramp => state,
        };
        let trajectory = match way {
            0 => Trajectory::stop(now, from, homing.order.slope()),
            _ => homing.order.onward(now, from, origin),
        };
        self.forward = way >= 0;
        self.begin(now, trajectory, Phase::Homing);
        self.home_limit(now);
    }

    fn home_go(&mut self, now: Instant, from: State, speed: f64) {
        let slope = self.home_slope();
        let trajectory = Trajectory::to_speed(now, from, speed, slope, slope);
        self.forward = speed >= 0.0;
        self.begin(now, trajectory, Phase::Homing);
    }

    fn home_brake(&mut self, now: Instant) {
        let trajectory = Trajectory::stop(now, self.state(now), self.home_slope());
        self.begin(now, trajectory, Phase::Homing);
    }

    /// Slope of the homing under way, in counts per second squared.
    pub(super) fn home_slope(&self) -> f64 {
        self.homing.as_ref().map_or(0.0, |it| it.order.slope())
    }

    /// The switches, as a homing that gets its limits from `source` sees them.
    fn home_switches(&self, now: Instant, source: LimitSource) -> Inputs {
        let position = self.state(now).position;
        let at = |forward| {
            let held = self.machine.hard_stop.is_some_and(|[low, high]| {
                if forward { position >= high as f64 } else { position <= low as f64 }
            });
            let switch = self.wants.switches.has(limit(forward));
            match source {
                LimitSource::Switch => switch,
                LimitSource::HardStop => held,
                LimitSource::Either => switch || held,
            }
        };
        let home = self.wants.switches.has(Input::HomeSwitch);
        let all =
            [(Input::HomeSwitch, home), (Input::LimitPos, at(true)), (Input::LimitNeg, at(false))];
        let mut switches = Inputs::default();
        all.iter().filter(|(_, on)| *on).for_each(|(signal, _)| switches.insert(*signal));
        switches
    }

    /// The next index mark that is passed and waited for.
    pub(super) fn next_index(&self, now: Instant, waits: WaitsForIndex) -> Option<IndexPulse> {
        let way =
            if waits.forward { CrossingDirection::Rising } else { CrossingDirection::Falling };
        // While the axis turns round it may pass marks the other way.
        let after = self.trajectory.goes_at(way, now)?;
        let index = self.machine.index.or(Some(waits.marks));
        match waits.only {
            Some(mark) => self.machine.index_at(mark, way, &self.trajectory, after),
            None => Machine { index, ..self.machine }.next_index(&self.trajectory, after),
        }
    }
}
