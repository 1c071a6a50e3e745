//! A reply whose checksum is wrong.

use super::*;
use crate::wire::{Coding, Frame};

/// All bits of the checksum are inverted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct WrongChecksum {}

impl Fault for WrongChecksum {
    const NAME: &'static str = "bad_crc";
    const ABOUT: &'static str = "The checksum of the reply is wrong: its bits are inverted.";
    const IMPOSSIBLE_ON_TCP: Option<&'static str> = Some("Modbus TCP frames have no checksum");

    fn read(_: &FaultKeys) -> Result<Self, KeyRefusal> {
        Ok(Self {})
    }

    fn on_reply(&mut self, reply: &DriveReply<'_>, out: &mut Outgoing<'_>) -> Option<Duration> {
        let mut frame = reply.frame();
        invert_checksum(&mut frame, reply.line.coding());
        out.send(&frame);
        None
    }

    fn leaves(&self) -> Leaves {
        Leaves::CHANGED
    }

    fn describe(&self, unit: u8) -> String {
        format!("reply from unit {unit} sent with a bad checksum")
    }
}

fn invert_checksum(frame: &mut Frame, coding: Coding) {
    let end = frame.len();
    match coding {
        Coding::Rtu => frame[end - 2..].iter_mut().for_each(|byte| *byte = !*byte),
        // Two digits before CR LF.
        Coding::Ascii => frame[end - 4..end - 2].iter_mut().for_each(|digit| {
            let value = char::from(*digit).to_digit(16).unwrap_or(0);
            let inverted = char::from_digit(15 - value, 16).unwrap_or('0');
            *digit = inverted.to_ascii_uppercase() as u8;
        }),
        Coding::Mbap => {}
    }
}
