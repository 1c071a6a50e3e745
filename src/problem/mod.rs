//! What is wrong with a file: found by path, told at its place.
//!
//! [`parse`] makes a tree of a text, each key and value with its place. [`decode`](decode::decode) reads the raw
//! structs of a format out of it; what can't be read is a problem, and reading goes on without it. Checks speak of a
//! [`Path`] (`line.refuse[2]`) and know nothing of lines and columns; [`settle`] gives each problem its place, in
//! the order of the file. [`render`](render::render) prints them.

pub mod bounds;
pub mod decode;
mod parse;
mod place;
pub mod render;
pub mod suggest;
mod syntax;
pub mod tree;

pub use parse::parse;
pub use place::{Path, Places, Seg};

use std::collections::BTreeSet;
use tree::Node;

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
    /// Where in the text; [`settle`] looks it up where it is not known from the start.
    pub mark: Option<Mark>,
    /// The value at the path could not be read. Whatever a check finds out about it, or below it, is a
    /// consequence and not told.
    pub unread: bool,
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
        Self { path, at: At::Value, what: what.into(), advice: None, mark: None, unread: false }
    }

    /// A problem with the key that ends `path`.
    pub fn key(path: Path, what: impl Into<String>) -> Self {
        Self { at: At::Key, ..Self::value(path, what) }
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

    /// The same problem at a known place.
    #[must_use]
    pub fn marked(mut self, mark: Mark) -> Self {
        self.mark = Some(mark);
        self
    }

    /// The same problem, with a value that could not be read.
    #[must_use]
    pub(crate) fn unread(mut self) -> Self {
        self.unread = true;
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

/// Could the value at `path`, or one that it is part of, not be read?
pub fn is_unread(problems: &[Problem], path: &Path) -> bool {
    problems.iter().any(|it| it.unread && path.starts_with(&it.path))
}

/// Could the value at `path`, or anything below it, not be read?
pub fn has_unread(problems: &[Problem], path: &Path) -> bool {
    problems.iter().any(|it| it.unread && it.path.starts_with(path))
}

/// The `problems` of `file` as they are to be told: without consequences, each at its place or at what is nearest to it,
/// in the order of the file.
pub fn placed(mut problems: Vec<Problem>, file: &Node) -> Vec<Problem> {
    let mut places = Places::new(file);
    settle(&mut problems, |problem| Some(places.find_nearest(&problem.path, problem.at)));
    problems
}

/// Leaves out consequences, gives each problem the place that `find` has for it, and sorts them by that.
pub fn settle(problems: &mut Vec<Problem>, mut find: impl FnMut(&Problem) -> Option<Mark>) {
    let mut unread: BTreeSet<Path> = BTreeSet::new();
    problems.retain(|problem| {
        let mut above = Some(problem.path.clone());
        while let Some(path) = above {
            if unread.contains(&path) {
                return false;
            }
            above = path.parent();
        }
        if problem.unread {
            unread.insert(problem.path.clone());
        }
        true
    });
    for problem in problems.iter_mut() {
        problem.mark = problem.mark.or_else(|| find(problem));
    }
    problems.sort_by_key(|it| (it.mark.is_none(), it.mark));
}
