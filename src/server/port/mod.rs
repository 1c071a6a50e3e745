//! The ports: where bytes enter and leave the process.
//!
//! A port moves bytes and tells who is there. It deliberately knows no Modbus, no frame and no
//! emulated time: it never waits on a clock, so coming back to a port that was unplugged is the
//! caller's job. Everything here runs on one thread, inside a Tokio runtime.
//!
//! All three keep the same promise about answers: **one write a whole answer, and never a wait**. A line
//! that waited for a slow reader would shift the time of every drive on it. What a reader does not take is
//! lost, as on a wire; only a TCP client, which was promised a stream, is disconnected instead.
//!
//! [`Pty`] and [`Serial`] carry one line each and look alike, hence [`Tty`]. A [`Listener`] carries many
//! clients and speaks in events.

mod client;
pub mod pty;
pub mod serial;
mod symlink;
pub mod tcp;
mod tuning;

use std::io;

pub use pty::Pty;
pub use serial::Serial;
pub use tcp::{ClientId, Listener, TcpEvent};

/// A port that carries one line: a pseudo-terminal of ours or a real serial port.
#[derive(Debug)]
pub enum Tty {
    /// Our own pseudo-terminal.
    Pty(Pty),
    /// A device that others made.
    Serial(Serial),
}

/// What was read from a terminal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Input {
    /// Bytes; at least one, unless somebody has left or nothing was there.
    pub len: usize,
    /// Have all programs left the other end?
    pub left: Left,
}

/// When the last program has closed a terminal, if it has. A real port does not tell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Left {
    /// It has not.
    #[default]
    Nobody,
    /// Before these bytes, which are of the next program.
    Before,
    /// Nobody is there now, and all that was sent has been read.
    After,
}

impl Tty {
    /// Waits for bytes, or for the last program to leave. Cancel-safe.
    ///
    /// # Errors
    /// `NotConnected` when a serial port was unplugged; a pseudo-terminal of ours can't be.
    pub async fn read(&mut self, buf: &mut [u8]) -> io::Result<Input> {
        match self {
            Self::Pty(pty) => pty.read(buf).await,
            Self::Serial(serial) => serial.read(buf).await.map(Input::bytes),
        }
    }

    /// Takes what is waiting now; 0 bytes means nothing is.
    ///
    /// # Errors
    /// As for [`Tty::read`].
    pub fn try_read(&mut self, buf: &mut [u8]) -> io::Result<Input> {
        match self {
            Self::Pty(pty) => pty.try_read(buf),
            Self::Serial(serial) => serial.try_read(buf).map(Input::bytes),
        }
    }

    /// Sends an answer in one write and says how many of its bytes were taken; the rest is lost.
    ///
    /// # Errors
    /// As for [`Tty::read`].
    pub fn write_now(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Pty(pty) => pty.write_now(bytes),
            Self::Serial(serial) => serial.write_now(bytes),
        }
    }
}

impl Input {
    fn bytes(len: usize) -> Self {
        Self { len, left: Left::Nobody }
    }
}

/// An error that still matches by kind and reads as a sentence.
fn said(kind: io::ErrorKind, sentence: impl Into<String>) -> io::Error {
    io::Error::new(kind, sentence.into())
}

/// Has the other end of a terminal gone? Linux and macOS tell it in different numbers.
fn is_hang_up(error: &io::Error) -> bool {
    use rustix::io::Errno;
    matches!(Errno::from_io_error(error), Some(Errno::IO | Errno::NXIO | Errno::NODEV))
}
