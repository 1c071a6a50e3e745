//! The wall clock, at a rate: the only file that asks what time it is.

use crate::time::{Duration, Instant};
use std::pin::Pin;
use std::task::{Context, Poll};

/// Maps the wall to the emulated world.
///
/// It counts on tokio's clock, so that under `tokio::time::pause` the emulated world is paused too.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: tokio::time::Instant,
    /// The emulated time then.
    from: Instant,
    rate: f64,
}

impl Clock {
    /// Starts now, with `rate` emulated seconds for each second of the wall.
    pub fn start(rate: f64) -> Self {
        Self::start_at(Instant::ZERO, rate)
    }

    /// The same, for an emulated world in which it is `from` already.
    pub fn start_at(from: Instant, rate: f64) -> Self {
        Self { start: wall_now(), from, rate }
    }

    /// Emulated seconds for each second of the wall.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The emulated time.
    pub fn now(&self) -> Instant {
        self.from + wall_now().duration_since(self.start).mul_f64(self.rate)
    }

    /// Sleeps until the emulated time is `at`; for ever without one.
    ///
    /// It may wake slightly early or late: read [`Clock::now`] again afterwards.
    pub async fn until(&self, at: Option<Instant>) {
        let Some(at) = at else { return std::future::pending().await };
        let elapsed = at.since(self.from).div_f64(self.rate);
        match self.start.checked_add(elapsed) {
            Some(wall) => tokio::time::sleep_until(wall).await,
            None => std::future::pending().await,
        }
    }

    /// The moment of the wall that is `time` from now.
    pub fn wall_after(time: Duration) -> tokio::time::Instant {
        wall_now() + time
    }

    /// Is a moment of the wall over?
    pub fn is_over(at: tokio::time::Instant) -> bool {
        wall_now() >= at
    }

    /// Waits `time` of the wall, whatever the rate: for ports, which live out there.
    #[allow(clippy::disallowed_methods)] // This is the clock.
    pub async fn wall(time: Duration) {
        tokio::time::sleep(time).await;
    }

    /// The same for those who poll.
    #[allow(clippy::disallowed_methods)] // This is the clock.
    pub fn wall_timer(time: Duration) -> WallTimer {
        WallTimer(Box::pin(tokio::time::sleep(time)))
    }
}

/// A timer of the wall.
#[derive(Debug)]
pub struct WallTimer(Pin<Box<tokio::time::Sleep>>);

impl WallTimer {
    /// Waits until it is over.
    pub fn poll_over(&mut self, cx: &mut Context<'_>) -> Poll<()> {
        self.0.as_mut().poll(cx)
    }
}

#[allow(clippy::disallowed_methods)] // This is the clock.
fn wall_now() -> tokio::time::Instant {
    tokio::time::Instant::now()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test(start_paused = true)]
    async fn the_rate_stretches_time() {
        let clock = Clock::start(50.0);
        clock.until(Some(Instant::from_millis(5000))).await;
        let now = clock.now();
        assert!(now >= Instant::from_millis(5000) && now < Instant::from_millis(5100), "{now}");
    }
}
