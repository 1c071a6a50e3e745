//! A reply that arrives in the next transaction.

use super::*;

/// Holds the reply until the next request on its link, whoever that is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Late {}

impl Fault for Late {
    const NAME: &'static str = "late";
    const ABOUT: &'static str =
        "The reply is held back until the next request on its link, and then sent first.";
    const RELEASED_BY: Option<Passing> = Some(Passing::Request);

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        out.hold(None, &reply.frame());
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::LATER
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} held until the next request")
    }
}
