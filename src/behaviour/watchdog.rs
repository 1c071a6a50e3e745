//! What a master must refresh: it holds for a while, then it is over. An input word that falls back, or the
//! patience of a drive that expects to be spoken to.
//!
//! This is how drives notice that their master fell silent.

use crate::time::{Duration, Instant};

/// One watchdog.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Watchdog {
    /// When the master did its part last, while there is something to hold.
    since: Option<Instant>,
    /// How long it holds; `None` for ever.
    time: Option<Duration>,
}

impl Watchdog {
    /// The master did its part: it holds for `time` from `now` on, or for ever.
    pub fn refresh(&mut self, now: Instant, time: Option<Duration>) {
        (self.since, self.time) = (Some(now), time);
    }

    /// From now on `time` counts from when the master did its part last.
    pub fn retime(&mut self, time: Option<Duration>) {
        self.time = time;
    }

    /// There is nothing to hold.
    pub fn stop(&mut self) {
        self.since = None;
    }

    /// When it is over.
    pub fn deadline(&self) -> Option<Instant> {
        Some(self.since? + self.time?)
    }

    /// If its time is over: how long it held. It stops then.
    pub fn expired(&mut self, now: Instant) -> Option<Duration> {
        self.deadline().filter(|at| *at <= now)?;
        self.since.take().map(|since| now.since(since))
    }
}
