//! The signals that end a run.

use std::io;
use tokio::signal::unix::{Signal, SignalKind, signal};

/// Listens for SIGINT and SIGTERM from the moment it is made: whoever is told that the run is ready may end it
/// at once.
#[derive(Debug)]
pub struct Stop {
    int: Signal,
    term: Signal,
}

impl Stop {
    /// Listens from now on.
    ///
    /// # Errors
    /// If the system has no handlers to give.
    pub fn listen() -> io::Result<Self> {
        let (int, term) = (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
        Ok(Self { int, term })
    }

    /// Waits until somebody wants the run to end and says with which signal.
    pub async fn requested(&mut self) -> &'static str {
        tokio::select! {
            _ = self.int.recv() => "SIGINT",
            _ = self.term.recv() => "SIGTERM",
        }
    }
}
