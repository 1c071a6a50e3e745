//! The steps of a homing method: words resolved, and whether they end at an origin.

use super::super::compile::Wirer;
use crate::model::raw::{RawMethod, RawStep, RawWay};
use crate::problem::{Path, Problem};
use crate::words::{Edge, Input, MOST_STEPS, Method, Step, Steps, Then, Until, Word};

/// Signals that a step can wait for.
const SWITCHES: [Input; 3] = [Input::HomeSwitch, Input::LimitPos, Input::LimitNeg];

impl Wirer<'_> {
    pub(super) fn method(&mut self, raw: &RawMethod, path: &Path) -> Method {
        let by = raw.by.as_ref().and_then(|name| self.switch(name, &path.key("by")));
        for (key, steps) in [("on", &raw.on), ("at_limit", &raw.at_limit)] {
            let why = match key {
                "on" if by.is_none() => "there is no `by`",
                "at_limit" if raw.steps.is_empty() => "there is no first step",
                _ => continue,
            };
            if !steps.is_empty() {
                let what = format!("`{key}` changes nothing: {why}");
                self.problems.push(Problem::key(path.key(key), what).advise("leave it out"));
            }
        }
        if by.is_some() && raw.on.is_empty() {
            let what = "`by` changes nothing without `on`";
            self.problems.push(Problem::key(path.key("by"), what).advise("leave it out"));
        }
        Method {
            by,
            steps: self.steps(&raw.steps, &path.key("steps")),
            at_limit: self.steps(&raw.at_limit, &path.key("at_limit")),
            on: self.steps(&raw.on, &path.key("on")),
            index: raw.index,
        }
    }

    fn steps(&mut self, raw: &[RawStep], path: &Path) -> Steps {
        if raw.len() > MOST_STEPS {
            let what = format!("{} steps, and there is room for {MOST_STEPS}", raw.len());
            self.problems.push(Problem::value(path.clone(), what));
        }
        let step = |(i, it): (usize, &RawStep)| self.step(it, &path.index(i));
        let steps: Vec<_> = raw.iter().enumerate().filter_map(step).collect();
        let origin = |step: &Step| step.then == Then::Origin;
        let last = steps.len().saturating_sub(1);
        if steps.len() == raw.len() {
            for (i, step) in steps.iter().enumerate().filter(|(i, it)| origin(it) != (*i == last)) {
                let what = match origin(step) {
                    true => "the origin ends a homing, and a step follows",
                    false => "the last step finds no origin",
                };
                self.problems.push(Problem::value(path.index(i).key("then"), what));
            }
        }
        Steps::new(&steps)
    }

    fn step(&mut self, raw: &RawStep, path: &Path) -> Option<Step> {
        let pace = self.word(&raw.at, "pace", &path.key("at"));
        let until = self.until(&raw.to, &path.key("to"));
        let then = self.word(&raw.then, "end of a step", &path.key("then"));
        Some(Step { forward: raw.go == RawWay::Pos, pace: pace?, until: until?, then: then? })
    }

    fn until(&mut self, text: &str, path: &Path) -> Option<Until> {
        match text {
            "collision" => return Some(Until::Collision),
            "index" => return Some(Until::Index(None)),
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
                let what = format!("`{text}` is nothing to wait for");
                let advice =
                    "a switch with `on` or `off`, `index`, `index after SWITCH on`, or `collision`";
                self.problems.push(Problem::value(path.clone(), what).advise(advice));
                return None;
            }
        };
        let edge = Edge { signal: self.switch(name, path)?, on };
        Some(if index { Until::Index(Some(edge)) } else { Until::Edge(edge) })
    }

    /// One of the switches, and wired.
    fn switch(&mut self, name: &str, path: &Path) -> Option<Input> {
        let signal = self.word::<Input>(name, "switch", path)?;
        let names = || SWITCHES.map(Word::name).join(", ");
        let what = if !SWITCHES.contains(&signal) {
            format!("`{name}` is no switch; there are {}", names())
        } else if !self.inputs_wired().contains(&signal) {
            format!("`{name}` is wired to nothing")
        } else {
            return Some(signal);
        };
        self.problems.push(Problem::value(path.clone(), what));
        None
    }
}
