//! A terminal as a port: a pseudo-terminal of ours, or a serial port that may go and come back.

use super::pty::{Input, Left, Pty};
use super::{ClientId, INPUT, Port, PortEvent, Serial};
use crate::serial::Settings;
use crate::server::clock::{Clock, WallTimer};
use crate::time::Duration;
use crate::wire::Frame;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::task::{Context, Poll, ready};
use tracing::{info, warn};

/// How long an answer may take to leave a port before it moves: 256 characters at 2400 baud.
const FLUSH: Duration = Duration::from_millis(1200);

/// How often it is looked whether it has left.
const FLUSH_STEP: Duration = Duration::from_millis(1);

/// How often a lost port is looked for.
const LOOK_AGAIN: Duration = Duration::from_millis(250);

/// A terminal, open.
#[derive(Debug)]
enum Tty {
    /// Our own pseudo-terminal.
    Pty(Pty),
    /// A device that others made.
    Serial(Serial),
}

impl Tty {
    /// Waits for bytes, or for the last program to leave.
    ///
    /// # Errors
    /// `NotConnected` when a serial port was unplugged; a pseudo-terminal of ours can't be.
    fn poll_read(&mut self, cx: &mut Context<'_>, buf: &mut [u8]) -> Poll<io::Result<Input>> {
        match self {
            Self::Pty(pty) => pty.poll_read(cx, buf),
            Self::Serial(serial) => {
                serial.poll_read(cx, buf).map_ok(|len| Input { len, left: Left::None })
            }
        }
    }

    /// Sends an answer in one write and says how many of its bytes were taken; the rest is lost.
    ///
    /// # Errors
    /// As for [`Tty::poll_read`].
    fn write_now(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Pty(pty) => pty.write_now(bytes),
            Self::Serial(serial) => serial.write_now(bytes),
        }
    }
}

/// Where a terminal is opened, once and again.
#[derive(Debug)]
enum TtyPlace {
    /// Wherever the system has one, with a symlink to it if asked for.
    Pty(Option<PathBuf>),
    /// The path of a device.
    Serial(String),
}

/// A terminal that is there, or is waited for.
#[derive(Debug)]
pub struct TtyPort {
    /// What it is called in diagnostics.
    name: String,
    place: TtyPlace,
    settings: Settings,
    state: TtyState,
    /// Who is at the other end.
    client: ClientId,
    /// The master at the port has been reported.
    is_told: bool,
    /// The other end has stopped reading.
    stalled: bool,
}

#[derive(Debug)]
enum TtyState {
    Open(Tty),
    /// It moves to new settings once what was written has left; what comes meanwhile leaves behind that.
    Moving {
        serial: Serial,
        patience: Duration,
        timer: WallTimer,
        queue: Vec<Frame>,
    },
    /// It is looked for when the timer ends. Of each new kind of failure one is told.
    Away {
        timer: WallTimer,
        told: ErrorKind,
    },
}

impl TtyState {
    /// Gone; it is looked for after a while.
    fn away() -> Self {
        Self::Away { timer: Clock::wall_timer(LOOK_AGAIN), told: ErrorKind::NotFound }
    }
}

impl TtyPort {
    /// Opens a pseudo-terminal for a line that is set to `settings`; with `link`, a symlink leads to it.
    ///
    /// # Errors
    /// As for [`Pty::open`].
    pub fn pty(name: String, link: Option<PathBuf>, settings: Settings) -> io::Result<Self> {
        Self::open(name, TtyPlace::Pty(link), settings)
    }

    /// Opens the serial device at `path` with `settings`.
    ///
    /// # Errors
    /// As for [`Serial::open`].
    pub fn serial(name: String, path: String, settings: Settings) -> io::Result<Self> {
        let port = Self::open(name, TtyPlace::Serial(path), settings)?;
        if let TtyState::Open(Tty::Serial(serial)) = &port.state {
            serial.note().into_iter().for_each(|note| warn!("{note}"));
        }
        Ok(port)
    }

    fn open(name: String, place: TtyPlace, settings: Settings) -> io::Result<Self> {
        let state = TtyState::Open(place.open(settings)?);
        let client = ClientId(0);
        Ok(Self { name, place, settings, state, client, is_told: false, stalled: false })
    }

