//! One client of a listener: its connection and the two tasks that serve it.
//!
//! The reader waits when the line's owner is behind, and with it, through TCP, the client: a flood stays on
//! the client's side. The owner never waits for a client: what a connection does not take at once goes to
//! a backlog of limited size, and a client that lets it fill up is given up.

use std::io::{self, ErrorKind};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rustix::net::sockopt;
use tokio::net::TcpStream;
use tokio::sync::mpsc::{Sender, UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::task::AbortHandle;

use super::{ClientId, INPUT, TcpEvent, said};
use crate::time::Duration;

/// Bytes that may wait for a client on top of what the system keeps for it: some hundred answers.
const BACKLOG: usize = 64 * 1024;

/// Silence after which the system asks the peer whether it is still there, how often it asks, and how many questions
/// without an answer end the connection: half a minute and three times ten seconds.
const KEEPALIVE_AFTER: Duration = Duration::from_secs(30);
const KEEPALIVE_EVERY: Duration = Duration::from_secs(10);
const KEEPALIVE_PROBES: u32 = 3;

/// A connected client; gone when this is dropped.
#[derive(Debug)]
pub(super) struct Client {
    /// The number of the piece of bytes that it sent last, among those of all clients; 0 before its first.
    pub(super) last_active: u64,
    stream: Arc<TcpStream>,
    backlog: UnboundedSender<Vec<u8>>,
    /// Bytes in the backlog, and in the hands of the writer.
    waiting: Arc<AtomicUsize>,
    reader: AbortHandle,
    writer: AbortHandle,
}

impl Client {
    /// Starts to serve a connection; what happens on it goes to `report`.
    pub(super) fn start(id: ClientId, stream: TcpStream, report: Sender<TcpEvent>) -> Self {
        // An answer must not wait for the next one. Fails only if the client has gone already.
        let _ = stream.set_nodelay(true);
        // Without it a client whose cable was pulled is never missed; where the system has none, it is not.
        let _ = keep_alive(&stream);
        let stream = Arc::new(stream);
        let (backlog, queue) = unbounded_channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        let reader = tokio::spawn(listen(id, stream.clone(), report.clone()));
        let writer = tokio::spawn(catch_up(id, stream.clone(), queue, waiting.clone(), report));
        let (reader, writer) = (reader.abort_handle(), writer.abort_handle());
        Self { last_active: 0, stream, backlog, waiting, reader, writer }
    }

    /// Sends an answer: in one write, if the connection takes it. Never waits.
    ///
    /// # Errors
    /// The connection is broken, or the client has not read for too long.
    pub(super) fn send(&self, bytes: &[u8]) -> io::Result<()> {
        let waiting = self.waiting.load(Relaxed);
        // Straight to the system, unless something older is still waiting.
        let taken = match waiting {
            0 => or_nothing(self.stream.try_write(bytes))?,
            _ => 0,
        };
        let rest = &bytes[taken..];
        if rest.is_empty() {
            return Ok(());
        }
        if waiting + rest.len() > BACKLOG {
            return Err(said(
                ErrorKind::ConnectionAborted,
                format!("stopped reading: {waiting} bytes of answers are waiting for it"),
            ));
        }
        self.waiting.fetch_add(rest.len(), Relaxed);
        // Without a writer the connection is broken, and the report of that is on its way.
        let _ = self.backlog.send(rest.to_vec());
        Ok(())
    }
}

impl AsFd for Client {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.stream.as_fd()
    }
}

#[cfg(test)]
impl Client {
    /// Bytes that the connection has not taken yet.
    pub(super) fn waiting(&self) -> usize {
        self.waiting.load(Relaxed)
    }

    /// The connection itself.
    pub(super) fn stream(&self) -> &TcpStream {
        &self.stream
    }

    /// Waits for what the writer waits for.
    pub(super) async fn has_room(&self) {
        self.stream.writable().await.unwrap();
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.reader.abort();
        self.writer.abort();
    }
}

/// Has the system ask a silent peer whether it is still there.
fn keep_alive(stream: &TcpStream) -> rustix::io::Result<()> {
    sockopt::set_socket_keepalive(stream, true)?;
    sockopt::set_tcp_keepidle(stream, KEEPALIVE_AFTER)?;
    sockopt::set_tcp_keepintvl(stream, KEEPALIVE_EVERY)?;
    sockopt::set_tcp_keepcnt(stream, KEEPALIVE_PROBES)
}

/// The reader: hands on what arrives, in order, until the client leaves.
async fn listen(id: ClientId, stream: Arc<TcpStream>, report: Sender<TcpEvent>) {
    let mut buf = [0; INPUT];
    let end = loop {
        match read(&stream, &mut buf).await {
            Ok(0) => break None,
            Ok(count) => {
                if report.send(TcpEvent::Bytes(id, buf[..count].to_vec())).await.is_err() {
                    return;
                }
            }
            Err(e) => break Some(e),
        }
    };
    // Fails only when the listener is gone, and then no reply is needed.
    let _ = report.send(TcpEvent::Closed(id, end)).await;
}

/// The writer: sends what a connection did not take at once.
async fn catch_up(
    id: ClientId,
    stream: Arc<TcpStream>,
    mut queue: UnboundedReceiver<Vec<u8>>,
    waiting: Arc<AtomicUsize>,
    report: Sender<TcpEvent>,
) {
    while let Some(bytes) = queue.recv().await {
        if let Err(e) = write_all(&stream, &bytes).await {
            let _ = report.send(TcpEvent::Closed(id, Some(e))).await;
            return;
        }
        waiting.fetch_sub(bytes.len(), Relaxed);
    }
}

async fn read(stream: &TcpStream, buf: &mut [u8]) -> io::Result<usize> {
    loop {
        stream.readable().await?;
        match stream.try_read(buf) {
            Err(e) if e.kind() == ErrorKind::WouldBlock => {}
            done => return done,
        }
    }
}

async fn write_all(stream: &TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        stream.writable().await?;
        bytes = &bytes[or_nothing(stream.try_write(bytes))?..];
    }
    Ok(())
}

fn or_nothing(done: io::Result<usize>) -> io::Result<usize> {
    match done {
        Err(e) if e.kind() == ErrorKind::WouldBlock => Ok(0),
        done => done,
    }
}
