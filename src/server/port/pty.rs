//! A pseudo-terminal of our own: a serial line without hardware.
//!
//! A program opens [`Pty::path`] as if it were a serial port. Two things differ from a real one, by the
//! kernel's decision: it has neither parity nor 7 data bits (Linux forces 8 data bits and clears parity),
//! and bytes cross it at once, at any baud.
//!
//! It holds its own descriptor of the side that programs open. Otherwise the first program to close it
//! would hang up the line, and reading would fail until another one came. The price: the kernel never sees
//! a *last* close, so it discards nothing that a program left unread and frees no lock that a killed program
//! had put on the terminal. `Presence` counts who is there, so that we can do both.

use std::ffi::OsString;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::task::{Context, Poll, ready};

use rustix::event::{PollFd, PollFlags};
use rustix::fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl};
use rustix::io::{Errno, FdFlags, fcntl_setfd, retry_on_intr};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, ioctl_tiocnxcl, tcflush, tcgetattr, tcsetattr,
};
use tokio::io::unix::AsyncFd;
use tracing::warn;

use super::symlink::PortSymlink;
use super::{is_any_ready, is_hang_up, said};
use notices::Presence;

/// What was read from a terminal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Input {
    /// Bytes; at least one, unless a program has left or there was nothing to read.
    pub len: usize,
    /// Have all programs left the other end?
    pub left: Left,
}

/// When the last program has closed a terminal, if it has. A real port does not tell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Left {
    /// It has not.
    #[default]
    None,
    /// Before these bytes, which are of the next program.
    Before,
    /// No program has it open now, and all that was sent has been read.
    After,
}

/// A pseudo-terminal, open at both ends.
#[derive(Debug)]
pub struct Pty {
    // First, so that it is dropped first: a link must not outlive what it points to.
    link: Option<PortSymlink>,
    master: AsyncFd<OwnedFd>,
    slave: OwnedFd,
    path: PathBuf,
    /// Who has it open; `None` where the system does not tell.
    presence: Option<Presence>,
    /// The last program has left, and something that it sent may still be waiting; then its leaving is not told yet.
    deserted: bool,
}

impl Pty {
    /// Opens a new pseudo-terminal in raw mode; with `link`, also a symlink to it that lives as long.
    ///
    /// # Errors
    /// The system has none to give, or the link can't be made: something other than a symlink is
    /// there, or its directory is missing.
    ///
    /// # Panics
    /// Outside a Tokio runtime with I/O.
    pub fn open(link: Option<&Path>) -> io::Result<Self> {
        let (master, slave, path) = open_pair()
            .map_err(|e| said(e.kind(), format!("cannot open a pseudo-terminal: {e}")))?;
        // Before its path is known to any program.
        let presence = Presence::watch(&path).inspect_err(|error| {
            warn!("{}: cannot detect when a program closes it: {error}", path.display());
        });
        let link = link.map(|at| PortSymlink::create(at, &path)).transpose()?;
        let (master, presence) = (watch(master)?, presence.ok());
        Ok(Self { link, master, slave, path, presence, deserted: false })
    }

    /// The device that programs open, such as `/dev/pts/3`.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The symlink to [`Pty::path`], absolute, if one was asked for.
    pub fn link(&self) -> Option<&Path> {
        self.link.as_ref().map(PortSymlink::at)
    }

    /// Waits for bytes, or for the last program to close it.
    ///
    /// # Errors
    /// What the system says, never a hang-up.
    pub fn poll_read(&mut self, cx: &mut Context<'_>, buf: &mut [u8]) -> Poll<io::Result<Input>> {
        if buf.is_empty() {
            return Poll::Ready(Ok(Input::default()));
        }
        loop {
            if self.deserted {
                return Poll::Ready(self.try_read(buf));
            }
            let len = match self.poll_bytes(cx, buf)? {
                Poll::Ready(len) => len,
                Poll::Pending => {
                    let Some(presence) = &self.presence else { return Poll::Pending };
                    ready!(presence.poll_changes(cx))?;
                    or_nothing(read(self.master.as_fd(), buf))?
                }
            };
            let input = self.told(len);
            if input != Input::default() {
                return Poll::Ready(Ok(input));
            }
        }
    }

    /// Waits for bytes, 1 at least.
    fn poll_bytes(&mut self, cx: &mut Context<'_>, buf: &mut [u8]) -> Poll<io::Result<usize>> {
        loop {
            let mut ready = ready!(self.master.poll_read_ready(cx))?;
            match ready.try_io(|master| Ok(read(master.as_fd(), buf)?)) {
                Ok(Ok(len)) if len > 0 => return Poll::Ready(Ok(len)),
                Ok(Err(e)) if !is_hang_up(&e) => return Poll::Ready(Err(e)),
                // Can't be while we hold the slave. If a system thinks otherwise, the line is as good as
                // idle, and asking again would only burn the processor: readiness stays set after a hang-up.
                Ok(_) => return Poll::Pending,
                Err(_would_block) => {}
            }
        }
    }

