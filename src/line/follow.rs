//! Traffic between a master and other units: followed so that it is never taken for ours.

use crate::wire::function::EXCEPTION;
use crate::wire::{Adu, rtu};

/// A good frame that is not for us.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Foreign<'a> {
    /// A master's request to another unit.
    Request(Adu<'a>),
    /// Another unit's answer.
    Response(Adu<'a>),
}

/// Remembers the last foreign request, because only that tells its answer from another request.
#[derive(Debug, Default)]
pub struct Follower {
    pending: Option<Pending>,
}

#[derive(Debug, Clone, Copy)]
struct Pending {
    unit: u8,
    function: u8,
    /// Length of a good answer, where the request fixes it.
    answer_len: Option<usize>,
}

impl Follower {
    /// Length of the foreign frame that begins with `bytes`, as far as can be told by now.
    pub fn frame_len(&self, bytes: &[u8]) -> Option<usize> {
        let asked = rtu::request_len(bytes);
        match self.answer_len(bytes) {
            // No answer that goes on, but the request once again: its unit has not answered.
            Some(len) if bytes.len() < len && !self.is_len_fixed() && ends_at(bytes, asked) => {
                asked
            }
            awaited => awaited.or(asked),
        }
    }

    /// Does the request fix the length of its answer?
    fn is_len_fixed(&self) -> bool {
        self.pending.is_some_and(|pending| pending.answer_len.is_some())
    }

    /// Names a good frame that is not for us, and remembers it if it is a request.
    pub fn follow<'a>(&mut self, bytes: &'a [u8], adu: Adu<'a>) -> Foreign<'a> {
        if self.is_answer(bytes) {
            self.pending = None;
            return Foreign::Response(adu);
        }
        self.pending = Some(Pending {
            unit: adu.unit,
            function: adu.function(),
            answer_len: answer_len(bytes),
        });
        Foreign::Request(adu)
    }

    /// A request to one of ours, or a long silence, ends the other conversation.
    pub fn forget(&mut self) {
        self.pending = None;
    }

    /// Is the good frame `bytes` the answer we wait for? Where its function tells no length, whatever comes next is.
    fn is_answer(&self, bytes: &[u8]) -> bool {
        match (self.answer_len(bytes), self.pending) {
            (None, Some(pending)) if rtu::response_len(bytes).is_none() => {
                bytes[..2] == [pending.unit, pending.function]
            }
            (len, _) => len == Some(bytes.len()),
        }
    }

    /// Length of `bytes` as the answer we wait for, or `None` if they can't be that.
    pub fn answer_len(&self, bytes: &[u8]) -> Option<usize> {
        let pending = self.pending?;
        let (unit, function) = (*bytes.first()?, *bytes.get(1)?);
        if unit != pending.unit || function & !EXCEPTION != pending.function {
            return None;
        }
        let len = rtu::response_len(bytes)?;
        let expected =
            function & EXCEPTION != 0 || pending.answer_len.is_none_or(|expected| expected == len);
        expected.then_some(len)
    }
}

/// Length of a good answer to `request`, where that fixes it.
fn answer_len(request: &[u8]) -> Option<usize> {
    let (function, rest) = request.get(1..)?.split_first()?;
    let &[_, _, high, low, ..] = rest else { return None };
    let count = usize::from(u16::from_be_bytes([high, low]));
    match function {
        0x01 | 0x02 => Some(5 + count.div_ceil(8)),
        0x03 | 0x04 | 0x17 => Some(5 + 2 * count),
        _ => None,
    }
}

/// Is there a frame at the front of `bytes` whose CRC fits at `len`?
fn ends_at(bytes: &[u8], len: Option<usize>) -> bool {
    rtu::ends(bytes).any(|end| Some(end) == len)
}
