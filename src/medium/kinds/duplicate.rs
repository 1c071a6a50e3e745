//! A reply that leaves twice.

use super::*;

/// Sends the reply a second time, right behind itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Duplicate {}

impl Fault for Duplicate {
    const NAME: &'static str = "duplicate";
    const ABOUT: &'static str = "The reply is sent twice.";

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let frame = reply.frame();
        out.part(&frame);
        out.send(&frame);
        Some(Duration::ZERO)
    }

    fn leaves(&self) -> Leaves {
        Leaves { after: 1, ..Leaves::INTACT }
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} sent twice")
    }
}
