//! From what a link heard to what the drives say: the middle of the road from byte to byte.

use super::{Bus, LinkId, Output};
use crate::event::{DriveId, Transaction, What};
use crate::line::{Foreign, LineEvent};
use crate::medium::FaultHit;
use crate::time::Instant;
use crate::wire::function::{EXCEPTION, READ};
use crate::wire::{Adu, BROADCAST, Exception, Frame, Inline, Pdu, Response};

/// What a link heard, detached from its buffer so that drives and links can be touched again.
enum Taken {
    /// `answer` is set where the exception bit makes it an answer rather than a request.
    Request {
        unit: u8,
        pdu: Pdu,
        answer: bool,
    },
    /// To every drive of the line.
    Broadcast(Pdu),
    BadCrc(What),
    Told(What),
    Lost(What),
}

impl Bus {
    /// Takes everything that `link` has heard if there was silence until `now`.
    pub(super) fn listen(&mut self, link: LinkId, now: Instant) {
        while let Some(taken) = self.take(link, now) {
            if taken.is_request() {
                self.release_late(link);
            }
            match taken {
                Taken::Request { unit, pdu, answer: true } => {
                    self.emit(What::Foreign { unit, pdu, answer: true });
                }
                Taken::Request { unit, pdu, .. } => self.answer(link, unit, pdu),
                Taken::Broadcast(pdu) => self.broadcast(link, pdu),
                Taken::BadCrc(what) => self.answer_bad_crc(link, what),
                Taken::Told(what) => self.emit(what),
                Taken::Lost(what) => {
                    self.emit(what);
                    self.outputs.push_back(Output::Close(link));
                }
            }
        }
    }

    fn take(&mut self, link: LinkId, now: Instant) -> Option<Taken> {
        let it = self.links.get_mut(&link)?;
        let (tcp, sole) = (it.tcp, self.drives.len() == 1 && self.drives[0].is_powered());
        Some(match it.line.next(now, &self.units)? {
            // Modbus TCP lets a client say 0 or 255 for "whoever is there" (messaging on TCP/IP, 4.4.1.2).
            LineEvent::Request(adu) if adu.unit == BROADCAST && !(tcp && sole) => {
                broadcast(adu, tcp)
            }
            LineEvent::Foreign(Foreign::Request(adu)) if adu.unit == 0xFF && tcp && sole => {
                request(adu, tcp)
            }
            LineEvent::Request(adu) => request(adu, tcp),
            LineEvent::Foreign(foreign) => Taken::Told(told(foreign)),
            LineEvent::BadCrc { bytes, crc } => {
                Taken::BadCrc(What::BadCrc { frame: Frame::from_slice(bytes), crc, answered: None })
            }
            LineEvent::BadAscii { bytes, why } => {
                Taken::Told(What::BadAscii { characters: Frame::from_slice(bytes), why })
            }
            LineEvent::Noise { bytes, len, why } => {
                Taken::Told(What::Noise { head: Inline::from_slice(bytes), len, why })
            }
            LineEvent::Lost(why) => Taken::Lost(What::Lost(why)),
        })
    }

    fn answer(&mut self, link: LinkId, unit: u8, request: Pdu) {
        let addressed = self.by_unit[usize::from(unit)];
        let Some(id) = addressed.or_else(|| self.drives().next().map(|(id, _)| id)) else { return };
        let now = self.now;
        // Whoever says 0 or 255 on TCP means this drive, and a rule about its unit means that too.
        let asked = if addressed.is_some() { unit } else { self.drive(id).unit() };
        let mut fault_hit = self.faults.fault_hit(now, asked, &request);
        let mut repeated = None;
        let adu = Adu { unit, pdu: &request };
        let function = adu.function();
        let exception = |code| Response::Exception(Exception { function, code }).encode();
        if let Some(code) = fault_hit.as_ref().and_then(FaultHit::exception) {
            self.send(link, id, adu, exception(code), fault_hit.as_mut());
        } else if !fault_hit.as_ref().is_some_and(FaultHit::loses_request) {
            let drive = &mut self.drives[usize::from(id.0)];
            let (answer, refusal) = match drive.request(now, &request) {
                Ok(response) => (response.encode(), None),
                Err(refusal) => (exception(refusal.code), Some(refusal)),
            };
            let issued = drive.issued();
            self.count(id, function);
            // What an answer confirms must be there after a power failure.
            self.keep(id);
            self.send(link, id, adu, answer, fault_hit.as_mut());
            self.emit(What::Transaction(Transaction { drive: id, unit, request, answer, refusal }));
            let arrives = fault_hit.as_ref().map_or(Some(now), |it| it.arrives(now));
            repeated = self.repeat_detector.executed(now, id, request, issued, arrives);
        }
        self.tell(unit, fault_hit.as_ref());
        self.after_drive(id);
        if let Some((action, count)) = repeated {
            self.emit(What::RepeatedCommand { drive: id, unit, action, count });
        }
    }

