//! The way to the master: the one queue of what leaves, at the pace of the line and through an adapter.
//!
//! A request has ended when its last byte has arrived: where bytes come in one piece, that is the end of its last
//! character. A reply begins after the drive's turnaround, its characters follow each other without a gap, and what
//! has no adapter in front of it leaves in one piece with its last character (serial line, 2.5.1).

use super::{LineBehaviour, Pacing};
use crate::line::Line;
use crate::rng::{Fork, Rng};
use crate::serial::Mode;
use crate::time::{Duration, Instant};
use crate::wire::{Adu, Frame, Pdu};
use std::collections::{BTreeMap, VecDeque};

/// Bytes that fill a chunk: a packet of full speed USB less the two bytes of status that adapters put first.
const CHUNK: usize = 62;

/// A link onto a line: the serial line, or one TCP client.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LinkId(pub(crate) u32);

/// What carries the bytes of a link, and with it what can happen to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// Serial frames on something that takes no time of its own: a pseudo-terminal, a stream.
    Serial,
    /// A serial port, which takes the time of characters itself.
    Uart,
    /// Modbus TCP: no adapter, no echo, and nobody else on the line.
    Tcp,
}

/// A request as a master sent it.
#[derive(Debug, Clone, Copy)]
pub struct MasterRequest<'a> {
    /// Where it came from.
    pub link: LinkId,
    /// The line that it came on.
    pub line: &'a Line,
    /// Who is asked, and what.
    pub adu: Adu<'a>,
    /// The unit that fault rules look at: that of the drive, where a TCP client asked whoever is there.
    pub unit: u8,
}

impl MasterRequest<'_> {
    /// The request as it travels.
    pub fn frame(&self) -> Frame {
        self.line.frame(self.adu.unit, self.adu.pdu)
    }
}

/// A reply as a drive gives it.
#[derive(Debug, Clone, Copy)]
pub struct DriveReply<'a> {
    /// Where it goes.
    pub link: LinkId,
    /// The line that it leaves on.
    pub line: &'a Line,
    /// Who replies.
    pub unit: u8,
    /// What it says.
    pub pdu: &'a Pdu,
    /// When the drive begins to send it.
    pub begins: Instant,
}

impl DriveReply<'_> {
    /// The reply as it travels.
    pub fn frame(&self) -> Frame {
        self.line.frame(self.unit, self.pdu)
    }
}

/// What passes on a link while a reply is held for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passing {
    /// A master's request has arrived, whoever it is for.
    Request,
    /// A reply has left, whole.
    Reply,
}

/// How far bytes are on their way. Of one instant, those that are farther move first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Progress {
    /// On the wire: the instant is that of their last character, or of the adapter's timer.
    OnWire,
    /// The drive has not begun to send them.
    Waiting,
}

/// The place of bytes in the queue: when they move, how far they are, and how many came before.
type Ticket = (Instant, Progress, u64);

/// An entry without an instant of its own: somebody else has to release it.
const NEVER: Instant = Instant::END;

/// A fault that holds a reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ReplyHolder {
    /// The name of its kind.
    pub(super) kind: &'static str,
    /// What releases the reply before its instant, if anything does.
    pub(super) released_by: Option<Passing>,
}

#[derive(Debug)]
struct Entry {
    link: LinkId,
    frame: Frame,
    /// Does a reply end with it?
    is_last: bool,
    /// What holds it, and may release it before its instant.
    holder: Option<ReplyHolder>,
}

/// What the wire of one link is doing.
#[derive(Debug)]
struct Wire {
    carrier: Carrier,
    /// When the last character of a reply has left.
    free: Instant,
    /// What the adapter is still collecting.
    chunk: Option<Ticket>,
}

/// The latency timer of a USB adapter. It runs freely: when it ends has nothing to do with when bytes arrive.
#[derive(Debug, Clone, Copy)]
struct LatencyTimer {
    period: Duration,
    /// When it ends for the first time, less than a period after time 0.
    phase: Duration,
}

