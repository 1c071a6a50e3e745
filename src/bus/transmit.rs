//! The way of bytes to the master: at the pace of the line, and through an adapter that makes lumps of them.
//!
//! A request has ended when its last byte has arrived: where bytes come in one piece, that is the end of its
//! last character. A reply begins after the drive's turnaround, its characters follow each other without a
//! gap, and what has no adapter in front of it leaves in one piece with its last character (serial line, 2.5.1).

use super::{Bus, LinkId, Output};
use crate::event::DriveId;
use crate::medium::{LineBehaviour, Pacing};
use crate::rng::Fork;
use crate::time::{Duration, Instant};
use crate::wire::Frame;

/// Bytes that fill a lump: a packet of full speed USB less the two bytes of status that adapters put first.
const LUMP: usize = 62;

/// No rule of faults can have this name, so that none draws the same.
const STREAM: &str = "(chunk)";

/// The latency timer of a USB adapter. It runs freely: when it ends has nothing to do with when bytes arrive.
#[derive(Debug, Clone, Copy)]
pub struct LatencyTimer {
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

impl Bus {
    /// Gives the line its line behaviour, in place of those that it had.
    pub fn set_line_behaviour(&mut self, line_behaviour: LineBehaviour) {
        let is_same = line_behaviour.chatter == self.line_behaviour.chatter;
        let fork = self.faults.fork(STREAM);
        self.adapter = line_behaviour.chunk.map(|latency| LatencyTimer::new(latency, fork));
        self.line_behaviour = line_behaviour;
        if !is_same {
            self.invite_others();
        }
    }

    /// What the line always does.
    pub fn line_behaviour(&self) -> &LineBehaviour {
        &self.line_behaviour
    }

    /// When `drive` begins its reply to what has come on `link`.
    pub(super) fn reply_begins(&self, link: LinkId, drive: DriveId) -> Instant {
        let paced = self.spoken.filter(|_| self.line_behaviour.pacing != Pacing::Ideal);
        let received = self.links.get(&link).map(|it| it.line.received_at());
        let (Some(mode), Some(received)) = (paced, received) else { return self.now };
        self.now.max(received + self.drive(drive).model().line.turnaround(mode))
    }

    /// Time that `count` characters of a reply take.
    pub(super) fn characters(&self, count: usize) -> Duration {
        let paced = self.spoken.filter(|_| self.line_behaviour.pacing == Pacing::Line);
        paced.map_or(Duration::ZERO, |mode| mode.settings.characters(count as f64))
    }

    /// Sends `frame` from `at` on.
    pub(super) fn transmit_at(&mut self, at: Instant, link: LinkId, frame: Frame) {
        match at <= self.now {
            true => self.transmit(link, frame),
            false => {
                self.queue.timed.until(at, link, frame);
            }
        }
    }

    /// Sends `frame` from now on, or from when what is on the wire has left.
    pub(super) fn transmit(&mut self, link: LinkId, frame: Frame) {
        if !self.line_behaviour.takes_time() {
            return self.outputs.push_back(Output::Transmit { link, frame });
        }
        let Some(it) = self.links.get(&link) else { return };
        let begins = self.now.max(it.free);
        self.arrive(link, &frame, begins);
    }

    /// Passes bytes on whose last character has just ended: nobody here has sent them.
    pub(super) fn pass(&mut self, link: LinkId, frame: &Frame) {
        match self.adapter {
            None => self.leave(self.now, link, *frame),
            Some(timer) => {
                frame.iter().for_each(|byte| self.collect(link, timer, self.now, *byte));
            }
        }
    }

    /// Is something on its way that has to leave as the line is?
    pub(super) fn is_under_way(&self) -> bool {
        let waiting = self.queue.timed.first().is_some() || self.leaving.first().is_some();
        waiting && self.line_behaviour.takes_time()
    }

    /// Lets the characters of `frame` arrive, the first of which begins at `begins`.
    fn arrive(&mut self, link: LinkId, frame: &Frame, begins: Instant) {
        let ends = begins + self.characters(frame.len());
        self.links.get_mut(&link).into_iter().for_each(|it| it.free = ends);
        let Some(timer) = self.adapter else { return self.leave(ends, link, *frame) };
        for (i, byte) in frame.iter().enumerate() {
            self.collect(link, timer, begins + self.characters(i + 1), *byte);
        }
    }

    /// The adapter of `link` gets a byte at `at`. It hands over what it has when a packet is full, and whenever
    /// its timer ends.
    fn collect(&mut self, link: LinkId, timer: LatencyTimer, at: Instant, byte: u8) {
        let Some(it) = self.links.get_mut(&link) else { return };
        let open = it.lump.filter(|(due, _)| at < *due);
        let lump = open.and_then(|ticket| Some((ticket, self.leaving.get_mut(ticket)?)));
        let Some((ticket, lump)) = lump else {
            let ticket = self.leaving.until(timer.ends_after(at), link, Frame::from_slice(&[byte]));
            it.lump = Some(ticket);
            return;
        };
        lump.push(byte);
        if lump.len() == LUMP {
            let full = self.leaving.take(ticket);
            full.into_iter().for_each(|full| self.leave(at, link, full));
        }
    }

    fn leave(&mut self, at: Instant, link: LinkId, frame: Frame) {
        match at <= self.now {
            true => self.outputs.push_back(Output::Transmit { link, frame }),
            false => {
                self.leaving.until(at, link, frame);
            }
        }
    }
}
