//! docs/log.md, made from the schema and the samples.

use super::samples;
use super::validate::{Alternative, Key, alternatives};
use crate::expect::{root, same};
use crate::kit::object;
use drivemu::event::{Event, REASONS};
use drivemu::log;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;

const HEAD: &str = "\
<!-- Generated from src/event.rs, src/event and tests/log by `UPDATE_DOCS=1 cargo test`; edit there, not here. -->

# The log

`drivemu run` writes an event log to stdout, as text or with `--format json` as JSON; `--log-file FILE` writes it as JSON to a file as well. Each line
is one event. Both forms are public: the names and keys below do not change without a line in the change log. `drivemu schema log` prints the JSON
Schema.

```text
1.322 unit 1 stopped at 5000
1.322 cell-2 unit 1 stopped at 5000
```

A line of text has the time in seconds of emulated time, with several lines the name of the line, and what happened. It is for people: filter JSON
rather than text. Names of files appear with control characters written out (`\\n`), so an event is always one line.

Every JSON object has these keys, besides those of its event:

| key | type | meaning |
| --- | --- | --- |
| `t` | number | When, in seconds of emulated time since the start of the run. |
| `line` | string | The name of the line. |
| `event` | string | The name of the event. |
| `text` | string | The line of the text log, without its time. |

Positions are in counts of the drive, as its position register shows them; speeds are in revolutions per minute. PDUs, frames and CRCs are bytes in
hex, in the order in which they are on the wire. A row is named by its code in the manual, or by drivemu's name for it where the manual has none. A
key that is not always there is marked *optional*.

A log that is read too slowly loses lines and says so (`log_lost`); it never holds a drive up.
";

/// The parts of the page: a title and the events in it, by the first and the last.
const PARTS: [(&str, &str); 4] = [
    ("Requests", "read"),
    ("The line", "foreign"),
    ("Faults and scenarios", "fault"),
    ("Drives", "power_on"),
];

#[test]
fn the_page_is_up_to_date() {
    let checked = same(&root("docs/log.md"), &page(), "UPDATE_DOCS");
    checked.unwrap_or_else(|what| panic!("{what}"));
}

/// What the schema says of an event, all of its shapes together.
struct About {
    text: String,
    keys: Vec<(String, Key, bool)>,
}

fn page() -> String {
    let mut events: BTreeMap<String, About> = BTreeMap::new();
    for it in alternatives(&log::schema()) {
        let name = it.keys["event"].schema["const"].as_str().expect("a name").to_owned();
        let shapes = events.entry(name);
        let about = shapes.or_insert_with(|| About { text: it.about.clone(), keys: Vec::new() });
        about.add(&it);
    }
    let mut out = HEAD.to_owned();
    let mut parts = PARTS.iter().peekable();
    let samples = samples::all();
    let mut told: Vec<String> = Vec::new();
    for event in &samples {
        let name = object(event)["event"].as_str().expect("a name").to_owned();
        if told.contains(&name) {
            continue;
        }
        if let Some((title, _)) = parts.next_if(|(_, first)| *first == name) {
            write!(out, "\n## {title}\n").expect("a string");
        }
        let of_name: Vec<_> = samples.iter().filter(|it| object(it)["event"] == *name).collect();
        section(&mut out, &name, &events[&name], &of_name);
        told.push(name);
    }
    assert!(parts.next().is_none(), "a part without a first event");
    let lost = &events["log_lost"];
    out.push_str("\n## The log itself\n");
    heading(&mut out, "log_lost", lost);
    let notice = log::LogNotice::lost(3);
    writeln!(out, "\n```text\n{}\n{}\n```", notice.text(), notice.json()).expect("a string");
    reasons(&mut out);
    out
}

impl About {
    fn add(&mut self, shape: &Alternative) {
        let is_in = |name: &String| shape.keys.get(name).is_some_and(|key| key.is_required);
        self.keys.iter_mut().for_each(|(name, _, always)| *always &= is_in(name));
        let first = self.keys.is_empty();
        for name in &shape.order {
            let common = ["t", "line", "event", "text"].contains(&name.as_str());
            let key = &shape.keys[name];
            match self.keys.iter_mut().find(|(known, ..)| known == name) {
                _ if common => {}
                Some((_, known, _)) => known.also(key),
                None => self.keys.push((name.clone(), key.listed(), first && key.is_required)),
            }
        }
    }
}

fn section(out: &mut String, name: &str, about: &About, samples: &[&Event]) {
    heading(out, name, about);
    writeln!(out, "\n```text").expect("a string");
    for event in samples {
        writeln!(out, "{event}").expect("a string");
    }
    writeln!(out, "{}\n```", log::json(samples[0], "line")).expect("a string");
}

fn heading(out: &mut String, name: &str, about: &About) {
    write!(out, "\n### `{name}`\n\n{}\n", about.text).expect("a string");
    if about.keys.is_empty() {
        return;
    }
    write!(out, "\n| key | type | meaning |\n| --- | --- | --- |\n").expect("a string");
    for (key, it, always) in &about.keys {
        let (kind, text) = (kind(&it.schema), it.about().replace('\n', " "));
        let optional = if *always { "" } else { "*optional* " };
        writeln!(out, "| `{key}` | {optional}{kind} | {text} |").expect("a string");
    }
}

/// The type of a key, as people say it.
fn kind(schema: &Value) -> String {
    let words: Vec<_> = schema["enum"].as_array().into_iter().flatten().collect();
    let named = words.iter().filter_map(|it| it.as_str()).map(|it| format!("`{it}`"));
    match (&schema["type"], words.len()) {
        (_, 1..=16) => named.collect::<Vec<_>>().join(", "),
        (Value::String(kind), _) => kind.clone(),
        (Value::Array(kinds), _) => {
            let kinds: Vec<_> = kinds.iter().filter_map(Value::as_str).collect();
            kinds.join(" or ")
        }
        _ => "one of the kinds".into(),
    }
}

fn reasons(out: &mut String) {
    let head = "\n## Reasons\n\nWhy an order has no effect, or a chain ends: `reason` and, with what it is about for `...`, `why`.\n\n\
                | reason | why |\n| --- | --- |\n";
    out.push_str(head);
    for reason in REASONS {
        writeln!(out, "| `{}` | {} |", reason.name, reason.text.replace("{}", "..."))
            .expect("a string");
    }
}
