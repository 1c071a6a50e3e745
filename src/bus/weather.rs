//! Bad weather between line and drives: what a fault rule makes of a reply on its way out.

use super::{Bus, LinkId};
use crate::event::{DriveId, Mishap, What};
use crate::fault::{Faults, Strike};
use crate::wire::{Adu, Frame, Pdu};

impl Bus {
    /// Puts fault rules on the line, in place of those that were there.
    pub fn set_faults(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// The fault rules of the line.
    pub fn faults(&self) -> &Faults {
        &self.faults
    }

    /// Sends the answer of `drive` to `request`, as far as a rule that acts on it lets that be.
    pub(super) fn send(
        &mut self,
        link: LinkId,
        drive: DriveId,
        request: Adu<'_>,
        answer: Pdu,
        strike: Option<&mut Strike>,
    ) {
        let begins = self.reply_begins(link, drive);
        let Some(line) = self.links.get(&link).map(|it| &it.line) else { return };
        let Some(strike) = strike else {
            let frame = line.frame(request.unit, &answer);
            return self.transmit_at(begins, link, frame);
        };
        let (unit, answer) = strike.forge(request.unit, answer);
        let mut frame = line.frame(unit, &answer);
        strike.spoil(&mut frame, line.coding());
        match strike.mishap {
            Mishap::RequestLost | Mishap::ReplyLost => {}
            Mishap::Delayed(by) => self.transmit_at(begins + by, link, frame),
            Mishap::Late => self.held.until_request(link, frame),
            Mishap::Extra(bytes) => {
                self.transmit_at(begins, link, frame);
                self.transmit_at(begins, link, strike.noise(bytes));
            }
            Mishap::Garbage(bytes) => {
                self.transmit_at(begins, link, strike.noise(bytes));
                self.transmit_at(begins, link, frame);
            }
            Mishap::Duplicated => {
                self.transmit_at(begins, link, frame);
                self.transmit_at(begins, link, frame);
            }
            Mishap::Split { at, gap } => {
                let at = at.map_or(frame.len() / 2, usize::from).min(frame.len() - 1);
                let (first, second) = frame.split_at(at);
                self.transmit_at(begins, link, Frame::from_slice(first));
                let second_begins = begins + self.characters(at) + gap;
                self.transmit_at(second_begins, link, Frame::from_slice(second));
            }
            Mishap::Echoed => {
                self.echo(link, request);
                self.transmit_at(begins, link, frame);
            }
            Mishap::BadChecksum
            | Mishap::BitsFlipped(_)
            | Mishap::Truncated(_)
            | Mishap::WrongUnit(_)
            | Mishap::WrongFunction(_)
            | Mishap::Exception(_)
            | Mishap::Busy => self.transmit_at(begins, link, frame),
        }
    }

    /// Gives a request back as it came.
    pub(super) fn echo(&mut self, link: LinkId, request: Adu<'_>) {
        let Some(it) = self.links.get(&link) else { return };
        let frame = it.line.frame(request.unit, request.pdu);
        self.pass(link, &frame);
    }

    /// A request has come on `link`: what is late leaves now.
    pub(super) fn release_late(&mut self, link: LinkId) {
        while let Some((link, frame)) = self.held.take_late(link) {
            self.transmit(link, frame);
        }
    }

    /// Tells which rule did what.
    pub(super) fn tell(&mut self, unit: u8, strike: Option<&Strike>) {
        if let Some(Strike { rule, hit, mishap, .. }) = strike {
            self.emit(What::Fault { rule: *rule, unit, mishap: *mishap, hit: *hit });
        }
    }
}