    /// The path that masters open, and the symlink that leads there.
    pub fn paths(&self) -> (Option<String>, Option<String>) {
        let text = |path: &Path| path.display().to_string();
        match (&self.place, &self.state) {
            (TtyPlace::Serial(path), _) => (Some(path.clone()), None),
            (_, TtyState::Open(Tty::Pty(pty))) => (Some(text(pty.path())), pty.link().map(text)),
            _ => (None, None),
        }
    }

    /// The port is gone, and is waited for.
    fn lose(&mut self, error: &io::Error) {
        warn!("{}: the port disappeared ({error}); waiting for it", self.name);
        self.state = TtyState::away();
    }

    /// Goes on with what takes time. Is the terminal open and set as the line is?
    fn poll_open(&mut self, cx: &mut Context<'_>) -> Poll<()> {
        loop {
            match &mut self.state {
                TtyState::Open(_) => return Poll::Ready(()),
                TtyState::Moving { serial, patience, timer, .. } => {
                    let unsent = match serial.unsent() {
                        Ok(unsent) => unsent > 0 && !patience.is_zero(),
                        Err(error) => {
                            self.lose(&error);
                            continue;
                        }
                    };
                    if unsent {
                        ready!(timer.poll_over(cx));
                        *patience = patience.saturating_sub(FLUSH_STEP);
                        *timer = Clock::wall_timer(FLUSH_STEP);
                        continue;
                    }
                    self.moved();
                }
                TtyState::Away { timer, told } => {
                    ready!(timer.poll_over(cx));
                    match self.place.open(self.settings) {
                        Ok(tty) => {
                            self.state = TtyState::Open(tty);
                            info!("{}: the port is back", self.name);
                        }
                        Err(error) => {
                            if error.kind() != *told {
                                *told = error.kind();
                                warn!("{}: {error}; still waiting", self.name);
                            }
                            *timer = Clock::wall_timer(LOOK_AGAIN);
                        }
                    }
                }
            }
        }
    }

    /// What was written before has left: sets the port, and writes what has waited for that.
    fn moved(&mut self) {
        let state = std::mem::replace(&mut self.state, TtyState::away());
        let TtyState::Moving { mut serial, queue, .. } = state else { return };
        let Settings { baud, format } = self.settings;
        let set = serial.retune(baud, format.data_bits, format.parity.letter(), format.stop_bits);
        if let Err(error) = set {
            return self.lose(&error);
        }
        serial.note().into_iter().for_each(|note| warn!("{note}"));
        self.state = TtyState::Open(Tty::Serial(serial));
        queue.iter().for_each(|frame| self.write(frame));
    }

    fn write(&mut self, frame: &[u8]) {
        let TtyState::Open(tty) = &mut self.state else { return };
        match tty.write_now(frame) {
            Ok(taken) => {
                if taken < frame.len() && !self.stalled {
                    warn!("{}: replies are not being read; they are lost, as on a wire", self.name);
                }
                self.stalled = taken < frame.len();
            }
            Err(error) => self.lose(&error),
        }
    }

    /// The present program has left; the next one is another master.
    fn next_client(&mut self) -> ClientId {
        let gone = self.client;
        self.client = ClientId(gone.0 + 1);
        (self.is_told, self.stalled) = (false, false);
        gone
    }
}

impl Port for TtyPort {
    fn poll_event(&mut self, cx: &mut Context<'_>, input: &mut [u8; INPUT]) -> Poll<PortEvent> {
        loop {
            if self.is_told && matches!(self.state, TtyState::Away { .. }) {
                return Poll::Ready(PortEvent::Lost(self.next_client()));
            }
            ready!(self.poll_open(cx));
            let TtyState::Open(tty) = &mut self.state else { continue };
            if !self.is_told {
                self.is_told = true;
                return Poll::Ready(PortEvent::Opened(self.client));
            }
            let read = match ready!(tty.poll_read(cx, input)) {
                Ok(read) => read,
                Err(error) => {
                    self.lose(&error);
                    continue;
                }
            };
            if read.left == Left::After {
                return Poll::Ready(PortEvent::Closed(self.next_client()));
            }
            let replaced = read.left == Left::Before;
            self.stalled &= !replaced;
            return Poll::Ready(PortEvent::Bytes { from: self.client, len: read.len, replaced });
        }
    }