impl LatencyTimer {
    /// With a phase drawn from `fork`, in microseconds.
    fn new(period: Duration, fork: Fork) -> Self {
        let last = (period.as_micros() as u64).saturating_sub(1);
        Self { period, phase: Duration::from_micros(fork.stream(0).between(0, last)) }
    }

    /// When it ends next after `at`.
    fn ends_after(self, at: Instant) -> Instant {
        let first = Instant::ZERO + self.phase;
        if at < first {
            return first;
        }
        let into = at.since(first).as_nanos() % self.period.as_nanos();
        at + (self.period - Duration::from_nanos(into as u64))
    }
}

/// The queue of what leaves a line, and what moves it on.
#[derive(Debug, Default)]
pub(super) struct Transmitter {
    pacing: Pacing,
    adapter: Option<LatencyTimer>,
    /// How bytes on their way are sent; `None` on Modbus TCP.
    mode: Option<Mode>,
    wires: BTreeMap<LinkId, Wire>,
    queue: BTreeMap<Ticket, Entry>,
    /// Entries that there ever were.
    count: u64,
    /// What has left and was not polled yet.
    left: VecDeque<(LinkId, Frame)>,
}

impl Transmitter {
    /// Takes the pace of `behaviour`, and its adapter with a timer whose phase is drawn from `fork`.
    pub(super) fn set_behaviour(&mut self, behaviour: &LineBehaviour, fork: Fork) {
        self.pacing = behaviour.pacing;
        self.adapter = behaviour.chunk.map(|latency| LatencyTimer::new(latency, fork));
    }

    pub(super) fn set_mode(&mut self, mode: Option<Mode>) {
        self.mode = mode;
    }

    pub(super) fn mode(&self) -> Option<Mode> {
        self.mode
    }

    pub(super) fn open(&mut self, link: LinkId, carrier: Carrier) {
        self.wires.insert(link, Wire { carrier, free: Instant::ZERO, chunk: None });
    }

    pub(super) fn is_tcp(&self, link: LinkId) -> bool {
        self.wires.get(&link).is_some_and(|wire| wire.carrier == Carrier::Tcp)
    }

    pub(super) fn close(&mut self, link: LinkId) {
        self.forget(link);
        self.wires.remove(&link);
    }

    /// Forgets what has not left on `link`: nobody is there to receive it.
    pub(super) fn forget(&mut self, link: LinkId) {
        self.queue.retain(|_, entry| entry.link != link);
    }

    /// When the last character of a reply on `link` has left.
    pub(super) fn free_at(&self, link: LinkId) -> Instant {
        self.wires.get(&link).map_or(Instant::ZERO, |wire| wire.free)
    }

    /// Is a reply waiting that will begin by itself?
    pub(super) fn is_waiting(&self) -> bool {
        self.timed().any(|(_, progress, _)| *progress == Progress::Waiting)
    }

    /// Is something on its way that has to leave in the mode of the line as it is?
    pub(super) fn is_under_way(&self) -> bool {
        self.takes_time() && self.timed().next().is_some()
    }

    /// When bytes move next, how far they are, and on which link.
    pub(super) fn next(&self) -> Option<(Instant, Progress, LinkId)> {
        let ((at, progress, _), entry) = self.queue.first_key_value()?;
        (*at < NEVER).then_some((*at, *progress, entry.link))
    }

    /// Moves the first bytes that are due at `now`.
    pub(super) fn on_timeout(&mut self, now: Instant) {
        let Some(first) = self.queue.first_entry().filter(|it| it.key().0 <= now) else { return };
        let ((_, progress, _), entry) = first.remove_entry();
        match progress {
            Progress::OnWire => self.left.push_back((entry.link, entry.frame)),
            Progress::Waiting => self.begin(now, entry.link, &entry.frame, entry.is_last),
        }
    }

