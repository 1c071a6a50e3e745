//! The steps of a homing method: words resolved, and whether they end at an origin.

use super::super::Choice;
use super::super::compile::Wirer;
use crate::model::raw::{RawHomingStep, RawMethod, RawWay};
use crate::problem::{Path, Problem};
use crate::vocabulary::{
    HomingStep, IndexRule, Input, LimitRule, LimitSource, MOST_STEPS, Method, SignalEdge, Steps,
    Then, Until,
};

impl Wirer<'_> {
    /// Limits and index pulses have been resolved before.
    pub(super) fn method(&mut self, raw: &RawMethod, path: &Path) -> Method {
        let by = raw.by.as_ref().and_then(|name| self.seen_switch(name, &path.key("by")));
        if by.is_some() && raw.on.is_empty() {
            self.unused("by", "there is no `on`", path);
        }
        if raw.by.is_none() && !raw.on.is_empty() {
            self.unused("on", "there is no `by`", path);
        }
        let method = Method {
            by,
            steps: self.steps(&raw.steps, &path.key("steps")),
            at_limit: self.steps(&raw.at_limit, &path.key("at_limit")),
            on: self.steps(&raw.on, &path.key("on")),
            index: raw.index,
        };
        if let Some(why) = self.never_turns(&method).filter(|_| !raw.at_limit.is_empty()) {
            self.unused("at_limit", why, path);
        }
        if let Some(why) = self.never_refined(&method).filter(|_| raw.index) {
            self.unused("index", why, path);
        }
        method
    }

    /// Why the steps of `method` for a limit are never taken.
    fn never_turns(&self, method: &Method) -> Option<&'static str> {
        let limit = self.wiring.homing.as_ref().and_then(|it| it.limit.as_ref());
        let turns = limit.is_none_or(|it| it.all().contains(&LimitRule::Turn));
        let meets = |step: HomingStep| {
            let ahead = if step.forward { Input::LimitPos } else { Input::LimitNeg };
            let wanted = Until::Edge(SignalEdge { signal: ahead, on: true });
            step.until != wanted && self.is_seen(ahead)
        };
        let first = [method.steps.get(0), method.on.get(0)];
        match () {
            () if !turns => Some("`homing.limit` is never `turn`"),
            () if !first.into_iter().flatten().any(meets) => {
                Some("the first step cannot meet a limit")
            }
            () => None,
        }
    }

    /// Why an index pulse never refines the origin of `method`.
    fn never_refined(&self, method: &Method) -> Option<&'static str> {
        let rule = self.wiring.homing.as_ref().and_then(|it| it.index.as_ref());
        let rules = rule.map(Choice::all).unwrap_or_default();
        match () {
            () if method.steps.is_empty() => Some("there are no steps"),
            () if rules.iter().all(|it| *it == IndexRule::None) => {
                Some("`homing.index` is never `back` or `onward`")
            }
            () => None,
        }
    }

    fn steps(&mut self, raw: &[RawHomingStep], path: &Path) -> Steps {
        if raw.len() > MOST_STEPS {
            let what = format!("{} steps, but at most {MOST_STEPS} are allowed", raw.len());
            self.problems.push(Problem::key(path.clone(), what));
        }
        let step = |(i, it): (usize, &RawHomingStep)| self.step(it, &path.index(i));
        let steps: Vec<_> = raw.iter().enumerate().filter_map(step).collect();
        let origin = |step: &HomingStep| step.then == Then::Origin;
        let last = steps.len().saturating_sub(1);
        if steps.len() == raw.len() {
            for (i, step) in steps.iter().enumerate().filter(|(i, it)| origin(it) != (*i == last)) {
                let what = match origin(step) {
                    true => "`origin` ends the homing, but more steps follow",
                    false => "the last step must end with `origin`",
                };
                self.problems.push(Problem::value(path.index(i).key("then"), what));
            }
        }
        let mut found = false;
        for (i, step) in steps.iter().enumerate() {
            if step.until == Until::SameIndex && !found {
                let what = "no earlier step waits for an index pulse";
                self.problems.push(Problem::value(path.index(i).key("to"), what));
            }
            found |= matches!(step.until, Until::Index(_));
        }
        Steps::new(&steps)
    }

    fn step(&mut self, raw: &RawHomingStep, path: &Path) -> Option<HomingStep> {
        let pace = self.word(&raw.at, "pace", &path.key("at"));
        let until = self.until(&raw.to, &path.key("to"));
        let then = self.word(&raw.then, "end of a step", &path.key("then"));
        Some(HomingStep { forward: raw.go == RawWay::Pos, pace: pace?, until: until?, then: then? })
    }

    fn until(&mut self, text: &str, path: &Path) -> Option<Until> {
        match text {
            "collision" => return Some(Until::Collision),
            "index" => return Some(Until::Index(None)),
            "same index" => return Some(Until::SameIndex),
            _ => {}
        }
        let (index, edge) = match text.strip_prefix("index after ") {
            Some(edge) => (true, edge),
            None => (false, text),
        };
        let (name, on) = match edge.split_once(' ') {
            Some((name, "on")) => (name, true),
            Some((name, "off")) => (name, false),
            _ => {
                let what = format!("unknown target `{text}`");
                let advice = "use a switch with `on` or `off`, `index`, `index after SWITCH on`, `same index`, or `collision`";
                self.problems.push(Problem::value(path.clone(), what).advise(advice));
                return None;
            }
        };
        let edge = SignalEdge { signal: self.seen_switch(name, path)?, on };
        Some(if index { Until::Index(Some(edge)) } else { Until::Edge(edge) })
    }

    /// A switch that the drive can see.
    fn seen_switch(&mut self, name: &str, path: &Path) -> Option<Input> {
        let signal = self.switch(name, path)?;
        if !self.is_seen(signal) {
            let what = format!("`{name}` is not wired");
            let advice = "add it under `signals.inputs`";
            self.problems.push(Problem::value(path.clone(), what).advise(advice));
            return None;
        }
        Some(signal)
    }

    /// Can `signal` be active in a homing? A hard stop can stand for a limit switch.
    pub(super) fn is_seen(&self, signal: Input) -> bool {
        let source = self.wiring.homing.as_ref().and_then(|it| it.source.as_ref());
        let stops = source.is_some_and(|it| it.all().iter().any(|it| *it != LimitSource::Switch));
        self.inputs_wired().contains(&signal) || stops && signal != Input::HomeSwitch
    }
}