    /// Has something been sent, or the last program left, of which [`Pty::poll_read`] has not told yet?
    pub fn is_anything_waiting(&mut self) -> bool {
        let since = self.presence.as_mut().map_or(Since::Same, Presence::poll);
        self.deserted |= since != Since::Same;
        self.deserted || is_any_ready(&mut [PollFd::new(&self.master, PollFlags::IN)])
    }

    /// Takes what is waiting now; 0 bytes means nothing is.
    ///
    /// # Errors
    /// As for [`Pty::poll_read`].
    pub fn try_read(&mut self, buf: &mut [u8]) -> io::Result<Input> {
        let len = or_nothing(read(self.master.as_fd(), buf))?;
        Ok(self.told(len))
    }

    /// Has a program it open, as far as can be told?
    pub fn is_open_elsewhere(&self) -> bool {
        self.presence.as_ref().is_none_or(Presence::is_anybody_there)
    }

    /// `len` bytes were read, all that is there if 0: who has left before or behind them?
    fn told(&mut self, len: usize) -> Input {
        let Some(presence) = &mut self.presence else {
            if len > 0 {
                self.unlock();
            }
            return Input { len, left: Left::None };
        };
        // Looked at behind the bytes, so that what was sent before a close is read before it is told.
        let since = presence.poll();
        let present = presence.is_anybody_there();
        self.deserted |= since != Since::Same || len > 0 && !present;
        let left = match self.deserted {
            // Which bytes came from which program is not known any more; none is lost.
            true if present => Left::Before,
            true if len == 0 => Left::After,
            _ => Left::None,
        };
        if left != Left::None {
            self.deserted = false;
            // Answers to those who have left; the next program has asked nothing yet that was answered.
            let _ = tcflush(&self.slave, QueueSelector::IFlush);
        }
        if left == Left::After {
            self.unlock();
        }
        Input { len, left }
    }

    /// Sends an answer in one write and says how many of its bytes were taken.
    ///
    /// Never waits. Fewer than all (or 0) means that several KiB have not been read; the rest is lost.
    ///
    /// # Errors
    /// What the system says, never a hang-up.
    pub fn write_now(&self, bytes: &[u8]) -> io::Result<usize> {
        or_nothing(retry_on_intr(|| rustix::io::write(&self.master, bytes)))
    }

    /// Baud and stop bits (1 or 2) that the program at the other end has set last.
    ///
    /// They don't change what crosses the line; they are a hint that a program is set to another baud
    /// than the drive. Until a program sets them they are those of [`Pty::preset`], or 38400 and 1.
    ///
    /// # Errors
    /// What the system says.
    pub fn master_settings(&self) -> io::Result<(u32, u8)> {
        // Asked of our slave: the same on Linux, and macOS refuses it on the master.
        let termios = tcgetattr(&self.slave)?;
        let two = termios.control_modes.contains(ControlModes::CSTOPB);
        Ok((termios.output_speed(), if two { 2 } else { 1 }))
    }

    /// Sets what [`Pty::master_settings`] says until a program sets something else, so that one that
    /// never touches the baud (`cat`) is not blamed for it.
    ///
    /// # Errors
    /// The system knows no such baud.
    pub fn preset(&self, baud: u32, stop_bits: u8) -> io::Result<()> {
        let mut termios = tcgetattr(&self.slave)?;
        termios.set_speed(baud)?;
        termios.control_modes.set(ControlModes::CSTOPB, stop_bits == 2);
        Ok(tcsetattr(&self.slave, OptionalActions::Now, &termios)?)
    }

    /// Lets the next program in, should the last one have been killed with the terminal locked (`TIOCEXCL`).
    ///
    /// It leaves that to the last close, which never comes here, and without root every open would fail as busy.
    fn unlock(&self) {
        let _ = ioctl_tiocnxcl(&self.slave);
    }
}

fn open_pair() -> io::Result<(OwnedFd, OwnedFd, PathBuf)> {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
    fcntl_setfd(&master, FdFlags::CLOEXEC)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    let path = PathBuf::from(OsString::from_vec(ptsname(&master, Vec::new())?.into_bytes()));

    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
    let slave = rustix::fs::open(&path, flags, Mode::empty())?;
    let mut termios = tcgetattr(&slave)?;
    termios.make_raw();
    termios.control_modes |= ControlModes::CREAD | ControlModes::CLOCAL;
    tcsetattr(&slave, OptionalActions::Now, &termios)?;

    // After the slave was opened: macOS refuses it before.
    fcntl_setfl(&master, fcntl_getfl(&master)? | OFlags::NONBLOCK)?;
    Ok((master, slave, path))
}

