//! PDUs: requests, as types that can't lie, and what a drive answers. A [`Span`] never wraps, [`Words`] are as many as the
//! span says.

use super::Pdu;
use super::function::{EXCEPTION, MASK_WRITE, READ, WRITE_MANY, WRITE_ONE};

/// A run of registers: at least one, none beyond 0xFFFF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    start: u16,
    count: u16,
}

impl Span {
    /// `count` registers from `start`; `None` if that is no register or more than there are.
    pub fn new(start: u16, count: u16) -> Option<Self> {
        let end = u32::from(start) + u32::from(count);
        (count > 0 && end <= 0x1_0000).then_some(Self { start, count })
    }

    /// One register.
    pub fn one(address: u16) -> Self {
        Self { start: address, count: 1 }
    }

    /// The first address.
    pub fn start(self) -> u16 {
        self.start
    }

    /// How many.
    pub fn count(self) -> u16 {
        self.count
    }

    /// The last address.
    pub fn last(self) -> u16 {
        self.start + (self.count - 1)
    }

    /// Every address, in order.
    pub fn addresses(self) -> impl DoubleEndedIterator<Item = u16> + Clone {
        self.start..=self.last()
    }
}

/// Register values as they lie in a PDU: high byte first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Words<'a>(&'a [u8]);

impl<'a> Words<'a> {
    /// One value.
    pub fn one(bytes: &'a [u8; 2]) -> Self {
        Self(bytes)
    }

    /// How many.
    pub fn len(self) -> usize {
        self.0.len() / 2
    }

    /// Is there none?
    pub fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    /// Value `index`, or `None` beyond the last.
    pub fn get(self, index: usize) -> Option<u16> {
        let bytes = self.0.get(2 * index..2 * index + 2)?;
        Some(u16::from_be_bytes([bytes[0], bytes[1]]))
    }

    /// Every value, in order.
    pub fn iter(self) -> impl Iterator<Item = u16> + 'a {
        self.0.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]]))
    }
}

/// What becomes of the bits of a register (application protocol, 6.16).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Masks {
    /// Bits that stay as they are.
    pub and: u16,
    /// What the others become.
    pub or: u16,
}

impl Masks {
    /// The value that `current` becomes.
    pub fn apply(self, current: u16) -> u16 {
        current & self.and | self.or & !self.and
    }
}

/// A request that a drive can decide about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Request<'a> {
    /// 0x03 Read Holding Registers (application protocol, 6.3).
    Read(Span),
    /// 0x06 Write Single Register (6.6).
    WriteOne {
        /// Which register.
        address: u16,
        /// Its new value.
        value: Words<'a>,
    },
    /// 0x10 Write Multiple Registers (6.12).
    WriteMany {
        /// Which registers.
        span: Span,
        /// Their new values, as many as the span has registers.
        values: Words<'a>,
    },
    /// 0x16 Mask Write Register (6.16).
    MaskWrite {
        /// Which register.
        address: u16,
        /// What becomes of its bits.
        masks: Masks,
    },
}

/// A PDU that is no [`Request`], and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Malformed {
    /// A function code that is none of [`function::ALL`](super::function::ALL).
    Function(u8),
    /// Too long or too short, or a byte count that does not fit.
    Length {
        /// Bytes that are there.
        got: usize,
        /// Bytes that should be.
        want: usize,
    },
    /// Zero registers.
    NoRegisters,
    /// More registers than there are addresses from `start` on.
    Beyond {
        /// First address.
        start: u16,
        /// Registers asked for.
        count: u16,
    },
}

/// How far the lengths inside a 0x10 request must agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthCheck {
    /// Byte count, register count and data agree.
    Strict,
    /// The register count decides; byte count and surplus data don't matter.
    CountOnly,
}

impl<'a> Request<'a> {
    /// Reads a PDU.
    pub fn parse(pdu: &'a [u8], check: LengthCheck) -> Result<Self, Malformed> {
        match pdu.first() {
            Some(&READ) => {
                let [_, a, b, c, d] = exactly(pdu)?;
                Ok(Self::Read(span([a, b], [c, d])?))
            }
            Some(&WRITE_ONE) => {
                let [_, a, b, _, _] = exactly(pdu)?;
                Ok(Self::WriteOne { address: u16::from_be_bytes([a, b]), value: Words(&pdu[3..]) })
            }
            Some(&WRITE_MANY) => Self::parse_write_many(pdu, check),
            Some(&MASK_WRITE) => {
                let [_, a, b, c, d, e, f] = exactly(pdu)?;
                let masks =
                    Masks { and: u16::from_be_bytes([c, d]), or: u16::from_be_bytes([e, f]) };
                Ok(Self::MaskWrite { address: u16::from_be_bytes([a, b]), masks })
            }
            other => Err(Malformed::Function(other.copied().unwrap_or(0))),
        }
    }

