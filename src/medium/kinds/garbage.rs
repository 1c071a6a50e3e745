//! Random bytes ahead of a reply.

use super::*;

/// Sends random bytes right ahead of the reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LeadingBytes {
    bytes: u8,
}

impl Fault for LeadingBytes {
    const NAME: &'static str = "garbage";
    const ABOUT: &'static str = "Random bytes come before the reply.";
    const KEYS: &'static [FaultKey] =
        &[FaultKey::number("bytes", "how many bytes are added; default 1", 1, 0xFF)];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { bytes: keys.number("bytes").unwrap_or(1) })
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let noise = out.noise(self.bytes);
        out.part(&noise);
        out.send(&reply.frame());
        Some(Duration::ZERO)
    }

    fn leaves(&self) -> Leaves {
        Leaves { before: 1, ..Leaves::INTACT }
    }

    fn describe(&self, unit: u8) -> String {
        format!("{} inserted before the reply from unit {unit}", count(self.bytes, "byte"))
    }
}
