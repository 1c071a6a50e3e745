//! The integration tests in one binary, one subject a module.

mod allocation;
mod bounds;
mod device_faults;
mod documents;
mod expect;
mod fault;
mod frames;
mod functions;
mod homing;
mod kit;
mod ladder;
mod line;
mod line_behaviour;
#[cfg(feature = "cli")]
mod live;
#[cfg(feature = "cli")]
mod log;
mod no_effect;
mod problems;
mod properties;
mod scenario;
#[cfg(feature = "cli")]
mod schema;
#[cfg(feature = "cli")]
mod server;
mod soak;
mod source;
mod state;
mod status;
mod tidy;
mod transcripts;
mod vocabulary;
mod wakes;
