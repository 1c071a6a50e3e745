//! State machines of a drive, one a file. They speak words; none knows a register, a vendor or a bus.

mod chain;
mod hold;
mod motor;
mod phase;
mod servo;

pub use chain::{Chain, MOST_WAITS, Rule, Wait};
pub use hold::Hold;
pub use motor::{Commands, Control, HomeOrder, Jog, Motor, Ramp, Slope, Wants};
pub use phase::{Phase, Replan, Stage};
pub use servo::{Servo, Trip};
