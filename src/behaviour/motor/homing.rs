//! Homing: the steps of a method one after the other, until one of them finds the origin.
//!
//! A step goes in one direction until a switch changes, an index pulse comes or a hard stop holds the axis. It sees
//! switches as the drive does, so it doesn't matter whether a terminal, a master or the machine moves them. What the
//! position register says of the origin is not decided here.
//!
//! A homing decides and does not act: it is asked what comes next and answers with a [`HomingMove`].

use super::home_order::HomeOrder;
use super::levels::limit_switch;
use crate::behaviour::effect::Effect;
use crate::motion::{Index, State, Trajectory};
use crate::time::Instant;
use crate::vocabulary::{
    HomeEnd, HomingStep, IndexRule, Input, Inputs, LimitRule, LimitSource, OriginStop, Pace,
    SignalEdge, Steps, Then, Until,
};
use std::collections::VecDeque;

/// A homing under way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Homing {
    order: HomeOrder,
    /// The steps that are being taken.
    steps: Steps,
    at: usize,
    /// No step has been finished, and no limit met.
    fresh: bool,
    state: HomingState,
    /// The switches as they were sampled last.
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

/// What a homing is told about the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct HomingView {
    pub(super) now: Instant,
    /// The command, as far as a hard stop lets the axis go.
    pub(super) command: State,
    /// The last whole count that the axis has reached.
    pub(super) position: i64,
    /// The signals of home switch and limits, among others.
    pub(super) switches: Inputs,
    /// Positions between which hard stops hold the axis.
    pub(super) hard_stop: Option<[i64; 2]>,
}

/// What the axis is to do for a homing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum HomingMove {
    /// Go on, and wait for something else on the way.
    ResetTimers,
    /// Begin this trajectory, which goes that way, and see what it meets.
    Go { trajectory: Trajectory, forward: bool },
    /// Begin this trajectory, to go on when it is over.
    Brake(Trajectory),
    /// It is over: stop because of it.
    Abort { why: HomeEnd, alarm: bool, by_limit: bool },
    /// It is done.
    Done { origin: i64 },
}

/// What a homing waits for that only the trajectory can tell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HomingWaits {
    pub(super) index: Option<IndexSearch>,
    /// Counts of pressing.
    pub(super) collision: Option<i64>,
    /// Do hard stops tell of limits?
    pub(super) limits_by_stop: bool,
    pub(super) until: Option<Instant>,
}

/// Which index pulse a homing waits for.
#[derive(Debug, Clone, Copy)]
pub(super) struct IndexSearch {
    pub(super) forward: bool,
    /// Index marks, where the machine has none of its own.
    pub(super) marks: Index,
    /// The mark it has to be, if not any will do.
    pub(super) only: Option<i64>,
}

type Effects = VecDeque<Effect>;

impl Homing {
    /// Begins on steps that depend on where the axis stands.
    pub(super) fn begin(order: HomeOrder, view: &HomingView) -> Self {
        let mut homing = Self {
            steps: order.method.steps,
            at: 0,
            fresh: true,
            state: HomingState::Ending,
            seen: Inputs::default(),
            mark: None,
            origin: 0,
            began: view.now,
            until: order.time_limit.map(|time| view.now + time),
            order,
        };
        let by = homing.order.method.by;
        if by.is_some_and(|by| homing.switches(view).has(by)) {
            homing.steps = homing.order.method.on;
        }
        homing
    }

    pub(super) fn order(&self) -> &HomeOrder {
        &self.order
    }

    fn step(&self) -> Option<HomingStep> {
        self.steps.get(self.at)
    }

    fn is_seeking(&self) -> bool {
        matches!(self.state, HomingState::Seeking { .. })
    }

    /// The direction in which it goes, where it goes at all.
    pub(super) fn heading(&self) -> Option<bool> {
        match self.state {
            HomingState::Seeking { .. } => self.step().map(|step| step.forward),
            HomingState::Refining { forward } => Some(forward),
            HomingState::Ending if self.order.way != 0 => Some(self.order.way > 0),
            HomingState::Braking | HomingState::Stuck | HomingState::Ending => None,
        }
    }

    /// How fast it goes in that direction, in counts per second.
    fn speed(&self, forward: bool) -> f64 {
        let speed = match (self.state, self.step().map(|step| step.pace)) {
            (HomingState::Seeking { .. }, Some(Pace::Fast)) => self.order.fast,
            _ => self.order.slow,
        };
        if forward { speed } else { -speed }
    }

