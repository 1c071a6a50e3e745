//! The exception of a server that is busy, in place of the drive's answer.

use super::*;

/// Server device busy (application protocol, 7): the standard's code, whatever the model makes of it.
const SERVER_DEVICE_BUSY: u8 = 0x06;

/// Answers with the exception for a busy server; the drive executes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Busy {}

impl Fault for Busy {
    const NAME: &'static str = "busy";
    const ABOUT: &'static str =
        "Exception 06, server device busy, is returned, and the drive executes nothing.";

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn passage(&self) -> Passage {
        Passage::Answered(SERVER_DEVICE_BUSY)
    }

    fn describe(&self, unit: u8) -> String {
        format!("request to unit {unit} answered as busy, not executed")
    }
}
