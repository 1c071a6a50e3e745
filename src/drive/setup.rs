//! What a bench says about one station before it is switched on, and what a request has ordered.

use crate::bank::Kept;
use crate::motion::Machine;
use crate::vocabulary::{Action, RowId};

/// A station as the bench sets it up.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Setup {
    /// Which station of the device, from 0.
    pub station: usize,
    /// What an earlier run has left in its memory.
    pub kept: Kept,
    /// Start values, kept over power-off as if somebody had stored them. They win over what was kept.
    pub values: Vec<(RowId, u32)>,
    /// The DIP switches: those of the address, above them those of the speed.
    pub switches: u8,
    /// Signals on the input terminals, bit by bit.
    pub terminals: u16,
    /// What stands along the axis.
    pub machine: Machine,
    /// Where the axis stands when power comes on for the first time, in counts of the machine.
    pub start: i64,
    /// What the position register says at power-on, in counts.
    pub position: i64,
}

/// An order that a request gave, one of those that twice are not the same as once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IssuedCommand {
    /// The order.
    pub action: Action,
    /// Did the drive obey?
    pub obeyed: bool,
}
