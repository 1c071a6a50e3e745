//! An exception that answers in place of the drive.

use super::*;

/// Answers with an exception; the drive executes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct AnswerException {
    code: u8,
}

impl Fault for AnswerException {
    const NAME: &'static str = "exception";
    const ABOUT: &'static str = "An exception is returned, and the drive executes nothing.";
    const KEYS: &'static [FaultKey] = &[FaultKey::number("code", "its code", 1, 0xFF).required()];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { code: keys.number("code").unwrap_or_default() })
    }

    fn passage(&self) -> Passage {
        Passage::Answered(self.code)
    }

    fn describe(&self, unit: u8) -> String {
        format!("request to unit {unit} answered with exception {:02X}, not executed", self.code)
    }
}
