//! Faults on a line: named rules that lose, damage, delay and rewrite what passes.
//!
//! A [`FaultRule`] says when and what; [`Faults`] are the rules of one line, in order, with what each has done.
//! Rules are read from a bench file ([`raw`]) or from the compact form of the command line
//! ([`parse`](fn@parse)); both are one grammar with the same checks ([`compile`](fn@compile)). Apart from them
//! a line has [`LineBehaviour`], which presets can bring along.
//!
//! Deliberately not here: drives, links and time that passes. A rule judges a request by what stands in it;
//! who executes it and when a reply leaves is the bus's.

mod compile;
mod effect;
mod kind;
mod line_behaviour;
mod list;
pub mod raw;
mod rule;
mod spec;

pub use compile::{FaultContext, FaultSet, NoRow, compile};
pub use kind::FaultKind;
pub use line_behaviour::{Chatter, LineBehaviour, Pacing};
pub use list::{FaultHit, Faults};
pub use rule::{Act, FaultRule, When};
pub use spec::parse;
