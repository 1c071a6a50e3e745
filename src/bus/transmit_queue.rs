//! Replies that wait: until their time, or for the next request on their link.

use super::LinkId;
use crate::time::Instant;
use crate::wire::Frame;
use std::collections::{BTreeMap, VecDeque};

/// Bytes that wait for a time.
#[derive(Debug, Default)]
pub struct Timed {
    /// Of one time in the order in which they came.
    by_time: BTreeMap<Ticket, (LinkId, Frame)>,
    next: u64,
}

/// Which bytes of [`Timed`]: when they are due, and how many came before.
pub type Ticket = (Instant, u64);

impl Timed {
    /// Holds `frame` until `at`.
    pub fn until(&mut self, at: Instant, link: LinkId, frame: Frame) -> Ticket {
        let ticket = (at, self.next);
        self.by_time.insert(ticket, (link, frame));
        self.next += 1;
        ticket
    }

    /// When the first are due, and where.
    pub fn first(&self) -> Option<(Instant, LinkId)> {
        self.by_time.first_key_value().map(|((at, _), (link, _))| (*at, *link))
    }

    /// The first.
    pub fn take_first(&mut self) -> Option<(LinkId, Frame)> {
        self.by_time.pop_first().map(|(_, frame)| frame)
    }

    /// Those of `ticket`, unless they are gone.
    pub fn get_mut(&mut self, ticket: Ticket) -> Option<&mut Frame> {
        self.by_time.get_mut(&ticket).map(|(_, frame)| frame)
    }

    /// Takes those of `ticket` before their time.
    pub fn take(&mut self, ticket: Ticket) -> Option<Frame> {
        self.by_time.remove(&ticket).map(|(_, frame)| frame)
    }

    /// Forgets what waits on `link`: nobody is there to hear it.
    pub fn forget(&mut self, link: LinkId) {
        self.by_time.retain(|_, (it, _)| *it != link);
    }
}

/// Replies that no drive has begun to send.
#[derive(Debug, Default)]
pub struct TransmitQueue {
    /// Those that wait for a time.
    pub timed: Timed,
    late: VecDeque<(LinkId, Frame)>,
}

impl TransmitQueue {
    /// Holds `frame` until the next request comes on `link`.
    pub fn until_request(&mut self, link: LinkId, frame: Frame) {
        self.late.push_back((link, frame));
    }

    /// The oldest of those that wait for a request on `link`.
    pub fn take_late(&mut self, link: LinkId) -> Option<(LinkId, Frame)> {
        let oldest = self.late.iter().position(|(it, _)| *it == link)?;
        self.late.remove(oldest)
    }

    /// Forgets what waits on `link`: nobody is there to hear it.
    pub fn forget(&mut self, link: LinkId) {
        self.timed.forget(link);
        self.late.retain(|(it, _)| *it != link);
    }
}
