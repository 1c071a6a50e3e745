//! The steps of a scenario for one line, shared by the task that serves the line and whoever waits for the last step.

use super::serve::lock;
use crate::bus::Bus;
use crate::scenario::{Director, Verdict};
use crate::time::Instant;
use std::sync::{Arc, Mutex};
use tokio::sync::Notify;

/// A director and who waits for it.
#[derive(Debug, Clone)]
pub struct ScenarioRun {
    director: Arc<Mutex<Director>>,
    over: Arc<Notify>,
}

impl ScenarioRun {
    /// For one line; `over` is told of when its steps are.
    pub fn new(director: Director, over: Arc<Notify>) -> Self {
        Self { director: Arc::new(Mutex::new(director)), over }
    }

    /// As [`Director::poll_at`].
    pub fn poll_at(&self) -> Option<Instant> {
        lock(&self.director).poll_at()
    }

    /// As [`Director::advance_to`].
    pub fn advance_to(&self, bus: &mut Bus, now: Instant) {
        self.with(|director| director.advance_to(bus, now));
    }

    /// As [`Director::poll`].
    pub fn poll(&self, bus: &mut Bus) {
        self.with(|director| director.poll(bus));
    }

    /// Is nothing left to do?
    pub fn is_over(&self) -> bool {
        lock(&self.director).is_over()
    }

    /// What became of all steps, now that the run is over, and why it is.
    pub fn verdicts(&self, now: Instant, why: &str) -> Vec<Verdict> {
        let mut director = lock(&self.director);
        director.end(now, Some(why));
        director.verdicts().to_vec()
    }

    fn with(&self, act: impl FnOnce(&mut Director)) {
        let mut director = lock(&self.director);
        act(&mut director);
        if director.is_over() {
            self.over.notify_one();
        }
    }
}