    pub(super) fn waits(&self) -> HomingWaits {
        let step = self.step().filter(|_| self.is_seeking());
        let index = match (self.state, step.map(|step| step.until)) {
            (HomingState::Refining { .. }, _) => true,
            (HomingState::Seeking { armed }, Some(Until::Index(_) | Until::SameIndex)) => armed,
            _ => false,
        };
        let marks = self.order.marks;
        let same = step.is_some_and(|step| step.until == Until::SameIndex);
        let only = self.mark.filter(|_| same);
        let forward = self.heading().filter(|_| index);
        let collides = step.is_some_and(|step| step.until == Until::Collision);
        HomingWaits {
            index: forward.map(|forward| IndexSearch { forward, marks, only }),
            collision: collides.then_some(self.order.collision),
            limits_by_stop: self.order.source != LimitSource::Switch,
            until: self.until,
        }
    }

    /// The present step begins. Without one the origin is here.
    pub(super) fn seek(&mut self, view: &HomingView, effects: &mut Effects) -> HomingMove {
        let Some(step) = self.step() else {
            self.origin = view.position;
            return self.end(view);
        };
        let armed = matches!(step.until, Until::Index(None) | Until::SameIndex);
        self.state = HomingState::Seeking { armed };
        let speed = self.speed(step.forward);
        effects.push_back(Effect::HomingStepStarted(step, speed));
        let trajectory = self.order.go(view.now, view.command, speed);
        HomingMove::Go { trajectory, forward: speed >= 0.0 }
    }

    /// A trajectory has begun on which it may meet a limit at once.
    pub(super) fn begun(&mut self, view: &HomingView, effects: &mut Effects) -> Option<HomingMove> {
        if self.is_seeking() {
            self.seen = self.switches(view);
        }
        self.meet_limit(view, effects)
    }

    /// Switches may have changed.
    pub(super) fn sample(
        &mut self,
        view: &HomingView,
        effects: &mut Effects,
    ) -> Option<HomingMove> {
        let switches = self.switches(view);
        let before = std::mem::replace(&mut self.seen, switches);
        let changed = |edge: SignalEdge| {
            before.has(edge.signal) != edge.on && switches.has(edge.signal) == edge.on
        };
        let armed = matches!(self.state, HomingState::Seeking { armed: true });
        let step = self.step().filter(|_| self.is_seeking());
        let arms = match step.map(|step| step.until) {
            Some(Until::Edge(edge)) if changed(edge) => {
                return self.found(view, view.position, effects);
            }
            Some(Until::Index(Some(edge))) => changed(edge) && !armed,
            _ => false,
        };
        if arms {
            self.state = HomingState::Seeking { armed: true };
        }
        self.meet_limit(view, effects).or(arms.then_some(HomingMove::ResetTimers))
    }

    /// What it waits for is at `at`.
    pub(super) fn found(
        &mut self,
        view: &HomingView,
        at: i64,
        effects: &mut Effects,
    ) -> Option<HomingMove> {
        if matches!(self.state, HomingState::Refining { .. }) {
            self.origin = at;
            effects.push_back(Effect::IndexFound(at));
            return Some(self.end(view));
        }
        let step = self.step()?;
        self.fresh = false;
        if matches!(step.until, Until::Index(_)) {
            self.mark = Some(at);
        }
        effects.push_back(Effect::HomingStepDone(step, at));
        Some(match step.then {
            Then::Ramp => {
                self.at += 1;
                self.state = HomingState::Braking;
                HomingMove::Brake(self.order.brake(view.now, view.command))
            }
            Then::Keep => {
                self.at += 1;
                self.seek(view, effects)
            }
            Then::Origin => {
                self.origin = at;
                self.refine(view, effects)
            }
        })
    }

    /// The trajectory is over.
    pub(super) fn stopped(
        &mut self,
        view: &HomingView,
        effects: &mut Effects,
    ) -> Option<HomingMove> {
        match self.state {
            HomingState::Braking => Some(self.seek(view, effects)),
            HomingState::Ending => Some(HomingMove::Done { origin: self.origin }),
            HomingState::Seeking { .. } | HomingState::Stuck | HomingState::Refining { .. } => None,
        }
    }

