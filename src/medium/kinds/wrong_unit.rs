//! A reply that names another unit.

use super::*;

/// Names another unit; the checksum of the reply is right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct WrongUnit {
    /// `None` is the unit behind the right one; once a reply is hit, it is a number.
    to: Option<u8>,
}

impl Fault for WrongUnit {
    const NAME: &'static str = "wrong_unit";
    const ABOUT: &'static str = "The reply names another unit.";
    const KEYS: &'static [FaultKey] =
        &[FaultKey::number("to", "the unit that the reply names; default the next one", 0, 0xFF)];

    fn read(keys: &FaultKeys) -> Result<Self, KeyRefusal> {
        let to = keys.number("to");
        match to.filter(|to| keys.unit() == Some(*to)) {
            None => Ok(Self { to }),
            Some(to) => Err(KeyRefusal { key: "to", what: format!("`to` must not be the addressed unit, {to}") }),
        }
    }

    fn has_effect(&self, unit: u8, _: u8) -> bool {
        self.to != Some(unit)
    }

    fn draw(self, unit: u8, _: u8, _: &mut Rng) -> Self {
        Self { to: self.to.or(Some(unit.wrapping_add(1))) }
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        out.send(&reply.line.frame(self.to.unwrap_or(reply.unit), reply.pdu));
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::CHANGED
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} sent as unit {}", self.to.unwrap_or(unit))
    }
}
