//! State machines of a drive, one a file. They speak words; none knows a register, a vendor or a bus.

mod hold;
mod motor;
mod phase;
mod servo;

pub use hold::Hold;
pub use motor::{HomeOrder, Motor, Ramp, Wants};
pub use phase::Stage;
pub use servo::{Servo, Trip};
