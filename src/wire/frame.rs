//! Bytes of frames and PDUs, the checksums that end a frame, and what a frame says.

use super::PDU_MAX;
use crc::{CRC_16_MODBUS, Crc, Table};
use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::{Deref, DerefMut};

/// Up to `N` bytes, held in place: an answer costs no allocation.
#[derive(Clone, Copy)]
pub struct Inline<const N: usize> {
    len: u16,
    bytes: [u8; N],
}

/// The bytes of one frame on a line. The longest of all framings is ASCII: `:`, 2 × (1 + 253 + 1) digits, CR LF.
pub type Frame = Inline<513>;

/// Function code and data.
pub type Pdu = Inline<PDU_MAX>;

impl<const N: usize> Inline<N> {
    /// No bytes yet.
    pub const fn new() -> Self {
        Self { len: 0, bytes: [0; N] }
    }

    /// The first bytes of `bytes`, as many as fit.
    pub fn from_slice(bytes: &[u8]) -> Self {
        let mut inline = Self::new();
        inline.extend(&bytes[..bytes.len().min(N)]);
        inline
    }

    /// Cuts off what stands behind the first `len` bytes.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len as u16);
    }

    /// Appends `byte`. Frames and PDUs are sized for the longest there is, so running over is a bug.
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

impl<const N: usize> Default for Inline<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Deref for Inline<N> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..usize::from(self.len)]
    }
}

impl<const N: usize> DerefMut for Inline<N> {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut self.bytes[..usize::from(self.len)]
    }
}

impl<const N: usize> PartialEq for Inline<N> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<const N: usize> Eq for Inline<N> {}

impl<const N: usize> fmt::Debug for Inline<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, byte) in self.iter().enumerate() {
            write!(f, "{}{byte:02X}", if i == 0 { "" } else { " " })?;
        }
        Ok(())
    }
}

/// In hex, with spaces.
impl<const N: usize> Serialize for Inline<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{self:?}"))
    }
}

#[cfg(feature = "cli")]
impl<const N: usize> schemars::JsonSchema for Inline<N> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Hex".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "string", "pattern": "^([0-9A-F]{2}( [0-9A-F]{2})*)?$" })
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
    /// Sent at so many bits per second, which is not the speed of the line.
    Speed(u32),
    /// A `:` inside a frame began a new one, or the next character never came.
    Unfinished,
}

impl fmt::Display for NoiseCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort => f.write_str("too short for a frame"),
            Self::TooLong => f.write_str("too long for a frame"),
            Self::OutsideFrame => f.write_str("outside a frame"),
            Self::Speed(baud) => write!(f, "sent at {baud} baud"),
            Self::Unfinished => f.write_str("incomplete frame"),
        }
    }
}

const CRC16: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_MODBUS);

/// CRC-16 of RTU frames (serial line, 6.2.2). It travels low byte first.
pub fn crc16(bytes: &[u8]) -> u16 {
    CRC16.checksum(bytes)
}

/// The lengths at which the last two bytes of the beginning of `bytes` are the CRC of what stands before them.
pub(super) fn crc_fits(bytes: &[u8]) -> impl Iterator<Item = usize> {
    let mut digest = CRC16.digest();
    // Over its own CRC this CRC is 0.
    let residues = bytes.iter().map(move |byte| {
        digest.update(&[*byte]);
        digest.clone().finalize()
    });
    residues.enumerate().filter(|(_, residue)| *residue == 0).map(|(i, _)| i + 1)
}

/// LRC of ASCII frames (serial line, 6.2.1): two's complement of the sum of the bytes.
pub fn lrc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // Printed in two manuals of the field and in the serial line specification's own example.
        assert_eq!(crc16(&[0x01, 0x03, 0x15, 0x07, 0x00, 0x02]).to_le_bytes(), [0x71, 0xC6]);
        assert_eq!(crc16(&[0x02, 0x07]), 0x1241);
        assert_eq!(lrc(&[0x01, 0x03, 0x02, 0x01, 0x00, 0x01]), 0xF8);
    }
}
