//! One line with its drives: bytes and time in, bytes and events out. No clock, no socket, no lock.
//!
//! Contract: feed one input, drain [`Bus::poll_output`] to `None`, come back at [`Bus::poll_at`] or with the
//! next input. Deadlines at or before `now` happen before the input that arrives at `now`; equal
//! deadlines happen in a fixed order: links, bytes that come through, replies that begin, others on the line,
//! then drives by number.
//!
//! A serial line has one link. A TCP port has one for each client, all onto the same drives.

mod answer;
mod chatter;
mod command;
mod deadlines;
mod faults;
mod output;
mod port;
mod repeat_detector;
mod request_counts;
mod transmit;
mod transmit_queue;

pub use command::{BETWEEN_EDGES, Command, CommandError, DriveOrder, LineCommand, Reply};
pub use output::{LinkId, Output, Wake, WakeReason};
pub use request_counts::RequestCounts;

use crate::drive::{Drive, Setup, View};
use crate::event::{Change, DriveId, Event, Remark, RemarkId, What};
use crate::line::{Framing, Line, Units};
use crate::medium::{Faults, LineBehaviour};
use crate::model::Model;
use crate::serial::Mode;
use crate::time::Instant;
use crate::wire::{BROADCAST, Frame};
use chatter::ChatterState;
use deadlines::{Deadlines, WakeTrace};
use repeat_detector::RepeatDetector;
use std::cmp::Ordering;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use transmit::LatencyTimer;
use transmit_queue::{Ticket, Timed, TransmitQueue};

/// Bytes that a line looks at before it is asked what it heard.
const CHUNK: usize = 256;

/// One line with its drives.
#[derive(Debug)]
pub struct Bus {
    now: Instant,
    links: BTreeMap<LinkId, Link>,
    next_link: u32,
    drives: Vec<Drive>,
    /// Device that each drive belongs to: the stations of one device share their power.
    devices: Vec<u16>,
    /// What each drive has heard.
    request_counts: Vec<RequestCounts>,
    /// What was told of steps.
    remarks: Vec<Remark>,
    /// How the line talks, if it is a serial one; then drives that talk otherwise are deaf.
    mode: Option<Mode>,
    /// The same for what is on its way: the line moves when that has left.
    spoken: Option<Mode>,
    units: Units,
    by_unit: [Option<DriveId>; 256],
    deadlines: Deadlines,
    wakes: WakeTrace,
    faults: Faults,
    line_behaviour: LineBehaviour,
    /// The timer of the adapter in front of the master, if there is one.
    adapter: Option<LatencyTimer>,
    queue: TransmitQueue,
    /// Bytes on the wire to the master.
    leaving: Timed,
    chatter: Option<ChatterState>,
    repeat_detector: RepeatDetector,
    outputs: VecDeque<Output>,
}

#[derive(Debug)]
struct Link {
    line: Line,
    /// A client of Modbus TCP.
    tcp: bool,
    /// When the last character of a reply has left.
    free: Instant,
    /// What the adapter is still collecting.
    lump: Option<Ticket>,
}

impl Bus {
    /// A line without anything on it.
    pub fn new() -> Self {
        Self {
            now: Instant::ZERO,
            links: BTreeMap::new(),
            next_link: 0,
            drives: Vec::new(),
            devices: Vec::new(),
            request_counts: Vec::new(),
            remarks: Vec::new(),
            mode: None,
            spoken: None,
            units: Units::new(),
            by_unit: [None; 256],
            deadlines: Deadlines::default(),
            wakes: WakeTrace::default(),
            faults: Faults::default(),
            line_behaviour: LineBehaviour::default(),
            adapter: None,
            queue: TransmitQueue::default(),
            leaving: Timed::default(),
            chatter: None,
            repeat_detector: RepeatDetector::default(),
            outputs: VecDeque::with_capacity(16),
        }
    }

    /// Puts one station of a device on the line; `setup` says which. Stations of one `device` share
    /// their power.
    pub fn add(&mut self, model: Arc<Model>, setup: &Setup, device: u16) -> DriveId {
        let id = DriveId(self.drives.len() as u16);
        self.drives.push(Drive::new(model, setup, self.now));
        self.devices.push(device);
        self.request_counts.push(RequestCounts::default());
        self.readdress();
        self.after_drive(id);
        id
    }

    /// Opens a link onto the line.
    pub fn open(&mut self, framing: Framing) -> LinkId {
        let id = LinkId(self.next_link);
        self.next_link += 1;
        let tcp = framing == Framing::Mbap;
        let line = Line::new(framing);
        self.links.insert(id, Link { line, tcp, free: Instant::ZERO, lump: None });
        id
    }

