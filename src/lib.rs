//! An emulator for Modbus motor drives.
//!
//! A PLC, an HMI or a master library talks to it over a serial line, a pseudo-terminal, TCP or inside
//! the same process, and meets the drive of the manual: same registers, same refusals, same time-outs.
//!
//! The library is a value: a [`bus::Bus`] takes bytes and a time and gives bytes and the next time. For
//! tests, [`testkit`] puts a virtual clock round it:
//!
//! ```
//! use drivemu::model::builtin::Builtin;
//! use drivemu::testkit::Rig;
//!
//! let mut rig = Rig::builtin(Builtin::default_name()).expect("an embedded model");
//! // No drive knows function 2B, so an exception answers.
//! assert!(rig.ask("01 2B 0E 01 00").starts_with("01 AB"));
//! ```
//!
//! `docs/ARCHITECTURE.md` draws the map of its modules.

pub mod bank;
pub mod behaviour;
pub mod bench;
pub mod bus;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod drive;
pub mod event;
pub mod line;
pub mod log;
pub mod medium;
pub mod model;
pub mod motion;
pub mod problem;
pub mod rng;
pub mod scenario;
pub mod serial;
#[cfg(feature = "cli")]
pub mod server;
pub mod testkit;
pub mod text;
pub mod time;
pub mod units;
pub mod vocabulary;
pub mod wire;

/// The README's Rust is tested with everything else.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The examples on pages are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/determinism.md")]
pub struct Pages;
