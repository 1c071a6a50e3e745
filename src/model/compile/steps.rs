//! The steps of a homing method: words resolved, and whether they end at an origin.

use super::names::Names;
use super::wired::Wired;
use crate::model::Choice;
use crate::model::raw::{RawHomingStep, RawMethod, RawWay};
use crate::problem::{Path, Problem};
use crate::vocabulary::{
    HomingStep, IndexRule, Input, LimitRule, LimitSource, MOST_STEPS, Method, SignalEdge, Steps,
    Then, Until,
};

/// What a homing can meet on its way.
pub(super) struct Sight<'a> {
    pub wired: &'a Wired,
    pub limit: Option<&'a Choice<LimitRule>>,
    pub source: Option<&'a Choice<LimitSource>>,
    pub index: Option<&'a Choice<IndexRule>>,
}

impl Sight<'_> {
    /// Can `signal` be active in a homing? A hard stop can stand for a limit switch.
    pub fn sees(&self, signal: Input) -> bool {
        let is_stop = |it: &LimitSource| *it != LimitSource::Switch;
        let stops = self.source.is_some_and(|it| it.all().iter().any(is_stop));
        self.wired.has(signal) || stops && signal != Input::HomeSwitch
    }

    /// Why the steps of `method` for a limit are never taken.
    fn never_turns(&self, method: &Method) -> Option<&'static str> {
        let turns = self.limit.is_none_or(|it| it.all().contains(&LimitRule::Turn));
        let meets = |step: HomingStep| {
            let ahead = if step.forward { Input::LimitPos } else { Input::LimitNeg };
            let wanted = Until::Edge(SignalEdge { signal: ahead, on: true });
            step.until != wanted && self.sees(ahead)
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
        let rules = self.index.map(Choice::all).unwrap_or_default();
        match () {
            () if method.steps.is_empty() => Some("there are no steps"),
            () if rules.iter().all(|it| *it == IndexRule::None) => {
                Some("`homing.index` is never `back` or `onward`")
            }
            () => None,
        }
    }
}

/// The method at `path`.
pub(super) fn method(raw: &RawMethod, sight: &Sight<'_>, path: &Path, names: &mut Names) -> Method {
    let by = raw.by.as_ref().and_then(|name| seen_switch(name, sight, &path.key("by"), names));
    if by.is_some() && raw.on.is_empty() {
        names.without_effect("by", "there is no `on`", path);
    }
    if raw.by.is_none() && !raw.on.is_empty() {
        names.without_effect("on", "there is no `by`", path);
    }
    let method = Method {
        by,
        steps: steps(&raw.steps, sight, &path.key("steps"), names),
        at_limit: steps(&raw.at_limit, sight, &path.key("at_limit"), names),
        on: steps(&raw.on, sight, &path.key("on"), names),
        index: raw.index,
    };
    if let Some(why) = sight.never_turns(&method).filter(|_| !raw.at_limit.is_empty()) {
        names.without_effect("at_limit", why, path);
    }
    if let Some(why) = sight.never_refined(&method).filter(|_| raw.index) {
        names.without_effect("index", why, path);
    }
    method
}

fn steps(raw: &[RawHomingStep], sight: &Sight<'_>, path: &Path, names: &mut Names) -> Steps {
    if raw.len() > MOST_STEPS {
        let what = format!("{} steps, but at most {MOST_STEPS} are allowed", raw.len());
        names.report(Problem::key(path.clone(), what));
    }
    let read = raw.iter().enumerate();
    let steps: Vec<_> = read.filter_map(|(i, it)| step(it, sight, &path.index(i), names)).collect();
    if steps.len() == raw.len() {
        ends_at_the_origin(&steps, path, names);
    }
    let mut found = false;
    for (i, step) in steps.iter().enumerate() {
        if step.until == Until::SameIndex && !found {
            let what = "no earlier step waits for an index pulse";
            names.report(Problem::value(path.index(i).key("to"), what));
        }
        found |= matches!(step.until, Until::Index(_));
    }
    Steps::new(&steps)
}

/// The last step ends at the origin, and no other does.
fn ends_at_the_origin(steps: &[HomingStep], path: &Path, names: &mut Names) {
    for (i, step) in steps.iter().enumerate() {
        let (is_last, is_origin) = (i + 1 == steps.len(), step.then == Then::Origin);
        let what = match (is_last, is_origin) {
            (false, true) => "`origin` ends the homing, but more steps follow",
            (true, false) => "the last step must end with `origin`",
            _ => continue,
        };
        names.report(Problem::value(path.index(i).key("then"), what));
    }
}

fn step(
    raw: &RawHomingStep,
    sight: &Sight<'_>,
    path: &Path,
    names: &mut Names,
) -> Option<HomingStep> {
    let pace = names.word(&raw.at, "pace", &path.key("at"));
    let until = until(&raw.to, sight, &path.key("to"), names);
    let then = names.word(&raw.then, "end of a step", &path.key("then"));
    Some(HomingStep { forward: raw.go == RawWay::Pos, pace: pace?, until: until?, then: then? })
}

fn until(text: &str, sight: &Sight<'_>, path: &Path, names: &mut Names) -> Option<Until> {
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
            names.report(Problem::value(path.clone(), what).advise(advice));
            return None;
        }
    };
    let edge = SignalEdge { signal: seen_switch(name, sight, path, names)?, on };
    Some(if index { Until::Index(Some(edge)) } else { Until::Edge(edge) })
}

/// A switch that the drive can see.
fn seen_switch(name: &str, sight: &Sight<'_>, path: &Path, names: &mut Names) -> Option<Input> {
    let signal = names.switch(name, path)?;
    if !sight.sees(signal) {
        let what = format!("`{name}` is not wired");
        let advice = "add it under `signals.inputs`";
        names.report(Problem::value(path.clone(), what).advise(advice));
        return None;
    }
    Some(signal)
}
