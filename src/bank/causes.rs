//! The causes that a request met, and which of them answers.
//!
//! Rust finds the whole set; the order in which causes answer, and with which code, is the model's.

use crate::model::{LineRules, Refuse};
use crate::vocabulary::{Cause, Detail, Named, Refusal};
use crate::wire::Malformed;
use crate::wire::function::READ;

/// The causes met so far, each with the first thing that met it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Causes {
    met: [Option<Detail>; Cause::ALL.len()],
}

impl Causes {
    /// `cause` alone.
    pub fn of(cause: Cause, detail: Detail) -> Self {
        let mut causes = Self::default();
        causes.meet(cause, detail);
        causes
    }

    /// What a request meets that could not be read.
    pub fn of_malformed(pdu: &[u8], malformed: Malformed, line: &LineRules) -> Self {
        let most = if pdu.first() == Some(&READ) { line.max_read } else { line.max_write };
        match malformed {
            Malformed::Function(code) => Self::of(Cause::Function, Detail::Function(code)),
            Malformed::Length { got, want } => {
                Self::of(Cause::Length, Detail::Length { got, want })
            }
            Malformed::NoRegisters => Self::of(Cause::Quantity, Detail::Quantity { got: 0, most }),
            Malformed::Beyond { start, count } => {
                let mut causes = Self::of(Cause::AddressBeyond, Detail::Address(start));
                if count > most {
                    causes.meet(Cause::Quantity, Detail::Quantity { got: count, most });
                }
                causes
            }
        }
    }

    /// Meets `cause`. Only the first detail of each cause is kept.
    pub fn meet(&mut self, cause: Cause, detail: Detail) {
        self.met[cause as usize].get_or_insert(detail);
    }

    /// The refusal that answers, by the model's ladder, or `None` if no cause was met.
    ///
    /// A model that does not tell addresses beyond the map from holes has no rung for
    /// `address_beyond`: they answer as `address`.
    pub fn refusal(mut self, ladder: &Refuse) -> Option<Refusal> {
        if ladder.code(Cause::AddressBeyond).is_none()
            && let Some(detail) = self.met[Cause::AddressBeyond as usize].take()
        {
            self.meet(Cause::Address, detail);
        }
        ladder.ladder().find_map(|(cause, code)| {
            let detail = self.met[cause as usize]?;
            Some(Refusal { cause, code, detail })
        })
    }
}
