//! MBAP frames: Modbus on TCP (messaging on TCP/IP, 3.1.3). The length field ends a frame, no timer.

use super::{Adu, Frame, PDU_MAX};
use std::fmt;

/// Bytes before the PDU: transaction, protocol, length, unit.
pub const HEADER: usize = 7;
/// Longest frame.
pub const MAX: usize = HEADER + PDU_MAX;

/// A header that can't be followed: the stream is lost and the connection must end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BadHeader {
    /// A protocol identifier other than 0.
    Protocol(u16),
    /// A length field outside 2..254.
    Length(u16),
}

impl fmt::Display for BadHeader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Protocol(id) => write!(
                f,
                "protocol identifier {id} is not Modbus; is the master using serial framing?"
            ),
            Self::Length(len) => write!(f, "length {len} is out of range"),
        }
    }
}

/// Frames `pdu` as the answer to `transaction`.
pub fn encode(transaction: u16, unit: u8, pdu: &[u8]) -> Frame {
    let mut frame = Frame::new();
    frame.extend(&transaction.to_be_bytes());
    frame.extend(&[0, 0]);
    frame.extend(&(pdu.len() as u16 + 1).to_be_bytes());
    frame.push(unit);
    frame.extend(pdu);
    frame
}

/// Length of the frame that begins with `bytes`, once enough of the header is there.
pub fn frame_len(bytes: &[u8]) -> Result<Option<usize>, BadHeader> {
    if let Some(&[high, low]) = bytes.get(2..4) {
        let protocol = u16::from_be_bytes([high, low]);
        if protocol != 0 {
            return Err(BadHeader::Protocol(protocol));
        }
    }
    let Some(&[high, low]) = bytes.get(4..6) else { return Ok(None) };
    // Unit and function code at least.
    match u16::from_be_bytes([high, low]) {
        length @ 2..=254 => Ok(Some(6 + usize::from(length))),
        length => Err(BadHeader::Length(length)),
    }
}

/// Takes a whole frame apart: transaction and content. `bytes` are as long as [`frame_len`] said.
pub fn decode(bytes: &[u8]) -> (u16, Adu<'_>) {
    let transaction = u16::from_be_bytes([bytes[0], bytes[1]]);
    (transaction, Adu { unit: bytes[6], pdu: &bytes[HEADER..] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let frame = encode(0x1234, 7, &[6, 0, 1, 0, 2]);
        assert_eq!(frame_len(&frame), Ok(Some(frame.len())));
        let (transaction, adu) = decode(&frame);
        assert_eq!((transaction, adu.unit, adu.pdu), (0x1234, 7, &[6, 0, 1, 0, 2][..]));
    }

    #[test]
    fn lost_streams() {
        assert_eq!(frame_len(&[0, 1, 0, 9]), Err(BadHeader::Protocol(9)));
        assert_eq!(frame_len(&[0, 1, 0, 0, 0, 1]), Err(BadHeader::Length(1)));
        assert_eq!(frame_len(&[0, 1, 0, 0, 1, 0]), Err(BadHeader::Length(256)));
        assert_eq!(frame_len(&[0, 1, 0, 0, 0]), Ok(None));
    }
}
