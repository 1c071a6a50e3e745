//! What an axis is doing, and what it tells about it.

/// What an axis is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Nothing.
    Standing,
    /// Going to a position.
    Moving,
    /// Going at a speed by order.
    Running,
    /// Going at a speed while a level asks for it.
    Jogging {
        /// In the positive direction?
        forward: bool,
    },
    /// Slowing down.
    Stopping,
    /// Running out without power.
    Coasting,
}

/// A new phase, as it is told: machine counts, counts per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// It goes to this position.
    Moves(i64),
    /// It goes at this speed by order.
    Runs(f64),
    /// It goes at this speed while a level asks for it.
    Jogs(f64),
    /// It slows down.
    Stops,
    /// It runs out without power.
    Coasts,
    /// It stands at this position.
    Stands(i64),
}
