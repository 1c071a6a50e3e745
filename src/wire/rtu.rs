//! RTU frames: unit, PDU, CRC low byte first (serial line, 2.5.1), and how long each kind is.
//!
//! Lengths are facts of the protocol. Whether a frame has ended is decided in `line`.

use super::frame::crc_fits;
use super::function::EXCEPTION;
use super::{Adu, Frame, crc16};

/// Shortest frame: unit, function, CRC.
pub const MIN: usize = 4;
/// Longest frame: unit, PDU, CRC.
pub const MAX: usize = 256;

/// A frame whose CRC does not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BadCrc {
    /// The CRC in the frame.
    pub got: u16,
    /// The CRC of its bytes.
    pub want: u16,
}

/// Frames `pdu`.
pub fn encode(unit: u8, pdu: &[u8]) -> Frame {
    let mut frame = Frame::new();
    frame.push(unit);
    frame.extend(pdu);
    frame.extend(&crc16(&frame).to_le_bytes());
    frame
}

/// Checks the CRC of `bytes`, which must be at least [`MIN`] long.
pub fn decode(bytes: &[u8]) -> Result<Adu<'_>, BadCrc> {
    let (body, crc) = bytes.split_at(bytes.len() - 2);
    let got = u16::from_le_bytes([crc[0], crc[1]]);
    let want = crc16(body);
    if got == want { Ok(Adu { unit: body[0], pdu: &body[1..] }) } else { Err(BadCrc { got, want }) }
}

/// Where a frame that begins with `bytes` could end: the lengths, shortest first, at which its CRC fits.
pub fn ends(bytes: &[u8]) -> impl Iterator<Item = usize> {
    crc_fits(bytes).filter(|len| (MIN..=MAX).contains(len))
}

/// Length of the request that begins with `bytes`, if its function tells and enough of it is there.
pub fn request_len(bytes: &[u8]) -> Option<usize> {
    match *bytes.get(1)? {
        0x01..=0x06 => Some(8),
        0x07 | 0x0B | 0x0C | 0x11 => Some(4),
        0x0F | 0x10 => Some(9 + usize::from(*bytes.get(6)?)),
        0x16 => Some(10),
        0x17 => Some(13 + usize::from(*bytes.get(10)?)),
        _ => None,
    }
}

/// Length of the answer that begins with `bytes`, if its function tells and enough of it is there.
pub fn response_len(bytes: &[u8]) -> Option<usize> {
    match *bytes.get(1)? {
        function if function & EXCEPTION != 0 => Some(5),
        0x01..=0x04 | 0x0C | 0x11 | 0x17 => Some(5 + usize::from(*bytes.get(2)?)),
        0x05 | 0x06 | 0x0B | 0x0F | 0x10 => Some(8),
        0x07 => Some(5),
        0x16 => Some(10),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let frame = encode(1, &[3, 0x15, 7, 0, 2]);
        assert_eq!(format!("{frame:?}"), "01 03 15 07 00 02 71 C6");
        assert_eq!(decode(&frame), Ok(Adu { unit: 1, pdu: &[3, 0x15, 7, 0, 2] }));
        assert_eq!(decode(&[1, 3, 0, 0]), Err(BadCrc { got: 0, want: 0x2140 }));
    }

    #[test]
    fn a_frame_may_end_where_its_crc_fits() {
        let two = [&*encode(9, &[8, 0, 0, 1, 2]), &*encode(1, &[3, 0, 0, 0, 1])].concat();
        assert_eq!(ends(&two).collect::<Vec<_>>(), [8]);
        assert_eq!(ends(&two[..7]).next(), None);
        assert_eq!(ends(&two[8..]).collect::<Vec<_>>(), [8]);
    }

    #[test]
    fn lengths() {
        assert_eq!(request_len(&[1, 0x10, 0, 0, 0, 2, 4]), Some(13));
        assert_eq!(request_len(&[1, 0x10, 0, 0, 0, 2]), None);
        assert_eq!(request_len(&[1, 0x2B]), None);
        assert_eq!(response_len(&[1, 0x83]), Some(5));
        assert_eq!(response_len(&[1, 0x03, 4]), Some(9));
    }
}
