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

// Without the program nothing makes lines of the log.
#![cfg_attr(not(feature = "cli"), allow(dead_code))]

pub mod bench;
pub mod bus;
pub mod drive;
pub mod event;
pub mod line;
pub mod medium;
pub mod model;
pub mod motion;
pub mod problem;
pub mod scenario;
pub mod serial;
pub mod testkit;
pub mod time;
pub mod vocabulary;
pub mod wire;

/// Modules that no signature of the public surface needs. The tests, benchmarks and fuzz targets of this package, which
/// are crates of their own, see them with feature `internals`.
macro_rules! internal {
    ($($(#[$cfg:meta])* mod $name:ident;)*) => {$(
        #[cfg(feature = "internals")]
        #[doc(hidden)]
        $(#[$cfg])*
        pub mod $name;
        #[cfg(not(feature = "internals"))]
        $(#[$cfg])*
        pub(crate) mod $name;
    )*};
}

internal! {
    mod bank;
    mod behaviour;
    #[cfg(feature = "cli")]
    mod cli;
    mod log;
    mod rng;
    #[cfg(feature = "cli")]
    mod server;
    mod text;
    mod units;
}

/// The program `drivemu`: reads the command line, does what it says, returns the exit code.
#[cfg(feature = "cli")]
pub fn main() -> std::process::ExitCode {
    cli::main()
}

pub use bench::Bench;
pub use bus::{Bus, Command};
pub use event::Event;
pub use model::Model;
pub use testkit::Rig;

/// The README's Rust is tested with everything else.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The examples on pages are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/determinism.md")]
pub struct Pages;
