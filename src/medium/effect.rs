//! Damage to the bytes of a reply.

use super::FaultHit;
use crate::event::FaultEffect;
use crate::rng::Rng;
use crate::time::Instant;
use crate::wire::function::EXCEPTION;
use crate::wire::{Coding, Frame, Pdu};

/// Bytes of an MBAP frame before its unit: a stream where these are wrong can't be followed.
const MBAP_HEAD: usize = 6;

impl FaultHit {
    /// Does no drive see the request?
    pub fn loses_request(&self) -> bool {
        self.effect == FaultEffect::RequestLost
    }

    /// When the reply of a drive has arrived whole, and as one that the master takes for the answer, if it
    /// leaves at `now`. `None` for never: what is late comes when it has been given up.
    pub fn arrives(&self, now: Instant) -> Option<Instant> {
        match self.effect {
            FaultEffect::Delayed(by) => Some(now + by),
            FaultEffect::Split { gap, .. } => Some(now + gap),
            FaultEffect::Extra(_)
            | FaultEffect::Garbage(_)
            | FaultEffect::Duplicated
            | FaultEffect::Exception(_)
            | FaultEffect::Busy
            | FaultEffect::Echoed => Some(now),
            FaultEffect::RequestLost
            | FaultEffect::ReplyLost
            | FaultEffect::BadChecksum
            | FaultEffect::BitsFlipped(_)
            | FaultEffect::Truncated(_)
            | FaultEffect::Late
            | FaultEffect::WrongUnit(_)
            | FaultEffect::WrongFunction(_) => None,
        }
    }

    /// The exception that answers in place of the drive, if one does.
    pub fn exception(&self) -> Option<u8> {
        match self.effect {
            FaultEffect::Exception(code) => Some(code),
            FaultEffect::Busy => Some(0x06),
            _ => None,
        }
    }

    /// The reply as it is framed: who says it, and what.
    pub fn rewrite(&self, unit: u8, answer: Pdu) -> (u8, Pdu) {
        let mut forged = answer;
        match self.effect {
            FaultEffect::WrongUnit(other) => return (other, answer),
            FaultEffect::WrongFunction(other) => {
                let exception = answer.first().copied().unwrap_or(0) & EXCEPTION;
                forged.first_mut().into_iter().for_each(|function| *function = other | exception);
            }
            _ => {}
        }
        (unit, forged)
    }

    /// Damages the framed reply.
    pub fn damage(&mut self, frame: &mut Frame, coding: Coding) {
        match self.effect {
            FaultEffect::BadChecksum => bad_checksum(frame, coding),
            FaultEffect::BitsFlipped(bits) => flip(frame, bits, coding, &mut self.rng),
            FaultEffect::Truncated(bytes) => {
                frame.truncate(frame.len().saturating_sub(bytes.into()).max(1));
            }
            _ => {}
        }
    }

    /// Random bytes.
    pub fn noise(&mut self, bytes: u8) -> Frame {
        let mut noise = Frame::new();
        (0..bytes).for_each(|_| noise.push(self.rng.between(0, 0xFF) as u8));
        noise
    }
}

fn bad_checksum(frame: &mut Frame, coding: Coding) {
    let end = frame.len();
    match coding {
        Coding::Rtu => frame[end - 2..].iter_mut().for_each(|byte| *byte = !*byte),
        // Two digits before CR LF.
        Coding::Ascii => frame[end - 4..end - 2].iter_mut().for_each(|digit| {
            let value = char::from(*digit).to_digit(16).unwrap_or(0);
            let inverted = char::from_digit(15 - value, 16).unwrap_or('0');
            *digit = inverted.to_ascii_uppercase() as u8;
        }),
        Coding::Mbap => {}
    }
}

/// Turns over `bits` different bits. A character of ASCII framing has seven of them on the line.
fn flip(frame: &mut Frame, bits: u8, coding: Coding, rng: &mut Rng) {
    let (first, width) = match coding {
        Coding::Rtu => (0, 8),
        Coding::Ascii => (0, 7),
        Coding::Mbap => (MBAP_HEAD, 8),
    };
    let count = (frame.len() - first) * width;
    let mut turned = std::collections::BTreeSet::new();
    while turned.len() < usize::from(bits).min(count) {
        turned.insert(rng.between(0, count as u64 - 1) as usize);
    }
    turned.iter().for_each(|bit| frame[first + bit / width] ^= 1 << (bit % width));
}