    /// Says how the line talks. Until then, and on TCP, every drive hears everything.
    pub fn set_mode(&mut self, mode: Mode) {
        self.mode = Some(mode);
        self.spoken = self.mode;
        self.readdress();
    }

    /// Tells frames on all serial links apart in another way from now on. What was half received is forgotten. Modbus
    /// TCP stays as it is.
    pub fn reframe_all(&mut self, framing: Framing) {
        let serial = self.links.values_mut().filter(|link| !link.tcp);
        serial.for_each(|link| link.line = Line::new(framing));
    }

    /// Closes a link. What was half received on it is forgotten, and what was to be sent on it.
    pub fn close(&mut self, link: LinkId) {
        self.forget_replies(link);
        self.links.remove(&link);
    }

    /// Forgets what was to be sent on a link: whoever asked for it has left, and another master is there.
    pub fn forget_replies(&mut self, link: LinkId) {
        self.queue.forget(link);
        self.leaving.forget(link);
    }

    /// Closes a link whose master has gone: what it said last has ended, as if by silence, and nobody hears the
    /// answer.
    pub fn hang_up(&mut self, now: Instant, link: LinkId) {
        self.advance_to(now);
        if let Some(silence) = self.silence_at(link) {
            self.listen(link, silence);
        }
        self.close(link);
    }

    /// The drives, in the order in which they were added.
    pub fn drives(&self) -> impl ExactSizeIterator<Item = (DriveId, &Drive)> {
        self.drives.iter().enumerate().map(|(i, drive)| (DriveId(i as u16), drive))
    }

    /// One drive.
    pub fn drive(&self, id: DriveId) -> &Drive {
        &self.drives[usize::from(id.0)]
    }

    /// Which device of the line a drive is a station of.
    pub fn device(&self, id: DriveId) -> u16 {
        self.devices[usize::from(id.0)]
    }

    /// The drive that answers to `unit`.
    pub fn find(&self, unit: u8) -> Option<DriveId> {
        self.by_unit[usize::from(unit)]
    }

    /// How the line talks, if it is a serial one.
    pub fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// How often a master has given a drive an order again whose answer it can't have heard.
    pub fn repeated_commands(&self, id: DriveId) -> u64 {
        self.repeat_detector.repeated(id)
    }

    /// The time up to which everything has happened.
    pub fn now(&self) -> Instant {
        self.now
    }

    /// Takes bytes that arrived on `link` at `now`.
    pub fn receive(&mut self, now: Instant, link: LinkId, bytes: &[u8]) {
        self.advance_to(now);
        self.interrupt_chatter();
        for chunk in bytes.chunks(CHUNK) {
            let Some(it) = self.links.get_mut(&link) else { return };
            it.line.receive(self.now, chunk);
            if self.line_behaviour.echo {
                self.pass(link, &Frame::from_slice(chunk));
            }
            self.listen(link, self.now);
        }
    }

