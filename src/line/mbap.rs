//! MBAP framing: the length field says all. A stream that lies is lost, since nothing marks a beginning.

use super::{Foreign, LineEvent, Units};
use crate::wire::mbap::{self, BadHeader};

#[derive(Debug, Default)]
pub struct Mbap {
    bytes: Vec<u8>,
    taken: usize,
    transaction: u16,
    lost: Option<BadHeader>,
}

impl Mbap {
    pub fn new() -> Self {
        Self { bytes: Vec::with_capacity(2 * mbap::MAX), ..Self::default() }
    }

    /// The transaction identifier of the frame heard last.
    pub fn transaction(&self) -> u16 {
        self.transaction
    }

    pub fn receive(&mut self, bytes: &[u8]) {
        self.discard_taken();
        if self.lost.is_none() {
            self.bytes.extend_from_slice(bytes);
        }
    }

    pub fn next(&mut self, units: &Units) -> Option<LineEvent<'_>> {
        self.discard_taken();
        if self.lost.is_some() {
            return None;
        }
        let len = match mbap::frame_len(&self.bytes) {
            Ok(len) => len?,
            Err(why) => {
                self.lost = Some(why);
                self.bytes.clear();
                return Some(LineEvent::Lost(why));
            }
        };
        let frame = self.bytes.get(..len)?;
        self.taken = len;
        let (transaction, adu) = mbap::decode(frame);
        self.transaction = transaction;
        Some(if units.has(adu.unit) {
            LineEvent::Request(adu)
        } else {
            LineEvent::Foreign(Foreign::Request(adu))
        })
    }

    fn discard_taken(&mut self) {
        self.bytes.drain(..std::mem::take(&mut self.taken));
    }
}
