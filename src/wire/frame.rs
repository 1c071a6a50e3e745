//! Bytes of one frame, held in place: an answer costs no allocation.

use std::fmt;
use std::ops::Deref;

/// Longest frame of all framings: ASCII, `:` + 2 × (1 + 253 + 1) digits + CR LF.
const FRAME_MAX: usize = 513;

/// The bytes of one frame on a line.
#[derive(Clone, Copy)]
pub struct Frame {
    len: u16,
    bytes: [u8; FRAME_MAX],
}

impl Frame {
    /// No bytes yet.
    pub const fn new() -> Self {
        Self { len: 0, bytes: [0; FRAME_MAX] }
    }

    /// The first bytes of `bytes`, as many as a frame holds.
    pub fn from_slice(bytes: &[u8]) -> Self {
        let mut frame = Self::new();
        frame.extend(&bytes[..bytes.len().min(FRAME_MAX)]);
        frame
    }

    /// Appends `byte`. A frame is sized for the longest PDU, so running over is a bug.
    pub fn push(&mut self, byte: u8) {
        self.bytes[usize::from(self.len)] = byte;
        self.len += 1;
    }

    /// Appends `bytes`.
    pub fn extend(&mut self, bytes: &[u8]) {
        let start = usize::from(self.len);
        self.bytes[start..start + bytes.len()].copy_from_slice(bytes);
        self.len += bytes.len() as u16;
    }
}

impl Default for Frame {
    fn default() -> Self {
        Self::new()
    }
}

impl Deref for Frame {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..usize::from(self.len)]
    }
}

impl PartialEq for Frame {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl Eq for Frame {}

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, byte) in self.iter().enumerate() {
            write!(f, "{}{byte:02X}", if i == 0 { "" } else { " " })?;
        }
        Ok(())
    }
}

/// What a frame says once framing and checksum are off: who, and what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Adu<'a> {
    /// Unit address; 0 is broadcast.
    pub unit: u8,
    /// Function code and data, 1 to 253 bytes.
    pub pdu: &'a [u8],
}

impl Adu<'_> {
    /// The function code, with the exception bit if it is set.
    pub fn function(&self) -> u8 {
        self.pdu.first().copied().unwrap_or(0)
    }
}

/// Why bytes are no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseCause {
    /// Fewer than a frame has.
    TooShort,
    /// More than a frame can have.
    TooLong,
    /// Not between `:` and CR LF.
    OutsideFrame,
    /// A `:` inside a frame began a new one, or the next character never came.
    Unfinished,
}
