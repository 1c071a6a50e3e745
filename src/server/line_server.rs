//! Serves one line: its drives, the ports where masters reach them, the scenario that plays on it, its inbox.
//!
//! One loop for whatever kinds of ports: something arrives, or it is time; then what the bus gives goes out.

use super::clock::Clock;
use super::lock;
use super::logger::Logger;
use super::port::{ClientId, INPUT, Port, PortEvent};
use super::ports::{PortId, Ports};
use super::store::Store;
use crate::bench::WireSpec;
use crate::bus::{Bus, Carrier, Command, CommandError, LinkId, Output, Reply};
use crate::event::Event;
use crate::line::Framing;
use crate::scenario::{Director, Verdict};
use crate::serial::Mode;
use crate::time::{Duration, Instant};
use std::convert::Infallible;
use std::fmt;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use thiserror::Error;
use tokio::sync::{mpsc, oneshot};
use tracing::warn;

/// Of the wall: a line works so long at a time on what is due already.
const SLICE: Duration = Duration::from_millis(50);

/// That the machine is too slow is told once.
static LAGS: AtomicBool = AtomicBool::new(false);

/// A subscriber to the events of lines.
pub trait Subscriber: fmt::Debug + Send {
    /// `event` has happened on the line called `name`.
    fn tell(&mut self, event: &Event, name: &str);
}

/// The log of a run, shared by all lines.
impl Subscriber for Arc<Mutex<Logger>> {
    fn tell(&mut self, event: &Event, name: &str) {
        lock(self).log(event, name);
    }
}

/// A line and everything that reaches it.
#[derive(Debug)]
pub struct LineServer {
    name: String,
    bus: Bus,
    clock: Clock,
    /// How frames are told apart at ports that are no Modbus TCP.
    wire: WireSpec,
    ports: Ports,
    inbox: Inbox,
    /// The steps that a scenario has for it.
    director: Director,
    /// Dropped when those are over.
    over: Option<mpsc::Sender<Infallible>>,
    subscribers: Vec<Box<dyn Subscriber>>,
    /// Where drives keep what they store, shared by all lines; else that ends with them.
    store: Option<Arc<Mutex<Store>>>,
}

/// What a line waits for.
enum Next {
    Message(Message),
    Port(PortId, PortEvent),
    Time,
}

impl LineServer {
    /// The line called `name` with the drives on `bus`, set as `wire` says; commands come to `inbox`. It has no port yet.
    pub fn new(name: String, mut bus: Bus, wire: WireSpec, clock: Clock, inbox: Inbox) -> Self {
        bus.observe(false);
        Self {
            name,
            bus,
            clock,
            wire,
            ports: Ports::default(),
            inbox,
            director: Director::default(),
            over: None,
            subscribers: Vec::new(),
            store: None,
        }
    }

    /// The steps that a scenario has for it.
    #[must_use]
    pub fn with_director(self, director: Director) -> Self {
        Self { director, ..self }
    }

    /// Drops `over` as soon as the last step of its scenario is done.
    pub fn tell_over(&mut self, over: mpsc::Sender<Infallible>) {
        self.over = Some(over);
    }

    /// Adds a subscriber to the events of the line.
    pub fn subscribe(&mut self, subscriber: Box<dyn Subscriber>) {
        self.bus.observe(true);
        self.subscribers.push(subscriber);
    }

    /// Keeps what drives store in `store`, beginning with what they have by now.
    pub fn keep_in(&mut self, store: Arc<Mutex<Store>>) {
        lock(&store).take(&self.name, &self.bus);
        self.store = Some(store);
    }

    /// Lets masters in by one more port.
    pub fn open(&mut self, port: Box<dyn Port>, carrier: Carrier) {
        self.ports.add(port, carrier);
    }

