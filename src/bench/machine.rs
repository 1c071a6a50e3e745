//! The machine on an axis, as a bench says it: whether its switches, stops and marks make sense.

use super::raw::RawMachine;
use crate::motion::{Index, Machine, Zone};

/// What is wrong with a machine: at which key, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MachineProblem {
    /// The key.
    pub key: &'static str,
    /// Why.
    pub what: String,
}

/// The machine that `raw` describes.
///
/// # Errors
/// Everything about it that can't be.
pub fn machine(raw: &RawMachine) -> Result<Machine, Vec<MachineProblem>> {
    let mut problems = Vec::new();
    let mut refuse = |key, what| problems.push(MachineProblem { key, what });
    let counts = |it: Option<i32>| it.map(i64::from);
    let pair = |it: Option<[i32; 2]>| it.map(|it| it.map(i64::from));
    let home = pair(raw.home);
    if let Some([from, to]) = home.filter(|[from, to]| from >= to) {
        refuse(
            "home",
            format!("the home switch would be active from {from} to before {to}, which is nowhere"),
        );
    }
    let limits = (counts(raw.negative_limit), counts(raw.positive_limit));
    if let (Some(negative), Some(positive)) = limits
        && negative > positive
    {
        refuse("positive_limit", format!("it lies below the negative limit, {negative}"));
    }
    let start = i64::from(raw.start);
    match pair(raw.hard_stop) {
        Some([low, high]) if low >= high => {
            refuse("hard_stop", format!("there is no way from {low} to {high}"));
        }
        Some([low, high]) if start < low || start > high => {
            let what = format!("the axis stands beyond its hard stops, {low} and {high}");
            refuse("start", what);
        }
        _ => {}
    }
    let index =
        raw.index.as_ref().map(|it| Index { every: it.every.into(), offset: it.offset.into() });
    if index.is_some_and(|it| it.every < 1) {
        refuse("index", "there is at least one count from one index pulse to the next".into());
    }
    match problems.is_empty() {
        true => Ok(Machine {
            home: home.map(|[from, to]| Zone { from, to }),
            negative_limit: limits.0,
            positive_limit: limits.1,
            hard_stop: pair(raw.hard_stop),
            index,
        }),
        false => Err(problems),
    }
}
