//! A bench: lines, the drives on each line, what each drive is set to.
//!
//! Built from a YAML file ([`parse`](fn@parse)) or from command-line flags and tests ([`DeviceSpec`]). Pure: it
//! opens nothing. Model files are fetched through a [`Library`], which is the server's to provide.

mod device;
mod line;
mod line_keys;
mod machine;
mod parse;
pub mod raw;
mod state;
mod wire_spec;

pub use device::{Device, DeviceSpec, OverrideKey, SpecProblem};
pub use line::{BenchLine, LineBuilder, Mismatch, PortSpec};
pub use machine::{MachineProblem, machine};
pub use parse::{kind_of, parse, parse_saved};
pub use state::{Saved, StateFile};
pub use wire_spec::{PATIENT_GAP, WireSpec, match_line};

use crate::model::builtin::Builtin;
use crate::model::{Choices, Model, load};
use std::sync::Arc;

/// Where model files come from.
pub trait Library {
    /// File name for messages and text of the model called `name`: a built-in, a product, or a path.
    ///
    /// # Errors
    /// One sentence that says why there is none and what to do.
    fn fetch(&self, name: &str) -> Result<(String, String), String>;

    /// The model called `name` with `choices`, compiled. A library that is asked for the same one often
    /// can keep it.
    ///
    /// # Errors
    /// As [`fetch`](Self::fetch), or the first problem of the file.
    fn model(&self, name: &str, choices: &Choices) -> Result<Arc<Model>, String> {
        let (file, text) = self.fetch(name)?;
        let model = load(&text, choices);
        model.map(Arc::new).map_err(|problems| format!("{file}: {}", problems[0]))
    }
}

/// The embedded models and no files.
#[derive(Debug, Clone, Copy, Default)]
pub struct BuiltinLibrary;

impl Library for BuiltinLibrary {
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        match Builtin::find(name) {
            Some(builtin) => Ok((builtin.file.into(), builtin.text.into())),
            None => Err(no_model(name)),
        }
    }
}

/// What to say about a model that does not exist.
pub fn no_model(name: &str) -> String {
    let names: Vec<_> = Builtin::all().map(|it| it.stem()).collect();
    match crate::problem::suggest::did_you_mean(name, names.iter().copied()) {
        Some(advice) => format!("unknown model or product `{name}`; {advice}"),
        None => format!("unknown model or product `{name}`; known: {}", names.join(", ")),
    }
}

/// Lines and their drives.
#[derive(Debug)]
pub struct Bench {
    /// The seed, if the bench fixes one.
    pub seed: Option<u64>,
    /// The lines, in order.
    pub lines: Vec<BenchLine>,
}
