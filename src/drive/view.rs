//! A drive as it is at an instant: computed for whoever looks at it, from closed forms, and stored nowhere.

use super::Drive;
use crate::bank::Bank;
use crate::model::Model;
use crate::motion::{Machine, State};
use crate::time::Instant;
use crate::vocabulary::{Output, Quantity, RowId};
use std::sync::Arc;

/// A drive as it is at an instant that is not before the last thing that happened to it, and not after the next one that
/// will happen by itself.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    drive: &'a Drive,
    now: Instant,
}

impl<'a> View<'a> {
    pub(super) fn new(drive: &'a Drive, now: Instant) -> Self {
        Self { drive, now }
    }

    /// The instant.
    pub fn now(self) -> Instant {
        self.now
    }

    /// The drive itself.
    pub fn drive(self) -> &'a Drive {
        self.drive
    }

    /// Its model.
    pub fn model(self) -> &'a Arc<Model> {
        self.drive.model()
    }

    /// The cells of its registers, which do not hold what the drive computes.
    pub fn bank(self) -> &'a Bank {
        self.drive.bank()
    }

    /// The unit address in force.
    pub fn unit(self) -> u8 {
        self.drive.unit()
    }

    /// The bits that `row` shows.
    pub fn show(self, row: RowId) -> u32 {
        self.drive.show(self.now, row)
    }

    /// The number that `row` shows.
    pub fn value(self, row: RowId) -> i64 {
        self.model().map.row(row).kind.value(self.show(row))
    }

    /// Is the output signal active?
    pub fn output(self, signal: Output) -> bool {
        self.drive.output(self.now, signal)
    }

    /// A number that the drive computes, in the base unit of its dimension, rounded.
    pub fn quantity(self, quantity: Quantity) -> i64 {
        self.drive.quantity(self.now, quantity)
    }

    /// Position and speed of the axis in the machine's coordinate, in counts and counts per second. No register shows
    /// that coordinate, and it stays as it is when positive counts go the other way.
    pub fn axis_state(self) -> State {
        self.drive.axis_state(self.now)
    }

    /// What stands along the axis.
    pub fn machine(self) -> Machine {
        self.drive.machine()
    }
}
