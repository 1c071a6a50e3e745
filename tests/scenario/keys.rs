//! No inert key: each key of a scenario, taken from the schema, changes what happens.

use super::{READ, RUN, failures};
use drivemu::bench::BuiltinLibrary;
use drivemu::problem::render::render;
use drivemu::scenario::raw::schema;
use drivemu::testkit::Rig;
use serde_json::Value;
use std::collections::BTreeSet;
use std::time::Duration;

const BENCH: &str = "lines: [{name: a, pty: auto, drives: [{model: yako-closed-loop, unit: 1}, {model: yako-closed-loop, unit: 2}]}]";

/// What happens, or what is wrong with the scenario.
fn run(text: &str) -> String {
    let rig = Rig::bench(BENCH, &BuiltinLibrary).expect("a good bench").with_scenario(text);
    let mut rig = match rig {
        Ok(rig) => rig,
        Err(problems) => return render(&problems, "scenario", text),
    };
    for _ in 0..10 {
        [READ, RUN, "02 06 0027 0002"].into_iter().for_each(|request| {
            rig.ask(request);
        });
        rig.advance(Duration::from_millis(500));
    }
    let verdicts = format!("{:?}", failures(rig.finish()));
    rig.log() + &verdicts
}

#[test]
fn each_key_changes_what_happens() {
    for key in keys() {
        let base = "name: s, do: [power_cycle]";
        let (without, with) = match key.as_str() {
            "steps" => (base, "name: s, do: [power off]"),
            "limit" => ("name: s, at: 4s, do: [power off]", "name: s, at: 4s, do: [power off]"),
            "name" => (base, "name: t, do: [power_cycle]"),
            "line" => (base, "name: s, line: b, do: [power_cycle]"),
            "unit" => (base, "name: s, unit: 2, do: [power_cycle]"),
            "at" => (base, "name: s, at: 2s, do: [power_cycle]"),
            "wait" => (base, "name: s, wait: 2s, do: [power_cycle]"),
            "after" | "n" => (base, "name: s, after: {n: 3}, do: [power_cycle]"),
            "kind" => (
                "name: s, after: {n: 3}, do: [power_cycle]",
                "name: s, after: {n: 3, kind: read}, do: [power_cycle]",
            ),
            "when" | "signal" | "is" => {
                (base, "name: s, when: {signal: moving, is: on}, do: [power_cycle]")
            }
            "quantity" | "above" => {
                (base, "name: s, when: {quantity: position.actual, above: 500}, do: [power_cycle]")
            }
            "register" | "below" => (
                "name: s, when: {quantity: position.actual, above: 500}, do: [power_cycle]",
                "name: s, when: {register: speed, above: 500, below: 999}, do: [power_cycle]",
            ),
            "repeat" | "every" | "times" => {
                (base, "name: s, repeat: {every: 1s, times: 3}, do: [power_cycle]")
            }
            "do" => (base, "name: s, do: [block on]"),
            "expect" => (base, "name: s, do: [power_cycle], expect: [{signal: alarm, is: on}]"),
            "within" => (
                "name: s, expect: [{signal: moving, is: on}]",
                "name: s, expect: [{signal: moving, is: on}], within: 2s",
            ),
            _ => panic!("nobody tests `{key}`"),
        };
        let limit = if key == "limit" { "limit: 2s\n" } else { "" };
        let without = run(&format!("steps: [{{{without}}}]"));
        let with = run(&format!("{limit}steps: [{{{with}}}]"));
        assert!(without != with, "`{key}` is inert:\n{with}");
    }
}

fn keys() -> BTreeSet<String> {
    let (mut found, schema) = (BTreeSet::new(), schema());
    let mut rest = vec![&schema];
    while let Some(value) = rest.pop() {
        if let Some(Value::Object(properties)) = value.get("properties") {
            found.extend(properties.keys().cloned());
        }
        match value {
            Value::Object(map) => rest.extend(map.values()),
            Value::Array(items) => rest.extend(items),
            _ => {}
        }
    }
    found
}