    /// The next frame that has left.
    pub(super) fn poll(&mut self) -> Option<(LinkId, Frame)> {
        self.left.pop_front()
    }

    /// Frames that have left and were not polled yet.
    pub(super) fn left(&self) -> usize {
        self.left.len()
    }

    /// Something passes on `link`: replies that are held may leave now.
    pub(super) fn on_passing(&mut self, now: Instant, link: LinkId, passing: Passing) {
        let released = |entry: &Entry| {
            let released_by = entry.holder.and_then(|holder| holder.released_by);
            entry.link == link && released_by == Some(passing)
        };
        while let Some(ticket) =
            self.queue.iter().find(|(_, entry)| released(entry)).map(|(it, _)| *it)
        {
            let entry = self.queue.remove(&ticket);
            entry.into_iter().for_each(|it| self.begin(now, link, &it.frame, it.is_last));
        }
    }

    /// Sends `frame` from `at` on, or from when what is on the wire has left.
    pub(super) fn send_at(
        &mut self,
        now: Instant,
        at: Instant,
        link: LinkId,
        frame: &Frame,
        is_last: bool,
    ) {
        match at <= now {
            true => self.begin(now, link, frame, is_last),
            false => {
                let entry = Entry { link, frame: *frame, is_last, holder: None };
                self.insert(at, Progress::Waiting, entry);
            }
        }
    }

    /// Passes bytes on whose last character has just ended: no drive has sent them.
    pub(super) fn pass(&mut self, now: Instant, link: LinkId, frame: &Frame) {
        match self.adapter_of(link) {
            None => self.leave(now, now, link, frame),
            Some(timer) => frame.iter().for_each(|byte| self.collect(now, link, timer, now, *byte)),
        }
    }

    fn timed(&self) -> impl Iterator<Item = &Ticket> {
        self.queue.keys().take_while(|(at, ..)| *at < NEVER)
    }

    fn takes_time(&self) -> bool {
        self.pacing != Pacing::Ideal || self.adapter.is_some()
    }

    /// The adapter in front of the master of `link`.
    fn adapter_of(&self, link: LinkId) -> Option<LatencyTimer> {
        self.adapter.filter(|_| !self.is_tcp(link))
    }

    /// Time that `count` characters of a reply take on `link` before the bytes are handed over.
    fn characters(&self, link: LinkId, count: usize) -> Duration {
        let is_uart = self.wires.get(&link).is_some_and(|wire| wire.carrier == Carrier::Uart);
        let paced = self.mode.filter(|_| self.pacing == Pacing::Line && !is_uart);
        paced.map_or(Duration::ZERO, |mode| mode.settings.characters(count as f64))
    }

    fn insert(&mut self, at: Instant, progress: Progress, entry: Entry) -> Ticket {
        let ticket = (at, progress, self.count);
        self.queue.insert(ticket, entry);
        self.count += 1;
        ticket
    }

    /// The drive begins to send `frame`.
    fn begin(&mut self, now: Instant, link: LinkId, frame: &Frame, is_last: bool) {
        match self.takes_time() {
            false => self.left.push_back((link, *frame)),
            true => self.put_on_wire(now, link, frame),
        }
        if is_last && !self.queue.is_empty() {
            self.on_passing(now, link, Passing::Reply);
        }
    }

    fn put_on_wire(&mut self, now: Instant, link: LinkId, frame: &Frame) {
        let Some(wire) = self.wires.get(&link) else { return };
        let begins = now.max(wire.free);
        let ends = begins + self.characters(link, frame.len());
        self.wires.entry(link).and_modify(|wire| wire.free = ends);
        let Some(timer) = self.adapter_of(link) else { return self.leave(now, ends, link, frame) };
        for (i, byte) in frame.iter().enumerate() {
            self.collect(now, link, timer, begins + self.characters(link, i + 1), *byte);
        }
    }

