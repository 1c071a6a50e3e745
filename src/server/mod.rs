//! The server: the only place that waits, opens and asks what time it is.
//!
//! One task owns one line: a [`LineServer`] takes bytes from its ports and commands from its inbox, sleeps until the
//! bus wants to be woken, and sends what the bus gives it. [`run`](fn@run) opens all lines of a bench, says that it is
//! ready, and ends on a signal.

mod clock;
mod destination;
mod diagnostics;
mod endpoints;
mod input;
mod line_server;
mod logger;
mod paths;
pub mod port;
mod ports;
mod run;
mod sink;
mod store;

pub use clock::Clock;
pub use destination::Destination;
pub use diagnostics::{Diagnostics, diagnose, said, say};
pub use input::{FileLibrary, is_path, plain, read_text};
pub use line_server::{InboxError, LineHandle, LineServer};
pub use logger::{LogFormat, Logger};
pub use paths::PathClaims;
pub use run::{Ended, Judged, Play, RunError, RunOptions, run};
pub use store::Store;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What lines share. A line that went down must not take the others along.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