/// The successor of `new` is an `unsafe fn`, which this crate forbids. What it asks for, a descriptor that
/// stays open and the same, is what an `OwnedFd` is.
#[allow(deprecated, reason = "sound for an OwnedFd; the successor is unsafe")]
fn watch(master: OwnedFd) -> io::Result<AsyncFd<OwnedFd>> {
    AsyncFd::new(master)
}

fn read(master: BorrowedFd<'_>, buf: &mut [u8]) -> rustix::io::Result<usize> {
    retry_on_intr(|| rustix::io::read(master, &mut *buf))
}

/// For a line, no data and no program are the same.
fn or_nothing(done: rustix::io::Result<usize>) -> io::Result<usize> {
    match done {
        Err(Errno::AGAIN) => Ok(0),
        Err(e) if is_hang_up(&e.into()) => Ok(0),
        other => Ok(other?),
    }
}

/// What the opens and closes since the last look have come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Since {
    /// No program has left, or one still has it open.
    Same,
    /// The last program has left.
    Left,
    /// The last program has left, and another has come.
    Replaced,
}

/// Who has a pseudo-terminal open, counted from the file notices of the system.
///
/// We hold the terminal open ourselves, so the kernel never sees a last close. Opens and closes of others are
/// counted instead. The system merges a notice with the one before it if the two are equal; so the directory
/// is watched as well as the terminal, which puts another notice between any two of them.
#[cfg(target_os = "linux")]
mod notices {
    use super::{Context, Path, Poll, Since, io};
    use rustix::fs::inotify::{self, CreateFlags, ReadFlags, WatchFlags};
    use rustix::io::Errno;
    use std::mem::MaybeUninit;
    use std::os::fd::OwnedFd;
    use tokio::io::unix::AsyncFd;

    /// How many open files of others lead to a terminal.
    #[derive(Debug)]
    pub(super) struct Presence {
        notices: AsyncFd<OwnedFd>,
        terminal: i32,
        open: u32,
    }

    impl Presence {
        /// Counts from now on, while no other process has `terminal` open.
        pub(super) fn watch(terminal: &Path) -> io::Result<Self> {
            let notices = inotify::init(CreateFlags::NONBLOCK | CreateFlags::CLOEXEC)?;
            let wanted = WatchFlags::OPEN | WatchFlags::CLOSE;
            let directory = terminal.parent().unwrap_or(Path::new("/"));
            inotify::add_watch(&notices, directory, wanted)?;
            let terminal = inotify::add_watch(&notices, terminal, wanted)?;
            Ok(Self { notices: super::watch(notices)?, terminal, open: 0 })
        }

        /// Did a program have it open at the last poll?
        pub(super) fn is_anybody_there(&self) -> bool {
            self.open > 0
        }

        /// Waits until a look may be worth while.
        pub(super) fn poll_changes(&self, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
            // What is noticed from here on makes it ready again.
            self.notices.poll_read_ready(cx).map_ok(|mut ready| ready.clear_ready())
        }

        /// What has happened since the last look.
        pub(super) fn poll(&mut self) -> Since {
            let mut buffer = [MaybeUninit::uninit(); 1024];
            let mut notices = inotify::Reader::new(self.notices.get_ref(), &mut buffer);
            let mut since = Since::Same;
            loop {
                let (watched, what) = match notices.next() {
                    Ok(notice) => (notice.wd(), notice.events()),
                    Err(Errno::INTR) => continue,
                    Err(_) => return since,
                };
                let ours = watched == self.terminal;
                if what.contains(ReadFlags::QUEUE_OVERFLOW) {
                    // Not known any more: as if all had left.
                    (self.open, since) = (0, Since::Left);
                } else if ours && what.contains(ReadFlags::OPEN) {
                    self.open += 1;
                    if since == Since::Left {
                        since = Since::Replaced;
                    }
                } else if ours && self.open > 0 {
                    self.open -= 1;
                    if self.open == 0 {
                        since = Since::Left;
                    }
                }
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod notices {
    use super::{Context, Path, Poll, Since, io};

    /// Never there: this system has no such notices of terminals.
    #[derive(Debug)]
    pub(super) enum Presence {}

    impl Presence {
        pub(super) fn watch(_: &Path) -> io::Result<Self> {
            Err(io::ErrorKind::Unsupported.into())
        }

        pub(super) fn is_anybody_there(&self) -> bool {
            match *self {}
        }

        pub(super) fn poll_changes(&self, _: &mut Context<'_>) -> Poll<io::Result<()>> {
            match *self {}
        }

        pub(super) fn poll(&mut self) -> Since {
            match *self {}
        }
    }
}

#[cfg(test)]
mod tests;
