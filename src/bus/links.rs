//! The links of a line: how each tells frames apart, and what it has received.

use super::stations::Stations;
use crate::event::EventKind;
use crate::line::{Foreign, Framing, Line, LineEvent};
use crate::medium::LinkId;
use crate::time::Instant;
use crate::wire::function::EXCEPTION;
use crate::wire::rtu::BadCrc;
use crate::wire::{Adu, BROADCAST, Coding, Frame, Inline, Pdu};
use std::collections::BTreeMap;

/// The links of a line. A serial port has one, a TCP port has one for each client.
#[derive(Debug, Default)]
pub(super) struct Links {
    by_id: BTreeMap<LinkId, Line>,
    next: u32,
}

impl Links {
    pub fn open(&mut self, framing: Framing) -> LinkId {
        let id = LinkId(self.next);
        self.next += 1;
        self.by_id.insert(id, Line::new(framing));
        id
    }

    pub fn close(&mut self, link: LinkId) {
        self.by_id.remove(&link);
    }

    /// Tells frames on all serial links apart in another way. What was half received is forgotten.
    pub fn reframe_all(&mut self, framing: Framing) {
        let serial = self.by_id.values_mut().filter(|line| !is_tcp(line));
        serial.for_each(|line| *line = Line::new(framing));
    }

    /// The line of `link`, unless that is closed.
    pub fn line(&self, link: LinkId) -> Option<&Line> {
        self.by_id.get(&link)
    }

    /// All of them.
    pub fn lines(&self) -> impl Iterator<Item = (LinkId, &Line)> {
        self.by_id.iter().map(|(id, line)| (*id, line))
    }

    /// Those that are no Modbus TCP.
    pub fn serial(&self) -> impl Iterator<Item = (LinkId, &Line)> {
        self.lines().filter(|(_, line)| !is_tcp(line))
    }

    /// When silence will end what was half received, by link.
    pub fn silences(&self) -> impl Iterator<Item = (Instant, LinkId)> {
        self.lines().filter_map(|(link, line)| Some((line.deadline()?, link)))
    }

    /// Takes bytes that arrived on `link` at `now`. Is it open?
    pub fn receive(&mut self, now: Instant, link: LinkId, bytes: &[u8]) -> bool {
        let line = self.by_id.get_mut(&link);
        line.map(|line| line.receive(now, bytes)).is_some()
    }

    /// What `link` has received next if there was silence until `now`.
    pub fn next(&mut self, now: Instant, link: LinkId, stations: &Stations) -> Option<LineInput> {
        let line = self.by_id.get_mut(&link)?;
        let is_tcp = is_tcp(line);
        let event = line.next(now, stations.units())?;
        Some(LineInput::of(event, is_tcp, stations))
    }
}

/// A client of Modbus TCP?
fn is_tcp(line: &Line) -> bool {
    line.coding() == Coding::Mbap
}

/// What a line has received, detached from its buffer so that drives and links can be touched again.
pub(super) enum LineInput {
    /// To one of our units.
    Request { unit: u8, pdu: Pdu },
    /// To every drive of the line.
    Broadcast(Pdu),
    /// A master's request to somebody who is not here.
    ForeignRequest(EventKind),
    /// A frame with a wrong checksum.
    BadCrc { frame: Frame, crc: BadCrc },
    /// Nothing that anybody answers.
    Other(EventKind),
    /// The stream can't be followed any more.
    Lost(EventKind),
}

impl LineInput {
    /// From a line that is Modbus TCP, or not, with these stations.
    fn of(event: LineEvent<'_>, is_tcp: bool, stations: &Stations) -> Self {
        let whoever = is_tcp && stations.sole().is_some();
        match event {
            // Modbus TCP lets a client say 0 or 255 for "whoever is there" (messaging on TCP/IP, 4.4.1.2).
            LineEvent::Request(adu) if adu.unit == BROADCAST && !whoever => {
                match Self::request(adu, is_tcp) {
                    Self::Request { pdu, .. } => Self::Broadcast(pdu),
                    reply => reply,
                }
            }
            LineEvent::Foreign(Foreign::Request(adu)) if adu.unit == 0xFF && whoever => {
                Self::request(adu, is_tcp)
            }
            LineEvent::Request(adu) => Self::request(adu, is_tcp),
            LineEvent::Foreign(Foreign::Request(adu)) => {
                let (pdu, here) = (Pdu::from_slice(adu.pdu), Some(stations.here(adu.unit)));
                Self::ForeignRequest(EventKind::Foreign { unit: adu.unit, pdu, reply: false, here })
            }
            LineEvent::Foreign(Foreign::Response(adu)) => Self::Other(foreign_reply(adu)),
            LineEvent::BadCrc { bytes, crc } => {
                Self::BadCrc { frame: Frame::from_slice(bytes), crc }
            }
            LineEvent::BadAscii { bytes, why } => {
                Self::Other(EventKind::BadAscii { characters: Frame::from_slice(bytes), why })
            }
            LineEvent::Noise { bytes, len, why } => {
                Self::Other(EventKind::Noise { head: Inline::from_slice(bytes), len, why })
            }
            LineEvent::Lost(why) => Self::Lost(EventKind::StreamClosed { why }),
        }
    }

    /// On a serial line the exception bit makes it a reply: our own, come back through a 2-wire adapter, or one of a
    /// second drive at our address. Answering it would never end. A TCP client sends nothing but requests.
    fn request(adu: Adu<'_>, is_tcp: bool) -> Self {
        match !is_tcp && adu.function() & EXCEPTION != 0 {
            true => Self::Other(foreign_reply(adu)),
            false => Self::Request { unit: adu.unit, pdu: Pdu::from_slice(adu.pdu) },
        }
    }
}

fn foreign_reply(adu: Adu<'_>) -> EventKind {
    let (unit, pdu) = (adu.unit, Pdu::from_slice(adu.pdu));
    EventKind::Foreign { unit, pdu, reply: true, here: None }
}
