//! Serves a line on TCP: many clients at once onto the same drives, each with a link of its own.

use super::{LineServer, Send};
use crate::bus::LinkId;
use crate::server::clock::Clock;
use crate::server::port::tcp::MAX_CLIENTS;
use crate::server::port::{ClientId, Listener, TcpEvent};
use crate::time::Duration;
use std::collections::BTreeMap;
use tracing::{info, warn};

/// How long the listener rests when the system gives it no more descriptors.
const REST: Duration = Duration::from_secs(1);

/// Serves `line` to the clients of `listener` for ever.
pub async fn serve_tcp(mut line: LineServer, mut listener: Listener) {
    let mut clients = Clients::default();
    let mut rested = None;
    loop {
        while let Some(send) = line.next_send() {
            match send {
                Send::Frame(link, frame) => {
                    clients
                        .by_link
                        .get(&link)
                        .into_iter()
                        .for_each(|id| listener.send(*id, &frame));
                }
                Send::Close(link) => {
                    clients.by_link.get(&link).into_iter().for_each(|id| listener.close(*id));
                }
                Send::Move(_) => {}
            }
        }
        let event = tokio::select! {
            biased;
            event = listener.next() => Some(event),
            // After a stall the timer may be told first; what was sent meanwhile came before that.
            () = line.woken() => match listener.is_anything_waiting() {
                true => Some(listener.next().await),
                false => None,
            },
            () = Clock::until_wall(rested), if rested.is_some() => {
                rested = None;
                listener.accept_again();
                None
            }
        };
        match event {
            None => line.advance(),
            Some(TcpEvent::Opened(id, from)) => {
                if clients.displaced == 0 {
                    info!("{}: {from} connected", line.name);
                }
                clients.insert(id, line.bus.open(line.framing()));
            }
            Some(TcpEvent::Bytes(id, bytes)) => {
                let link = clients.by_client.get(&id).copied();
                if let Some(link) = link {
                    line.receive(link, &bytes);
                }
            }
            Some(TcpEvent::Closed(id, error)) => {
                clients.remove(id).into_iter().for_each(|link| line.hang_up(link));
                match error {
                    Some(error) => warn!("{}: client connection lost: {error}", line.name),
                    None => info!("{}: client disconnected", line.name),
                }
                // Told once a crowd, not once a client.
                if let count @ 1.. = std::mem::take(&mut clients.displaced) {
                    info!(
                        "{}: fewer than {MAX_CLIENTS} clients again; {count} were disconnected",
                        line.name
                    );
                }
            }
            Some(TcpEvent::Displaced(id)) => {
                clients.remove(id).into_iter().for_each(|link| line.hang_up(link));
                if clients.displaced == 0 {
                    warn!(
                        "{}: {MAX_CLIENTS} clients are connected, which is the limit: each new one disconnects \
                         the one that has been silent longest",
                        line.name
                    );
                }
                clients.displaced += 1;
            }
            Some(TcpEvent::NotAccepting(error)) => {
                warn!("{}: cannot accept clients at the moment: {error}", line.name);
                rested = Some(Clock::wall_after(REST));
            }
        }
    }
}

/// Who is on which link.
#[derive(Default)]
struct Clients {
    by_client: BTreeMap<ClientId, LinkId>,
    by_link: BTreeMap<LinkId, ClientId>,
    /// How many had to give way since the limit was reached; 0 below it.
    displaced: u64,
}

impl Clients {
    fn insert(&mut self, client: ClientId, link: LinkId) {
        self.by_client.insert(client, link);
        self.by_link.insert(link, client);
    }

    fn remove(&mut self, client: ClientId) -> Option<LinkId> {
        let link = self.by_client.remove(&client)?;
        self.by_link.remove(&link);
        Some(link)
    }
}
