//! Random bytes behind a reply.

use super::*;

/// Sends random bytes right behind the reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ExtraBytes {
    bytes: u8,
}

impl Fault for ExtraBytes {
    const NAME: &'static str = "extra";
    const ABOUT: &'static str = "Random bytes follow the reply.";
    const KEYS: &'static [FaultKey] =
        &[FaultKey::number("bytes", "how many bytes are added; default 1", 1, 0xFF)];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { bytes: keys.number("bytes").unwrap_or(1) })
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        out.part(&reply.frame());
        let noise = out.noise(self.bytes);
        out.send(&noise);
        Some(Duration::ZERO)
    }

    fn leaves(&self) -> Leaves {
        Leaves { after: 1, ..Leaves::INTACT }
    }

    fn describe(&self, unit: u8) -> String {
        format!("{} appended to the reply from unit {unit}", count(self.bytes, "byte"))
    }
}
