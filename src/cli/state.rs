//! `--state`: what an earlier run has left, and what to say if that is not for this one.

use super::CliError;
use crate::bench::Saved;
use crate::problem::Problem;
use crate::problem::render::render;
use crate::server::{Store, plain};
use std::path::Path;

/// A state file as it was found. Without one it is that of a first run.
#[derive(Debug, Default)]
pub struct StateArg {
    /// What is in it.
    pub saved: Saved,
    file: String,
    text: String,
}

impl StateArg {
    /// Takes the file at `path` for this run.
    pub fn open(path: &Path) -> Result<(Store, Self), CliError> {
        let file = path.display().to_string();
        let (store, text) = Store::open(path)
            .map_err(|error| CliError::invalid(format!("cannot use {file}: {}", plain(&error))))?;
        let mut state = Self { file, ..Self::default() };
        if let Some(text) = text {
            state.text = text;
            state.saved = Saved::read(&state.text).map_err(|problems| state.refused(&problems))?;
        }
        Ok((store, state))
    }

    /// Makes sure that everything in it has found its drive.
    pub fn finish(mut self) -> Result<(), CliError> {
        let saved = std::mem::take(&mut self.saved);
        saved.finish().map_err(|problems| self.refused(&problems))
    }

    fn refused(&self, problems: &[Problem]) -> CliError {
        let Self { file, text, .. } = self;
        let told = render(problems, file, text);
        let advice =
            format!("{file} was not changed: correct it, move it away, or give another --state");
        CliError::invalid(format!("{told}{advice}"))
    }
}
