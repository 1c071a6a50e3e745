//! A reply that leaves in two pieces.

use super::*;
use crate::wire::Frame;

/// Sends the reply in two pieces with a pause between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Split {
    /// Bytes in the first piece; `None` is half of them.
    at: Option<u16>,
    gap_ms: u32,
}

impl Fault for Split {
    const NAME: &'static str = "split";
    const ABOUT: &'static str = "The reply is sent in two pieces.";
    const KEYS: &'static [FaultKey] = &[
        FaultKey::number("at", "bytes in the first piece; default half of them", 1, 512),
        FaultKey::number(
            "gap_ms",
            "milliseconds between the pieces; default 20",
            1,
            u32::MAX as u64,
        ),
    ];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { at: keys.number("at"), gap_ms: keys.number("gap_ms").unwrap_or(20) })
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let frame = reply.frame();
        let at = self.at.map_or(frame.len() / 2, usize::from).min(frame.len() - 1);
        let (first, second) = frame.split_at(at);
        let gap = Duration::from_millis(self.gap_ms.into());
        out.part(&Frame::from_slice(first));
        out.send_after(out.characters(at) + gap, &Frame::from_slice(second));
        Some(gap)
    }

    fn leaves(&self) -> Leaves {
        Leaves { reply: LeavingReply::Beginning, ..Leaves::INTACT }
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} split by a gap of {} ms", self.gap_ms)
    }
}
