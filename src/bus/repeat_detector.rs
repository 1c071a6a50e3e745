//! Orders that masters give twice, because they never heard that the first was carried out.
//!
//! Deliberately not by time: what comes again after an answer that arrived is meant. And not by link: a
//! master on TCP that gets no answer comes back on a new one.

use crate::drive::IssuedCommand;
use crate::event::DriveId;
use crate::time::Instant;
use crate::vocabulary::Action;
use crate::wire::Pdu;
use std::collections::BTreeMap;

/// The last request that each drive executed, where it was a command whose reply did not arrive.
#[derive(Debug, Default)]
pub struct RepeatDetector {
    orders: BTreeMap<DriveId, LastCommand>,
    repeated: BTreeMap<DriveId, u64>,
}

#[derive(Debug)]
struct LastCommand {
    request: Pdu,
    /// When its answer arrives, if it does.
    arrives: Option<Instant>,
}

impl RepeatDetector {
    /// Drive `id` executed `request` at `now`, which was `issued` as an order; its answer `arrives` then, if
    /// at all. Is it an order issued again? Then which, and how often that was so by now.
    pub fn executed(
        &mut self,
        now: Instant,
        id: DriveId,
        request: &Pdu,
        issued: Option<IssuedCommand>,
        arrives: Option<Instant>,
    ) -> Option<(Action, u64)> {
        let waits = |arrives: Option<Instant>| arrives.is_none_or(|at| at > now);
        let before = self.orders.remove(&id);
        let again = before.is_some_and(|it| waits(it.arrives) && it.request == *request);
        let IssuedCommand { action, obeyed } = issued?;
        if waits(arrives) && (obeyed || again) {
            self.orders.insert(id, LastCommand { request: *request, arrives });
        }
        again.then(|| {
            let count = self.repeated.entry(id).or_default();
            *count += 1;
            (action, *count)
        })
    }

    /// How often `id` was issued an order again.
    pub fn repeated(&self, id: DriveId) -> u64 {
        self.repeated.get(&id).copied().unwrap_or(0)
    }
}
