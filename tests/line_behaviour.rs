//! Behaviour of a line, to the nanosecond: when bytes are sent, in which chunks, what is echoed, and the traffic of others.

mod adapter;
mod keys;
#[cfg(feature = "cli")]
mod master;
mod others;
mod pacing;
mod slices;

use crate::kit::Files;
use drivemu::bench::{BenchLine, parse};
use drivemu::bus::{Bus, LinkId, Output};
use drivemu::event::Event;
use drivemu::time::{Duration, Instant};
use drivemu::wire::rtu;

const MS: Duration = Duration::from_millis(1);

/// Reads the jog speed of unit 1, which is 100.
const READ: &[u8] = &[0x03, 0x03, 0x04, 0x00, 0x01];
const ANSWER: &[u8] = &[0x03, 0x02, 0x00, 0x64];

/// Bytes that left, and when.
type Sent = (Instant, Vec<u8>);

/// A line whose drives are ready, with everything that comes out of it.
struct Bench {
    bus: Bus,
    link: LinkId,
    sent: Vec<Sent>,
    events: Vec<Event>,
}

impl Bench {
    /// A line of a bench file, without its braces.
    fn new(line: &str) -> Self {
        Self::seeded(line, 0)
    }

    fn seeded(text: &str, seed: u64) -> Self {
        let line = line(text);
        let mut bus = line.bus(seed);
        let link = bus.open_on(line.ports[0].carrier(), line.wire.framing(1.0));
        let mut bench = Self { bus, link, sent: Vec::new(), events: Vec::new() };
        bench.until(Instant::from_millis(2000));
        bench.sent.clear();
        bench.events.clear();
        bench
    }

    /// A servo at unit 1, with this line behaviour.
    fn servo(line_behaviour: &str) -> Self {
        Self::new(&format!("pty: auto, {line_behaviour}, drives: [{{model: hcfa-x}}]"))
    }

    /// Lets everything happen until `end`, each thing at its own instant.
    fn until(&mut self, end: Instant) {
        self.drain();
        while let Some(wake) = self.bus.poll_at().filter(|wake| wake.at <= end) {
            self.bus.advance_to(wake.at);
            self.drain();
        }
        self.bus.advance_to(end);
        self.drain();
    }

    fn wait(&mut self, time: Duration) {
        self.until(self.bus.now() + time);
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.bus.receive(self.bus.now(), self.link, bytes);
        self.drain();
    }

    /// Asks unit 1, and says what leaves within a second and how long after the request.
    fn ask(&mut self, pdu: &[u8]) -> Vec<(Duration, Vec<u8>)> {
        let asked = self.bus.now();
        self.sent.clear();
        self.receive(&rtu::encode(1, pdu));
        self.wait(1000 * MS);
        self.sent.drain(..).map(|(at, bytes)| (at.since(asked), bytes)).collect()
    }

    fn drain(&mut self) {
        while let Some(output) = self.bus.poll_output() {
            match output {
                Output::Transmit { frame, .. } => self.sent.push((self.bus.now(), frame.to_vec())),
                Output::Event(event) => self.events.push(event),
                _ => {}
            }
        }
    }
}

fn line(text: &str) -> BenchLine {
    let text = format!("lines: [{{{text}}}]");
    let bench = parse(&text, &Files).unwrap_or_else(|problems| panic!("{text}: {}", problems[0]));
    bench.lines.into_iter().next().expect("a line")
}

fn frame(pdu: &[u8]) -> Vec<u8> {
    rtu::encode(1, pdu).to_vec()
}

/// Time of so many characters of `bits` bits, to the nearest nanosecond.
fn characters(count: u64, bits: u64, baud: u64) -> Duration {
    Duration::from_nanos((count * bits * 1_000_000_000 + baud / 2) / baud)
}
