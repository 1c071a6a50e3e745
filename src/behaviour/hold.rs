//! What a master must refresh: it holds for a while, then it is over. An input word that falls back, or the
//! patience of a drive that expects to be spoken to.
//!
//! This is how drives notice that their master fell silent.

use crate::time::{Duration, Instant};

/// One watchdog.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Hold {
    until: Option<(Instant, Duration)>,
}

impl Hold {
    /// The master did its part: it holds for `time` from `now` on, or for ever.
    pub fn refresh(&mut self, now: Instant, time: Option<Duration>) {
        self.until = time.map(|time| (now + time, time));
    }

    /// There is nothing to hold.
    pub fn stop(&mut self) {
        self.until = None;
    }

    /// When it is over.
    pub fn deadline(&self) -> Option<Instant> {
        self.until.map(|(at, _)| at)
    }

    /// If its time is over: how long it held. It stops then.
    pub fn expired(&mut self, now: Instant) -> Option<Duration> {
        let (_, held) = self.until.filter(|(at, _)| *at <= now)?;
        self.until = None;
        Some(held)
    }
}