    /// Goes as `order` says from now on, the method apart, from a state of the setpoint.
    pub(super) fn retune(
        &mut self,
        now: Instant,
        order: HomeOrder,
        from: State,
        effects: &mut Effects,
    ) -> Trajectory {
        let before = std::mem::replace(&mut self.order, order);
        self.until = self.order.time_limit.map(|time| self.began + time);
        effects.extend(before.replans(&self.order).map(Effect::Replanned));
        match (self.state, self.heading()) {
            (HomingState::Seeking { .. } | HomingState::Refining { .. }, Some(forward)) => {
                self.order.go(now, from, self.speed(forward))
            }
            (HomingState::Ending, Some(_)) => self.order.onward(now, from, self.origin),
            _ => self.order.brake(now, from),
        }
    }

    /// What tells of limits may be something else now, which is no edge.
    pub(super) fn retuned(
        &mut self,
        view: &HomingView,
        effects: &mut Effects,
    ) -> Option<HomingMove> {
        self.seen = self.switches(view);
        self.meet_limit(view, effects)
    }

    /// Ends the present way if there is a limit ahead that it does not look for.
    fn meet_limit(&mut self, view: &HomingView, effects: &mut Effects) -> Option<HomingMove> {
        let forward = self.heading()?;
        let ahead = limit_switch(forward);
        if !self.seen.has(ahead) {
            return None;
        }
        let edge = SignalEdge { signal: ahead, on: true };
        let seeking = self.is_seeking();
        match self.step().map(|step| step.until) {
            // It stands there already.
            Some(Until::Edge(it)) if seeking && it == edge => {
                return self.found(view, view.position, effects);
            }
            // It passes the limit, or has started there: the index pulse lies beyond.
            Some(Until::Index(Some(it))) if seeking && it == edge => {
                self.state = HomingState::Seeking { armed: true };
                return Some(HomingMove::ResetTimers);
            }
            // It goes back to where it has just been.
            Some(Until::SameIndex) if seeking => return None,
            // The origin is this very limit, and the index pulse may lie beyond it.
            _ if !seeking && self.order.method.by == Some(ahead) => return None,
            _ => {}
        }
        let why = HomeEnd::Limit;
        if self.order.limit == LimitRule::Alarm {
            return Some(HomingMove::Abort { why, alarm: true, by_limit: false });
        }
        let turns = self.fresh && !self.order.method.at_limit.is_empty();
        if !turns && self.until.is_none() {
            return Some(HomingMove::Abort { why, alarm: false, by_limit: true });
        }
        if turns {
            (self.steps, self.at, self.fresh) = (self.order.method.at_limit, 0, false);
        }
        self.state = if turns { HomingState::Braking } else { HomingState::Stuck };
        effects.push_back(Effect::HomingLimit { forward, turns, at: view.position });
        Some(HomingMove::Brake(self.order.brake(view.now, view.command)))
    }

    /// Goes on from the origin for an index pulse, if there is one to look for.
    fn refine(&mut self, view: &HomingView, effects: &mut Effects) -> HomingMove {
        let method = self.order.method;
        // The last step may have gone either way, so back and onward are seen from the first.
        let onward = method.steps.get(0).is_none_or(|step| step.forward);
        let forward = match self.order.index {
            IndexRule::Back if method.index => !onward,
            IndexRule::Onward if method.index => onward,
            _ => return self.end(view),
        };
        self.state = HomingState::Refining { forward };
        effects.push_back(Effect::IndexSearchStarted { forward });
        let speed = self.speed(forward);
        let trajectory = self.order.go(view.now, State::at_rest(self.origin as f64), speed);
        HomingMove::Go { trajectory, forward: speed >= 0.0 }
    }

    /// The origin is found: goes to where the homing ends.
    fn end(&mut self, view: &HomingView) -> HomingMove {
        self.state = HomingState::Ending;
        let from = match self.order.stop {
            OriginStop::AtOnce => State::at_rest(self.origin as f64),
            OriginStop::Ramp => view.command,
        };
        let trajectory = match self.order.way {
            0 => self.order.brake(view.now, from),
            _ => self.order.onward(view.now, from, self.origin),
        };
        HomingMove::Go { trajectory, forward: self.order.way >= 0 }
    }

