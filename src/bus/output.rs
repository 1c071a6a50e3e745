//! What leaves a bus, and when it wants to be woken.

use crate::drive::Timer;
use crate::event::{DriveId, Event};
use crate::medium::{LinkId, Medium, MediumTimer};
use crate::serial::Mode;
use crate::time::Instant;
use crate::wire::Frame;
use std::collections::VecDeque;
use std::fmt;

/// What leaves a bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Output {
    /// A drive has stored something: what it keeps over power-off has to be safe before anything that comes
    /// behind this leaves, or an answer confirms what a power failure takes back.
    Keep(DriveId),
    /// A whole reply, or a chunk of one where the line has an adapter, to be sent in one write.
    Transmit {
        /// Where to.
        link: LinkId,
        /// The bytes.
        frame: Frame,
    },
    /// The line talks in another mode from now on: a port moves there once what was transmitted has left, and
    /// its link is framed anew.
    Moved(Mode),
    /// The link can't be followed any more and should be closed.
    Close(LinkId),
    /// Something happened.
    Event(Event),
}

/// What leaves a bus and was not polled yet, in order. Frames stay with the medium until then, and only have their
/// places here.
#[derive(Debug, Default)]
pub(super) struct OutputQueue {
    queue: VecDeque<PendingOutput>,
    /// Frames of the medium that have their place.
    placed: usize,
    /// Nobody wants to know of events.
    is_unobserved: bool,
}

#[derive(Debug)]
enum PendingOutput {
    Transmit,
    Other(Output),
}

impl OutputQueue {
    pub fn push(&mut self, output: Output) {
        self.queue.push_back(PendingOutput::Other(output));
    }

    /// Does somebody want to know of events?
    pub fn is_observed(&self) -> bool {
        !self.is_unobserved
    }

    pub fn observe(&mut self, observed: bool) {
        self.is_unobserved = !observed;
    }

    /// Gives the frames that `medium` has let go their places behind what is there.
    pub fn place_transmits(&mut self, medium: &Medium) {
        while self.placed < medium.transmits() {
            self.queue.push_back(PendingOutput::Transmit);
            self.placed += 1;
        }
    }

    pub fn poll(&mut self, medium: &mut Medium) -> Option<Output> {
        match self.queue.pop_front()? {
            PendingOutput::Other(output) => Some(output),
            PendingOutput::Transmit => {
                self.placed -= 1;
                medium.poll_transmit().map(|(link, frame)| Output::Transmit { link, frame })
            }
        }
    }
}

/// When a bus wants to be woken at the latest, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wake {
    /// When.
    pub at: Instant,
    /// Why.
    pub reason: WakeReason,
}

/// Why a bus wants to be woken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WakeReason {
    /// Silence will end a frame on that link.
    Silence(LinkId),
    /// Bytes have come through to the master of that link.
    Through(LinkId),
    /// A reply that was held begins to leave on that link.
    Reply(LinkId),
    /// The other masters on the line speak.
    Chatter,
    /// Something will happen in that drive, the first of what it waits for.
    Drive(DriveId, Timer),
}

impl fmt::Display for Wake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}  {}", self.at, self.reason)
    }
}

impl fmt::Display for WakeReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silence(link) => write!(f, "link {}: silence", link.0),
            Self::Through(link) => write!(f, "link {}: bytes through", link.0),
            Self::Reply(link) => write!(f, "link {}: delayed reply", link.0),
            Self::Chatter => f.write_str("chatter"),
            Self::Drive(drive, timer) => write!(f, "drive {}: {timer}", drive.0),
        }
    }
}

impl From<MediumTimer> for WakeReason {
    fn from(timer: MediumTimer) -> Self {
        match timer {
            MediumTimer::Through(link) => Self::Through(link),
            MediumTimer::Reply(link) => Self::Reply(link),
            MediumTimer::Chatter => Self::Chatter,
        }
    }
}
