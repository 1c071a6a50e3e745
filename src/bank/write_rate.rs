//! A memory cell stands some ten thousand to a hundred thousand writes. A master that stores in its cycle is
//! through with it in days; here are the two signs of it.

use crate::time::{Duration, Instant};
use crate::vocabulary::RowId;
use std::collections::BTreeMap;

/// Counts at which a cell is worn: what cheap and what good memories are promised to stand.
const WORN: [u32; 2] = [10_000, 100_000];

/// This many writes of one row within [`SOON`] are the doing of a cycle and not of a person.
pub const OFTEN: u32 = 100;

/// See [`OFTEN`].
pub const SOON: Duration = Duration::from_secs(60);

/// Is this the write that reaches what a memory is promised to stand?
pub fn is_worn(writes: u32) -> bool {
    WORN.contains(&writes)
}

/// How often rows were stored of late; begun anew at power-on.
#[derive(Debug, Clone, Default)]
pub struct WriteRate {
    /// By row; without one for all rows at once.
    bursts: BTreeMap<Option<RowId>, Burst>,
}

#[derive(Debug, Clone, Copy)]
struct Burst {
    since: Instant,
    writes: u32,
    told: bool,
}

impl WriteRate {
    /// Takes note of a write at `now`. Is it the one that makes [`OFTEN`] within [`SOON`]? That is told once.
    ///
    /// A minute begins with a write and ends a minute later, with the next write: nothing is kept of single
    /// writes.
    pub fn stored(&mut self, row: Option<RowId>, now: Instant) -> bool {
        let fresh = Burst { since: now, writes: 0, told: false };
        let burst = self.bursts.entry(row).or_insert(fresh);
        if now.since(burst.since) > SOON {
            *burst = Burst { told: burst.told, ..fresh };
        }
        burst.writes = burst.writes.saturating_add(1);
        let tell = burst.writes == OFTEN && !burst.told;
        burst.told |= tell;
        tell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stores `row` every `step` milliseconds and says with which of the writes that is told.
    fn told(row: Option<RowId>, step: u64, writes: u64) -> Vec<u64> {
        let mut write_rate = WriteRate::default();
        let at = |i: u64| Instant::from_millis(i * step);
        (1..=writes).filter(|i| write_rate.stored(row, at(*i))).collect()
    }

    #[test]
    fn a_hundred_within_a_minute_once() {
        let row = Some(RowId(7));
        assert_eq!(told(row, 600, 500), [100]);
        assert_eq!(told(row, 606, 500), [100], "the last of them is 59.994 s behind the first");
        assert_eq!(told(row, 607, 500), [0; 0]);
        assert_eq!(told(None, 0, 300), [100]);
    }

    #[test]
    fn each_row_by_itself() {
        let mut write_rate = WriteRate::default();
        let told =
            (0..198).filter(|i| write_rate.stored(Some(RowId(i % 2)), Instant::ZERO)).count();
        assert_eq!(told, 0);
        assert!(write_rate.stored(Some(RowId(0)), Instant::ZERO));
        assert!(write_rate.stored(Some(RowId(1)), Instant::ZERO));
    }
}
