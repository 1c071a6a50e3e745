//! For tests: a line with drives under a virtual clock, in this process.
//!
//! A [`Rig`] is one line; nothing passes on it but what a test says. [`transcript`] runs whole
//! conversations written as text, and [`soak`] random ones. With feature `cli`, [`live`] gives an
//! async byte stream that any master library can be put on; under a paused tokio clock its time is virtual too.

#[cfg(feature = "cli")]
pub mod live;
mod rig;
pub mod soak;
pub mod transcript;

pub use crate::wire::hex::{hex, to_hex};
pub use rig::Rig;
