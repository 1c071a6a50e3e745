//! A TCP port with many clients at once, told as one stream of events.
//!
//! Which frames cross it (MBAP, or serial frames as they are) is decided elsewhere. A client that only
//! shuts down its sending half counts as gone: answers given until then still reach it, later ones don't.
//! A peer that vanishes without a word (a pulled cable) is noticed by keepalive, within a minute.
//!
//! A limit on clients must not let those that do nothing keep out one that has something to ask: where
//! [`MAX_CLIENTS`] are connected, a new one displaces the one that has been silent longest.

use std::collections::{BTreeMap, VecDeque};
use std::io::{self, ErrorKind};
use std::net::SocketAddr;
use std::os::fd::AsFd;
use std::task::{Context, Poll, ready};

use rustix::event::{PollFd, PollFlags};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tracing::{info, warn};

use super::{ClientId, INPUT, Port, PortEvent, is_any_ready, said};
use crate::serial::Settings;
use crate::server::clock::{Clock, WallTimer};
use crate::time::Duration;
use client::Client;

mod client;

/// Clients at once; real drives and gateways serve 1 to 32.
pub const MAX_CLIENTS: usize = 64;

/// How long the listener rests when the system gives it no more descriptors.
const REST: Duration = Duration::from_secs(1);

/// Events that may wait for the line's owner, of at most 1 KiB each. Readers beyond that wait their turn, in
/// order, so that a client which floods us delays another by as many events and no more.
const EVENTS: usize = 16;

/// What happened at a listener.
///
/// Every `Opened` is followed by exactly one `Closed` or `Displaced`, and nothing of a client comes after that.
#[derive(Debug)]
pub enum TcpEvent {
    /// A client came.
    Opened(ClientId, SocketAddr),
    /// Bytes of a client, in order, cut anywhere.
    Bytes(ClientId, Vec<u8>),
    /// A client is gone: it left, we closed it (`None` both), its connection broke, or it stopped reading.
    Closed(ClientId, Option<io::Error>),
    /// A client came while [`MAX_CLIENTS`] were there, and this one was closed in its favour: none had been silent
    /// longer. It takes the place of its `Closed`.
    Displaced(ClientId),
    /// The system gives us no more connections (too many open files). None is taken until a client leaves or
    /// the owner, after some time, calls [`Listener::accept_again`].
    NotAccepting(io::Error),
}

/// A listening TCP port and its clients; all are closed when it is dropped.
#[derive(Debug)]
pub struct Listener {
    socket: TcpListener,
    accepting: bool,
    /// Whose turn it is: a client that comes, or those that are there.
    accepts_first: bool,
    clients: BTreeMap<ClientId, Client>,
    last_id: u64,
    /// Pieces of bytes that clients have sent: counted, since a port knows no time.
    pieces: u64,
    /// What the clients' tasks report.
    reports: Receiver<TcpEvent>,
    report: Sender<TcpEvent>,
    /// What we did ourselves and have not told yet.
    untold: VecDeque<TcpEvent>,
}

impl Listener {
    /// Listens on `HOST:PORT`; port 0 picks a free one.
    ///
    /// # Errors
    /// `AddrInUse`, `AddrNotAvailable`, `PermissionDenied`, `InvalidInput` or what else the system says;
    /// each as a sentence for the user.
    ///
    /// # Panics
    /// Outside a Tokio runtime with I/O.
    pub fn bind(addr: &str) -> io::Result<Self> {
        // The blocking call: names are looked up once, before anything runs.
        let socket = std::net::TcpListener::bind(addr)
            .and_then(|socket| socket.set_nonblocking(true).map(|()| socket))
            .and_then(TcpListener::from_std)
            .map_err(|e| refusal(addr, &e))?;
        let (report, reports) = channel(EVENTS);
        Ok(Self {
            socket,
            accepting: true,
            accepts_first: false,
            clients: BTreeMap::new(),
            last_id: 0,
            pieces: 0,
            reports,
            report,
            untold: VecDeque::new(),
        })
    }

