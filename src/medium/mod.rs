//! What happens to bytes between a master and the drives of its line: faults, pace, adapters, echoes and the traffic of
//! others.
//!
//! A [`Medium`] is a value without clock and socket: requests and replies go in, bytes with a time come out. It owns the
//! fault rules of a line ([`FaultRules`]), its behaviour ([`LineBehaviour`]) and the one queue of what leaves. Each kind
//! of fault is a file in `kinds`. Rules are read from a bench file ([`raw`]) or from the compact form of the command
//! line ([`parse`](fn@parse)); both are one grammar with the same checks ([`compile`](fn@compile)).
//!
//! Contract: a request that arrives goes through [`Medium::on_request`], the reply to it through [`Medium::on_reply`].
//! Behind each call [`Medium::poll_transmit`] gives what leaves now, and [`Medium::poll_at`] says when to call
//! [`Medium::on_timeout`].
//!
//! Deliberately not here: drives and models. Who executes a request and how long it takes is the caller's to know.

mod chatter;
mod compile;
mod keys;
mod kinds;
mod line_behaviour;
mod presets;
pub mod raw;
mod rules;
mod spec;
mod transmitter;

pub use compile::{FaultContext, FaultSet, NoRow, compile, parse};
pub use keys::{FaultKey, KeyForm};
pub use kinds::{FaultEffect, FaultKind, Leaves, LeavingReply, Passage};
pub use line_behaviour::{Chatter, LineBehaviour, Pacing};
pub use presets::Preset;
pub use rules::{FaultHit, FaultRule, FaultRules, PendingHit, When};
pub use transmitter::{Carrier, DriveReply, LinkId, MasterRequest, Outgoing, Passing};

use crate::line::{Line, Units};
use crate::serial::Mode;
use crate::time::{Duration, Instant};
use crate::wire::Frame;
use chatter::ChatterState;
use transmitter::{Progress, Transmitter};

/// Under this name the phase of the adapter's timer is drawn. No rule can have it.
const CHUNK_STREAM: &str = "(chunk)";

/// Under this name the traffic of others is drawn. No rule can have it.
const CHATTER_STREAM: &str = "(chatter)";

/// What lies between a master and the drives of one line.
#[derive(Debug, Default)]
pub struct Medium {
    rules: FaultRules,
    behaviour: LineBehaviour,
    transmitter: Transmitter,
    chatter: Option<ChatterState>,
}

/// What happens next by itself. Of one instant, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MediumTimer {
    /// Bytes have come through to the master of that link.
    Through(LinkId),
    /// A reply that waited begins to leave on that link.
    Reply(LinkId),
    /// It is the turn of others on the line.
    Chatter,
}

impl Medium {
    /// With `rules`, and as yet without behaviour: replies leave at once.
    pub fn new(rules: FaultRules) -> Self {
        Self { rules, ..Self::default() }
    }

    /// The fault rules.
    pub fn rules(&self) -> &FaultRules {
        &self.rules
    }

