//! An async byte stream as a port: an in-process pipe, for tests of master libraries.
//!
//! Unlike a wire it loses nothing: what its reader does not take waits, and no request is read meanwhile.

use super::{ClientId, INPUT, Port, PortEvent};
use crate::serial::Settings;
use std::fmt;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

/// A port whose one master is there until it drops the other end.
pub struct StreamPort<S> {
    stream: S,
    unsent: Vec<u8>,
    closing: bool,
}

/// The one master at a stream. It is there from the start: no event opens it.
pub const MASTER: ClientId = ClientId(0);

impl<S> StreamPort<S> {
    /// A port at our end of `stream`.
    pub fn new(stream: S) -> Self {
        Self { stream, unsent: Vec::new(), closing: false }
    }
}

impl<S> fmt::Debug for StreamPort<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StreamPort").field("unsent", &self.unsent.len()).finish_non_exhaustive()
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin + Send> Port for StreamPort<S> {
    fn poll_event(&mut self, cx: &mut Context<'_>, input: &mut [u8; INPUT]) -> Poll<PortEvent> {
        while !self.unsent.is_empty() {
            match ready!(Pin::new(&mut self.stream).poll_write(cx, &self.unsent)) {
                Ok(len) => drop(self.unsent.drain(..len)),
                // A reply may have been held until the client had left.
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                    return Poll::Ready(PortEvent::Ended(Ok(())));
                }
                Err(error) => return Poll::Ready(PortEvent::Ended(Err(error))),
            }
        }
        if self.closing {
            return Poll::Ready(PortEvent::Ended(Ok(())));
        }
        let mut buffer = ReadBuf::new(input);
        let read = ready!(Pin::new(&mut self.stream).poll_read(cx, &mut buffer));
        Poll::Ready(match read.map(|()| buffer.filled().len()) {
            Ok(0) => PortEvent::Ended(Ok(())),
            Ok(len) => PortEvent::Bytes { from: MASTER, len, replaced: false },
            Err(error) => PortEvent::Ended(Err(error)),
        })
    }

    /// What is in memory is seen at once.
    fn is_anything_waiting(&mut self) -> bool {
        false
    }

    fn send(&mut self, _: ClientId, frame: &[u8]) {
        self.unsent.extend_from_slice(frame);
    }

    fn close(&mut self, _: ClientId) {
        self.closing = true;
    }

    /// A stream has neither speed nor format.
    fn set_line(&mut self, _: Settings) {}

    fn master(&self) -> Option<(u32, u8)> {
        None
    }
}
