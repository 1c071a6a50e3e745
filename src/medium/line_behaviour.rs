//! LineBehaviour of a line: what it always does to what passes, apart from faults that hit one request.
//!
//! Only what they are. When a reply leaves and what others say is the bus's.

use crate::time::Duration;
use std::fmt;

/// What a line always does. By default it has none: a reply leaves at once and in one piece.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LineBehaviour {
    /// Reply timing.
    pub pacing: Pacing,
    /// Latency timer of a USB adapter at the master, 1 ms to 255 ms: bytes arrive in chunks when it expires.
    pub chunk: Option<Duration>,
    /// The master hears what it says.
    pub echo: bool,
    /// Others talk on the line.
    pub chatter: Option<Chatter>,
}

/// Reply timing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Pacing {
    /// Immediately after the request.
    #[default]
    Ideal,
    /// After the end-of-frame silence, the reply delay of the drive and the character times of the reply.
    Line,
}

/// Another master and its units.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chatter {
    /// Whom it asks.
    pub units: Vec<u8>,
    /// From one conversation to the next, on average.
    pub every: Duration,
}

impl LineBehaviour {
    /// Has it none?
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// May a reply be on its way for a while?
    pub fn takes_time(&self) -> bool {
        self.pacing != Pacing::Ideal || self.chunk.is_some()
    }

    /// These, and of `others` those that are not here.
    #[must_use]
    pub fn and(self, others: Self) -> Self {
        Self {
            pacing: if self.pacing == Pacing::Ideal { others.pacing } else { self.pacing },
            chunk: self.chunk.or(others.chunk),
            echo: self.echo || others.echo,
            chatter: self.chatter.or(others.chatter),
        }
    }

    /// The key of a line behaviour that is in both.
    pub fn shared(&self, others: &Self) -> Option<&'static str> {
        let both = [
            ("chunk", self.chunk.is_some() && others.chunk.is_some()),
            ("chatter", self.chatter.is_some() && others.chatter.is_some()),
        ];
        both.iter().find(|(_, both)| *both).map(|(key, _)| *key)
    }
}

impl fmt::Display for LineBehaviour {
    /// `paced replies, chunks of 16ms, echo, chatter of units 7, 8`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let chatter = self.chatter.as_ref().map(|chatter| {
            let units: Vec<_> = chatter.units.iter().map(u8::to_string).collect();
            format!("chatter of units {}", units.join(", "))
        });
        let told = [
            (self.pacing != Pacing::Ideal).then(|| "paced replies".to_owned()),
            self.chunk.map(|latency| format!("chunks of {latency:?}")),
            self.echo.then(|| "echo".to_owned()),
            chatter,
        ];
        f.write_str(&told.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}
