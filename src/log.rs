//! The event log: an event as a line of text, or as a JSON object with a schema.
//!
//! Both come from the event alone ([`crate::event`] says what), on whichever thread. docs/log.md is made from the
//! schema.

use crate::event::{Event, EventKind};
use crate::text::one_line;
use serde::Serialize;

/// An event as JSON.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "cli", schemars(extend("unevaluatedProperties" = false)))]
pub struct Record<'a> {
    /// When, in seconds of emulated time.
    t: f64,
    /// The name of the line.
    line: &'a str,
    #[serde(flatten)]
    kind: &'a EventKind,
    /// The line of the text log, without its time.
    text: String,
}

impl<'a> Record<'a> {
    /// `event` of the line called `line`.
    pub fn new(event: &'a Event, line: &'a str) -> Self {
        let text = one_line(&event.kind.to_string()).into_owned();
        Self { t: event.at.as_secs_f64(), line, kind: &event.kind, text }
    }
}

/// `event` as one line of text; with the name of its `line` where there are several.
pub fn text(event: &Event, line: Option<&str>) -> String {
    match line {
        None => event.to_string(),
        Some(line) => {
            format!("{} {} {}", event.at, one_line(line), one_line(&event.kind.to_string()))
        }
    }
}

/// `event` of the line called `line` as one line of JSON.
#[cfg(feature = "cli")]
pub fn json(event: &Event, line: &str) -> String {
    serde_json::to_string(&Record::new(event, line)).expect("an event has only keys that are text")
}

/// What the log says of itself.
#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "cli", schemars(extend("unevaluatedProperties" = false)))]
pub enum LogNotice {
    /// The reader of the log was too slow, and lines were lost before this one. It has neither time nor line.
    LogLost {
        /// How many lines.
        lines: u64,
        /// The line of the text log.
        text: String,
    },
}

impl LogNotice {
    /// So many `lines` were lost.
    pub fn lost(lines: u64) -> Self {
        let text = format!("{lines} lines of the log were lost: its reader is too slow");
        Self::LogLost { lines, text }
    }

    /// As one line of text.
    pub fn text(&self) -> &str {
        let Self::LogLost { text, .. } = self;
        text
    }

    /// As one line of JSON.
    #[cfg(feature = "cli")]
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("its keys are text")
    }
}

/// The JSON Schema of the objects of the log.
#[cfg(feature = "cli")]
pub fn schema() -> serde_json::Value {
    let settings = schemars::generate::SchemaSettings::draft2020_12().for_serialize();
    let mut all = settings.with(|it| it.inline_subschemas = true).into_generator();
    serde_json::json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A line of the log",
        "anyOf": [all.subschema_for::<Record<'_>>(), all.subschema_for::<LogNotice>()],
    })
}
