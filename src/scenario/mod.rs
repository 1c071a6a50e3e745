//! A scenario: what happens to lines and their drives, and when, and what should come of it.
//!
//! Built from a YAML file ([`parse`](fn@parse)) for the lines of a bench; a [`Director`] carries out the steps of one
//! line. Deliberately without threads across lines: the steps of a line know nothing of those of another.

mod compile;
mod director;
mod junit;
mod order;
pub mod raw;
mod step;

pub use compile::{check, parse};
pub use director::{Director, Verdict};
pub use junit::junit;
pub use order::{NoOrder, Order};
pub use step::{Condition, ScenarioStep, Subject, Test, Trigger};

use crate::time::Instant;

/// What happens to each line of a bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// One a line, in the order of the bench.
    pub parts: Vec<Part>,
}

/// What happens to one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The steps, in order.
    pub steps: Vec<ScenarioStep>,
    /// All is to be done by then.
    pub limit: Option<Instant>,
}

impl Scenario {
    /// Is it a test? Then the run ends with its last step, and how it ends depends on what became of them.
    pub fn is_test(&self) -> bool {
        let judges = |part: &Part| {
            part.limit.is_some() || part.steps.iter().any(|step| !step.expect.is_empty())
        };
        self.parts.iter().any(judges)
    }

    /// A director for each line.
    pub fn directors(self) -> impl Iterator<Item = Director> {
        self.parts.into_iter().map(|part| Director::new(part.steps, part.limit))
    }
}
