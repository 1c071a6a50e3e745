//! How much a drive has counts, for those who wait for that.

use super::Bus;
use crate::event::DriveId;
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
}

impl Bus {
    /// Requests that a drive has executed since the start.
    pub fn request_counts(&self, id: DriveId) -> RequestCounts {
        self.request_counts[usize::from(id.0)]
    }

    pub(super) fn count(&mut self, id: DriveId, function: u8) {
        let counts = &mut self.request_counts[usize::from(id.0)];
        match function {
            READ => counts.reads += 1,
            code if WRITES.contains(&code) => counts.writes += 1,
            _ => counts.others += 1,
        }
    }
}
