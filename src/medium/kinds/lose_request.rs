//! A request that no drive receives.

use super::*;

/// The request is lost on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LoseRequest {}

impl Fault for LoseRequest {
    const NAME: &'static str = "lose_request";
    const ABOUT: &'static str = "The request never reaches the drive.";
    const TAKES_BROADCASTS: bool = true;

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn passage(&self) -> Passage {
        Passage::Lost
    }

    fn on_reply(&mut self, _: &DriveReply<'_>, _: &mut Outgoing<'_>) -> Option<Duration> {
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::NOTHING
    }

    fn describe(&self, unit: u8) -> String {
        format!("request to unit {unit} lost")
    }
}
