//! What the targets share.

#![allow(dead_code)] // Each target is a program of its own and takes what it needs.

use drivemu::bench::{BuiltinLibrary, Library};
use drivemu::bus::Bus;
use drivemu::event::Event;
use drivemu::model::{Choices, Model};
use drivemu::problem::Problem;
use drivemu::problem::render::render;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Puts an event into words, as every run does.
pub fn tell(event: &Event, bus: &Bus) {
    drivemu::log::text::line(event, bus);
}

/// Draws all problems as a user sees them; there is one at least.
pub fn render_all(problems: &[Problem], text: &str) {
    assert!(!render(problems, "fuzz", text).is_empty(), "refused without a word");
}

/// The embedded models, each compiled once for each choice of options.
pub struct Compiled;

impl Library for Compiled {
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        BuiltinLibrary.fetch(name)
    }

    fn model(&self, name: &str, choices: &Choices) -> Result<Arc<Model>, String> {
        type Known = BTreeMap<(String, Choices), Result<Arc<Model>, String>>;
        static KNOWN: Mutex<Known> = Mutex::new(Known::new());
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (name.to_owned(), choices.clone());
        known.entry(key).or_insert_with(|| BuiltinLibrary.model(name, choices)).clone()
    }
}
