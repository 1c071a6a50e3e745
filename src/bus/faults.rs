//! Faults between line and drives: what a fault rule makes of a reply on its way out.

use super::{Bus, LinkId};
use crate::event::{DriveId, FaultEffect, What};
use crate::medium::{FaultHit, Faults};
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
        fault_hit: Option<&mut FaultHit>,
    ) {
        let begins = self.reply_begins(link, drive);
        let Some(line) = self.links.get(&link).map(|it| &it.line) else { return };
        let Some(fault_hit) = fault_hit else {
            let frame = line.frame(request.unit, &answer);
            return self.transmit_at(begins, link, frame);
        };
        let (unit, answer) = fault_hit.rewrite(request.unit, answer);
        let mut frame = line.frame(unit, &answer);
        fault_hit.damage(&mut frame, line.coding());
        match fault_hit.effect {
            FaultEffect::RequestLost | FaultEffect::ReplyLost => {}
            FaultEffect::Delayed(by) => self.transmit_at(begins + by, link, frame),
            FaultEffect::Late => self.queue.until_request(link, frame),
            FaultEffect::Extra(bytes) => {
                self.transmit_at(begins, link, frame);
                self.transmit_at(begins, link, fault_hit.noise(bytes));
            }
            FaultEffect::Garbage(bytes) => {
                self.transmit_at(begins, link, fault_hit.noise(bytes));
                self.transmit_at(begins, link, frame);
            }
            FaultEffect::Duplicated => {
                self.transmit_at(begins, link, frame);
                self.transmit_at(begins, link, frame);
            }
            FaultEffect::Split { at, gap } => {
                let at = at.map_or(frame.len() / 2, usize::from).min(frame.len() - 1);
                let (first, second) = frame.split_at(at);
                self.transmit_at(begins, link, Frame::from_slice(first));
                let second_begins = begins + self.characters(at) + gap;
                self.transmit_at(second_begins, link, Frame::from_slice(second));
            }
            FaultEffect::Echoed => {
                self.echo(link, request);
                self.transmit_at(begins, link, frame);
            }
            FaultEffect::BadChecksum
            | FaultEffect::BitsFlipped(_)
            | FaultEffect::Truncated(_)
            | FaultEffect::WrongUnit(_)
            | FaultEffect::WrongFunction(_)
            | FaultEffect::Exception(_)
            | FaultEffect::Busy => self.transmit_at(begins, link, frame),
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
        while let Some((link, frame)) = self.queue.take_late(link) {
            self.transmit(link, frame);
        }
    }

    /// Tells which rule did what.
    pub(super) fn tell(&mut self, unit: u8, fault_hit: Option<&FaultHit>) {
        if let Some(FaultHit { rule, hit, effect, .. }) = fault_hit {
            self.emit(What::Fault { rule: *rule, unit, effect: *effect, hit: *hit });
        }
    }
}
