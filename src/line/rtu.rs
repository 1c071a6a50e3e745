//! RTU framing (serial line, 2.5.1.1): silence ends a frame; a patient line closes it earlier.
//!
//! Early closing needs two witnesses, length and CRC. A frame with a broken CRC, an unknown function or
//! a length that lies has only silence to end it, so whatever comes in the same breath goes down with it.

use super::follow::Follower;
use super::{Heard, Units};
use crate::time::{Duration, Instant};
use crate::wire::NoiseCause;
use crate::wire::rtu::{self, MAX, MIN};

/// After this much silence nobody waits for an answer any more: what comes is a request, perhaps once again.
const ANSWERS_WITHIN: Duration = Duration::from_millis(500);

/// Room for one frame and a little of what runs over.
const BUFFER: usize = 2 * MAX;

#[derive(Debug)]
pub struct Rtu {
    gap: Duration,
    patient: bool,
    bytes: Vec<u8>,
    /// Bytes at the front that the last [`Rtu::next`] gave away.
    taken: usize,
    /// Bytes that found no room: the frame is too long anyway.
    spilt: usize,
    last: Instant,
    follower: Follower,
}

/// Where a frame in the buffer ends and what it is.
struct End {
    len: usize,
    silent: bool,
}

impl Rtu {
    pub fn new(gap: Duration, patient: bool) -> Self {
        let bytes = Vec::with_capacity(BUFFER);
        let follower = Follower::default();
        Self { gap, patient, bytes, taken: 0, spilt: 0, last: Instant::ZERO, follower }
    }

    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.discard_taken();
        if now.since(self.last) > ANSWERS_WITHIN {
            self.follower.forget();
        }
        let room = BUFFER - self.bytes.len();
        let (fits, over) = bytes.split_at(bytes.len().min(room));
        self.bytes.extend_from_slice(fits);
        self.spilt += over.len();
        self.last = now;
    }

    pub fn next(&mut self, now: Instant, units: &Units) -> Option<Heard<'_>> {
        self.discard_taken();
        let silent = self.deadline().is_some_and(|deadline| deadline <= now);
        let end = match self.early_end(units) {
            Some(len) => End { len, silent: false },
            None if silent => End { len: self.bytes.len(), silent: true },
            None => return None,
        };
        self.taken = end.len;
        let spilt = if end.silent { std::mem::take(&mut self.spilt) } else { 0 };
        let bytes = &self.bytes[..end.len];
        let noise = |why| Some(Heard::Noise { bytes, len: bytes.len() + spilt, why });
        if bytes.len() < MIN {
            return noise(NoiseCause::TooShort);
        }
        if bytes.len() + spilt > MAX {
            return noise(NoiseCause::TooLong);
        }
        match rtu::decode(bytes) {
            Err(crc) => Some(Heard::BadCrc { bytes, crc }),
            Ok(adu) if units.has(adu.unit) => {
                self.follower.forget();
                Some(Heard::Request(adu))
            }
            Ok(adu) => Some(Heard::Foreign(self.follower.follow(bytes, adu))),
        }
    }

    pub fn deadline(&self) -> Option<Instant> {
        (self.bytes.len() > self.taken).then(|| self.last + self.gap)
    }

    pub fn heard_at(&self) -> Instant {
        self.last
    }

    /// Length of the frame at the front, if length and CRC both say that it is whole.
    fn early_end(&self, units: &Units) -> Option<usize> {
        if !self.patient {
            return None;
        }
        let ours = units.has(*self.bytes.first()?);
        let len = match ours {
            true => rtu::request_len(&self.bytes)?,
            false => self.follower.frame_len(&self.bytes)?,
        };
        let frame = self.bytes.get(..len).filter(|_| len <= MAX)?;
        rtu::decode(frame).is_ok().then_some(len)
    }

    fn discard_taken(&mut self) {
        self.bytes.drain(..std::mem::take(&mut self.taken));
    }
}