    /// The adapter of `link` gets a byte at `at`. It hands over what it has when a packet is full, and whenever
    /// its timer ends.
    fn collect(&mut self, now: Instant, link: LinkId, timer: LatencyTimer, at: Instant, byte: u8) {
        let Some(wire) = self.wires.get(&link) else { return };
        let open = wire.chunk.filter(|(ends, ..)| at < *ends);
        let chunk = open.and_then(|ticket| Some((ticket, self.queue.get_mut(&ticket)?)));
        let Some((ticket, chunk)) = chunk else {
            let frame = Frame::from_slice(&[byte]);
            let entry = Entry { link, frame, is_last: false, holder: None };
            let ticket = self.insert(timer.ends_after(at), Progress::OnWire, entry);
            self.wires.entry(link).and_modify(|wire| wire.chunk = Some(ticket));
            return;
        };
        chunk.frame.push(byte);
        if chunk.frame.len() == CHUNK {
            let full = self.queue.remove(&ticket);
            full.into_iter().for_each(|full| self.leave(now, at, link, &full.frame));
        }
    }

    fn leave(&mut self, now: Instant, at: Instant, link: LinkId, frame: &Frame) {
        match at <= now {
            true => self.left.push_back((link, *frame)),
            false => {
                let entry = Entry { link, frame: *frame, is_last: false, holder: None };
                self.insert(at, Progress::OnWire, entry);
            }
        }
    }
}

/// What a fault can do with a reply: send, delay or hold it, in one frame or several.
#[derive(Debug)]
pub struct Outgoing<'a> {
    pub(super) transmitter: &'a mut Transmitter,
    pub(super) now: Instant,
    pub(super) link: LinkId,
    /// When the drive begins to send its reply.
    pub(super) begins: Instant,
    /// What the fault holds a reply as.
    pub(super) holder: ReplyHolder,
    pub(super) rng: &'a mut Rng,
}

impl Outgoing<'_> {
    /// Sends the reply, or the end of it.
    pub fn send(&mut self, frame: &Frame) {
        self.send_after(Duration::ZERO, frame);
    }

    /// Sends the reply, or the end of it, so much later than the drive begins.
    pub fn send_after(&mut self, by: Duration, frame: &Frame) {
        self.transmitter.send_at(self.now, self.begins + by, self.link, frame, true);
    }

    /// Sends part of a reply; more follows.
    pub fn part(&mut self, frame: &Frame) {
        self.transmitter.send_at(self.now, self.begins, self.link, frame, false);
    }

    /// Holds the reply until this kind of fault releases it, or until so much later than
    /// the drive would have begun.
    pub fn hold(&mut self, most: Option<Duration>, frame: &Frame) {
        let at = most.map_or(NEVER, |by| self.begins + by);
        let holder = Some(self.holder);
        let entry = Entry { link: self.link, frame: *frame, is_last: true, holder };
        self.transmitter.insert(at, Progress::Waiting, entry);
    }

    /// Does this kind of fault hold a reply for the link?
    pub fn is_holding(&self) -> bool {
        let held = |entry: &Entry| {
            entry.link == self.link
                && entry.holder.is_some_and(|holder| holder.kind == self.holder.kind)
        };
        self.transmitter.queue.values().any(held)
    }

    /// Gives bytes back to the master at once, as a receiver does that stays on.
    pub fn echo(&mut self, frame: &Frame) {
        self.transmitter.pass(self.now, self.link, frame);
    }

    /// So many random bytes.
    pub fn noise(&mut self, bytes: u8) -> Frame {
        let mut noise = Frame::new();
        (0..bytes).for_each(|_| noise.push(self.rng.between(0, 0xFF) as u8));
        noise
    }

    /// Time that `count` characters take on the line.
    pub fn characters(&self, count: usize) -> Duration {
        self.transmitter.characters(self.link, count)
    }

    /// What the fault draws from.
    pub fn rng(&mut self) -> &mut Rng {
        self.rng
    }
}
