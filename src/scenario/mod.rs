//! A scenario: what happens to a line and its drives, and when.

mod order;

pub use order::{NoOrder, Order};
