//! What comes out of a drive: one queue of values, in the order in which they came to be.

use super::timer::Timer;
use crate::event::DriveEvent;
use std::collections::VecDeque;

/// What comes out of a drive, in order.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveEffect {
    /// Something has changed, or has no effect.
    Told(DriveEvent),
    /// A deadline has woken it.
    Woken(Timer),
}

/// The effects that nobody has taken yet.
#[derive(Debug)]
pub(super) struct EffectQueue {
    effects: VecDeque<DriveEffect>,
}

impl EffectQueue {
    pub(super) fn new() -> Self {
        Self { effects: VecDeque::with_capacity(8) }
    }

    pub(super) fn change(&mut self, change: DriveEvent) {
        self.effects.push_back(DriveEffect::Told(change));
    }

    pub(super) fn woken(&mut self, timer: Timer) {
        self.effects.push_back(DriveEffect::Woken(timer));
    }

    pub(super) fn pop(&mut self) -> Option<DriveEffect> {
        self.effects.pop_front()
    }
}
