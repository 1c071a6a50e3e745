//! The integration tests in one binary, one subject a module.

mod allocation;
mod bounds;
mod documents;
mod expect;
mod fault;
mod frames;
mod functions;
mod habits;
mod homing;
mod kit;
mod ladder;
mod line;
#[cfg(feature = "cli")]
mod live;
mod no_effect;
mod problems;
mod properties;
mod scenario;
#[cfg(feature = "cli")]
mod schema;
#[cfg(feature = "cli")]
mod shell;
mod source;
mod state;
mod status;
mod storm;
mod tidy;
mod transcripts;
mod troubles;
mod words;
