//! What is seen of a master's port: how it is set, and bytes that come at another speed than the line's.

use super::{Bus, LinkId};
use crate::event::{PortSettings, What};
use crate::time::Instant;
use crate::wire::{Frame, Inline, NoiseCause};

impl Bus {
    /// Tells how the port of a master is set, and whether the line understands it.
    pub fn tell_port(&mut self, now: Instant, port: PortSettings, understood: bool) {
        self.advance_to(now);
        self.emit(What::Port { port, understood });
    }

    /// Takes bytes that arrived on `link` at `now`, sent at `baud` rather than the speed of the line: no drive
    /// understands them.
    pub fn receive_unheard(&mut self, now: Instant, link: LinkId, bytes: &[u8], baud: u32) {
        self.advance_to(now);
        if self.line_behaviour.echo {
            bytes.chunks(super::CHUNK).for_each(|bytes| self.pass(link, &Frame::from_slice(bytes)));
        }
        let (head, why) = (Inline::from_slice(bytes), NoiseCause::Speed(baud));
        self.emit(What::Noise { head, len: bytes.len(), why });
    }
}
