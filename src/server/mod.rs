//! The shell: the only place that waits, opens and asks what time it is.
//!
//! One task owns one [`crate::bus::Bus`]: it reads its port, sleeps until the bus wants to be woken, and sends what
//! the bus gives it. [`run`](fn@run) opens all lines of a bench, says that it is ready, and ends on a signal.

mod clock;
mod destination;
mod diagnostics;
mod input;
mod library;
mod logger;
mod outputs;
mod path_claims;
mod path_lock;
pub mod port;
mod ready;
mod run;
mod scenario_run;
mod serve;
mod sink;
mod stop;
mod store;

pub use clock::Clock;
pub use destination::Destination;
pub use diagnostics::{Diagnostics, diagnose, said, say};
pub use input::read_text;
pub use library::{FileLibrary, is_path, plain};
pub use logger::{LogFormat, Logger};
pub use path_claims::PathClaims;
pub use run::{Ended, Judged, Play, RunError, RunOptions, run};
pub use scenario_run::ScenarioRun;
pub use serve::{Frames, LineServer, Reopen, serve_stream, serve_tty};
pub use store::Store;
