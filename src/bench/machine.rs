//! The machine on an axis, as a bench says it: whether its switches, stops and marks make sense, and whether the
//! drive of `wiring` can tell that they are there.

use super::raw::{RawIndex, RawMachine};
use crate::model::Wiring;
use crate::motion::{Index, Machine, Zone};
use crate::vocabulary::{HomingStep, Input, Method, Named, Until};

/// What is wrong with a machine: at which key, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MachineProblem {
    /// The key.
    pub key: &'static str,
    /// Why.
    pub what: String,
}

/// The machine that `raw` describes, on the axis of a drive that is wired so.
///
/// # Errors
/// Everything about it that can't be, or that changes nothing.
pub fn machine(raw: &RawMachine, wiring: &Wiring) -> Result<Machine, Vec<MachineProblem>> {
    let pair = |it: Option<[i32; 2]>| it.map(|it| it.map(i64::from));
    let index = |it: &RawIndex| Index { every: it.every.into(), offset: it.offset.into() };
    let machine = Machine {
        home: pair(raw.home).map(|[from, to]| Zone { from, to }),
        negative_limit: raw.negative_limit.map(i64::from),
        positive_limit: raw.positive_limit.map(i64::from),
        hard_stop: pair(raw.hard_stop),
        index: raw.index.as_ref().map(index),
    };
    let mut problems = impossible(&machine, raw.start.into());
    if problems.is_empty() {
        problems = beyond_the_stops(&machine);
        problems.extend(unseen(&machine, raw.start, wiring));
    }
    if problems.is_empty() { Ok(machine) } else { Err(problems) }
}

fn impossible(machine: &Machine, start: i64) -> Vec<MachineProblem> {
    let mut problems = Vec::new();
    let mut refuse = |key, what| problems.push(MachineProblem { key, what });
    if let Some(Zone { from, to }) = machine.home.filter(|it| it.from >= it.to) {
        let what =
            format!("the range from {from} to before {to} is empty: the switch is never active");
        refuse("home", what);
    }
    if let (Some(negative), Some(positive)) = (machine.negative_limit, machine.positive_limit)
        && negative > positive
    {
        refuse("positive_limit", format!("must not be below the negative limit, {negative}"));
    }
    match machine.hard_stop {
        Some([low, high]) if low >= high => {
            refuse(
                "hard_stop",
                format!("the first hard stop must be below the second: {low} is not below {high}"),
            );
        }
        Some([low, high]) if start < low || start > high => {
            let what =
                format!("the axis starts at {start}, outside its hard stops, {low} and {high}");
            refuse("hard_stop", what);
        }
        _ => {}
    }
    if machine.index.is_some_and(|it| it.every < 1) {
        refuse("index", "`every` must be at least 1 count".into());
    }
    problems
}

/// Switches that the axis never gets to.
fn beyond_the_stops(machine: &Machine) -> Vec<MachineProblem> {
    let Some([low, high]) = machine.hard_stop else { return Vec::new() };
    let beyond = [
        ("home", machine.home.is_some_and(|it| it.to <= low || it.from > high)),
        ("negative_limit", machine.negative_limit.is_some_and(|it| it <= low)),
        ("positive_limit", machine.positive_limit.is_some_and(|it| it > high)),
    ];
    let what = format!("out of reach, beyond the hard stops, {low} and {high}");
    let problem = |(key, _)| MachineProblem { key, what: what.clone() };
    beyond.into_iter().filter(|(_, is)| *is).map(problem).collect()
}

/// What this drive can't see.
fn unseen(machine: &Machine, start: i32, wiring: &Wiring) -> Vec<MachineProblem> {
    let mut problems = Vec::new();
    let mut refuse = |key, what| problems.push(MachineProblem { key, what });
    let switches = [
        ("home", Input::HomeSwitch, machine.home.is_some()),
        ("negative_limit", Input::LimitNeg, machine.negative_limit.is_some()),
        ("positive_limit", Input::LimitPos, machine.positive_limit.is_some()),
    ];
    for (key, signal, _) in switches.into_iter().filter(|(.., is)| *is) {
        if !is_wired(wiring, signal) {
            let what = format!("no terminal of this drive can be assigned `{}`", signal.name());
            refuse(key, what);
        }
    }
    let moves = !wiring.axis.settings.is_empty();
    if machine.hard_stop.is_some() && !moves {
        refuse("hard_stop", "this drive does not move an axis".into());
    }
    let marked = looks_for_index(wiring);
    if machine.index.is_some() && !marked {
        refuse("index", "no homing method of this drive uses an index pulse".into());
    }
    let alone = *machine == Machine::default();
    if start != 0 && alone && !marked {
        refuse("start", "has no effect without a switch, a hard stop or an index pulse".into());
    }
    problems
}

fn is_wired(wiring: &Wiring, signal: Input) -> bool {
    let mut functions = wiring.input_terminals.iter().flat_map(|it| &it.codes);
    wiring.machine_inputs.contains(&signal) || functions.any(|(_, it)| *it == signal)
}

fn looks_for_index(wiring: &Wiring) -> bool {
    let waits = |step: HomingStep| matches!(step.until, Until::Index(_) | Until::SameIndex);
    let looks = |it: &Method| it.index || it.all_steps().any(waits);
    wiring.homing.iter().flat_map(|it| it.methods.values()).any(looks)
}
