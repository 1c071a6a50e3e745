//! Serves one line: port and clock in, port and log out. One loop a kind of port.

mod stream;
mod tcp;
mod tty;

pub use stream::serve_stream;
pub use tcp::serve_tcp;
pub use tty::{Reopen, serve_tty};

use super::clock::Clock;
use super::logger::Logger;
use super::scenario_run::ScenarioRun;
use super::store::Store;
use crate::bench::WireSpec;
use crate::bus::{Bus, LinkId, Output};
use crate::event::PortSettings;
use crate::line::Framing;
use crate::serial::{Mode, Settings};
use crate::time::{Duration, Instant};
use crate::wire::Frame;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tracing::warn;

/// Of the wall: a line works so long at a time on what is due already.
const SLICE: Duration = Duration::from_millis(50);

/// That the machine is too slow is told once.
static LAGS: AtomicBool = AtomicBool::new(false);

/// A line as a task serves it.
#[derive(Debug)]
pub struct LineServer {
    /// Its name.
    pub name: String,
    /// Its drives.
    pub bus: Bus,
    /// The time.
    pub clock: Clock,
    /// How frames are told apart.
    pub frames: Frames,
    /// The log, shared by all lines; none in a test.
    pub log: Option<Arc<Mutex<Logger>>>,
    /// Where drives keep what they store, shared by all lines; else that ends with them.
    pub store: Option<Arc<Mutex<Store>>>,
    /// The steps that a scenario has for it.
    pub scenario: Option<ScenarioRun>,
}

/// How frames are told apart on a port.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Frames {
    /// As on a serial line that is set so.
    Serial(WireSpec),
    /// Modbus TCP.
    Mbap,
}

/// Something for the port to do.
enum Send {
    Frame(LinkId, Frame),
    Close(LinkId),
    Move(Mode),
}

impl LineServer {
    /// The next thing for the port to do. On the way events go to the log, and what drives have stored goes to the
    /// disk.
    fn next_send(&mut self) -> Option<Send> {
        loop {
            match self.bus.poll_output()? {
                Output::Keep(drive) => {
                    if let Some(store) = &self.store {
                        lock(store).keep(&self.name, &self.bus, drive);
                    }
                }
                Output::Transmit { link, frame } => return Some(Send::Frame(link, frame)),
                Output::Close(link) => return Some(Send::Close(link)),
                Output::Moved(mode) => {
                    self.moved(mode);
                    return Some(Send::Move(mode));
                }
                Output::Event(event) => {
                    if let Some(log) = &self.log {
                        lock(log).log(&event, &self.name, &self.bus);
                    }
                }
            }
        }
    }

    /// How frames are told apart on each link.
    fn framing(&self) -> Framing {
        match self.frames {
            Frames::Serial(wire) => wire.framing(self.clock.rate()),
            Frames::Mbap => Framing::Mbap,
        }
    }

    /// Speed and format of the line.
    fn settings(&self) -> Settings {
        match self.frames {
            Frames::Serial(wire) => wire.mode.settings,
            Frames::Mbap => Settings::STANDARD,
        }
    }

    /// The line talks in another mode: so do all its links.
    fn moved(&mut self, mode: Mode) {
        if let Frames::Serial(wire) = &mut self.frames {
            wire.mode = mode;
        }
        self.bus.reframe_all(self.framing());
    }

    /// When the bus or the scenario has something to do.
    fn due(&self) -> Option<Instant> {
        let bus = self.bus.poll_at().map(|wake| wake.at);
        let scenario = self.scenario.as_ref().and_then(ScenarioRun::poll_at);
        [bus, scenario].into_iter().flatten().min()
    }

    /// Sleeps until the bus wants to be woken. If that is over already, signals and other lines have their turn first.
    async fn woken(&self) {
        match self.due() {
            Some(at) if at <= self.clock.now() => tokio::task::yield_now().await,
            due => self.clock.until(due).await,
        }
    }

    /// Lets time pass up to now.
    fn advance(&mut self) {
        self.advance_to(self.clock.now());
    }

    /// Lets time pass up to `now` and says how far that got. Where this machine can't do in time what the line asks for, it
    /// is cut off after a slice of the wall, and the emulated world lags behind: whoever serves the line looks at its
    /// port and lets others run before it goes on.
    fn advance_to(&mut self, now: Instant) -> Instant {
        let slice = Clock::wall_after(SLICE);
        while let Some(at) = self.due().filter(|at| *at < now) {
            self.pass(at);
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
        self.pass(now);
        now
    }

    fn pass(&mut self, now: Instant) {
        match &self.scenario {
            Some(scenario) => scenario.advance_to(&mut self.bus, now),
            None => self.bus.advance_to(now),
        }
    }

    /// Takes bytes that were just read from `link`.
    fn receive(&mut self, link: LinkId, bytes: &[u8]) {
        let at = self.advance_to(self.arrival(link));
        self.bus.receive(at, link, bytes);
        if let Some(scenario) = &self.scenario {
            scenario.poll(&mut self.bus);
        }
    }

    /// Takes bytes from `link` that were sent at `baud`, which is not the speed of the line.
    fn receive_unheard(&mut self, link: LinkId, bytes: &[u8], baud: u32) {
        self.advance();
        self.bus.receive_unheard(self.clock.now(), link, bytes, baud);
    }

    /// Tells how the port of the master is set.
    fn tell_port(&mut self, port: PortSettings, heard: bool) {
        self.bus.tell_port(self.bus.now(), port, heard);
    }

    /// Does a pseudo-terminal carry only what is sent at the speed of the line?
    fn matches_baud(&self) -> bool {
        matches!(self.frames, Frames::Serial(wire) if wire.match_baud)
    }

    /// The master of `link` has gone.
    fn hang_up(&mut self, link: LinkId) {
        self.bus.hang_up(self.clock.now(), link);
        if let Some(scenario) = &self.scenario {
            scenario.poll(&mut self.bus);
        }
    }

    /// The time at which input arrived on `link` that was just read.
    ///
    /// Input that waited while this process was kept from running is older than it looks: it came before the silence
    /// that nobody has heard yet, and before a watchdog or a step of a scenario that is overdue. What else a drive did by
    /// itself meanwhile says nothing about when it came: a watchdog that it refreshes counts from as late as can be.
    fn arrival(&self, link: LinkId) -> Instant {
        let now = self.clock.now();
        let silence = self.bus.silence_at(link);
        // A frame that is whole ended there; what has come since is another.
        let (ended, unfinished) = match self.bus.is_whole(link) {
            true => (silence, None),
            false => (None, silence),
        };
        let step = self.scenario.as_ref().and_then(ScenarioRun::poll_at);
        let overdue = [unfinished, self.bus.watchdog_at(), step].into_iter().flatten();
        let arrived = overdue.min().map_or(now, |at| now.min(at - Duration::from_nanos(1)));
        ended.filter(|at| *at <= now).map_or(arrived, |at| arrived.max(at))
    }
}

/// What lines share. A line that went down must not take the others along.
pub(super) fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
