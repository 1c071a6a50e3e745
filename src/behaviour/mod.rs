//! State machines of a drive, one a file. They speak words; none knows a register, a vendor or a bus.

mod chain;
mod motor;
mod phase;
mod servo;
mod watchdog;

pub use chain::{Chain, ChainRule, MOST_WAITS, Wait};
pub use motor::{Commands, Control, HomeOrder, Jog, Motor, Ramp, Slope, Wants};
pub use phase::{MotionReport, Phase, Replan};
pub use servo::{Servo, Trip};
pub use watchdog::Watchdog;
