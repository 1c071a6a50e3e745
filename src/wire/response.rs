//! Answers: what a drive says back, and how it lies in a PDU.

use super::Pdu;
use super::function::{EXCEPTION, MASK_WRITE, READ, WRITE_MANY, WRITE_ONE};
use super::request::{Masks, Span};

/// An exception: the function that failed and the code that says why.
///
/// Which code stands for which cause is the model's; vendors don't all use the standard's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exception {
    /// Function code of the request.
    pub function: u8,
    /// Exception code.
    pub code: u8,
}

/// The answer to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response<'a> {
    /// To 0x03: the values, at most 125.
    Read(&'a [u16]),
    /// To 0x06: an echo.
    WriteOne {
        /// Which register.
        address: u16,
        /// The value as it was sent.
        value: u16,
    },
    /// To 0x10: what was written.
    WriteMany(Span),
    /// To 0x16: an echo.
    MaskWrite {
        /// Which register.
        address: u16,
        /// What became of its bits.
        masks: Masks,
    },
    /// A refusal.
    Exception(Exception),
}

impl Response<'_> {
    /// The PDU as bytes.
    pub fn encode(&self) -> Pdu {
        let mut pdu = Pdu::new();
        match *self {
            Self::Read(values) => {
                pdu.extend(&[READ, (values.len() * 2) as u8]);
                values.iter().for_each(|value| pdu.extend(&value.to_be_bytes()));
            }
            Self::WriteOne { address, value } => {
                pdu.push(WRITE_ONE);
                pdu.extend(&address.to_be_bytes());
                pdu.extend(&value.to_be_bytes());
            }
            Self::WriteMany(span) => {
                pdu.push(WRITE_MANY);
                pdu.extend(&span.start().to_be_bytes());
                pdu.extend(&span.count().to_be_bytes());
            }
            Self::MaskWrite { address, masks: Masks { and, or } } => {
                pdu.push(MASK_WRITE);
                [address, and, or].iter().for_each(|word| pdu.extend(&word.to_be_bytes()));
            }
            Self::Exception(Exception { function, code }) => {
                pdu.extend(&[function | EXCEPTION, code]);
            }
        }
        pdu
    }
}
