//! ASCII framing (serial line, 2.5.2.1): `:` begins a frame whatever came before, CR LF ends it.

use super::{Foreign, LineEvent, Units};
use crate::time::{Duration, Instant};
use crate::wire::{Frame, NoiseCause, ascii};

#[derive(Debug)]
pub struct Ascii {
    gap: Duration,
    /// Received and not yet looked at, from `looked` on.
    incoming: Vec<u8>,
    looked: usize,
    /// Characters of the frame behind its `:`, or of the noise.
    body: Vec<u8>,
    inside: bool,
    /// The last `next` gave `body` away.
    given: bool,
    last: Instant,
    decoded: Frame,
}

/// What one character did.
enum AsciiState {
    More,
    Whole,
    Noise(NoiseCause),
}

impl Ascii {
    pub fn new(gap: Duration) -> Self {
        Self {
            gap,
            incoming: Vec::with_capacity(ascii::MAX),
            looked: 0,
            body: Vec::with_capacity(ascii::MAX),
            inside: false,
            given: false,
            last: Instant::ZERO,
            decoded: Frame::new(),
        }
    }

    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.incoming.drain(..std::mem::take(&mut self.looked));
        self.incoming.extend_from_slice(bytes);
        self.last = now;
    }

    pub fn next(&mut self, now: Instant, units: &Units) -> Option<LineEvent<'_>> {
        if std::mem::take(&mut self.given) {
            self.body.clear();
        }
        while let Some(&byte) = self.incoming.get(self.looked) {
            match self.step(byte) {
                AsciiState::More => {}
                AsciiState::Whole => return Some(self.whole(units)),
                AsciiState::Noise(why) => return Some(self.noise(why)),
            }
        }
        let silent = self.deadline().is_some_and(|deadline| deadline <= now);
        if !silent {
            return None;
        }
        let why = if std::mem::take(&mut self.inside) {
            NoiseCause::Unfinished
        } else {
            NoiseCause::OutsideFrame
        };
        Some(self.noise(why))
    }

    pub fn deadline(&self) -> Option<Instant> {
        let waiting = !self.given && (self.inside || !self.body.is_empty());
        waiting.then(|| self.last + self.gap)
    }

    pub fn received_at(&self) -> Instant {
        self.last
    }

    /// Looks at one character; leaves it where it is if what came before must be told first.
    fn step(&mut self, byte: u8) -> AsciiState {
        if byte == b':' && !self.body.is_empty() {
            let why = if std::mem::take(&mut self.inside) {
                NoiseCause::Unfinished
            } else {
                NoiseCause::OutsideFrame
            };
            return AsciiState::Noise(why);
        }
        self.looked += 1;
        match byte {
            b':' => self.inside = true,
            b'\n' if self.inside && self.body.last() == Some(&b'\r') => {
                self.body.pop();
                self.inside = false;
                return AsciiState::Whole;
            }
            // The line ends of a frame that was not: silent, or every answer would be followed by noise.
            b'\r' | b'\n' if !self.inside && self.body.is_empty() => {}
            byte => self.body.push(byte),
        }
        if self.body.len() >= ascii::MAX {
            self.inside = false;
            return AsciiState::Noise(NoiseCause::TooLong);
        }
        AsciiState::More
    }

    fn whole(&mut self, units: &Units) -> LineEvent<'_> {
        self.given = true;
        match ascii::decode(&self.body, &mut self.decoded) {
            Err(why) => LineEvent::BadAscii { bytes: &self.body, why },
            Ok(adu) if units.has(adu.unit) => LineEvent::Request(adu),
            // Colons leave no doubt where a frame begins, so it does not matter who sent it.
            Ok(adu) => LineEvent::Foreign(Foreign::Request(adu)),
        }
    }

    fn noise(&mut self, why: NoiseCause) -> LineEvent<'_> {
        self.given = true;
        LineEvent::Noise { bytes: &self.body, len: self.body.len(), why }
    }
}
