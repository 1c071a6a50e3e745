//! Presets: names for several rules, some with line behaviour.

use super::{Chatter, LineBehaviour};
use crate::time::Duration;

/// A name for several rules.
#[derive(Debug, Clone, Copy)]
pub struct Preset {
    /// Its name in files.
    pub name: &'static str,
    /// What it stands for, in a sentence.
    pub about: &'static str,
    /// Its rules, in compact form. The rare ones come first, since the first acts.
    pub rules: &'static [&'static str],
    /// The line behaviour that it brings besides.
    behaviour: fn() -> LineBehaviour,
    /// Why it is impossible on Modbus TCP, if it is.
    pub impossible_on_tcp: Option<&'static str>,
}

impl Preset {
    /// Every preset.
    pub const ALL: &'static [Self] = &[
        Self {
            name: "noisy_cable",
            about: "Preset: a cable that picks up noise.",
            rules: &[
                "lose_request:probability=0.005",
                "lose_reply:probability=0.005",
                "truncate:bytes=2,probability=0.002",
                "extra:bytes=1,probability=0.004",
                "garbage:bytes=1,probability=0.004",
                "flip_bits:bits=1,probability=0.01",
            ],
            behaviour: LineBehaviour::default,
            impossible_on_tcp: None,
        },
        Self {
            name: "sleepy_drive",
            about: "Preset: a drive that replies slowly, and sometimes not at all.",
            rules: &[
                "lose_request:probability=0.002",
                "busy:probability=0.005",
                "delay:ms=500-1500,probability=0.01",
                "delay:ms=5-60",
            ],
            behaviour: LineBehaviour::default,
            impossible_on_tcp: None,
        },
        Self {
            name: "usb_adapter",
            about: "Preset: a USB adapter that delivers bytes in chunks and occasionally loses some.",
            rules: &["lose_reply:probability=0.001", "split:gap_ms=16,probability=0.02"],
            behaviour: || LineBehaviour {
                chunk: Some(Duration::from_millis(16)),
                ..LineBehaviour::default()
            },
            impossible_on_tcp: Some("Modbus TCP has no serial adapter"),
        },
        Self {
            name: "crowded_line",
            about: "Preset: other traffic on the line, which occasionally collides with ours.",
            rules: &[
                "lose_request:probability=0.003",
                "truncate:bytes=2,probability=0.002",
                "garbage:bytes=2,probability=0.005",
            ],
            behaviour: || {
                let every = Duration::from_millis(50);
                let chatter = Some(Chatter { units: vec![241, 242, 243], every });
                LineBehaviour { chatter, ..LineBehaviour::default() }
            },
            impossible_on_tcp: Some("Modbus TCP has no shared line"),
        },
    ];

    /// The preset called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|preset| preset.name == name)
    }

    /// The line behaviour that it brings.
    pub fn line_behaviour(&self) -> LineBehaviour {
        (self.behaviour)()
    }
}
