//! The deadlines of all drives, ordered: ten thousand idle drives cost one look. And those that have passed last.

use super::Wake;
use crate::drive::Timer;
use crate::event::DriveId;
use crate::time::Instant;
use std::collections::{BTreeSet, VecDeque};

/// At most one deadline for each drive.
#[derive(Debug, Default)]
pub struct Deadlines {
    ordered: BTreeSet<(Instant, DriveId)>,
    by_drive: Vec<Option<(Instant, Timer)>>,
}

impl Deadlines {
    /// Sets or clears the deadline of `id`.
    pub fn set(&mut self, id: DriveId, deadline: Option<(Instant, Timer)>) {
        let index = usize::from(id.0);
        if self.by_drive.len() <= index {
            self.by_drive.resize(index + 1, None);
        }
        let at = |it: Option<(Instant, Timer)>| it.map(|(at, _)| at);
        let old = std::mem::replace(&mut self.by_drive[index], deadline);
        if at(old) == at(deadline) {
            return;
        }
        if let Some((old, _)) = old {
            self.ordered.remove(&(old, id));
        }
        self.ordered.extend(at(deadline).map(|at| (at, id)));
    }

    /// The earliest deadline; of equal ones that of the drive with the lowest number.
    pub fn first(&self) -> Option<(Instant, DriveId, Timer)> {
        let (at, id) = *self.ordered.first()?;
        let (_, timer) = self.by_drive[usize::from(id.0)]?;
        Some((at, id, timer))
    }
}

/// How many wake-ups are kept.
const KEPT: usize = 32;

/// The last wake-ups of a bus. Nothing is decided by them.
#[derive(Debug)]
pub struct WakeTrace {
    last: VecDeque<Wake>,
}

impl WakeTrace {
    /// Takes note of a wake-up; the oldest one gives way.
    pub fn note(&mut self, wake: Wake) {
        if self.last.len() == KEPT {
            self.last.pop_front();
        }
        self.last.push_back(wake);
    }

    /// Those that are kept, the latest one last.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Wake> {
        self.last.iter()
    }
}

impl Default for WakeTrace {
    fn default() -> Self {
        Self { last: VecDeque::with_capacity(KEPT) }
    }
}
