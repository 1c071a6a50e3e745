//! RTU framing (serial line, 2.5.1.1): silence ends a frame; a patient line closes it earlier.
//!
//! Early closing needs two witnesses: the CRC, and with it the length that the function tells, or a silence of t3.5,
//! or a good frame of known length that follows. A frame with a broken CRC has only the longer silence of a patient
//! line to end it, so whatever arrives before that is lost with it.

use super::follow::Follower;
use super::{LineEvent, Units};
use crate::time::{Duration, Instant};
use crate::wire::NoiseCause;
use crate::wire::rtu::{self, MAX, MIN};

/// After this much silence no reply is expected any more: what comes is a request, possibly a repeated one.
const ANSWERS_WITHIN: Duration = Duration::from_millis(500);

/// Room for one frame and a little of what runs over.
const BUFFER: usize = 2 * MAX;

#[derive(Debug)]
pub struct Rtu {
    silence: Duration,
    patience: Option<Duration>,
    bytes: Vec<u8>,
    /// Bytes at the front that the last [`Rtu::next`] gave away.
    taken: usize,
    /// Bytes that found no room: the frame is too long anyway.
    spilt: usize,
    /// The buffer could be one frame: its CRC fits, and nothing says that more is to come.
    whole: bool,
    last: Instant,
    follower: Follower,
}

/// Where a frame in the buffer ends and what it is.
struct End {
    len: usize,
    silent: bool,
}

impl Rtu {
    /// `silence` ends a frame; with `patience` it does so only where the CRC fits, and that longer silence ends the rest.
    pub fn new(silence: Duration, patience: Option<Duration>) -> Self {
        let bytes = Vec::with_capacity(BUFFER);
        let (last, follower) = (Instant::ZERO, Follower::default());
        Self { silence, patience, bytes, taken: 0, spilt: 0, whole: false, last, follower }
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
        self.whole = false;
        self.last = now;
    }

    pub fn next(&mut self, now: Instant, units: &Units) -> Option<LineEvent<'_>> {
        self.discard_taken();
        let early = self.early_end(units);
        self.whole = early.is_none() && self.is_whole(units);
        let silent = self.deadline().is_some_and(|deadline| deadline <= now);
        let end = match early {
            Some(len) => End { len, silent: false },
            None if silent => End { len: self.bytes.len(), silent: true },
            None => return None,
        };
        self.taken = end.len;
        let spilt = if end.silent { std::mem::take(&mut self.spilt) } else { 0 };
        let bytes = &self.bytes[..end.len];
        let noise = |why| Some(LineEvent::Noise { bytes, len: bytes.len() + spilt, why });
        if bytes.len() < MIN {
            return noise(NoiseCause::TooShort);
        }
        if bytes.len() + spilt > MAX {
            return noise(NoiseCause::TooLong);
        }
        match rtu::decode(bytes) {
            Err(crc) => Some(LineEvent::BadCrc { bytes, crc }),
            Ok(adu) if units.has(adu.unit) => {
                self.follower.forget();
                Some(LineEvent::Request(adu))
            }
            Ok(adu) => Some(LineEvent::Foreign(self.follower.follow(bytes, adu))),
        }
    }

    pub fn deadline(&self) -> Option<Instant> {
        let silence = match self.patience {
            Some(patience) if !self.whole => patience,
            _ => self.silence,
        };
        (self.bytes.len() > self.taken).then(|| self.last + silence)
    }

    /// Is what was received so far a whole frame that only waits for silence?
    pub fn waits_for_silence_only(&self) -> bool {
        self.whole
    }

    pub fn received_at(&self) -> Instant {
        self.last
    }

    /// Length of the frame at the front, if its end is beyond doubt before any silence.
    fn early_end(&self, units: &Units) -> Option<usize> {
        self.patience?;
        match self.told_len(units) {
            Some(len) if self.bytes.len() < len && len <= MAX => None,
            Some(len) if is_good(&self.bytes, len) => Some(len),
            _ => seam(&self.bytes),
        }
    }

    /// Could the buffer be one frame, as far as CRC and length say?
    fn is_whole(&self, units: &Units) -> bool {
        let ours = self.bytes.first().is_some_and(|unit| units.has(*unit));
        // Of an answer that was asked for the length is known, and it is not there yet.
        let awaited = if ours { None } else { self.follower.answer_len(&self.bytes) };
        self.spilt == 0
            && awaited.is_none_or(|len| len <= self.bytes.len())
            && is_good(&self.bytes, self.bytes.len())
    }

    /// Length of the frame at the front, if its function tells it.
    fn told_len(&self, units: &Units) -> Option<usize> {
        if units.has(*self.bytes.first()?) {
            rtu::request_len(&self.bytes)
        } else {
            self.follower.frame_len(&self.bytes)
        }
    }

    fn discard_taken(&mut self) {
        self.bytes.drain(..std::mem::take(&mut self.taken));
    }
}

/// Are the first `len` of `bytes` there, and a frame whose CRC fits?
fn is_good(bytes: &[u8], len: usize) -> bool {
    let frame = bytes.get(..len).filter(|_| (MIN..=MAX).contains(&len));
    frame.is_some_and(|frame| rtu::decode(frame).is_ok())
}

/// Where the frame at the front ends though its function does not tell: its CRC fits, and behind it begins a good
/// frame of known length, perhaps after further ones like it.
fn seam(bytes: &[u8]) -> Option<usize> {
    rtu::ends(bytes).find(|len| {
        let mut rest = &bytes[*len..];
        loop {
            if rtu::request_len(rest).is_some_and(|len| is_good(rest, len)) {
                return true;
            }
            match rtu::ends(rest).next() {
                Some(len) => rest = &rest[len..],
                None => return false,
            }
        }
    })
}
