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

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Option<Duration> = Some(Duration::from_secs(1));

    fn ms(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    #[test]
    fn expires_once_and_says_how_long_it_held() {
        let mut watchdog = Watchdog::default();
        assert_eq!((watchdog.deadline(), watchdog.expired(ms(5000))), (None, None));
        watchdog.refresh(ms(0), SECOND);
        watchdog.refresh(ms(500), SECOND);
        assert_eq!(watchdog.deadline(), Some(ms(1500)));
        assert_eq!(watchdog.expired(ms(1499)), None);
        assert_eq!(watchdog.expired(ms(1600)), Some(Duration::from_millis(1100)));
        assert_eq!(watchdog.expired(ms(1600)), None);
    }

    #[test]
    fn another_time_counts_from_the_last_refresh() {
        let mut watchdog = Watchdog::default();
        watchdog.refresh(ms(100), SECOND);
        watchdog.retime(None);
        assert_eq!(watchdog.deadline(), None, "it holds for ever");
        watchdog.retime(Some(Duration::from_millis(50)));
        assert_eq!(watchdog.deadline(), Some(ms(150)));
        watchdog.stop();
        assert_eq!(watchdog.expired(ms(9999)), None);
    }
}
