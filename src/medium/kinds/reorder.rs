//! A reply that changes places with the next one on its link.

use super::*;

/// Holds the reply until another reply has left on its link, and sends it right behind that; at the latest after a
/// time, alone. A reply that is hit while one is held is that other reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Reorder {
    /// The longest that it is held, in milliseconds.
    #[serde(skip)]
    most_ms: u32,
    /// Was it that other reply?
    #[serde(rename = "ahead")]
    is_ahead: bool,
}

impl Fault for Reorder {
    const NAME: &'static str = "reorder";
    const ABOUT: &'static str =
        "The reply is held back until the next reply on its link has been sent, and follows it.";
    const KEYS: &'static [FaultKey] = &[FaultKey::number(
        "ms",
        "milliseconds after which the reply is sent even if no other was; default 5000",
        1,
        u32::MAX as u64,
    )];
    const REPORTS: &'static [(&'static str, &'static str)] =
        &[("ahead", "was it sent ahead of the one that was held?")];
    const RELEASED_BY: Option<Passing> = Some(Passing::Reply);

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { most_ms: keys.number("ms").unwrap_or(5000), is_ahead: false })
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        self.is_ahead = out.is_holding();
        if self.is_ahead {
            out.send(&reply.frame());
            return Some(Duration::ZERO);
        }
        let most = Duration::from_millis(self.most_ms.into());
        out.hold(Some(most), &reply.frame());
        Some(most)
    }

    fn leaves(&self) -> Leaves {
        if self.is_ahead { Leaves::INTACT } else { Leaves::LATER }
    }

    fn describe(&self, unit: u8) -> String {
        match self.is_ahead {
            true => format!("reply from unit {unit} sent ahead of the held one"),
            false => format!("reply from unit {unit} held until the next reply"),
        }
    }
}
