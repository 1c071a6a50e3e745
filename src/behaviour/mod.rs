//! State machines of a drive, one a file. They speak words; none knows a register, a vendor or a bus.

mod hold;
mod servo;

pub use hold::Hold;
pub use servo::{Servo, Trip};
