//! What is wrong with a file: found by path, printed by place.
//!
//! A check speaks of a [`Path`] (`line.refuse[2]`), never of a line number. Only [`render`] turns a
//! path into line, column and caret, by walking the same text once more with a parser that keeps
//! marks ([`place`]). So checks work the same on a parsed tree, on a fragment laid over it and in tests.

pub mod bounds;
mod path;
pub mod place;
pub mod render;
pub mod section;
pub mod suggest;

pub use path::{Path, Seg};

/// One thing that is wrong with a file, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Where in the tree.
    pub path: Path,
    /// Does the caret stand under the key or under the value at that path?
    pub at: At,
    /// What is wrong, as one sentence without a full stop.
    pub what: String,
    /// What to do about it, if there is something to say (`did you mean C06.04 (Jog speed)?`).
    pub advice: Option<String>,
    /// Where in the text, when the path can't say (a syntax error, the second of two equal keys).
    pub mark: Option<Mark>,
}

/// What the caret of a [`Problem`] stands under.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum At {
    /// The map key that ends the path.
    Key,
    /// The value at the path.
    Value,
}

/// A place in a text. Lines and columns count from 1; a column counts characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Mark {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Length in characters, at least 1; a value over several lines is marked up to its line's end.
    pub length: usize,
}

impl Problem {
    /// A problem with the value at `path`.
    pub fn value(path: Path, what: impl Into<String>) -> Self {
        Self { path, at: At::Value, what: what.into(), advice: None, mark: None }
    }

    /// A problem with the key that ends `path`.
    pub fn key(path: Path, what: impl Into<String>) -> Self {
        Self { path, at: At::Key, what: what.into(), advice: None, mark: None }
    }

    /// The same problem with advice.
    #[must_use]
    pub fn advise(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(advice.into());
        self
    }

    /// The same problem with advice, if there is any.
    #[must_use]
    pub fn advise_if(mut self, advice: Option<String>) -> Self {
        self.advice = advice.or(self.advice);
        self
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.path.is_root() {
            true => write!(f, "{}", self.what)?,
            false => write!(f, "{}: {}", self.path, self.what)?,
        }
        match &self.advice {
            Some(advice) => write!(f, " ({advice})"),
            None => Ok(()),
        }
    }
}