    /// Lets time pass up to `now`: whatever is due until then happens, each thing at its own instant.
    /// Time never runs backwards; an earlier `now` changes nothing.
    pub fn advance_to(&mut self, now: Instant) {
        while let Some(wake) = self.poll_at().filter(|wake| wake.at <= now) {
            self.now = self.now.max(wake.at);
            match wake.reason {
                // The drive says by itself what has woken it.
                WakeReason::Drive(..) => {}
                _ => self.wakes.note(wake),
            }
            match wake.reason {
                WakeReason::Silence(link) => self.listen(link, self.now),
                WakeReason::Through(_) => {
                    let through = self.leaving.take_first();
                    let output = through.map(|(link, frame)| Output::Transmit { link, frame });
                    self.outputs.extend(output);
                    self.move_line();
                }
                WakeReason::Reply(_) => {
                    let due = self.queue.timed.take_first();
                    due.into_iter().for_each(|(link, frame)| self.transmit(link, frame));
                    self.move_line();
                }
                WakeReason::Chatter => self.let_others_speak(),
                WakeReason::Drive(id, _) => {
                    self.drives[usize::from(id.0)].advance_to(self.now);
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

    /// As [`Drive::next_time_when`].
    pub fn next_time_when(
        &self,
        id: DriveId,
        side: impl Fn(View<'_>) -> Ordering,
    ) -> Option<Instant> {
        self.drive(id).next_time_when(self.now, side)
    }

    /// The last wake-ups, the latest one last: for the message of a test that fails.
    pub fn wakes(&self) -> impl ExactSizeIterator<Item = &Wake> {
        self.wakes.iter()
    }

    /// What was told of a step.
    pub fn remark(&self, id: RemarkId) -> &Remark {
        &self.remarks[id.0 as usize]
    }

    /// The next thing that leaves the bus.
    pub fn poll_output(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    /// When silence will end what was half received on `link`.
    pub fn silence_at(&self, link: LinkId) -> Option<Instant> {
        self.links.get(&link)?.line.deadline()
    }

    /// Is what was received on `link` so far a whole frame that only waits for silence?
    pub fn is_whole(&self, link: LinkId) -> bool {
        self.links.get(&link).is_some_and(|it| it.line.waits_for_silence_only())
    }

    /// When the first watchdog of a drive expires if no master says more.
    pub fn watchdog_at(&self) -> Option<Instant> {
        self.drives.iter().filter_map(Drive::watchdog_at).min()
    }

    /// When to come back at the latest, and why.
    pub fn poll_at(&self) -> Option<Wake> {
        let silence = |(id, link): (&LinkId, &Link)| {
            let at = link.line.deadline()?;
            Some(Wake { at, reason: WakeReason::Silence(*id) })
        };
        let silences = self.links.iter().filter_map(silence);
        let through = |(at, link)| Wake { at, reason: WakeReason::Through(link) };
        let reply = |(at, link)| Wake { at, reason: WakeReason::Reply(link) };
        let others = |others: &ChatterState| Wake { at: others.at(), reason: WakeReason::Chatter };
        let bytes = self.leaving.first().map(through);
        let replies = self.queue.timed.first().map(reply);
        let others = self.chatter.as_ref().map(others);
        let drive = |(at, id, timer)| Wake { at, reason: WakeReason::Drive(id, timer) };
        let drives = self.deadlines.first().map(drive);
        let replies = bytes.into_iter().chain(replies);
        silences.chain(replies).chain(others).chain(drives).min_by_key(|wake| wake.at)
    }

    fn emit(&mut self, what: What) {
        self.outputs.push_back(Output::Event(Event { at: self.now, what }));
    }

    /// Has what a drive has stored kept.
    fn keep(&mut self, id: DriveId) {
        if self.drives[usize::from(id.0)].take_stored() {
            self.outputs.push_back(Output::Keep(id));
        }
    }

    /// Collects what a drive has to tell and when it wants to be woken.
    fn after_drive(&mut self, id: DriveId) {
        self.keep(id);
        if self.drives[usize::from(id.0)].take_restart() {
            self.switch(id, Drive::power_cycle);
        }
        while let Some(timer) = self.drives[usize::from(id.0)].poll_woken() {
            self.wakes.note(Wake { at: self.now, reason: WakeReason::Drive(id, timer) });
        }
        let mut moved = false;
        while let Some(change) = self.drives[usize::from(id.0)].poll_change() {
            moved |= matches!(
                change,
                Change::Unit { .. } | Change::Mode { .. } | Change::PoweredOn | Change::PoweredOff
            );
            let unit = self.drives[usize::from(id.0)].unit();
            self.emit(What::Drive { drive: id, unit, change });
        }
        if moved {
            self.follow_drives();
            self.readdress();
        }
        self.deadlines.set(id, self.drives[usize::from(id.0)].next_timer());
    }

    /// Switches all stations of `id`'s device: they share their power.
    fn switch(&mut self, id: DriveId, power: impl Fn(&mut Drive, Instant)) {
        let device = self.devices[usize::from(id.0)];
        for i in 0..self.drives.len() {
            if self.devices[i] == device {
                power(&mut self.drives[i], self.now);
                self.after_drive(DriveId(i as u16));
            }
        }
    }

    /// Where all drives of a serial line agree on another mode, the line goes with them: a lone drive takes
    /// its port along.
    fn follow_drives(&mut self) {
        let Some(line) = self.mode else { return };
        let mut modes = self.drives.iter().map(Drive::mode);
        let Some(Some(first)) = modes.next() else { return };
        if first != line && modes.all(|mode| mode == Some(first)) {
            self.mode = Some(first);
            self.move_line();
        }
    }

    /// Moves the port after its drives, once what is on its way has left.
    fn move_line(&mut self) {
        let Some(mode) = self.mode.filter(|_| self.spoken != self.mode) else { return };
        if !self.is_under_way() {
            self.spoken = self.mode;
            self.emit(What::Moved(mode));
            self.outputs.push_back(Output::Moved(mode));
        }
    }

    /// Does the drive hear what is said on the line?
    fn hears(&self, drive: &Drive) -> bool {
        drive.is_powered() && (self.mode.is_none() || drive.mode() == self.mode)
    }

    /// Finds out again who answers to what. Of two drives with one address the first answers.
    fn readdress(&mut self) {
        self.units = Units::new();
        self.by_unit = [None; 256];
        for (i, drive) in self.drives.iter().enumerate().rev() {
            if drive.unit() != BROADCAST && self.hears(drive) {
                self.units.insert(drive.unit());
                self.by_unit[usize::from(drive.unit())] = Some(DriveId(i as u16));
            }
        }
    }
}

impl Default for Bus {
    fn default() -> Self {
        Self::new()
    }
}
