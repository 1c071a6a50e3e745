//! Events as people and programs read them, decoded with the model's own names.
//!
//! The core tells what happened in values; only here do they become text ([`text`]) or, with feature `cli`,
//! JSON ([`json`]). Nothing in here decides anything.

#[cfg(feature = "cli")]
pub mod json;
mod no_effect;
mod rows;
pub mod text;
mod why;
