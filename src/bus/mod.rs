//! One line with its drives: bytes and time in, bytes and events out. No clock, no socket, no lock.
//!
//! Contract: feed one input, drain [`Bus::poll_output`] to `None`, come back at [`Bus::poll_at`] or with the next
//! input. Deadlines at or before `now` happen before the input that arrives at `now`; equal ones happen in a fixed
//! order: links, bytes that come through, replies that begin, others on the line, then drives by number.
//!
//! A serial port has one link, a TCP port has one for each client, all onto the same drives.

mod command;
mod deadlines;
mod links;
mod output;
mod repeat_detector;
mod request_counts;
mod stations;

pub use crate::medium::{Carrier, LinkId};
pub use command::{BETWEEN_EDGES, Command, CommandError, DriveOrder, LineCommand, Reply};
pub use output::{Output, Wake, WakeReason};
pub use request_counts::RequestCounts;

use crate::drive::{Drive, DriveEffect, Setup, View};
use crate::event::{Broadcast, DriveId, Event, EventKind, PortSettings, Transaction};
use crate::line::{Framing, Line};
use crate::medium::{
    DriveReply, FaultRules, LineBehaviour, MasterRequest, Medium, Passage, PendingHit,
};
use crate::model::Model;
use crate::serial::Mode;
use crate::time::{Duration, Instant};
use crate::wire::function::READ;
use crate::wire::rtu::BadCrc;
use crate::wire::{Adu, BROADCAST, Exception, Frame, Inline, NoiseCause, Pdu, Response};
use deadlines::{Deadlines, WakeTrace};
use links::{LineInput, Links};
use output::OutputQueue;
use repeat_detector::RepeatDetector;
use stations::Stations;
use std::sync::Arc;

/// Bytes that a line looks at before it is asked what it heard.
const CHUNK: usize = 256;

/// One line with its drives.
#[derive(Debug, Default)]
pub struct Bus {
    now: Instant,
    links: Links,
    stations: Stations,
    /// How the line talks, if it is a serial one; then drives that talk otherwise are deaf. The medium follows once
    /// what is on its way has left.
    mode: Option<Mode>,
    deadlines: Deadlines,
    wakes: WakeTrace,
    medium: Medium,
    repeat_detector: RepeatDetector,
    outputs: OutputQueue,
}

impl Bus {
    /// A line without anything on it, on which nothing goes wrong.
    pub fn new() -> Self {
        Self::default()
    }

    /// A line without anything on it.
    pub fn with_medium(medium: Medium) -> Self {
        Self { medium, ..Self::default() }
    }

    /// Puts one station of a device on the line; `setup` says which. Stations of one `device` share
    /// their power.
    pub fn add(&mut self, model: Arc<Model>, setup: &Setup, device: u16) -> DriveId {
        let id = self.stations.add(Drive::new(model, setup, self.now), device);
        self.stations.readdress(self.mode);
        self.after_drive(id);
        id
    }

    /// Opens a link onto the line, on something that takes no time of its own.
    pub fn open(&mut self, framing: Framing) -> LinkId {
        let is_tcp = framing == Framing::Mbap;
        self.open_on(if is_tcp { Carrier::Tcp } else { Carrier::Serial }, framing)
    }

    /// Opens a link onto the line whose bytes `carrier` carries.
    pub fn open_on(&mut self, carrier: Carrier, framing: Framing) -> LinkId {
        let id = self.links.open(framing);
        self.medium.open(id, carrier);
        id
    }

    /// Says how the line talks. Until then, and on TCP, every drive hears everything.
    pub fn set_mode(&mut self, mode: Mode) {
        self.mode = Some(mode);
        self.medium.set_mode(self.mode);
        self.stations.readdress(self.mode);
    }

    /// Tells frames on all serial links apart in another way from now on. What was half received is forgotten. Modbus
    /// TCP stays as it is.
    pub fn reframe_all(&mut self, framing: Framing) {
        self.links.reframe_all(framing);
    }

    /// Closes a link. What was half received on it is forgotten, and what was to be sent on it.
    pub fn close(&mut self, link: LinkId) {
        self.medium.close(link);
        self.links.close(link);
    }

    /// Forgets what was to be sent on a link: whoever asked for it has left, and another master is there.
    pub fn forget_replies(&mut self, link: LinkId) {
        self.medium.forget(link);
    }

    /// Closes a link whose master has gone: what it said last has ended, as if by silence, and nobody hears the
    /// answer.
    pub fn hang_up(&mut self, now: Instant, link: LinkId) {
        self.advance_to(now);
        self.silence_at(link).into_iter().for_each(|silence| self.listen(link, silence));
        self.close(link);
    }

    /// The drives, in the order in which they were added.
    pub fn drives(&self) -> impl ExactSizeIterator<Item = (DriveId, &Drive)> {
        self.stations.iter()
    }

