//! Who has a pseudo-terminal open, counted from the file notices of the system (Linux).
//!
//! We hold the terminal open ourselves, so the kernel never sees a last close. Opens and closes of others are
//! counted instead. The system merges a notice with the one before it if the two are equal; so the directory
//! is watched as well as the terminal, which puts another notice between any two of them.

use std::io;
use std::path::Path;
use std::task::{Context, Poll};

pub(super) use notices::Presence;

/// What the opens and closes since the last look have come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Since {
    /// No program has left, or one still has it open.
    Same,
    /// The last program has left.
    Left,
    /// The last program has left, and another has come.
    Replaced,
}

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
    pub(in super::super) struct Presence {
        notices: AsyncFd<OwnedFd>,
        terminal: i32,
        open: u32,
    }

    impl Presence {
        /// Counts from now on, while no other process has `terminal` open.
        pub(in super::super) fn watch(terminal: &Path) -> io::Result<Self> {
            let notices = inotify::init(CreateFlags::NONBLOCK | CreateFlags::CLOEXEC)?;
            let wanted = WatchFlags::OPEN | WatchFlags::CLOSE;
            let directory = terminal.parent().unwrap_or(Path::new("/"));
            inotify::add_watch(&notices, directory, wanted)?;
            let terminal = inotify::add_watch(&notices, terminal, wanted)?;
            Ok(Self { notices: super::super::watch(notices)?, terminal, open: 0 })
        }

        /// Did a program have it open at the last poll?
        pub(in super::super) fn is_anybody_there(&self) -> bool {
            self.open > 0
        }

        /// Waits until a look may be worth while.
        pub(in super::super) fn poll_changes(&self, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
            // What is noticed from here on makes it ready again.
            self.notices.poll_read_ready(cx).map_ok(|mut ready| ready.clear_ready())
        }

        /// What has happened since the last look.
        pub(in super::super) fn poll(&mut self) -> Since {
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
    pub(in super::super) enum Presence {}

    impl Presence {
        pub(in super::super) fn watch(_: &Path) -> io::Result<Self> {
            Err(io::ErrorKind::Unsupported.into())
        }

        pub(in super::super) fn is_anybody_there(&self) -> bool {
            match *self {}
        }

        pub(in super::super) fn poll_changes(&self, _: &mut Context<'_>) -> Poll<io::Result<()>> {
            match *self {}
        }

        pub(in super::super) fn poll(&mut self) -> Since {
            match *self {}
        }
    }
}
