//! The kinds of fault, one file each: what it does to a request and to a reply, its keys, its text and its JSON.
//!
//! A new kind is a file in this folder and a line in the list below. Nothing else in the program knows it.

use super::keys::{FaultKey, FaultKeys, KeyRefusal};
use super::transmitter::{DriveReply, MasterRequest, Outgoing, Passing, ReplyHolder};
use crate::rng::Rng;
use crate::time::Duration;
use serde::Serialize;
use std::fmt;

/// From the list to the modules, to [`FaultKind::ALL`], and to one type that is any of them.
macro_rules! kinds {
    ($($module:ident::$Kind:ident,)*) => {
        $(mod $module; pub use $module::$Kind;)*

        impl FaultKind {
            /// Every kind.
            pub const ALL: &'static [Self] =
                &[$(Self::of::<$Kind>(|keys| $Kind::read(keys).map(FaultEffect::$Kind)),)*];
        }

        /// What a fault rule does to a request or its reply: any of the kinds.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
        #[serde(untagged)]
        #[allow(missing_docs)] // Each kind says what it is.
        pub enum FaultEffect {
            $($Kind($Kind),)*
        }

        impl FaultEffect {
            /// The name of its kind.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$Kind(_) => $Kind::NAME,)* }
            }

            /// Why it is impossible on Modbus TCP, if it is.
            pub fn impossible_on_tcp(&self) -> Option<&'static str> {
                match self { $(Self::$Kind(_) => $Kind::IMPOSSIBLE_ON_TCP,)* }
            }

            /// Does it also act on requests to unit 0, which have no reply?
            pub(super) fn takes_broadcasts(&self) -> bool {
                match self { $(Self::$Kind(_) => $Kind::TAKES_BROADCASTS,)* }
            }

            /// What becomes of a request that it hits.
            pub fn passage(&self) -> Passage {
                match self { $(Self::$Kind(it) => it.passage(),)* }
            }

            /// What leaves at once of a reply that it hits.
            pub fn leaves(&self) -> Leaves {
                match self { $(Self::$Kind(it) => it.leaves(),)* }
            }

            /// What it did to a request to `unit` or to its reply, for the log.
            pub fn describe(&self, unit: u8) -> String {
                match self { $(Self::$Kind(it) => it.describe(unit),)* }
            }

            pub(super) fn has_effect(&self, unit: u8, function: u8) -> bool {
                match self { $(Self::$Kind(it) => it.has_effect(unit, function),)* }
            }

            pub(super) fn draw(self, unit: u8, function: u8, rng: &mut Rng) -> Self {
                match self { $(Self::$Kind(it) => Self::$Kind(it.draw(unit, function, rng)),)* }
            }

            pub(super) fn on_request(
                &self,
                request: &MasterRequest<'_>,
                out: &mut Outgoing<'_>,
            ) {
                match self { $(Self::$Kind(it) => it.on_request(request, out),)* }
            }

            pub(super) fn on_reply(
                &mut self,
                reply: &DriveReply<'_>,
                out: &mut Outgoing<'_>,
            ) -> Option<Duration> {
                match self { $(Self::$Kind(it) => it.on_reply(reply, out),)* }
            }

            /// How it holds a reply.
            pub(super) fn holder(&self) -> ReplyHolder {
                match self {
                    $(Self::$Kind(_) => ReplyHolder { kind: $Kind::NAME, released_by: $Kind::RELEASED_BY },)*
                }
            }
        }
    };
}

kinds! {
    lose_request::LoseRequest,
    lose_reply::LoseReply,
    bad_crc::WrongChecksum,
    flip_bits::FlipBits,
    truncate::Truncate,
    extra::ExtraBytes,
    garbage::LeadingBytes,
    delay::Delay,
    late::Late,
    reorder::Reorder,
    duplicate::Duplicate,
    split::Split,
    wrong_unit::WrongUnit,
    wrong_function::WrongFunction,
    exception::AnswerException,
    busy::Busy,
    echo::EchoRequest,
}

