//! What the targets share.

#![allow(dead_code)] // Each target is a program of its own and takes what it needs.

use drivemu::bench::Library;
use drivemu::event::Event;
use drivemu::model::builtin::Builtin;
use drivemu::model::{Choices, Model, load};
use drivemu::problem::Problem;
use drivemu::problem::render::render;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Puts an event into words, as every run does.
pub fn tell(event: &Event) {
    let _ = event.to_string();
}

/// Draws all problems as a user sees them; there is one at least.
pub fn render_all(problems: &[Problem], text: &str) {
    assert!(!render(problems, "fuzz", text).is_empty(), "refused without a word");
}

/// The embedded models, each compiled once for each choice of options.
pub struct Compiled;

impl Library for Compiled {
    /// By file name only: to look a product up takes compiling them all, far longer than a bench.
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        let known = Builtin::all().find(|it| it.stem() == name);
        let known = known.ok_or_else(|| format!("no model `{name}`"))?;
        Ok((known.file.into(), known.text.into()))
    }

    fn model(&self, name: &str, choices: &Choices) -> Result<Arc<Model>, String> {
        type Known = BTreeMap<(String, Choices), Result<Arc<Model>, String>>;
        static KNOWN: Mutex<Known> = Mutex::new(Known::new());
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (name.to_owned(), choices.clone());
        let compile = || {
            let (_, text) = self.fetch(name)?;
            let model = load(&text, choices).map_err(|problems| problems[0].to_string())?;
            Ok(Arc::new(model))
        };
        known.entry(key).or_insert_with(compile).clone()
    }
}
