//! An emulator for Modbus motor drives.
//!
//! A PLC, an HMI or a master library talks to it over a serial line, a pseudo-terminal, TCP or inside
//! the same process, and meets the drive of the manual: same registers, same refusals, same time-outs.
//!
//! The library is a value: a [`bus::Bus`] takes bytes and a time and gives bytes and the next time. For
//! tests, [`testkit`] puts a virtual clock round it:
//!
//! ```
//! use drivemu::testkit::Rig;
//!
//! let mut rig = Rig::builtin("yako-closed-loop").expect("an embedded model");
//! assert_eq!(rig.ask("01 03 00 23 00 01"), "01 03 02 00 3C");
//! ```
//!
//! `docs/ARCHITECTURE.md` draws the map. Imports point down only:
//!
//! ```text
//! main · cli            flags, exit code
//! shell                 the only place that waits          (feature `cli`)
//! testkit · log         virtual clock | events as text
//! bench                 benches: YAML -> buses
//! bus                   one line: framing + drives
//! drive                 the only place that sees registers AND behaviours
//! bank  behaviour       cells and plans | state machines
//! line  model           silence and frames | YAML -> Model
//! time units wire words event problem                      what everyone may say
//! ```

pub mod bank;
pub mod behaviour;
pub mod bench;
pub mod bus;
pub mod drive;
pub mod event;
pub mod line;
pub mod log;
pub mod model;
pub mod problem;
#[cfg(feature = "cli")]
pub mod shell;
pub mod testkit;
pub mod time;
pub mod units;
pub mod wire;
pub mod words;

/// The README's Rust is tested with everything else.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