/// A kind of fault. A value of it is what one rule does; once a rule has acted, with the numbers that were drawn for
/// that request.
///
/// It serializes to the keys that a fault event has of its own.
trait Fault: Copy + Serialize {
    /// Its name in files and in the log.
    const NAME: &'static str;
    /// What it does, for the schema.
    const ABOUT: &'static str;
    /// The keys that it has besides those of every rule.
    const KEYS: &'static [FaultKey] = &[];
    /// What its event says besides its keys: name in JSON, and what it means; yes or no.
    const REPORTS: &'static [(&'static str, &'static str)] = &[];
    /// Why it is impossible on Modbus TCP, if it is.
    const IMPOSSIBLE_ON_TCP: Option<&'static str> = None;
    /// Does it also act on requests to unit 0, which have no reply?
    const TAKES_BROADCASTS: bool = false;
    /// What on its link releases a reply that it holds, if anything does.
    const RELEASED_BY: Option<Passing> = None;

    /// Reads it from its keys, each of which is in its range.
    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal>;

    /// Does it change anything about a request with `function` to `unit`, or about its reply?
    fn has_effect(&self, _unit: u8, _function: u8) -> bool {
        true
    }

    /// This one with what it draws for a request with `function` to `unit`.
    fn draw(self, _unit: u8, _function: u8, _rng: &mut Rng) -> Self {
        self
    }

    /// What becomes of a request that it hits.
    fn passage(&self) -> Passage {
        Passage::Delivered
    }

    /// Sends what the master receives before any reply to a request that it hits.
    fn on_request(&self, _request: &MasterRequest<'_>, _out: &mut Outgoing<'_>) {}

    /// Sends, changes, holds or drops the reply to a request that it hit. Returns how much later than without it the
    /// master has an answer that it accepts; `None` if it never has.
    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        out.send(&reply.frame());
        Some(Duration::ZERO)
    }

    /// The frames that leave at once when it hits a reply, for the soak test to hold against those that did.
    fn leaves(&self) -> Leaves {
        Leaves::INTACT
    }

    /// What it did to a request to `unit` or to its reply, for the log.
    fn describe(&self, unit: u8) -> String;
}

/// What becomes of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passage {
    /// It reaches its drive, or all drives.
    Delivered,
    /// No drive receives it.
    Lost,
    /// No drive receives it, and this exception code answers.
    Answered(u8),
}

/// The frames that leave at once in place of one reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leaves {
    /// Frames before it.
    pub before: usize,
    /// What leaves of the reply itself.
    pub reply: LeavingReply,
    /// Frames behind it.
    pub after: usize,
}

/// What leaves of one reply at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeavingReply {
    /// The reply as the drive gave it.
    Intact,
    /// Something else in its place.
    Changed,
    /// Its beginning; the rest leaves later.
    Beginning,
    /// Nothing; it leaves later.
    Later,
    /// Nothing, ever.
    Nothing,
}

impl Leaves {
    /// The reply alone, as the drive gave it.
    pub const INTACT: Self = Self { before: 0, reply: LeavingReply::Intact, after: 0 };
    const CHANGED: Self = Self { reply: LeavingReply::Changed, ..Self::INTACT };
    const LATER: Self = Self { reply: LeavingReply::Later, ..Self::INTACT };
    const NOTHING: Self = Self { reply: LeavingReply::Nothing, ..Self::INTACT };
}

/// `1 bit`, `3 bits`.
fn count(number: u8, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// What a file and the log call a kind, and where it is possible.
#[derive(Debug, Clone, Copy)]
pub struct FaultKind {
    /// Its name in files and in the log.
    pub name: &'static str,
    /// What it does, in a sentence.
    pub about: &'static str,
    /// The keys that it has besides those of every rule.
    pub keys: &'static [FaultKey],
    /// What its event says besides its keys: name in JSON, and what it means; yes or no.
    pub reports: &'static [(&'static str, &'static str)],
    /// Why it is impossible on Modbus TCP, if it is.
    pub impossible_on_tcp: Option<&'static str>,
    /// Does it also act on requests to unit 0, which have no reply?
    pub takes_broadcasts: bool,
    pub(super) read: fn(&FaultKeys) -> Result<FaultEffect, KeyRefusal>,
}

impl FaultKind {
    const fn of<F: Fault>(read: fn(&FaultKeys) -> Result<FaultEffect, KeyRefusal>) -> Self {
        Self {
            name: F::NAME,
            about: F::ABOUT,
            keys: F::KEYS,
            reports: F::REPORTS,
            impossible_on_tcp: F::IMPOSSIBLE_ON_TCP,
            takes_broadcasts: F::TAKES_BROADCASTS,
            read,
        }
    }

    /// The kind called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|kind| kind.name == name)
    }

    /// The key `name` of this kind.
    pub fn key(&self, name: &str) -> Option<&'static FaultKey> {
        self.keys.iter().find(|key| key.name == name)
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
