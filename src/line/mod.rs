//! From bytes to frames: where one ends, whose it is, and what is only noise.
//!
//! A [`Line`] is one byte stream with its framing. It knows time and lengths and nothing of what a
//! request means. RTU has two ways to end a frame (serial line, 2.5.1.1): a strict line does so after a
//! silence of t3.5 and not before; a patient one as soon as length and CRC agree, after t3.5 where at least
//! the CRC fits, and else only after a longer silence. Patient is for ports, where schedulers and USB
//! adapters stretch a pause inside a frame to many times t3.5.

mod ascii;
mod follow;
mod mbap;
mod rtu;

pub use follow::Foreign;

use crate::time::{Duration, Instant};
use crate::wire::ascii::BadAscii;
use crate::wire::mbap::BadHeader;
use crate::wire::rtu::BadCrc;
use crate::wire::{Adu, Coding, Frame, NoiseCause};

/// How frames are told apart on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// Binary frames that end by silence, with a CRC.
    Rtu {
        /// Silence that ends a frame, t3.5; on a patient line only one whose CRC fits.
        silence: Duration,
        /// A patient line: silence that ends anything. `None` makes it a strict one.
        patience: Option<Duration>,
    },
    /// ASCII. `gap` is the longest pause between two characters of a frame; the standard says 1 s.
    Ascii {
        /// Longest pause inside a frame.
        gap: Duration,
    },
    /// Modbus TCP.
    Mbap,
}

/// What a line made of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineEvent<'a> {
    /// A good frame for one of our units, or broadcast.
    Request(Adu<'a>),
    /// A good frame between a master and another unit.
    Foreign(Foreign<'a>),
    /// A frame whose CRC does not fit, as long as one can be.
    BadCrc {
        /// The bytes, CRC included.
        bytes: &'a [u8],
        /// Both values.
        crc: BadCrc,
    },
    /// An ASCII frame that does not add up.
    BadAscii {
        /// The characters between `:` and CR LF.
        bytes: &'a [u8],
        /// Why it is not a valid frame.
        why: BadAscii,
    },
    /// Bytes that can be no frame.
    Noise {
        /// The first of them.
        bytes: &'a [u8],
        /// How many there were.
        len: usize,
        /// Why they are none.
        why: NoiseCause,
    },
    /// A TCP stream that can't be followed; its connection must end.
    Lost(BadHeader),
}

/// Which unit addresses are ours on a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units([bool; 256]);

impl Units {
    /// None but broadcast.
    pub fn new() -> Self {
        let mut units = [false; 256];
        units[usize::from(crate::wire::BROADCAST)] = true;
        Self(units)
    }

    /// Makes `unit` one of ours.
    pub fn insert(&mut self, unit: u8) {
        self.0[usize::from(unit)] = true;
    }

    /// Is `unit` one of ours, or broadcast?
    pub fn has(&self, unit: u8) -> bool {
        self.0[usize::from(unit)]
    }
}

impl Default for Units {
    fn default() -> Self {
        Self::new()
    }
}

/// One byte stream and its framing.
#[derive(Debug)]
pub struct Line {
    framer: Framer,
}

#[derive(Debug)]
enum Framer {
    Rtu(rtu::Rtu),
    Ascii(ascii::Ascii),
    Mbap(mbap::Mbap),
}

impl Line {
    /// A silent line.
    pub fn new(framing: Framing) -> Self {
        let framer = match framing {
            Framing::Rtu { silence, patience } => Framer::Rtu(rtu::Rtu::new(silence, patience)),
            Framing::Ascii { gap } => Framer::Ascii(ascii::Ascii::new(gap)),
            Framing::Mbap => Framer::Mbap(mbap::Mbap::new()),
        };
        Self { framer }
    }

    /// Takes bytes that arrived at `now`. Call [`Line::next`] until it gives nothing before more time
    /// passes or more bytes come.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        match &mut self.framer {
            Framer::Rtu(rtu) => rtu.receive(now, bytes),
            Framer::Ascii(ascii) => ascii.receive(now, bytes),
            Framer::Mbap(mbap) => mbap.receive(bytes),
        }
    }

    /// The next thing heard, given that it is `now` and that `units` are ours.
    pub fn next(&mut self, now: Instant, units: &Units) -> Option<LineEvent<'_>> {
        match &mut self.framer {
            Framer::Rtu(rtu) => rtu.next(now, units),
            Framer::Ascii(ascii) => ascii.next(now, units),
            Framer::Mbap(mbap) => mbap.next(units),
        }
    }

    /// When silence will end a frame.
    pub fn deadline(&self) -> Option<Instant> {
        match &self.framer {
            Framer::Rtu(rtu) => rtu.deadline(),
            Framer::Ascii(ascii) => ascii.deadline(),
            Framer::Mbap(_) => None,
        }
    }

    /// Is what was received so far a whole frame that only waits for silence? What comes next is another one.
    pub fn waits_for_silence_only(&self) -> bool {
        matches!(&self.framer, Framer::Rtu(rtu) if rtu.waits_for_silence_only())
    }

    /// When bytes came last, where time counts.
    pub fn received_at(&self) -> Instant {
        match &self.framer {
            Framer::Rtu(rtu) => rtu.received_at(),
            Framer::Ascii(ascii) => ascii.received_at(),
            Framer::Mbap(_) => Instant::ZERO,
        }
    }

    /// How its frames are coded.
    pub fn coding(&self) -> Coding {
        match &self.framer {
            Framer::Rtu(_) => Coding::Rtu,
            Framer::Ascii(_) => Coding::Ascii,
            Framer::Mbap(_) => Coding::Mbap,
        }
    }

    /// Frames an answer of `unit` to the request heard last.
    pub fn frame(&self, unit: u8, pdu: &[u8]) -> Frame {
        match &self.framer {
            Framer::Rtu(_) => crate::wire::rtu::encode(unit, pdu),
            Framer::Ascii(_) => crate::wire::ascii::encode(unit, pdu),
            Framer::Mbap(mbap) => crate::wire::mbap::encode(mbap.transaction(), unit, pdu),
        }
    }
}