    /// Puts `rule` behind all others. Was it put there?
    ///
    /// # Errors
    /// Why it can do nothing here.
    pub fn add_rule(&mut self, rule: FaultRule) -> Result<bool, &'static str> {
        match rule.effect.impossible_on_tcp().filter(|_| self.mode().is_none()) {
            Some(why) => Err(why),
            None => Ok(self.rules.add(rule)),
        }
    }

    /// Takes the rule called `name` away. Was there one? What it holds still leaves.
    pub fn remove_rule(&mut self, name: &str) -> bool {
        self.rules.remove(name)
    }

    /// What it always does.
    pub fn behaviour(&self) -> &LineBehaviour {
        &self.behaviour
    }

    /// Behaves so from `now` on.
    pub fn set_behaviour(&mut self, now: Instant, behaviour: LineBehaviour) {
        let is_same = behaviour.chatter == self.behaviour.chatter;
        self.transmitter.set_behaviour(&behaviour, self.rules.fork(CHUNK_STREAM));
        self.behaviour = behaviour;
        if !is_same {
            let fork = self.rules.fork(CHATTER_STREAM);
            let chatter = self.behaviour.chatter.clone();
            self.chatter = chatter.map(|chatter| ChatterState::new(chatter, fork, now));
        }
    }

    /// In which mode bytes are on their way; `None` on Modbus TCP.
    pub fn mode(&self) -> Option<Mode> {
        self.transmitter.mode()
    }

    /// Bytes are on their way in this mode from now on.
    pub fn set_mode(&mut self, mode: Option<Mode>) {
        self.transmitter.set_mode(mode);
    }

    /// The mode in which replies take their time; `None` where they begin at once.
    pub fn paced_mode(&self) -> Option<Mode> {
        self.mode().filter(|_| self.behaviour.pacing != Pacing::Ideal)
    }

    /// Is something on its way that has to leave in the mode of the line as it is?
    pub fn is_under_way(&self) -> bool {
        self.transmitter.is_under_way()
    }

    /// A link is there from now on.
    pub fn open(&mut self, link: LinkId, carrier: Carrier) {
        self.transmitter.open(link, carrier);
    }

    /// A link is gone, and with it what has not left on it.
    pub fn close(&mut self, link: LinkId) {
        self.transmitter.close(link);
    }

    /// Forgets what has not left on `link`.
    pub fn forget(&mut self, link: LinkId) {
        self.transmitter.forget(link);
    }

    /// The master of `link` has sent bytes: they come back where the line echoes.
    pub fn on_bytes(&mut self, now: Instant, link: LinkId, bytes: &[u8]) {
        if self.behaviour.echo && !self.transmitter.is_tcp(link) {
            self.transmitter.pass(now, link, &Frame::from_slice(bytes));
        }
    }

    /// A request has arrived. The rule that acts on it, if one does and can on what carries the link; its [passage](PendingHit::passage) says what
    /// becomes of the request, and [`on_reply`](Self::on_reply) takes it to the reply.
    pub fn on_request(&mut self, now: Instant, request: &MasterRequest<'_>) -> Option<PendingHit> {
        let MasterRequest { link, adu, unit, .. } = *request;
        self.on_foreign_request(now, link);
        let is_tcp = self.transmitter.is_tcp(link);
        let mut pending = self.rules.on_request(now, unit, adu.pdu, is_tcp)?;
        pending.hit.unit = adu.unit;
        let effect = pending.hit.effect;
        let rng = &mut pending.rng;
        let transmitter = &mut self.transmitter;
        let mut out =
            Outgoing { transmitter, now, link, begins: now, holder: effect.holder(), rng };
        effect.on_request(request, &mut out);
        Some(pending)
    }

    /// A request has arrived that is for nobody here: no rule looks at it, but what waits for one leaves.
    pub fn on_foreign_request(&mut self, now: Instant, link: LinkId) {
        self.transmitter.on_passing(now, link, Passing::Request);
    }

    /// A drive replies, to a request on which `pending` acts. How much later than without faults the master has an
    /// answer that it accepts; `None` if it never has.
    pub fn on_reply(
        &mut self,
        now: Instant,
        reply: &DriveReply<'_>,
        pending: Option<&mut PendingHit>,
    ) -> Option<Duration> {
        let DriveReply { link, begins, .. } = *reply;
        let Some(PendingHit { hit, rng, .. }) = pending else {
            self.transmitter.send_at(now, begins, link, &reply.frame(), true);
            return Some(Duration::ZERO);
        };
        let transmitter = &mut self.transmitter;
        let mut out = Outgoing { transmitter, now, link, begins, holder: hit.effect.holder(), rng };
        hit.effect.on_reply(reply, &mut out)
    }

    /// The next frame that leaves at `now`, and where; what leaves later is due at [`poll_at`](Self::poll_at).
    pub fn poll_transmit(&mut self) -> Option<(LinkId, Frame)> {
        self.transmitter.poll()
    }

    /// How many frames [`poll_transmit`](Self::poll_transmit) has to give.
    pub fn transmits(&self) -> usize {
        self.transmitter.left()
    }

    /// What happens next by itself, and when.
    pub fn poll_at(&self) -> Option<(Instant, MediumTimer)> {
        let bytes = self.transmitter.next().map(|(at, progress, link)| match progress {
            Progress::OnWire => (at, MediumTimer::Through(link)),
            Progress::Waiting => (at, MediumTimer::Reply(link)),
        });
        let chatter = self.chatter.as_ref().map(|it| (it.at(), MediumTimer::Chatter));
        bytes.into_iter().chain(chatter).min()
    }

    /// Moves the first bytes that are due at `now`.
    pub fn on_timeout(&mut self, now: Instant) {
        self.transmitter.on_timeout(now);
    }

    /// It is the turn of others at `now`. What they say, to be passed to every link of `lines`; nothing where one of
    /// them is not silent. Units of `ours` are not asked.
    pub fn on_chatter<'a>(
        &mut self,
        now: Instant,
        lines: impl Iterator<Item = (LinkId, &'a Line)>,
        ours: &Units,
    ) -> Option<Frame> {
        let chatter = self.chatter.as_mut()?;
        let settings = self.transmitter.mode().map(|mode| mode.settings);
        let (mut first, mut is_silent) = (None, !self.transmitter.is_waiting());
        for (link, line) in lines {
            let free = self.transmitter.free_at(link);
            is_silent &= settings.is_some_and(|it| chatter.fits(now, line, it, free));
            first = first.or(Some(line));
        }
        match (first, settings) {
            (Some(line), Some(settings)) if is_silent => chatter.speak(now, line, settings, ours),
            _ => {
                chatter.skip_turn(now);
                None
            }
        }
    }

    /// The master of `link` receives what others say, whose last character ends at `now`.
    pub fn overhear(&mut self, now: Instant, link: LinkId, frame: &Frame) {
        self.transmitter.pass(now, link, frame);
    }

    /// A master of ours speaks, and others don't. Did they speak last?
    pub fn interrupt_chatter(&mut self, now: Instant) -> bool {
        self.chatter.as_mut().is_some_and(|chatter| chatter.interrupt(now))
    }
}