    /// The switches, as a homing sees them that gets its limits where its order says.
    fn switches(&self, view: &HomingView) -> Inputs {
        let position = view.command.position;
        let at = |forward| {
            let held = view.hard_stop.is_some_and(|[low, high]| {
                if forward { position >= high as f64 } else { position <= low as f64 }
            });
            let switch = view.switches.has(limit_switch(forward));
            match self.order.source {
                LimitSource::Switch => switch,
                LimitSource::HardStop => held,
                LimitSource::Either => switch || held,
            }
        };
        let home = view.switches.has(Input::HomeSwitch);
        let all =
            [(Input::HomeSwitch, home), (Input::LimitPos, at(true)), (Input::LimitNeg, at(false))];
        let mut switches = Inputs::default();
        all.iter().filter(|(_, on)| *on).for_each(|(signal, _)| switches.insert(*signal));
        switches
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::behaviour::motor::Slope;
    use crate::vocabulary::Method;

    /// Forward and fast onto the home switch, back and slow off it: there is the origin. At a limit: the other way.
    fn order() -> HomeOrder {
        let edge = |on| Until::Edge(SignalEdge { signal: Input::HomeSwitch, on });
        let step = |forward, pace, on, then| HomingStep { forward, pace, until: edge(on), then };
        let off = step(false, Pace::Slow, false, Then::Origin);
        HomeOrder {
            method: Method {
                steps: Steps::new(&[step(true, Pace::Fast, true, Then::Ramp), off]),
                at_limit: Steps::new(&[step(false, Pace::Fast, true, Then::Keep), off]),
                ..Method::default()
            },
            fast: 1000.0,
            slow: 100.0,
            accel: Slope::Rate(1e4),
            limit: LimitRule::Turn,
            source: LimitSource::Switch,
            index: IndexRule::None,
            marks: Index { every: 0, offset: 0 },
            stop: OriginStop::AtOnce,
            way: 0,
            collision: 0,
            time_limit: None,
        }
    }

    fn view(position: i64, switches: &[Input]) -> HomingView {
        let mut on = Inputs::default();
        switches.iter().for_each(|it| on.insert(*it));
        let command = State::at_rest(position as f64);
        HomingView { now: Instant::ZERO, command, position, switches: on, hard_stop: None }
    }

    /// A homing that goes forward from 0, and nothing to report.
    fn seeking(order: HomeOrder) -> (Homing, Effects) {
        let mut effects = Effects::new();
        let mut homing = Homing::begin(order, &view(0, &[]));
        let begun = homing.seek(&view(0, &[]), &mut effects);
        assert!(matches!(begun, HomingMove::Go { forward: true, .. }), "{begun:?}");
        assert_eq!(homing.begun(&view(0, &[]), &mut effects), None);
        effects.clear();
        (homing, effects)
    }

    #[test]
    fn an_edge_brings_the_next_step_and_the_last_one_the_origin() {
        let (mut homing, mut effects) = seeking(order());
        let onto = view(500, &[Input::HomeSwitch]);
        let next = homing.sample(&onto, &mut effects);
        assert!(matches!(next, Some(HomingMove::Brake(_))), "{next:?}");
        let next = homing.stopped(&onto, &mut effects);
        assert!(matches!(next, Some(HomingMove::Go { forward: false, .. })), "{next:?}");
        assert_eq!(homing.begun(&onto, &mut effects), None);
        let off = view(499, &[]);
        let next = homing.sample(&off, &mut effects);
        assert!(matches!(next, Some(HomingMove::Go { .. })), "{next:?}");
        let done = homing.stopped(&off, &mut effects);
        assert_eq!(done, Some(HomingMove::Done { origin: 499 }));
    }

    #[test]
    fn a_limit_turns_it_round_once() {
        let (mut homing, mut effects) = seeking(order());
        let limit = view(800, &[Input::LimitPos]);
        let next = homing.sample(&limit, &mut effects);
        assert!(matches!(next, Some(HomingMove::Brake(_))), "{next:?}");
        assert_eq!(effects, [Effect::HomingLimit { forward: true, turns: true, at: 800 }]);
        let next = homing.stopped(&limit, &mut effects);
        assert!(matches!(next, Some(HomingMove::Go { forward: false, .. })), "{next:?}");
        assert_eq!(homing.begun(&limit, &mut effects), None, "it goes away from there");
        let other = homing.sample(&view(-800, &[Input::LimitNeg]), &mut effects);
        let (why, alarm, by_limit) = (HomeEnd::Limit, false, true);
        assert_eq!(other, Some(HomingMove::Abort { why, alarm, by_limit }));
    }

    #[test]
    fn a_limit_is_a_fault_where_the_order_says_so() {
        let (mut homing, mut effects) = seeking(HomeOrder { limit: LimitRule::Alarm, ..order() });
        let next = homing.sample(&view(800, &[Input::LimitPos]), &mut effects);
        let (why, alarm, by_limit) = (HomeEnd::Limit, true, false);
        assert_eq!(next, Some(HomingMove::Abort { why, alarm, by_limit }));
    }
}
