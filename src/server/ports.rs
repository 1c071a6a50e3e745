//! The ports of one line: which of them has something to tell, and on which link each of their masters speaks.

use super::port::{ClientId, INPUT, Port, PortEvent};
use crate::bus::{Carrier, LinkId};
use crate::event::PortSettings;
use crate::serial::Settings;
use std::collections::BTreeMap;
use std::future::poll_fn;
use std::task::Poll;

/// Which port of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PortId(usize);

/// The ports of a line.
#[derive(Debug, Default)]
pub struct Ports {
    all: Vec<OpenPort>,
    /// Which is asked first next time: a port that always has something keeps no other waiting.
    turn: usize,
    by_client: BTreeMap<(PortId, ClientId), LinkId>,
    by_link: BTreeMap<LinkId, (PortId, ClientId)>,
}

#[derive(Debug)]
struct OpenPort {
    port: Box<dyn Port>,
    carrier: Carrier,
    /// How its master had set its end when that was told last.
    told: Option<PortSettings>,
    /// Nothing will come there any more.
    ended: bool,
}

impl Ports {
    /// One more.
    pub fn add(&mut self, port: Box<dyn Port>, carrier: Carrier) -> PortId {
        self.all.push(OpenPort { port, carrier, told: None, ended: false });
        PortId(self.all.len() - 1)
    }

    /// Waits for what happens next at any of them; bytes go to the front of `input`. Cancel-safe.
    pub async fn next(&mut self, input: &mut [u8; INPUT]) -> (PortId, PortEvent) {
        poll_fn(|cx| {
            let count = self.all.len();
            let turn = self.turn;
            for at in (0..count).map(|i| (turn + i) % count) {
                let it = &mut self.all[at];
                if it.ended {
                    continue;
                }
                if let Poll::Ready(event) = it.port.poll_event(cx, input) {
                    it.ended = matches!(event, PortEvent::Ended(_));
                    self.turn = at + 1;
                    return Poll::Ready((PortId(at), event));
                }
            }
            Poll::Pending
        })
        .await
    }

    /// Has something arrived of which [`Ports::next`] has not told yet?
    pub fn is_anything_waiting(&mut self) -> bool {
        self.all.iter_mut().any(|it| !it.ended && it.port.is_anything_waiting())
    }

    /// Will nothing come at any of them any more?
    pub fn have_ended(&self) -> bool {
        self.all.iter().all(|it| it.ended)
    }

    /// What carries the bytes of `port`.
    pub fn carrier(&self, port: PortId) -> Carrier {
        self.all[port.0].carrier
    }

    /// The master `client` speaks on `link` from now on.
    pub fn attach(&mut self, port: PortId, client: ClientId, link: LinkId) {
        self.by_client.insert((port, client), link);
        self.by_link.insert(link, (port, client));
    }

    /// The master `client` does not speak any more; gives back the link on which it did.
    pub fn detach(&mut self, port: PortId, client: ClientId) -> Option<LinkId> {
        let link = self.by_client.remove(&(port, client))?;
        self.by_link.remove(&link);
        Some(link)
    }

    /// The link on which a master speaks.
    pub fn link(&self, port: PortId, client: ClientId) -> Option<LinkId> {
        self.by_client.get(&(port, client)).copied()
    }

    /// Sends a frame to the master of `link`, if it is still there.
    pub fn send(&mut self, link: LinkId, frame: &[u8]) {
        if let Some((port, client)) = self.by_link.get(&link) {
            self.all[port.0].port.send(*client, frame);
        }
    }

    /// Parts with the master of `link`.
    pub fn close(&mut self, link: LinkId) {
        if let Some((port, client)) = self.by_link.get(&link) {
            self.all[port.0].port.close(*client);
        }
    }

    /// The line talks in other settings from now on.
    pub fn set_line(&mut self, settings: Settings) {
        self.all.iter_mut().for_each(|it| it.port.set_line(settings));
    }

    /// How the master at `port` has set its end, against a line that is set to `line`; where that can be seen.
    pub fn master(&self, port: PortId, line: Settings) -> Option<PortSettings> {
        let (baud, stop_bits) = self.all[port.0].port.master()?;
        Some(PortSettings { baud, stop_bits, line })
    }

    /// The same for the port on which the master of `link` speaks.
    pub fn master_of(&self, link: LinkId, line: Settings) -> Option<PortSettings> {
        let (port, _) = self.by_link.get(&link)?;
        self.master(*port, line)
    }

    /// `now` is how the master at `port` has set its end: is that worth a word? Settings that fit are only where
    /// others were told before, and each is told once.
    pub fn is_news(&mut self, port: PortId, now: PortSettings) -> bool {
        let told = self.all[port.0].told.replace(now);
        told != Some(now) && (!now.fits() || told.is_some_and(|told| !told.fits()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::port::{MASTER, StreamPort};
    use tokio::io::AsyncWriteExt;

    /// Two ports that always have something: each has its turn.
    #[tokio::test]
    async fn no_port_keeps_another_waiting() {
        let mut ports = Ports::default();
        let mut masters = Vec::new();
        for _ in 0..2 {
            let (mut master, ours) = tokio::io::duplex(8 * INPUT);
            master.write_all(&[0; 4 * INPUT]).await.unwrap();
            ports.add(Box::new(StreamPort::new(ours)), Carrier::Serial);
            masters.push(master);
        }
        let mut input = [0; INPUT];
        for turn in 0..8 {
            let (port, event) = ports.next(&mut input).await;
            assert_eq!(port, PortId(turn % 2));
            assert!(matches!(event, PortEvent::Bytes { from: MASTER, .. }), "{event:?}");
        }
        drop(masters);
        for _ in 0..2 {
            assert!(!ports.have_ended());
            let (_, event) = ports.next(&mut input).await;
            assert!(matches!(event, PortEvent::Ended(Ok(()))), "{event:?}");
        }
        assert!(ports.have_ended());
    }
}
