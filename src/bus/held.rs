//! Replies that wait: until their time, or for the next request on their link.

use super::LinkId;
use crate::time::Instant;
use crate::wire::Frame;
use std::collections::{BTreeMap, VecDeque};

/// Replies that have not left yet.
#[derive(Debug, Default)]
pub struct Held {
    /// By time; of one time in the order in which they came.
    timed: BTreeMap<(Instant, u64), (LinkId, Frame)>,
    late: VecDeque<(LinkId, Frame)>,
    next: u64,
}

impl Held {
    /// Holds `frame` until `at`.
    pub fn until(&mut self, at: Instant, link: LinkId, frame: Frame) {
        self.timed.insert((at, self.next), (link, frame));
        self.next += 1;
    }

    /// Holds `frame` until the next request comes on `link`.
    pub fn until_request(&mut self, link: LinkId, frame: Frame) {
        self.late.push_back((link, frame));
    }

    /// When the first leaves, and where.
    pub fn first(&self) -> Option<(Instant, LinkId)> {
        self.timed.first_key_value().map(|((at, _), (link, _))| (*at, *link))
    }

    /// The first of those that wait for a time.
    pub fn take_first(&mut self) -> Option<(LinkId, Frame)> {
        self.timed.pop_first().map(|(_, held)| held)
    }

    /// The oldest of those that wait for a request on `link`.
    pub fn take_late(&mut self, link: LinkId) -> Option<(LinkId, Frame)> {
        let oldest = self.late.iter().position(|(it, _)| *it == link)?;
        self.late.remove(oldest)
    }

    /// Forgets what waits on `link`: nobody is there to hear it.
    pub fn forget(&mut self, link: LinkId) {
        self.timed.retain(|_, (it, _)| *it != link);
        self.late.retain(|(it, _)| *it != link);
    }
}
