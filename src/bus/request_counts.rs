//! How many requests a drive has executed, for those who wait for that.

use crate::wire::function::{READ, WRITES};

/// Requests that a drive got and answered, refused ones too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RequestCounts {
    /// Reads.
    pub reads: u64,
    /// Writes.
    pub writes: u64,
    /// With other functions.
    pub others: u64,
}

impl RequestCounts {
    /// All of them.
    pub fn all(self) -> u64 {
        self.reads + self.writes + self.others
    }

    /// One more, with `function`.
    pub(super) fn count(&mut self, function: u8) {
        match function {
            READ => self.reads += 1,
            code if WRITES.contains(&code) => self.writes += 1,
            _ => self.others += 1,
        }
    }
}