    /// Where it listens, with the port that was picked.
    ///
    /// # Errors
    /// What the system says.
    pub fn local_addr(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Waits for the next event.
    pub fn poll_next(&mut self, cx: &mut Context<'_>) -> Poll<TcpEvent> {
        loop {
            if let Some(event) = self.untold.pop_front() {
                return Poll::Ready(event);
            }
            // Each has the first word by turns: a flood of bytes keeps no client out, and the other way round.
            self.accepts_first = !self.accepts_first;
            let accepted = if self.accepts_first { self.poll_accept(cx) } else { Poll::Pending };
            if let Poll::Ready(event) = accepted {
                match event {
                    Some(event) => return Poll::Ready(event),
                    None => continue,
                }
            }
            if let Poll::Ready(Some(report)) = self.reports.poll_recv(cx) {
                match self.told(report) {
                    Some(event) => return Poll::Ready(event),
                    None => continue,
                }
            }
            if self.accepts_first {
                return Poll::Pending;
            }
            match ready!(self.poll_accept(cx)) {
                Some(event) => return Poll::Ready(event),
                None => continue,
            }
        }
    }

    /// Takes a client in, of which [`Listener::poll_next`] has not told yet; or fails.
    fn poll_accept(&mut self, cx: &mut Context<'_>) -> Poll<Option<TcpEvent>> {
        if !self.accepting {
            return Poll::Pending;
        }
        Poll::Ready(match ready!(self.socket.poll_accept(cx)) {
            Ok((stream, peer)) => {
                self.admit(stream, peer);
                None
            }
            Err(e) => self.not_accepted(e),
        })
    }

    /// Has something arrived of which [`Listener::poll_next`] has not told yet?
    pub fn is_anything_waiting(&self) -> bool {
        let socket = self.accepting.then(|| self.socket.as_fd());
        let clients = self.clients.values().map(Client::as_fd);
        let watched = socket.into_iter().chain(clients);
        let mut watched: Vec<_> =
            watched.map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN)).collect();
        !self.untold.is_empty() || !self.reports.is_empty() || is_any_ready(&mut watched)
    }

    /// Sends an answer to a client: one write, if the connection takes it. Never waits. To a client that
    /// is gone, nothing; one that is too slow, or broken, is closed and reported by [`Listener::poll_next`].
    pub fn send(&mut self, id: ClientId, bytes: &[u8]) {
        if let Some(Err(e)) = self.clients.get(&id).map(|client| client.send(bytes)) {
            self.part(id, Some(e));
        }
    }

    /// Closes a client; [`Listener::poll_next`] reports it.
    pub fn close(&mut self, id: ClientId) {
        self.part(id, None);
    }

    /// Takes connections again after [`TcpEvent::NotAccepting`].
    pub fn accept_again(&mut self) {
        self.accepting = true;
    }

    fn admit(&mut self, stream: TcpStream, peer: SocketAddr) {
        if self.clients.len() >= MAX_CLIENTS {
            // Of those that have said nothing at all the one that came first.
            let silent = self.clients.iter().min_by_key(|(_, client)| client.last_active);
            let silent = silent.map(|(id, _)| *id);
            if let Some(id) = silent
                && self.forget(id)
            {
                self.untold.push_back(TcpEvent::Displaced(id));
            }
        }
        self.last_id += 1;
        let id = ClientId(self.last_id);
        self.clients.insert(id, Client::start(id, stream, self.report.clone()));
        self.untold.push_back(TcpEvent::Opened(id, peer));
    }

    fn not_accepted(&mut self, error: io::Error) -> Option<TcpEvent> {
        use ErrorKind::{ConnectionAborted, ConnectionReset, Interrupted};
        // A client that left before we looked is no news.
        if matches!(error.kind(), ConnectionAborted | ConnectionReset | Interrupted) {
            return None;
        }
        // The connection stays in the queue, so asking again at once would turn in a circle.
        self.accepting = false;
        Some(TcpEvent::NotAccepting(error))
    }

    /// A report of a client's task, unless that client is gone: its last words may still be in the queue.
    fn told(&mut self, report: TcpEvent) -> Option<TcpEvent> {
        let known = match &report {
            TcpEvent::Bytes(id, _) => {
                self.pieces += 1;
                let client =
                    self.clients.get_mut(id).map(|client| client.last_active = self.pieces);
                client.is_some()
            }
            TcpEvent::Closed(id, _) => self.forget(*id),
            _ => true,
        };
        known.then_some(report)
    }

    fn part(&mut self, id: ClientId, error: Option<io::Error>) {
        if self.forget(id) {
            self.untold.push_back(TcpEvent::Closed(id, error));
        }
    }

    fn forget(&mut self, id: ClientId) -> bool {
        let known = self.clients.remove(&id).is_some();
        self.accepting |= known;
        known
    }
}

