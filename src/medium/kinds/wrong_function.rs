//! A reply that names another function.

use super::*;
use crate::wire::function::EXCEPTION;

/// Names another function; an exception stays one, and the checksum of the reply is right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct WrongFunction {
    /// `None` is the function behind the right one; once a reply is hit, it is a number.
    to: Option<u8>,
}

impl Fault for WrongFunction {
    const NAME: &'static str = "wrong_function";
    const ABOUT: &'static str = "The reply names another function.";
    const KEYS: &'static [FaultKey] = &[FaultKey::number(
        "to",
        "the function that the reply names; default the next one",
        1,
        0x7F,
    )];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self { to: keys.number("to") })
    }

    fn has_effect(&self, _: u8, function: u8) -> bool {
        self.to != Some(function)
    }

    fn draw(self, _: u8, function: u8, _: &mut Rng) -> Self {
        Self { to: self.to.or(Some(function.wrapping_add(1) & !EXCEPTION)) }
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let mut pdu = *reply.pdu;
        if let (Some(function), Some(to)) = (pdu.first_mut(), self.to) {
            *function = to | *function & EXCEPTION;
        }
        out.send(&reply.line.frame(reply.unit, &pdu));
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::CHANGED
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} sent with function {:02X}", self.to.unwrap_or(0))
    }
}
