//! One rule: when it acts, and what it does.

use super::FaultKind;
use crate::event::FaultEffect;
use crate::rng::{Chance, Rng};
use crate::time::{Duration, Instant};
use crate::wire::function::EXCEPTION;
use crate::wire::{BROADCAST, LengthCheck, Request, Span};

/// A rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultRule {
    /// Its name on its line.
    pub name: String,
    /// When it acts.
    pub when: When,
    /// What it does.
    pub act: Act,
}

/// When a rule acts. Requests that `unit` to `until` hold for are its occurrences; the others choose among them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct When {
    /// Only requests to this unit.
    pub unit: Option<u8>,
    /// Only these functions; empty is every one.
    pub functions: Vec<u8>,
    /// Only requests that touch one of these; empty is every request.
    pub spans: Vec<Span>,
    /// Only from here on.
    pub from: Instant,
    /// Only before.
    pub until: Option<Instant>,
    /// Occurrences that pass first.
    pub skip: u64,
    /// Then it is the turn of every so manieth; at least 1.
    pub every: u64,
    /// Whose turn it is is hit with this chance; `None` always is.
    pub chance: Option<Chance>,
    /// So many hits and no more.
    pub count: Option<u64>,
}

/// What a rule does, with what it goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // `FaultKind` and `RawFault` tell each.
pub enum Act {
    LoseRequest,
    LoseReply,
    BadCrc,
    FlipBits { bits: u8 },
    Truncate { bytes: u8 },
    Extra { bytes: u8 },
    Garbage { bytes: u8 },
    Delay { least_ms: u32, most_ms: u32 },
    Late,
    Duplicate,
    Split { at: Option<u16>, gap_ms: u32 },
    WrongUnit { to: Option<u8> },
    WrongFunction { to: Option<u8> },
    Exception { code: u8 },
    Busy,
    Echo,
}

impl FaultRule {
    /// Is a request to `unit` at `now` an occurrence of this rule?
    pub(super) fn concerns(&self, now: Instant, unit: u8, request: &[u8]) -> bool {
        let When { functions, spans, from, until, .. } = &self.when;
        let function = request.first().copied().unwrap_or(0);
        *from <= now
            && until.is_none_or(|until| now < until)
            && self.when.unit.is_none_or(|it| it == unit)
            && (functions.is_empty() || functions.contains(&function))
            && (spans.is_empty() || touches(spans, request))
            && (unit != BROADCAST || self.act.kind().takes_broadcasts())
            && self.act.changes(unit, function)
    }
}

impl When {
    /// Is it the turn of occurrence number `n`, counted from 1?
    pub(super) fn is_turn(&self, n: u64) -> bool {
        n > self.skip && (n - self.skip).is_multiple_of(self.every)
    }
}

fn touches(spans: &[Span], request: &[u8]) -> bool {
    let touched = match Request::parse(request, LengthCheck::CountOnly) {
        Ok(Request::Read(span) | Request::WriteMany { span, .. }) => span,
        Ok(Request::WriteOne { address, .. }) => Span::one(address),
        Err(_) => return false,
    };
    spans.iter().any(|span| span.start() <= touched.last() && touched.start() <= span.last())
}

impl Act {
    /// Its kind.
    pub fn kind(self) -> FaultKind {
        match self {
            Self::LoseRequest => FaultKind::LoseRequest,
            Self::LoseReply => FaultKind::LoseReply,
            Self::BadCrc => FaultKind::BadCrc,
            Self::FlipBits { .. } => FaultKind::FlipBits,
            Self::Truncate { .. } => FaultKind::Truncate,
            Self::Extra { .. } => FaultKind::Extra,
            Self::Garbage { .. } => FaultKind::Garbage,
            Self::Delay { .. } => FaultKind::Delay,
            Self::Late => FaultKind::Late,
            Self::Duplicate => FaultKind::Duplicate,
            Self::Split { .. } => FaultKind::Split,
            Self::WrongUnit { .. } => FaultKind::WrongUnit,
            Self::WrongFunction { .. } => FaultKind::WrongFunction,
            Self::Exception { .. } => FaultKind::Exception,
            Self::Busy => FaultKind::Busy,
            Self::Echo => FaultKind::Echo,
        }
    }

    /// Would anybody notice? A reply that names the right unit as the wrong one is no fault.
    fn changes(self, unit: u8, function: u8) -> bool {
        match self {
            Self::WrongUnit { to } => to != Some(unit),
            Self::WrongFunction { to } => to != Some(function),
            _ => true,
        }
    }

    /// What it does to a request to `unit` and its reply, with its numbers drawn.
    pub(super) fn effect(self, unit: u8, function: u8, rng: &mut Rng) -> FaultEffect {
        match self {
            Self::LoseRequest => FaultEffect::RequestLost,
            Self::LoseReply => FaultEffect::ReplyLost,
            Self::BadCrc => FaultEffect::BadChecksum,
            Self::FlipBits { bits } => FaultEffect::BitsFlipped(bits),
            Self::Truncate { bytes } => FaultEffect::Truncated(bytes),
            Self::Extra { bytes } => FaultEffect::Extra(bytes),
            Self::Garbage { bytes } => FaultEffect::Garbage(bytes),
            Self::Delay { least_ms, most_ms } => {
                let [least, most] = [least_ms, most_ms].map(|ms| u64::from(ms) * 1000);
                FaultEffect::Delayed(Duration::from_micros(rng.between(least, most)))
            }
            Self::Late => FaultEffect::Late,
            Self::Duplicate => FaultEffect::Duplicated,
            Self::Split { at, gap_ms } => {
                FaultEffect::Split { at, gap: Duration::from_millis(gap_ms.into()) }
            }
            Self::WrongUnit { to } => FaultEffect::WrongUnit(to.unwrap_or(unit.wrapping_add(1))),
            Self::WrongFunction { to } => {
                FaultEffect::WrongFunction(to.unwrap_or(function.wrapping_add(1) & !EXCEPTION))
            }
            Self::Exception { code } => FaultEffect::Exception(code),
            Self::Busy => FaultEffect::Busy,
            Self::Echo => FaultEffect::Echoed,
        }
    }
}
