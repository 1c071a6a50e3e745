//! ASCII frames: `:`, two hex digits a byte, LRC, CR LF (serial line, 2.5.2).
//!
//! Sends capitals; takes small letters too, as many masters send them.

use super::{Adu, Frame, lrc};
use std::fmt;

/// Longest frame: `:`, 255 bytes as digits, CR LF.
pub const MAX: usize = 513;

/// Why the characters between `:` and CR LF are no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BadAscii {
    /// Something that is no hex digit, at this position behind the `:`.
    NotHex(usize),
    /// An odd number of digits, or too few.
    Length(usize),
    /// The LRC does not fit.
    Lrc {
        /// In the frame.
        got: u8,
        /// Of its bytes.
        want: u8,
    },
}

impl fmt::Display for BadAscii {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotHex(at) => write!(f, "character {} is not a hex digit", at + 1),
            Self::Length(len) => {
                write!(f, "{len} characters, expected an even number of at least 6")
            }
            Self::Lrc { got, want } => write!(f, "LRC {got:02X}, expected {want:02X}"),
        }
    }
}

/// Frames `pdu`.
pub fn encode(unit: u8, pdu: &[u8]) -> Frame {
    let mut body = Frame::new();
    body.push(unit);
    body.extend(pdu);
    body.push(lrc(&body));
    let mut frame = Frame::new();
    frame.push(b':');
    for byte in body.iter() {
        frame.extend(&[digit(byte >> 4), digit(byte & 0x0F)]);
    }
    frame.extend(b"\r\n");
    frame
}

/// Reads the characters between `:` and CR LF into `into` and checks the LRC.
pub fn decode<'a>(characters: &[u8], into: &'a mut Frame) -> Result<Adu<'a>, BadAscii> {
    // Unit, function and LRC at least.
    if !characters.len().is_multiple_of(2) || characters.len() < 6 {
        return Err(BadAscii::Length(characters.len()));
    }
    *into = Frame::new();
    for (i, pair) in characters.chunks_exact(2).enumerate() {
        let high = value(pair[0]).ok_or(BadAscii::NotHex(2 * i))?;
        let low = value(pair[1]).ok_or(BadAscii::NotHex(2 * i + 1))?;
        into.push(high << 4 | low);
    }
    let (&got, body) = into.split_last().ok_or(BadAscii::Length(0))?;
    let want = lrc(body);
    if got == want {
        Ok(Adu { unit: body[0], pdu: &body[1..] })
    } else {
        Err(BadAscii::Lrc { got, want })
    }
}

fn digit(nibble: u8) -> u8 {
    b"0123456789ABCDEF"[usize::from(nibble)]
}

fn value(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|value| value as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let frame = encode(1, &[3, 2, 1, 0, 1]);
        assert_eq!(&*frame, b":010302010001F8\r\n");
        let mut buffer = Frame::new();
        assert_eq!(decode(b"010302010001f8", &mut buffer).map(|adu| adu.unit), Ok(1));
    }

    #[test]
    fn what_is_wrong() {
        let mut buffer = Frame::new();
        assert_eq!(decode(b"01030", &mut buffer), Err(BadAscii::Length(5)));
        assert_eq!(decode(b"0103", &mut buffer), Err(BadAscii::Length(4)));
        assert_eq!(decode(b"01X3FC", &mut buffer), Err(BadAscii::NotHex(2)));
        assert_eq!(decode(b"0103FD", &mut buffer), Err(BadAscii::Lrc { got: 0xFD, want: 0xFC }));
    }
}
