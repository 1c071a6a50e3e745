//! The log is public: every event is one of its schema, and docs/log.md, which is made from that, names it.

mod page;
mod samples;
mod validate;

use crate::kit::{Conversation, object};
use drivemu::log;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use validate::{alternatives, validate};

/// The events that the schema knows, by name.
fn known() -> BTreeSet<String> {
    let all = alternatives(&log::schema());
    let name =
        |it: &validate::Alternative| it.keys["event"].schema["const"].as_str().map(str::to_owned);
    all.iter().map(|it| name(it).expect("an event has a name")).collect()
}

fn must_be_valid(schema: &Value, event: &Value) {
    validate(schema, event).unwrap_or_else(|why| panic!("{why}\n{event:#}"));
}

/// A new event can't be forgotten: the schema has each variant, and each one of the schema must be among the samples.
#[test]
fn each_event_is_one_of_the_schema() {
    let schema = log::schema();
    let mut seen = BTreeSet::new();
    for event in samples::all() {
        let object = object(&event);
        must_be_valid(&schema, &object);
        seen.insert(object["event"].as_str().expect("a name").to_owned());
    }
    let lost: Value = serde_json::from_str(&log::LogNotice::lost(3).json()).expect("an object");
    must_be_valid(&schema, &lost);
    seen.insert("log_lost".to_owned());
    assert_eq!(seen, known());
}

/// What drives really say, in all conversations and frames.
#[test]
fn conversations_log_nothing_else() {
    let schema = log::schema();
    let mut seen = BTreeSet::new();
    for folder in ["tests/transcripts", "tests/frames"] {
        for rig in Conversation::all(folder).iter().flat_map(Conversation::rigs) {
            for event in rig.expect("it goes as written").events() {
                let object = object(event);
                must_be_valid(&schema, &object);
                seen.insert(object["event"].as_str().expect("a name").to_owned());
            }
        }
    }
    let unseen: Vec<_> = known().difference(&seen).cloned().collect();
    assert!(unseen.len() < 12, "hardly anything happens: {unseen:?} are not there");
}

/// A test that holds everything holds nothing.
#[test]
fn what_is_wrong_is_not_valid() {
    let schema = log::schema();
    let good = json!({"t": 1.5, "line": "a", "event": "stopped", "unit": 1, "at": 5, "text": "x"});
    must_be_valid(&schema, &good);
    let with = |key: &str, value: Value| {
        let mut bad = good.clone();
        bad[key] = value;
        bad
    };
    let mut without = good.clone();
    without.as_object_mut().expect("an object").remove("at");
    for bad in [
        without,
        with("at", json!("5")),
        with("at", json!(5.5)),
        with("unit", json!(256)),
        with("event", json!("stands")),
        with("to", json!(5)),
        with("new", json!(null)),
        json!({"event": "log_lost", "lines": 1}),
    ] {
        assert!(validate(&schema, &bad).is_err(), "{bad}");
    }
}

/// Each key says what it is, with its unit.
#[test]
fn each_key_is_explained() {
    for it in alternatives(&log::schema()) {
        let unexplained: Vec<_> = it
            .keys
            .iter()
            .filter(|(name, key)| *name != "event" && key.about().is_empty())
            .collect();
        assert!(unexplained.is_empty() && !it.about.is_empty(), "{:?}: {unexplained:?}", it.about);
    }
}
