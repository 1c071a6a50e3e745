//! Bad weather on a line: named rules that lose, damage, delay and forge what passes.
//!
//! A [`Rule`] says when and what; [`Faults`] are the rules of one line, in order, with what each has done.
//! Rules are read from a bench file ([`raw`]) or from the compact form of the command line
//! ([`parse`](fn@parse)); both are one grammar with the same checks ([`compile`](fn@compile)). Apart from them
//! a line has [`Habits`], which presets can bring along.
//!
//! Deliberately not here: drives, links and time that passes. A rule judges a request by what stands in it;
//! who executes it and when a reply leaves is the bus's.

mod compile;
mod habits;
mod kind;
mod list;
pub mod raw;
mod rule;
mod spec;
mod spoil;

pub use compile::{NoRow, Site, Weather, compile};
pub use habits::{Chatter, Habits, Pacing};
pub use kind::Kind;
pub use list::{Faults, Strike};
pub use rule::{Act, Rule, When};
pub use spec::parse;