    /// One drive.
    pub fn drive(&self, id: DriveId) -> &Drive {
        self.stations.drive(id)
    }

    /// Which device of the line a drive is a station of.
    pub fn device(&self, id: DriveId) -> u16 {
        self.stations.device(id)
    }

    /// The drive that answers to `unit`.
    pub fn find(&self, unit: u8) -> Option<DriveId> {
        self.stations.find(unit)
    }

    /// How the line talks, if it is a serial one.
    pub fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// The fault rules of the line.
    pub fn faults(&self) -> &FaultRules {
        self.medium.rules()
    }

    /// What the line always does.
    pub fn line_behaviour(&self) -> &LineBehaviour {
        self.medium.behaviour()
    }

    /// Requests that a drive has executed since the start.
    pub fn request_counts(&self, id: DriveId) -> RequestCounts {
        self.stations.counts(id)
    }

    /// How often a master has given a drive an order again whose answer it can't have heard.
    pub fn repeated_commands(&self, id: DriveId) -> u64 {
        self.repeat_detector.repeated(id)
    }

    /// Should it give events as outputs? It does, unless it is told that nobody looks at them; then none is built.
    pub fn observe(&mut self, observed: bool) {
        self.outputs.observe(observed);
    }

    /// The time up to which everything has happened.
    pub fn now(&self) -> Instant {
        self.now
    }

    /// Takes bytes that arrived on `link` at `now`.
    pub fn receive(&mut self, now: Instant, link: LinkId, bytes: &[u8]) {
        self.advance_to(now);
        if self.medium.interrupt_chatter(self.now) {
            // Our master has waited for silence, so what others said before has ended on all links.
            let open: Vec<_> = self.links.silences().collect();
            open.into_iter().for_each(|(silence, link)| self.listen(link, silence));
        }
        for chunk in bytes.chunks(CHUNK) {
            if !self.links.receive(self.now, link, chunk) {
                return;
            }
            self.medium.on_bytes(self.now, link, chunk);
            self.place_transmits();
            self.listen(link, self.now);
        }
    }

    /// Takes bytes that arrived on `link` at `now`, sent at `baud` rather than the speed of the line: no drive
    /// understands them.
    pub fn receive_mismatched(&mut self, now: Instant, link: LinkId, bytes: &[u8], baud: u32) {
        self.advance_to(now);
        bytes.chunks(CHUNK).for_each(|chunk| self.medium.on_bytes(self.now, link, chunk));
        self.place_transmits();
        let (head, why) = (Inline::from_slice(bytes), NoiseCause::Speed(baud));
        self.emit(EventKind::Noise { head, len: bytes.len(), why });
    }

    /// Tells how the port of a master is set, and whether the line understands it.
    pub fn tell_port(&mut self, now: Instant, port: PortSettings, understood: bool) {
        self.advance_to(now);
        self.emit(port.event(understood));
    }

    /// Lets time pass up to `now`: whatever is due until then happens, each thing at its own instant.
    /// Time never runs backwards; an earlier `now` changes nothing.
    pub fn advance_to(&mut self, now: Instant) {
        while let Some(wake) = self.poll_at().filter(|wake| wake.at <= now) {
            self.now = self.now.max(wake.at);
            // A drive says by itself what has woken it.
            if !matches!(wake.reason, WakeReason::Drive(..)) {
                self.wakes.note(wake);
            }
            match wake.reason {
                WakeReason::Silence(link) => self.listen(link, self.now),
                WakeReason::Through(_) | WakeReason::Reply(_) => {
                    self.medium.on_timeout(self.now);
                    self.place_transmits();
                    self.move_line();
                }
                WakeReason::Chatter => self.let_others_speak(),
                WakeReason::Drive(id, _) => {
                    self.stations.drive_mut(id).advance_to(self.now);
                    self.after_drive(id);
                }
            }
        }
        self.now = self.now.max(now);
    }

