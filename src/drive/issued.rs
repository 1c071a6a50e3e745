//! What a request has ordered.

use crate::vocabulary::Action;

/// An order that a request gave, one of those that twice are not the same as once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IssuedCommand {
    /// The order.
    pub action: Action,
    /// Did the drive obey?
    pub obeyed: bool,
}