    /// The same with a port whose master is there already and speaks on `link`.
    pub fn open_for(
        &mut self,
        port: Box<dyn Port>,
        carrier: Carrier,
        client: ClientId,
        link: LinkId,
    ) {
        let port = self.ports.add(port, carrier);
        self.ports.attach(port, client, link);
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its drives.
    pub fn bus(&self) -> &Bus {
        &self.bus
    }

    /// Serves it until it is told to stop, or nothing will come at any of its ports any more. Then they close: links
    /// are removed, clients see the end.
    ///
    /// # Errors
    /// Why the last port has ended, if not in peace.
    pub async fn serve(&mut self) -> io::Result<()> {
        let end = self.serve_until_end().await;
        self.ports = Ports::default();
        end
    }

    async fn serve_until_end(&mut self) -> io::Result<()> {
        let mut input = [0; INPUT];
        loop {
            self.send_all();
            let (clock, due) = (self.clock, self.due());
            // A sender waits for its reply, so the inbox starves no port. A port can flood us.
            let next = tokio::select! {
                biased;
                Some(message) = self.inbox.0.recv() => Next::Message(message),
                (port, event) = self.ports.next(&mut input) => Next::Port(port, event),
                () = woken(clock, due) => Next::Time,
            };
            let next = match next {
                // After a stall the timer may be told first; what was sent meanwhile came before that.
                Next::Time if self.ports.is_anything_waiting() => tokio::select! {
                    biased;
                    (port, event) = self.ports.next(&mut input) => Next::Port(port, event),
                    () = Clock::wall(SLICE) => Next::Time,
                },
                next => next,
            };
            match next {
                Next::Message(Message::Stop) => return Ok(()),
                Next::Message(Message::Command(command, reply)) => {
                    let now = self.advance();
                    let done = self.bus.command(now, command);
                    self.director.poll(&mut self.bus);
                    // The sender may have given up waiting.
                    let _ = reply.send(done);
                }
                Next::Port(_, PortEvent::Ended(end)) if self.ports.have_ended() => return end,
                Next::Port(port, event) => self.take(port, event, &input),
                Next::Time => drop(self.advance()),
            }
        }
    }

    /// It is over, and `why`: what became of the steps of its scenario.
    pub fn end(mut self, why: &str) -> Vec<Verdict> {
        self.director.end(self.clock.now(), Some(why));
        self.director.verdicts().to_vec()
    }

    /// Takes what has happened at a port.
    fn take(&mut self, port: PortId, event: PortEvent, input: &[u8]) {
        match event {
            PortEvent::Opened(client) => {
                let link = self.bus.open_on(self.ports.carrier(port), self.framing(port));
                self.ports.attach(port, client, link);
            }
            PortEvent::Bytes { from, len, replaced } => {
                let Some(link) = self.ports.link(port, from) else { return };
                if replaced {
                    // Not a link of its own: the rest of a frame may have come with its first bytes.
                    self.bus.forget_replies(link);
                }
                if len > 0 {
                    self.receive(port, link, &input[..len]);
                }
            }
            PortEvent::Closed(client) => {
                let Some(link) = self.ports.detach(port, client) else { return };
                let now = self.advance();
                self.bus.hang_up(now, link);
                self.director.poll(&mut self.bus);
            }
            PortEvent::Lost(client) => {
                let link = self.ports.detach(port, client);
                link.into_iter().for_each(|link| self.bus.close(link));
            }
            PortEvent::Ended(_) => {}
        }
    }

    /// Takes bytes that were just read.
    fn receive(&mut self, port: PortId, link: LinkId, bytes: &[u8]) {
        if let Some(baud) = self.look_at_master(port) {
            let now = self.advance();
            self.bus.receive_mismatched(now, link, bytes, baud);
        } else {
            let at = self.advance_to(self.arrival(link));
            self.bus.receive(at, link, bytes);
        }
        self.director.poll(&mut self.bus);
    }

    /// Tells, once, if the master's port is set to something that no wire would carry. Gives its baud if that is why
    /// no drive understands it.
    fn look_at_master(&mut self, port: PortId) -> Option<u32> {
        let master = self.ports.master(port, self.wire.mode.settings)?;
        let heard = !self.wire.match_baud || master.same_baud();
        if self.ports.is_news(port, master) {
            self.bus.tell_port(self.bus.now(), master, heard);
        }
        (!heard).then_some(master.baud)
    }

    /// Sends what there is to send. Events go to the subscribers, and what drives have stored to the disk.
    fn send_all(&mut self) {
        while let Some(output) = self.bus.poll_output() {
            match output {
                Output::Keep(drive) => {
                    if let Some(store) = &self.store {
                        lock(store).keep(&self.name, &self.bus, drive);
                    }
                }
                Output::Transmit { link, frame } => {
                    if self.carries(link) {
                        self.ports.send(link, &frame);
                    }
                }
                Output::Close(link) => self.ports.close(link),
                Output::Moved(mode) => self.moved(mode),
                Output::Event(event) => {
                    self.subscribers.iter_mut().for_each(|it| it.tell(&event, &self.name));
                }
            }
        }
        if self.director.is_over() {
            self.over = None;
        }
    }

    /// Does a frame of the line reach the master of `link` as it is?
    fn carries(&self, link: LinkId) -> bool {
        let master = |it: &Self| it.ports.master_of(link, it.wire.mode.settings);
        !self.wire.match_baud || master(self).is_none_or(|master| master.same_baud())
    }

    /// How frames are told apart on the links of `port`.
    fn framing(&self, port: PortId) -> Framing {
        match self.ports.carrier(port) {
            Carrier::Serial | Carrier::Uart => self.wire.framing(self.clock.rate()),
            Carrier::Tcp => Framing::Mbap,
        }
    }

    /// The line talks in another mode: so do its serial links, and its ports move there.
    fn moved(&mut self, mode: Mode) {
        self.wire.mode = mode;
        self.bus.reframe_all(self.wire.framing(self.clock.rate()));
        self.ports.set_line(mode.settings);
    }

    /// When the bus or the scenario has something to do.
    fn due(&self) -> Option<Instant> {
        let bus = self.bus.poll_at().map(|wake| wake.at);
        [bus, self.director.poll_at()].into_iter().flatten().min()
    }

    /// Lets time pass up to now and says how far that got.
    fn advance(&mut self) -> Instant {
        self.advance_to(self.clock.now())
    }

    /// Lets time pass up to `now` and says how far that got. Where this machine can't do in time what the line asks for, it
    /// is cut off after a slice of the wall, and the emulated world lags behind: the loop looks at its ports and lets
    /// others run before it goes on.
    fn advance_to(&mut self, now: Instant) -> Instant {
        let slice = Clock::wall_after(SLICE);
        while let Some(at) = self.due().filter(|at| *at < now) {
            self.director.advance_to(&mut self.bus, at);
            if Clock::is_over(slice) {
                if !LAGS.swap(true, Ordering::Relaxed) {
                    warn!(
                        "{}: cannot keep up with its clock; emulated time lags behind",
                        self.name
                    );
                }
                return self.bus.now().min(now);
            }
        }
        self.director.advance_to(&mut self.bus, now);
        now
    }

    /// The time at which input arrived on `link` that was just read.
    ///
    /// Input that waited while this process was kept from running is older than it looks: it came before the silence
    /// that was not observed yet, and before a watchdog or a step of a scenario that is overdue. What else a drive did by
    /// itself meanwhile says nothing about when it came: a watchdog that it refreshes counts from as late as can be.
    fn arrival(&self, link: LinkId) -> Instant {
        let now = self.clock.now();
        let silence = self.bus.silence_at(link);
        // A frame that is whole ended there; what has come since is another.
        let (ended, unfinished) = match self.bus.is_whole(link) {
            true => (silence, None),
            false => (None, silence),
        };
        let overdue = [unfinished, self.bus.watchdog_at(), self.director.poll_at()];
        let overdue = overdue.into_iter().flatten().min();
        let arrived = overdue.map_or(now, |at| now.min(at - Duration::from_nanos(1)));
        ended.filter(|at| *at <= now).map_or(arrived, |at| arrived.max(at))
    }
}

/// Sleeps until something is due. If that is over already, signals and other lines have their turn first.
async fn woken(clock: Clock, due: Option<Instant>) {
    match due {
        Some(at) if at <= clock.now() => tokio::task::yield_now().await,
        due => clock.until(due).await,
    }
}

/// Capacity of an inbox in messages; sending blocks when it is full.
const ROOM: usize = 16;

/// Gives commands to a line that is being served, from any task.
#[derive(Debug, Clone)]
pub struct LineHandle(mpsc::Sender<Message>);

/// Where the commands for a line come to: its only input besides its masters.
#[derive(Debug)]
pub struct Inbox(mpsc::Receiver<Message>);

/// Something for the line.
#[derive(Debug)]
enum Message {
    /// Carry this out and say what came of it.
    Command(Command, oneshot::Sender<Result<Reply, CommandError>>),
    /// Serve no more.
    Stop,
}

/// Why a command had no effect.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum InboxError {
    /// The line did not carry it out.
    #[error(transparent)]
    Refused(#[from] CommandError),
    /// The line is not served any more.
    #[error("the line is no longer served")]
    Ended,
}

impl LineHandle {
    /// A handle, and the inbox that it leads to: a line that is served takes from there.
    pub fn new() -> (Self, Inbox) {
        let (messages, inbox) = mpsc::channel(ROOM);
        (Self(messages), Inbox(inbox))
    }

    /// Has the line carry out `command` now, and waits until it has.
    ///
    /// # Errors
    /// Why it has not.
    pub async fn command(&self, command: impl Into<Command>) -> Result<Reply, InboxError> {
        let (reply, replied) = oneshot::channel();
        let message = Message::Command(command.into(), reply);
        self.0.send(message).await.map_err(|_| InboxError::Ended)?;
        Ok(replied.await.map_err(|_| InboxError::Ended)??)
    }

    /// Has the line served no more. Its ports close with it.
    pub async fn stop(&self) {
        // Fails if it is not served any more.
        let _ = self.0.send(Message::Stop).await;
    }
}