    /// Every drive executes, none answers (serial line, 2.1).
    fn broadcast(&mut self, link: LinkId, request: Pdu) {
        let fault_hit = self.faults.fault_hit(self.now, BROADCAST, &request);
        if fault_hit.as_ref().is_some_and(FaultHit::loses_request) {
            return self.tell(BROADCAST, fault_hit.as_ref());
        }
        if fault_hit.is_some() {
            self.echo(link, Adu { unit: BROADCAST, pdu: &request });
            self.tell(BROADCAST, fault_hit.as_ref());
        }
        if request.first() == Some(&READ) {
            return self.emit(What::BroadcastRead { request });
        }
        for i in 0..self.drives.len() {
            if !self.hears(&self.drives[i]) {
                continue;
            }
            let (drive, unit) = (DriveId(i as u16), self.drives[i].unit());
            let refusal = self.drives[i].request(self.now, &request).err();
            self.emit(What::Broadcast { drive, unit, request, refusal });
            self.after_drive(drive);
        }
    }

    /// Some drives answer a broken frame, if the address in it is theirs.
    fn answer_bad_crc(&mut self, link: LinkId, what: What) {
        let What::BadCrc { frame, crc, .. } = what else { return };
        let named = frame.first().and_then(|unit| self.by_unit[usize::from(*unit)]);
        let answered = named.and_then(|id| {
            let code = self.drive(id).model().line.crc_error?;
            Some((id, code))
        });
        if let (Some((drive, code)), [unit, function, ..]) = (answered, &*frame) {
            let exception = Exception { function: *function & 0x7F, code };
            let adu = Adu { unit: *unit, pdu: &frame[1..] };
            self.send(link, drive, adu, Response::Exception(exception).encode(), None);
        }
        self.emit(What::BadCrc { frame, crc, answered });
    }
}

impl Taken {
    /// Does a master say it? Then late replies meet it.
    fn is_request(&self) -> bool {
        match self {
            Self::Request { answer, .. } => !answer,
            Self::Broadcast(_) => true,
            Self::Told(what) => matches!(what, What::Foreign { answer: false, .. }),
            Self::BadCrc(_) | Self::Lost(_) => false,
        }
    }
}

/// On a serial line the exception bit makes it an answer: our own, come back through a 2-wire adapter, or one of a
/// second drive at our address. Answering it would never end. A TCP client says nothing but requests.
fn request(adu: Adu<'_>, tcp: bool) -> Taken {
    let answer = !tcp && adu.function() & EXCEPTION != 0;
    Taken::Request { unit: adu.unit, pdu: Pdu::from_slice(adu.pdu), answer }
}

fn broadcast(adu: Adu<'_>, tcp: bool) -> Taken {
    match request(adu, tcp) {
        Taken::Request { pdu, answer: false, .. } => Taken::Broadcast(pdu),
        answer => answer,
    }
}

fn told(foreign: Foreign<'_>) -> What {
    let (adu, answer) = match foreign {
        Foreign::Request(adu) => (adu, false),
        Foreign::Response(adu) => (adu, true),
    };
    What::Foreign { unit: adu.unit, pdu: Pdu::from_slice(adu.pdu), answer }
}