    /// One drive as it is now.
    pub fn view(&self, id: DriveId) -> View<'_> {
        self.drive(id).at(self.now)
    }

    /// The last wake-ups, the latest one last: for the message of a test that fails.
    pub fn wakes(&self) -> impl ExactSizeIterator<Item = &Wake> {
        self.wakes.iter()
    }

    /// The next thing that leaves the bus.
    pub fn poll_output(&mut self) -> Option<Output> {
        self.outputs.poll(&mut self.medium)
    }

    /// When silence will end what was half received on `link`.
    pub fn silence_at(&self, link: LinkId) -> Option<Instant> {
        self.links.line(link)?.deadline()
    }

    /// Is what was received on `link` so far a whole frame that only waits for silence?
    pub fn is_whole(&self, link: LinkId) -> bool {
        self.links.line(link).is_some_and(Line::waits_for_silence_only)
    }

    /// When the first watchdog of a drive expires if no master says more.
    pub fn watchdog_at(&self) -> Option<Instant> {
        self.stations.iter().filter_map(|(_, drive)| drive.watchdog_at()).min()
    }

    /// When to come back at the latest, and why.
    pub fn poll_at(&self) -> Option<Wake> {
        let silences = self.links.silences().map(|(at, link)| (at, WakeReason::Silence(link)));
        let medium = self.medium.poll_at().map(|(at, timer)| (at, timer.into()));
        let drives =
            self.deadlines.first().map(|(at, id, timer)| (at, WakeReason::Drive(id, timer)));
        let first = silences.chain(medium).chain(drives).min_by_key(|(at, _)| *at);
        first.map(|(at, reason)| Wake { at, reason })
    }

    /// Takes everything that `link` has received if there was silence until `now`.
    fn listen(&mut self, link: LinkId, now: Instant) {
        while let Some(input) = self.links.next(now, link, &self.stations) {
            match input {
                LineInput::Request { unit, pdu } => self.answer(link, unit, pdu),
                LineInput::Broadcast(pdu) => self.broadcast(link, pdu),
                LineInput::ForeignRequest(kind) => {
                    self.medium.on_foreign_request(self.now, link);
                    self.place_transmits();
                    self.emit(kind);
                }
                LineInput::BadCrc { frame, crc } => self.answer_bad_crc(link, frame, crc),
                LineInput::Other(what) => self.emit(what),
                LineInput::Lost(what) => {
                    self.emit(what);
                    self.outputs.push(Output::Close(link));
                }
            }
        }
    }

    fn answer(&mut self, link: LinkId, unit: u8, request: Pdu) {
        let addressed = self.stations.find(unit);
        let Some(id) = addressed.or_else(|| self.drives().next().map(|(id, _)| id)) else { return };
        let now = self.now;
        let adu = Adu { unit, pdu: &request };
        // Whoever says 0 or 255 on TCP means this drive, and a rule about its unit means that too.
        let asked = if addressed.is_some() { unit } else { self.drive(id).unit() };
        let mut hit = self.on_request(link, adu, asked);
        let function = adu.function();
        let exception = |code| Response::Exception(Exception { function, code }).encode();
        let mut repeated = None;
        match hit.as_ref().map_or(Passage::Delivered, PendingHit::passage) {
            Passage::Lost => {}
            Passage::Answered(code) => {
                self.reply(link, id, unit, &exception(code), hit.as_mut());
            }
            Passage::Delivered => {
                let drive = self.stations.drive_mut(id);
                let (reply, refusal) = match drive.request(now, &request) {
                    Ok(response) => (response.encode(), None),
                    Err(refusal) => (exception(refusal.code), Some(refusal)),
                };
                let issued = drive.issued();
                self.stations.count(id, function);
                // What an answer confirms must be there after a power failure.
                self.keep(id);
                let later = self.reply(link, id, unit, &reply, hit.as_mut());
                self.emit_with(|bus| {
                    let (drive, decoder) = (id, bus.drive(id).decoder());
                    Transaction { drive, unit, decoder, request, reply, refusal }.into()
                });
                let arrives = later.map(|later| now + later);
                repeated = self.repeat_detector.executed(now, id, &request, issued, arrives);
            }
        }
        hit.into_iter().for_each(|hit| self.emit(EventKind::Fault(hit.finish())));
        self.after_drive(id);
        if let Some((action, count)) = repeated {
            self.emit(EventKind::RepeatedCommand { drive: id, unit, action, count });
        }
    }

    /// Every drive executes, none answers (serial line, 2.1).
    fn broadcast(&mut self, link: LinkId, request: Pdu) {
        let hit = self.on_request(link, Adu { unit: BROADCAST, pdu: &request }, BROADCAST);
        let passage = hit.as_ref().map_or(Passage::Delivered, PendingHit::passage);
        hit.into_iter().for_each(|hit| self.emit(EventKind::Fault(hit.finish())));
        if passage == Passage::Lost {
            return;
        }
        if request.first() == Some(&READ) {
            return self.emit(EventKind::BroadcastRead { request });
        }
        for drive in self.stations.ids() {
            if !self.stations.receives(drive, self.mode) {
                continue;
            }
            let station = self.stations.drive_mut(drive);
            let unit = station.unit();
            let refusal = station.request(self.now, &request).err();
            self.emit_with(|bus| {
                let decoder = bus.drive(drive).decoder();
                Broadcast { drive, unit, decoder, request, refusal }.into()
            });
            self.after_drive(drive);
        }
    }

    /// Some drives answer a broken frame, if the address in it is theirs.
    fn answer_bad_crc(&mut self, link: LinkId, frame: Frame, crc: BadCrc) {
        let named = frame.first().and_then(|unit| self.stations.find(*unit));
        let answered = named.and_then(|id| Some((id, self.drive(id).model().line.crc_error?)));
        if let (Some((drive, code)), [unit, function, ..]) = (answered, &*frame) {
            let exception = Exception { function: *function & 0x7F, code };
            self.reply(link, drive, *unit, &Response::Exception(exception).encode(), None);
        }
        self.emit(EventKind::bad_crc(frame, crc, answered.map(|(_, code)| code)));
    }

    fn on_request(&mut self, link: LinkId, adu: Adu<'_>, unit: u8) -> Option<PendingHit> {
        let line = self.links.line(link)?;
        let hit = self.medium.on_request(self.now, &MasterRequest { link, line, adu, unit });
        self.place_transmits();
        hit
    }

    /// Lets `drive` reply as `unit`. How much later than usual the master has an answer that it accepts, if ever.
    fn reply(
        &mut self,
        link: LinkId,
        drive: DriveId,
        unit: u8,
        pdu: &Pdu,
        hit: Option<&mut PendingHit>,
    ) -> Option<Duration> {
        let line = self.links.line(link)?;
        let paced = self.medium.paced_mode();
        let begins = paced.map_or(self.now, |mode| {
            let turnaround = self.stations.drive(drive).model().line.turnaround(mode);
            self.now.max(line.received_at() + turnaround)
        });
        let reply = DriveReply { link, line, unit, pdu, begins };
        let later = self.medium.on_reply(self.now, &reply, hit);
        self.place_transmits();
        later
    }

    /// Others on the line have their turn: our masters and our drives receive what they say.
    fn let_others_speak(&mut self) {
        let said = self.medium.on_chatter(self.now, self.links.serial(), self.stations.units());
        let Some(frame) = said else { return };
        let links: Vec<LinkId> = self.links.serial().map(|(link, _)| link).collect();
        for link in links {
            self.medium.overhear(self.now, link, &frame);
            self.place_transmits();
            self.links.receive(self.now, link, &frame);
            self.listen(link, self.now);
        }
    }

    fn place_transmits(&mut self) {
        self.outputs.place_transmits(&self.medium);
    }

    /// Tells of an event, which is built only if somebody wants to know.
    fn emit_with(&mut self, kind: impl FnOnce(&Self) -> EventKind) {
        if self.outputs.is_observed() {
            let kind = kind(self);
            self.outputs.push(Output::Event(Event { at: self.now, kind }));
        }
    }

    fn emit(&mut self, kind: EventKind) {
        self.emit_with(|_| kind);
    }

    /// Has what a drive has stored kept.
    fn keep(&mut self, id: DriveId) {
        if self.stations.drive_mut(id).take_stored() {
            self.outputs.push(Output::Keep(id));
        }
    }

    /// Collects what a drive has to tell and when it wants to be woken.
    fn after_drive(&mut self, id: DriveId) {
        self.keep(id);
        if self.stations.drive_mut(id).take_restart() {
            self.switch(id, Drive::power_cycle);
        }
        let mut moved = false;
        while let Some(effect) = self.stations.drive_mut(id).poll_effect() {
            let event = match effect {
                DriveEffect::Told(event) => event,
                DriveEffect::Woken(timer) => {
                    self.wakes.note(Wake { at: self.now, reason: WakeReason::Drive(id, timer) });
                    continue;
                }
            };
            let changes_reach = event.changes_reach();
            moved |= changes_reach;
            self.emit_with(|bus| {
                // It takes a look at every drive, and only such an event is read with it.
                let line = if changes_reach { bus.stations.agreed_mode(bus.mode) } else { None };
                EventKind::Drive { drive: id, unit: bus.drive(id).unit(), line, event }
            });
        }
        if moved {
            // Where all drives of a serial line agree on another mode, the line goes with them.
            self.mode = self.stations.agreed_mode(self.mode);
            self.move_line();
            self.stations.readdress(self.mode);
        }
        self.deadlines.set(id, self.stations.drive(id).next_timer());
    }

    /// Switches all stations of `id`'s device: they share their power.
    fn switch(&mut self, id: DriveId, power: impl Fn(&mut Drive, Instant)) {
        let device = self.stations.device(id);
        for id in self.stations.ids() {
            if self.stations.device(id) == device {
                power(self.stations.drive_mut(id), self.now);
                self.after_drive(id);
            }
        }
    }

    /// Moves the port after its drives, once what is on its way has left.
    fn move_line(&mut self) {
        let Some(mode) = self.mode.filter(|_| self.medium.mode() != self.mode) else { return };
        if !self.medium.is_under_way() {
            self.medium.set_mode(self.mode);
            self.emit(EventKind::LineSettings { mode });
            self.outputs.push(Output::Moved(mode));
        }
    }
}