    fn is_anything_waiting(&mut self) -> bool {
        match &mut self.state {
            TtyState::Open(Tty::Pty(pty)) => pty.is_anything_waiting(),
            TtyState::Open(Tty::Serial(serial)) => serial.is_anything_waiting(),
            TtyState::Moving { .. } | TtyState::Away { .. } => false,
        }
    }

    fn send(&mut self, to: ClientId, frame: &[u8]) {
        match &mut self.state {
            _ if to != self.client => {}
            TtyState::Moving { queue, .. } => queue.push(Frame::from_slice(frame)),
            TtyState::Open(_) | TtyState::Away { .. } => self.write(frame),
        }
    }

    /// Only a TCP stream can be lost; here silence ends whatever it is.
    fn close(&mut self, _: ClientId) {}

    fn set_line(&mut self, settings: Settings) {
        self.settings = settings;
        self.state = match std::mem::replace(&mut self.state, TtyState::away()) {
            TtyState::Open(Tty::Serial(serial)) => {
                let (timer, queue) = (Clock::wall_timer(FLUSH_STEP), Vec::new());
                TtyState::Moving { serial, patience: FLUSH, timer, queue }
            }
            TtyState::Open(Tty::Pty(pty)) => {
                // The port of a program that has it open stays as that has set it, which may be wrong from now on.
                // A port without a program changes only its visible settings; bytes pass nevertheless.
                if !pty.is_open_elsewhere() {
                    let _ = pty.preset(settings.baud, settings.format.stop_bits);
                }
                TtyState::Open(Tty::Pty(pty))
            }
            moving_or_away => moving_or_away,
        };
    }

    fn master(&self) -> Option<(u32, u8)> {
        match &self.state {
            TtyState::Open(Tty::Pty(pty)) => pty.master_settings().ok(),
            _ => None,
        }
    }
}

impl TtyPlace {
    fn open(&self, Settings { baud, format }: Settings) -> io::Result<Tty> {
        match self {
            Self::Pty(link) => {
                let pty = Pty::open(link.as_deref())?;
                // So that a program that sets nothing is not blamed for it. Where that can't be done, it is.
                let _ = pty.preset(baud, format.stop_bits);
                Ok(Tty::Pty(pty))
            }
            Self::Serial(path) => {
                let parity = format.parity.letter();
                Serial::open(path, baud, format.data_bits, parity, format.stop_bits)
                    .map(Tty::Serial)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::future::poll_fn;
    use tokio::time::timeout;

    async fn next(port: &mut TtyPort) -> Option<PortEvent> {
        let mut input = [0; INPUT];
        let event = poll_fn(|cx| port.poll_event(cx, &mut input));
        timeout(std::time::Duration::from_millis(200), event).await.ok()
    }

    async fn heard(far: &mut Pty) -> Vec<u8> {
        let mut bytes = [0; INPUT];
        let read = poll_fn(|cx| far.poll_read(cx, &mut bytes));
        let read = timeout(std::time::Duration::from_secs(2), read).await.unwrap().unwrap();
        bytes[..read.len].to_vec()
    }

    /// What is written before leaves in the old settings, what comes behind in the new ones.
    #[tokio::test]
    async fn a_reply_leaves_before_the_port_moves() {
        let mut far = Pty::open(None).unwrap();
        let path = far.path().display().to_string();
        let mut port = TtyPort::serial("line".into(), path, "9600-8N2".parse().unwrap()).unwrap();
        let Some(PortEvent::Opened(client)) = next(&mut port).await else { panic!("not open") };
        port.send(client, b"old");
        port.set_line("57600-8N1".parse().unwrap());
        port.send(client, b"new");
        assert_eq!(heard(&mut far).await, b"old");
        assert_eq!(far.master_settings().unwrap(), (9600, 2));
        assert!(next(&mut port).await.is_none(), "nothing has happened");
        assert_eq!(far.master_settings().unwrap(), (57600, 1));
        assert_eq!(heard(&mut far).await, b"new");
        drop(far);
        let lost = next(&mut port).await;
        assert!(matches!(lost, Some(PortEvent::Lost(it)) if it == client), "{lost:?}");
        assert!(!port.is_anything_waiting());
        assert!(next(&mut port).await.is_none(), "there is nothing to open again");
    }
}