/// A listener as a port of a line, with a word in the diagnostics about who comes and goes.
#[derive(Debug)]
pub struct TcpPort {
    /// What it is called there.
    name: String,
    listener: Listener,
    /// How many clients had to give way since the limit was reached; 0 below it.
    displaced: u64,
    /// Until then it takes no clients.
    rest: Option<WallTimer>,
}

impl TcpPort {
    /// The port of `listener`.
    pub fn new(name: String, listener: Listener) -> Self {
        Self { name, listener, displaced: 0, rest: None }
    }

    /// A client has left, as far as that concerns the line.
    fn left(&mut self, error: Option<io::Error>) {
        match error {
            Some(error) => warn!("{}: client connection lost: {error}", self.name),
            None => info!("{}: client disconnected", self.name),
        }
        // Told once a crowd, not once a client.
        if let count @ 1.. = std::mem::take(&mut self.displaced) {
            info!(
                "{}: fewer than {MAX_CLIENTS} clients again; {count} were disconnected",
                self.name
            );
        }
    }

    fn displace(&mut self) {
        if self.displaced == 0 {
            warn!(
                "{}: {MAX_CLIENTS} clients are connected, which is the limit: each new one disconnects \
                 the one that has been silent longest",
                self.name
            );
        }
        self.displaced += 1;
    }
}

impl Port for TcpPort {
    fn poll_event(&mut self, cx: &mut Context<'_>, input: &mut [u8; INPUT]) -> Poll<PortEvent> {
        loop {
            if self.rest.as_mut().is_some_and(|rest| rest.poll_over(cx).is_ready()) {
                self.rest = None;
                self.listener.accept_again();
            }
            return Poll::Ready(match ready!(self.listener.poll_next(cx)) {
                TcpEvent::Opened(client, from) => {
                    if self.displaced == 0 {
                        info!("{}: {from} connected", self.name);
                    }
                    PortEvent::Opened(client)
                }
                TcpEvent::Bytes(from, bytes) => {
                    let len = bytes.len();
                    input[..len].copy_from_slice(&bytes);
                    PortEvent::Bytes { from, len, replaced: false }
                }
                TcpEvent::Closed(client, error) => {
                    self.left(error);
                    PortEvent::Closed(client)
                }
                TcpEvent::Displaced(client) => {
                    self.displace();
                    PortEvent::Closed(client)
                }
                TcpEvent::NotAccepting(error) => {
                    warn!("{}: cannot accept clients at the moment: {error}", self.name);
                    self.rest = Some(Clock::wall_timer(REST));
                    continue;
                }
            });
        }
    }

    fn is_anything_waiting(&mut self) -> bool {
        self.listener.is_anything_waiting()
    }

    fn send(&mut self, to: ClientId, frame: &[u8]) {
        self.listener.send(to, frame);
    }

    fn close(&mut self, client: ClientId) {
        self.listener.close(client);
    }

    /// A connection has neither speed nor format.
    fn set_line(&mut self, _: Settings) {}

    fn master(&self) -> Option<(u32, u8)> {
        None
    }
}

fn refusal(addr: &str, error: &io::Error) -> io::Error {
    let why = match error.kind() {
        ErrorKind::AddrInUse => "address in use (port 0 picks a free one)".into(),
        ErrorKind::AddrNotAvailable => "not an address of this machine".into(),
        ErrorKind::PermissionDenied => "permission denied (ports below 1024 need root)".into(),
        ErrorKind::InvalidInput => "expected HOST:PORT".into(),
        _ => error.to_string(),
    };
    said(error.kind(), format!("cannot listen on {addr}: {why}"))
}

#[cfg(test)]
mod tests;
