//! Modbus on paper: frames, requests, answers. No time, no registers, no models.
//!
//! Application protocol: "MODBUS Application Protocol Specification V1.1b3". Frames: "MODBUS over
//! Serial Line V1.02" (RTU 2.5.1, ASCII 2.5.2) and "MODBUS Messaging on TCP/IP V1.0b" (MBAP).

pub mod ascii;
mod frame;
pub mod hex;
pub mod mbap;
mod pdu;
pub mod rtu;

pub use frame::{Adu, Frame, Inline, NoiseCause, Pdu, crc16, lrc};
pub use pdu::{Exception, LengthCheck, Malformed, Masks, Request, Response, Span, Words};

/// Function codes.
pub mod function {
    /// Read Holding Registers.
    pub const READ: u8 = 0x03;
    /// Write Single Register.
    pub const WRITE_ONE: u8 = 0x06;
    /// Write Multiple Registers.
    pub const WRITE_MANY: u8 = 0x10;
    /// Mask Write Register.
    pub const MASK_WRITE: u8 = 0x16;
    /// Those that a drive can support.
    pub const ALL: [u8; 4] = [READ, WRITE_ONE, WRITE_MANY, MASK_WRITE];
    /// Those of them that write registers.
    pub const WRITES: [u8; 3] = [WRITE_ONE, WRITE_MANY, MASK_WRITE];
    /// Set in the function code of an exception.
    pub const EXCEPTION: u8 = 0x80;
}

/// How frames are coded on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coding {
    /// Bytes with a CRC.
    Rtu,
    /// Characters with an LRC.
    Ascii,
    /// Bytes behind a header, without a checksum.
    Mbap,
}

/// The unit address that every drive hears and none answers.
pub const BROADCAST: u8 = 0;

/// Longest PDU: function code and 252 bytes (application protocol, 4.1).
pub const PDU_MAX: usize = 253;
