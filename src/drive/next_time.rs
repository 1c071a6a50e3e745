//! When something is going to hold by itself: solved for, as deadlines are, for those who wait for it from outside.

use super::{Drive, View};
use crate::motion::first_equal;
use crate::time::Instant;
use std::cmp::Ordering;

impl Drive {
    /// The first instant after `now` at which what `side` looks at is equal to what is waited for, before the next
    /// deadline and if nobody asks the drive for anything meanwhile.
    ///
    /// A number is met to the count also where the axis only passes it. A signal that is on only while speed or deviation
    /// pass through a window is missed where that takes less than a sixteenth of a ramp.
    pub fn next_time_when(
        &self,
        now: Instant,
        side: impl Fn(View<'_>) -> Ordering,
    ) -> Option<Instant> {
        let end = self.next_timer().map(|(at, _)| at);
        let mut marks = self.motor.marks(now);
        marks.extend(self.interrupt_forgotten_at(now).filter(|at| *at > now));
        marks.sort_unstable();
        let side = |at| side(self.at(at));
        first_equal(now, &marks, side).filter(|at| end.is_none_or(|end| *at < end))
    }
}
