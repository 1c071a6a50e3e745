//! The shell: the only place that waits, opens and asks what time it is.
//!
//! One task owns one [`crate::bus::Bus`]: it reads its port, sleeps until the bus wants to be woken, and sends what
//! the bus gives it. [`run`](fn@run) opens all lines of a bench, says that it is ready, and ends on a signal.

mod clock;
mod diagnostics;
mod library;
mod logger;
pub mod port;
mod ready;
mod run;
mod serve;
mod stage;
mod stop;
mod store;

pub use clock::Clock;
pub use diagnostics::{Diagnostics, diagnose};
pub use library::{FileLibrary, plain};
pub use logger::{LogFormat, Logger};
pub use run::{Judged, OpenError, Play, RunOptions, run};
pub use serve::{Frames, Reopen, Served, serve_stream, serve_tty};
pub use stage::Stage;
pub use store::Store;
