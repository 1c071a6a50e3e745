//! The deadlines of all drives, ordered: ten thousand idle drives cost one look.

use crate::event::DriveId;
use crate::time::Instant;
use std::collections::BTreeSet;

/// At most one deadline for each drive.
#[derive(Debug, Default)]
pub struct Deadlines {
    ordered: BTreeSet<(Instant, DriveId)>,
    by_drive: Vec<Option<Instant>>,
}

impl Deadlines {
    /// Sets or clears the deadline of `id`.
    pub fn set(&mut self, id: DriveId, deadline: Option<Instant>) {
        let index = usize::from(id.0);
        if self.by_drive.len() <= index {
            self.by_drive.resize(index + 1, None);
        }
        if self.by_drive[index] == deadline {
            return;
        }
        if let Some(old) = std::mem::replace(&mut self.by_drive[index], deadline) {
            self.ordered.remove(&(old, id));
        }
        self.ordered.extend(deadline.map(|at| (at, id)));
    }

    /// The earliest deadline; of equal ones that of the drive with the lowest number.
    pub fn first(&self) -> Option<(Instant, DriveId)> {
        self.ordered.first().copied()
    }
}
