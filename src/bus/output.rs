//! What leaves a bus, and when it wants to be woken.

use crate::drive::Timer;
use crate::event::{DriveId, Event};
use crate::serial::Mode;
use crate::time::Instant;
use crate::wire::Frame;
use std::fmt;

/// A link onto a bus: the serial line, or one TCP client.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LinkId(pub(super) u32);

/// What leaves a bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// A drive has stored something: what it keeps over power-off has to be safe before anything that comes
    /// behind this leaves, or an answer confirms what a power failure takes back.
    Keep(DriveId),
    /// A whole answer, or a lump of one where the line has an adapter, to be sent in one write.
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
