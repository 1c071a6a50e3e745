//! How much a drive has heard, for those who wait for that.

use super::Bus;
use crate::event::DriveId;
use crate::wire::function::{READ, WRITE_MANY, WRITE_ONE};

/// Requests that a drive got and answered, refused ones too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Heard {
    /// Reads.
    pub reads: u64,
    /// Writes.
    pub writes: u64,
    /// With other functions.
    pub others: u64,
}

impl Heard {
    /// All of them.
    pub fn all(self) -> u64 {
        self.reads + self.writes + self.others
    }
}

impl Bus {
    /// What a drive has heard so far.
    pub fn heard(&self, id: DriveId) -> Heard {
        self.heard[usize::from(id.0)]
    }

    pub(super) fn count(&mut self, id: DriveId, function: u8) {
        let heard = &mut self.heard[usize::from(id.0)];
        match function {
            READ => heard.reads += 1,
            WRITE_ONE | WRITE_MANY => heard.writes += 1,
            _ => heard.others += 1,
        }
    }
}
