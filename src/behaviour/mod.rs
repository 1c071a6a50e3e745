//! State machines of a drive, one a file. They speak the vocabulary; none knows a register, a vendor or a bus.

mod chain;
mod effect;
mod motor;
mod power;
mod watchdog;

pub use chain::{Chain, ChainRule, MOST_WAITS, Wait};
pub use effect::{Effect, Replan};
pub use motor::{
    Commands, Control, HomeOrder, Jog, Motor, MotorLevels, MotorTimer, Phase, Ramp, Slope,
};
pub use power::{
    CommandControl, LevelControl, PowerControl, PowerLevels, PowerStage, Trip,
};
pub use watchdog::Watchdog;
