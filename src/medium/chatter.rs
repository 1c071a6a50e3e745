//! The traffic of others on a line: another master asks its units, in the gaps between our transactions.
//!
//! What they say is whole at the instant of its last character, for our master and for our drives. They
//! speak only when the line has been silent; when our master speaks, the unit that was to answer them does not.

use super::Chatter;
use crate::line::{Line, Units};
use crate::rng::{Chance, Fork, Rng};
use crate::serial::Settings;
use crate::time::{Duration, Instant};
use crate::wire::function::{READ, WRITE_ONE};
use crate::wire::{Frame, Pdu};

/// Characters of silence between frames (serial line, 2.5.1.1).
const SILENCE: f64 = 3.5;

/// How many turns are bursts of noise instead of conversations.
const NOISE: f64 = 0.05;

/// How many requests nobody answers.
const NO_ANSWER: f64 = 0.1;

/// Another master and its units.
#[derive(Debug)]
pub(super) struct ChatterState {
    chatter: Chatter,
    fork: Fork,
    /// Conversations that were drawn.
    count: u64,
    /// For the next of them.
    rng: Rng,
    /// When their last turn was.
    turn: Instant,
    /// When they speak.
    at: Instant,
    /// The frame that answers then; else a conversation begins.
    answer: Option<Frame>,
    /// They spoke last: what is heard of a frame is theirs.
    spoke: bool,
}

impl ChatterState {
    pub(super) fn new(chatter: Chatter, fork: Fork, now: Instant) -> Self {
        let (count, rng, answer, spoke) = (0, fork.stream(0), None, false);
        let mut others = Self { chatter, fork, count, rng, turn: now, at: now, answer, spoke };
        others.pause(now);
        others
    }

    /// When they speak next.
    pub(super) fn at(&self) -> Instant {
        self.at
    }

    /// Is `line`, on which our last reply ends at `free`, silent for as long as they need for what they say next?
    pub(super) fn fits(
        &self,
        now: Instant,
        line: &Line,
        settings: Settings,
        free: Instant,
    ) -> bool {
        let characters = settings.characters(self.next_len(line) as f64);
        let begins = now - (settings.silence(SILENCE) + characters);
        line.deadline().is_none() && line.received_at().max(free) <= begins
    }

    /// Characters of what they say next on a line like `line`. Of their requests one is as long as the other.
    fn next_len(&self, line: &Line) -> usize {
        self.answer.unwrap_or_else(|| line.frame(0, &[0; 5])).len()
    }

    /// Says nothing until the next conversation: half of `every` to one and a half after the last.
    fn pause(&mut self, now: Instant) {
        self.answer = None;
        self.rng = self.fork.stream(self.count);
        self.count += 1;
        let every = self.chatter.every.as_micros() as u64;
        let pause = Duration::from_micros(self.rng.between(every / 2, every + every / 2));
        self.at = now.max(self.turn + pause);
    }

    /// A conversation that could begin now does not.
    pub(super) fn skip_turn(&mut self, now: Instant) {
        self.turn = now;
        self.pause(now);
    }

    /// A master of ours speaks, so they don't. Did they speak last?
    pub(super) fn interrupt(&mut self, now: Instant) -> bool {
        if self.answer.is_some() {
            self.pause(now);
        }
        std::mem::take(&mut self.spoke)
    }

    /// What they say at `now` on a line like `line`, where `ours` are not to be asked.
    pub(super) fn speak(
        &mut self,
        now: Instant,
        line: &Line,
        settings: Settings,
        ours: &Units,
    ) -> Option<Frame> {
        if let Some(answer) = self.answer {
            self.pause(now);
            self.spoke = true;
            return Some(answer);
        }
        self.turn = now;
        let Self { rng, chatter, .. } = self;
        if rng.happens(Chance::new(NOISE)) {
            let noise = noise(rng);
            self.pause(now);
            self.spoke = true;
            return Some(noise);
        }
        let unit = chatter.units[rng.between(0, chatter.units.len() as u64 - 1) as usize];
        let is_answered = !rng.happens(Chance::new(NO_ANSWER));
        let (request, answer) = conversation(rng);
        if ours.has(unit) {
            self.pause(now);
            return None;
        }
        if is_answered {
            let answer = line.frame(unit, &answer);
            self.at = now + settings.silence(SILENCE) + settings.characters(answer.len() as f64);
            self.answer = Some(answer);
        } else {
            self.pause(now);
        }
        self.spoke = true;
        Some(line.frame(unit, &request))
    }
}

/// A request and its answer: a read of one to eight registers, or one time in four a write.
fn conversation(rng: &mut Rng) -> (Pdu, Pdu) {
    let mut word = |most| (rng.between(0, most) as u16).to_be_bytes();
    let (address, is_write) = (word(4095), word(3) == [0, 0]);
    let [_, more] = word(7);
    let mut request = Pdu::from_slice(&[if is_write { WRITE_ONE } else { READ }]);
    request.extend(&address);
    if is_write {
        request.extend(&word(0xFFFF));
        return (request, request);
    }
    let count = more + 1;
    request.extend(&[0, count]);
    let mut answer = Pdu::from_slice(&[READ, 2 * count]);
    (0..count).for_each(|_| answer.extend(&word(0xFFFF)));
    (request, answer)
}

/// One to three bytes, which are too few for a frame.
fn noise(rng: &mut Rng) -> Frame {
    let mut noise = Frame::new();
    (0..rng.between(1, 3)).for_each(|_| noise.push(rng.between(0, 0xFF) as u8));
    noise
}
