//! A reply with some of its bits flipped.

use super::*;
use crate::wire::{Coding, Frame};
use std::collections::BTreeSet;

/// Bytes of an MBAP frame before its unit: a stream where these are wrong can't be followed.
const MBAP_HEAD: usize = 6;

/// Flips bits, each once, at places that are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct FlipBits {
    bits: u8,
}

impl Fault for FlipBits {
    const NAME: &'static str = "flip_bits";
    const ABOUT: &'static str = "Some bits of the reply are flipped.";
    // The shortest reply has 24 bits that may be flipped, on TCP.
    const KEYS: &'static [FaultKey] = &[FaultKey::number("bits", "how many; default 1", 1, 16)];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { bits: keys.number("bits").unwrap_or(1) })
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let mut frame = reply.frame();
        flip(&mut frame, self.bits, reply.line.coding(), out.rng());
        out.send(&frame);
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::CHANGED
    }

    fn describe(&self, unit: u8) -> String {
        format!("{} flipped in the reply from unit {unit}", count(self.bits, "bit"))
    }
}

/// Flips `bits` different bits. A character of ASCII framing has seven of them on the line.
fn flip(frame: &mut Frame, bits: u8, coding: Coding, rng: &mut Rng) {
    let (first, width) = match coding {
        Coding::Rtu => (0, 8),
        Coding::Ascii => (0, 7),
        Coding::Mbap => (MBAP_HEAD, 8),
    };
    let count = (frame.len() - first) * width;
    let mut flipped = BTreeSet::new();
    while flipped.len() < usize::from(bits).min(count) {
        flipped.insert(rng.between(0, count as u64 - 1) as usize);
    }
    flipped.iter().for_each(|bit| frame[first + bit / width] ^= 1 << (bit % width));
}
