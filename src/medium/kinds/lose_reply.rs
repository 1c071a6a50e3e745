//! A reply that the master never gets, though the drive has executed the request.

use super::*;

/// The reply is lost on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LoseReply {}

impl Fault for LoseReply {
    const NAME: &'static str = "lose_reply";
    const ABOUT: &'static str = "The drive executes the request, and its reply is lost.";

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn on_reply(&mut self, _: &DriveReply<'_>, _: &mut Outgoing<'_>) -> Option<Duration> {
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::NOTHING
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} lost")
    }
}