    /// The registers that it reads or writes.
    pub fn span(self) -> Span {
        match self {
            Self::Read(span) | Self::WriteMany { span, .. } => span,
            Self::WriteOne { address, .. } | Self::MaskWrite { address, .. } => Span::one(address),
        }
    }

    fn parse_write_many(pdu: &'a [u8], check: LengthCheck) -> Result<Self, Malformed> {
        let [_, a, b, c, d, byte_count, data @ ..] = pdu else {
            return Err(Malformed::Length { got: pdu.len(), want: 6 });
        };
        let count = usize::from(u16::from_be_bytes([*c, *d]));
        let fits = match check {
            LengthCheck::Strict => usize::from(*byte_count) == 2 * count && data.len() == 2 * count,
            LengthCheck::CountOnly => data.len() >= 2 * count,
        };
        if !fits {
            return Err(Malformed::Length { got: pdu.len(), want: 6 + 2 * count });
        }
        let span = span([*a, *b], [*c, *d])?;
        Ok(Self::WriteMany { span, values: Words(&data[..2 * count]) })
    }
}

fn exactly<const N: usize>(pdu: &[u8]) -> Result<[u8; N], Malformed> {
    pdu.try_into().map_err(|_| Malformed::Length { got: pdu.len(), want: N })
}

fn span(start: [u8; 2], count: [u8; 2]) -> Result<Span, Malformed> {
    let (start, count) = (u16::from_be_bytes(start), u16::from_be_bytes(count));
    match Span::new(start, count) {
        Some(span) => Ok(span),
        None if count == 0 => Err(Malformed::NoRegisters),
        None => Err(Malformed::Beyond { start, count }),
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(pdu: &[u8]) -> Result<Request<'_>, Malformed> {
        Request::parse(pdu, LengthCheck::Strict)
    }

    #[test]
    fn a_span_never_wraps() {
        assert_eq!(Span::new(0xFFFF, 1).map(Span::last), Some(0xFFFF));
        assert_eq!(Span::new(0xFFFF, 2), None);
        assert_eq!(Span::new(0, 0), None);
        assert_eq!(Span::new(1, 0xFFFF).map(Span::last), Some(0xFFFF));
    }

    #[test]
    fn lies_are_named() {
        assert_eq!(parse(&[]), Err(Malformed::Function(0)));
        assert_eq!(parse(&[0x2B, 0x0E]), Err(Malformed::Function(0x2B)));
        assert_eq!(parse(&[3, 0, 0, 0]), Err(Malformed::Length { got: 4, want: 5 }));
        assert_eq!(parse(&[3, 0, 0, 0, 0]), Err(Malformed::NoRegisters));
        let beyond = Malformed::Beyond { start: 0xFFFF, count: 2 };
        assert_eq!(parse(&[3, 0xFF, 0xFF, 0, 2]), Err(beyond));
        assert_eq!(parse(&[16, 0, 0, 0, 1]), Err(Malformed::Length { got: 5, want: 6 }));
        // Two registers announced, the byte count of one.
        let want = Malformed::Length { got: 8, want: 10 };
        assert_eq!(parse(&[16, 0, 0, 0, 2, 2, 0, 1]), Err(want));
    }

    #[test]
    fn masks_keep_and_set_bits() {
        // The example of the specification.
        let masks = Masks { and: 0xF2, or: 0x25 };
        assert_eq!(masks.apply(0x12), 0x17);
        let pdu = [0x16, 0, 4, 0, 0xF2, 0, 0x25];
        assert_eq!(parse(&pdu), Ok(Request::MaskWrite { address: 4, masks }));
        assert_eq!(parse(&pdu).map(Request::span), Ok(Span::one(4)));
        assert_eq!(parse(&pdu[..5]), Err(Malformed::Length { got: 5, want: 7 }));
    }

    #[test]
    fn count_only_takes_what_the_count_says() {
        let pdu = [16, 0, 0x21, 0, 1, 12, 0, 10, 0, 100, 7];
        let Ok(Request::WriteMany { span, values }) = Request::parse(&pdu, LengthCheck::CountOnly)
        else {
            panic!("refused");
        };
        assert_eq!((span, values.iter().collect::<Vec<_>>()), (Span::one(0x21), vec![10]));
        let short = [16, 0, 0x21, 0, 2, 12, 0, 10];
        assert!(Request::parse(&short, LengthCheck::CountOnly).is_err());
    }
}
