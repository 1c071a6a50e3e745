//! The kinds of fault: the name of each in files, what it does, and the keys that it goes by.

use super::{Chatter, LineBehaviour};
use crate::time::Duration;
use serde::Deserialize;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// Declares the kinds: variant, name in files, explanation, keys of its own.
macro_rules! kinds {
    ($($variant:ident $name:literal $about:literal [$($key:literal)*],)*) => {
        /// What a rule does. The last few are presets: each stands for several rules.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
        #[cfg_attr(feature = "cli", derive(JsonSchema))]
        pub enum FaultKind {
            $(#[doc = $about] #[serde(rename = $name)] $variant,)*
        }

        impl FaultKind {
            /// Every kind.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The name in files.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// The keys that go with this kind and not with every one.
            pub fn keys(self) -> &'static [&'static str] {
                match self { $(Self::$variant => &[$($key,)*],)* }
            }
        }
    };
}

kinds! {
    LoseRequest "lose_request" "The request never reaches the drive." [],
    LoseReply "lose_reply" "The drive executes the request, and its reply is lost." [],
    BadCrc "bad_crc" "The checksum of the reply is wrong: its bits are inverted." [],
    FlipBits "flip_bits" "Some bits of the reply are flipped." ["bits"],
    Truncate "truncate" "The end of the reply is missing." ["bytes"],
    Extra "extra" "Random bytes follow the reply." ["bytes"],
    Garbage "garbage" "Random bytes come before the reply." ["bytes"],
    Delay "delay" "The reply is delayed." ["ms"],
    Late "late" "The reply is held back until the next request on its link, and then sent first." [],
    Duplicate "duplicate" "The reply is sent twice." [],
    Split "split" "The reply is sent in two pieces." ["at" "gap_ms"],
    WrongUnit "wrong_unit" "The reply names another unit." ["to"],
    WrongFunction "wrong_function" "The reply names another function." ["to"],
    Exception "exception" "An exception is returned, and the drive executes nothing." ["code"],
    Busy "busy" "Exception 06, server device busy, is returned, and the drive executes nothing." [],
    Echo "echo" "The request comes back before the reply, as on a 2-wire line whose receiver stays on." [],
    NoisyCable "noisy_cable" "Preset: a cable that picks up noise." [],
    SleepyDrive "sleepy_drive" "Preset: a drive that replies slowly, and sometimes not at all." [],
    UsbAdapter "usb_adapter" "Preset: a USB adapter that delivers bytes in chunks and occasionally loses some." [],
    CrowdedLine "crowded_line" "Preset: other traffic on the line, which occasionally collides with ours." [],
}

impl FaultKind {
    /// The rules that a preset stands for, in compact form. The rare ones come first, since the first acts.
    pub fn preset(self) -> Option<&'static [&'static str]> {
        match self {
            Self::NoisyCable => Some(&[
                "lose_request:probability=0.005",
                "lose_reply:probability=0.005",
                "truncate:bytes=2,probability=0.002",
                "extra:bytes=1,probability=0.004",
                "garbage:bytes=1,probability=0.004",
                "flip_bits:bits=1,probability=0.01",
            ]),
            Self::SleepyDrive => Some(&[
                "lose_request:probability=0.002",
                "busy:probability=0.005",
                "delay:ms=500-1500,probability=0.01",
                "delay:ms=5-60",
            ]),
            Self::UsbAdapter => {
                Some(&["lose_reply:probability=0.001", "split:gap_ms=16,probability=0.02"])
            }
            Self::CrowdedLine => Some(&[
                "lose_request:probability=0.003",
                "truncate:bytes=2,probability=0.002",
                "garbage:bytes=2,probability=0.005",
            ]),
            _ => None,
        }
    }

    /// The line behaviour that a preset gives its line besides.
    pub fn line_behaviour(self) -> LineBehaviour {
        let every = Duration::from_millis(50);
        match self {
            Self::UsbAdapter => {
                LineBehaviour { chunk: Some(Duration::from_millis(16)), ..LineBehaviour::default() }
            }
            Self::CrowdedLine => {
                let chatter = Chatter { units: vec![241, 242, 243], every };
                LineBehaviour { chatter: Some(chatter), ..LineBehaviour::default() }
            }
            _ => LineBehaviour::default(),
        }
    }

    /// Does it touch a request that nobody answers, too?
    pub fn takes_broadcasts(self) -> bool {
        matches!(self, Self::LoseRequest | Self::Echo)
    }

    /// Why it can do nothing on Modbus TCP, if it can't.
    pub fn impossible_on_tcp(self) -> Option<&'static str> {
        match self {
            Self::BadCrc => Some("Modbus TCP frames have no checksum"),
            Self::Echo => Some("Modbus TCP has no echo"),
            Self::UsbAdapter => Some("Modbus TCP has no serial adapter"),
            Self::CrowdedLine => Some("Modbus TCP has no shared line"),
            _ => None,
        }
    }
}
