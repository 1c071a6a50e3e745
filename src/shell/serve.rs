//! Serves one line: port and clock in, port and log out. One loop a kind of port.

mod stream;
mod tcp;
mod tty;

pub use stream::serve_stream;
pub use tcp::serve_tcp;
pub use tty::{Reopen, serve_tty};

use super::clock::Clock;
use super::logger::Logger;
use crate::bus::{Bus, LinkId, Output, Wake, WakeReason};
use crate::line::Framing;
use crate::time::{Duration, Instant};
use crate::wire::Frame;
use std::cell::RefCell;
use std::rc::Rc;

/// A line as a task serves it.
#[derive(Debug)]
pub struct Served {
    /// Its name.
    pub name: String,
    /// Its drives.
    pub bus: Bus,
    /// The time.
    pub clock: Clock,
    /// How frames are told apart.
    pub framing: Framing,
    /// The log, shared by all lines; none in a test.
    pub log: Option<Rc<RefCell<Logger>>>,
}

/// Something for the port to do.
enum Send {
    Frame(LinkId, Frame),
    Close(LinkId),
}

impl Served {
    /// The next thing for the port to do; events go to the log on the way.
    fn next_send(&mut self) -> Option<Send> {
        loop {
            match self.bus.poll_output()? {
                Output::Transmit { link, frame } => return Some(Send::Frame(link, frame)),
                Output::Close(link) => return Some(Send::Close(link)),
                Output::Event(event) => {
                    if let Some(log) = &self.log {
                        log.borrow_mut().log(&event, &self.name, &self.bus);
                    }
                }
            }
        }
    }

    /// Sleeps until the bus wants to be woken.
    async fn woken(&self) {
        self.clock.until(self.bus.poll_at().map(|wake| wake.at)).await;
    }

    /// The time at which input arrived that was just read.
    ///
    /// Input that waited while this process was kept from running is older than it looks; it came before
    /// the silence that nobody has heard yet.
    fn arrival(&self) -> Instant {
        let now = self.clock.now();
        match self.bus.poll_at() {
            Some(Wake { at, reason: WakeReason::Silence(_) }) if at <= now => {
                at - Duration::from_nanos(1)
            }
            _ => now,
        }
    }
}
