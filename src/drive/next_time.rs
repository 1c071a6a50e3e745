//! When something is going to hold by itself: solved for, as deadlines are, for those who wait for it from outside.

use super::Drive;
use crate::motion::first_equal;
use crate::time::Instant;
use std::cell::RefCell;
use std::cmp::Ordering;

impl Drive {
    /// The first instant after now at which what `side` looks at is equal to what is waited for, before the next
    /// deadline and if nobody asks the drive for anything meanwhile.
    ///
    /// A number is met to the count also where the axis only passes it. A signal that is on only while speed or deviation pass through a window is missed where that takes less than a
    /// sixteenth of a ramp.
    pub fn next_time_when(&mut self, side: impl Fn(&Self) -> Ordering) -> Option<Instant> {
        let (now, end) = (self.now, self.deadline());
        let mut marks = self.motor.marks(now);
        marks.extend(self.interrupt_forgotten_at().filter(|at| *at > now));
        marks.sort_unstable();
        let drive = RefCell::new(self);
        let side = |at| {
            let mut drive = drive.borrow_mut();
            drive.now = at;
            let seen = side(&drive);
            drive.now = now;
            seen
        };
        first_equal(now, &marks, side).filter(|at| end.is_none_or(|end| *at < end))
    }
}
