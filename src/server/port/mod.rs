//! The ports: where bytes enter and leave the process.
//!
//! A [`Port`] moves bytes and tells who is there. It deliberately knows no Modbus, no frame and no emulated time.
//! Whatever kind it is, it is asked for its next event by polling, so that one task can serve several.
//!
//! All kinds keep the same promise about answers: **one write a whole answer, and never a wait**. A line
//! that waited for a slow reader would shift the time of every drive on it. What a reader does not take is
//! lost, as on a wire; only a TCP client, which was promised a stream, is disconnected instead.

pub mod pty;
pub mod serial;
mod stream;
mod symlink;
pub mod tcp;
mod tty;

use crate::serial::Settings;
use rustix::event::{PollFd, Timespec, poll};
use rustix::io::retry_on_intr;
use std::fmt;
use std::io;
use std::task::{Context, Poll};

pub use serial::Serial;
pub use stream::{MASTER, StreamPort};
pub use tcp::{Listener, TcpPort};
pub use tty::TtyPort;

/// Bytes that a port hands over at once; a Modbus frame has 260 at most.
pub const INPUT: usize = 1024;

/// A master at a port: a TCP client, or the program that has a terminal open. Never used twice at one port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ClientId(pub u64);

/// A way in for masters.
pub trait Port: fmt::Debug + Send {
    /// What happens next. Bytes go to the front of `input`.
    fn poll_event(&mut self, cx: &mut Context<'_>, input: &mut [u8; INPUT]) -> Poll<PortEvent>;

    /// Has something arrived of which [`Port::poll_event`] has not told yet? After a stall of the process a timer may
    /// be told of before it is.
    fn is_anything_waiting(&mut self) -> bool;

    /// Sends an answer in one write. Never waits. To a client that is gone, nothing.
    fn send(&mut self, to: ClientId, frame: &[u8]);

    /// Parts with a client whose requests can't be told apart any more.
    fn close(&mut self, client: ClientId);

    /// The line talks at another speed or in another format from now on, what was sent before excepted.
    fn set_line(&mut self, settings: Settings);

    /// The baud and the stop bits that the master has set at its end, where that can be seen.
    fn master(&self) -> Option<(u32, u8)>;
}

/// What happened at a port.
///
/// Every `Opened` is followed by at most one `Closed` or `Lost`, and nothing of a client comes after that.
#[derive(Debug)]
pub enum PortEvent {
    /// A master is there, or may be.
    Opened(ClientId),
    /// Bytes of a master, in order, cut anywhere.
    Bytes {
        /// Whose.
        from: ClientId,
        /// How many.
        len: usize,
        /// Before these bytes another program took the place of the one that was there. A frame may have begun with
        /// the first and end with the second.
        replaced: bool,
    },
    /// A master has left: what it said last has ended.
    Closed(ClientId),
    /// The way to a master is gone, in the middle of whatever it said.
    Lost(ClientId),
    /// Nothing will come here any more.
    Ended(io::Result<()>),
}

/// An error that still matches by kind and reads as a sentence.
fn said(kind: io::ErrorKind, sentence: impl Into<String>) -> io::Error {
    io::Error::new(kind, sentence.into())
}

/// Is there something to read at one of `watched`, right now?
fn is_any_ready(watched: &mut [PollFd<'_>]) -> bool {
    let now = Timespec { tv_sec: 0, tv_nsec: 0 };
    retry_on_intr(|| poll(watched, Some(&now))).is_ok_and(|ready| ready > 0)
}

/// Has the other end of a terminal gone? Linux and macOS tell it in different numbers.
fn is_hang_up(error: &io::Error) -> bool {
    use rustix::io::Errno;
    matches!(Errno::from_io_error(error), Some(Errno::IO | Errno::NXIO | Errno::NODEV))
}
