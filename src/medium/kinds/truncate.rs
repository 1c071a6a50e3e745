//! A reply whose end is missing.

use super::*;

/// Cuts bytes off the end; one at least is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Truncate {
    bytes: u8,
}

impl Fault for Truncate {
    const NAME: &'static str = "truncate";
    const ABOUT: &'static str = "The end of the reply is missing.";
    const KEYS: &'static [FaultKey] = &[FaultKey::number(
        "bytes",
        "how many bytes are cut off; one at least is left. Default 1",
        1,
        0xFF,
    )];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { bytes: keys.number("bytes").unwrap_or(1) })
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let mut frame = reply.frame();
        frame.truncate(frame.len().saturating_sub(self.bytes.into()).max(1));
        out.send(&frame);
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::CHANGED
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} truncated by {}", count(self.bytes, "byte"))
    }
}
