//! Bytes in any cut at any time, on each framing: nothing panics, and after a silence the drives hear what they are asked.
//!
//! The first byte of an input is the framing. Then come pieces: a byte that says what, a byte that says how much, and
//! that many bytes.

#![no_main]

mod common;

use drivemu::bench::{BenchLine, parse};
use drivemu::bus::{Bus, LinkId, Output};
use drivemu::line::Framing;
use drivemu::time::Duration;
use drivemu::wire::{Frame, ascii, mbap, rtu};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

const BENCH: &str =
    "lines: [{pty: auto, drives: [{model: hcfa-x, unit: 1}, {model: yako-closed-loop, unit: 2}]}]";
const GAP: Duration = Duration::from_secs(1);

static LINE: LazyLock<BenchLine> = LazyLock::new(|| {
    let bench = parse(BENCH, &common::Compiled).expect("a good bench");
    bench.lines.into_iter().next().expect("a line")
});

fuzz_target!(|input: &[u8]| {
    let Some((framing, mut rest)) = input.split_first() else { return };
    let framing = match framing % 4 {
        0 => Framing::Rtu {
        silence: Duration::from_millis(4),
        patience: Some(Duration::from_millis(20)),
    },
        1 => Framing::Rtu { silence: Duration::from_millis(4), patience: None },
        2 => Framing::Ascii { gap: GAP },
        _ => Framing::Mbap,
    };
    let mut bus = LINE.bus(0);
    let mut link = bus.open(framing);
    while let [what, how, more @ ..] = rest {
        let (bytes, behind) = more.split_at(more.len().min(usize::from(*how)));
        let now = bus.now();
        match what % 4 {
            0 => bus.receive(now, link, bytes),
            1 if !bytes.is_empty() => bus.receive(now, link, &framed(framing, bytes)),
            2 => bus.advance_to(now + Duration::from_millis(u64::from(*how) * 4)),
            _ => bus.advance_to(now + Duration::from_nanos(u64::from(*how) * 100_000)),
        }
        rest = if what % 4 < 2 { behind } else { more };
        drain(&mut bus, &mut link, framing);
    }
    if framing == Framing::Mbap {
        bus.close(link);
        link = bus.open(framing);
    }
    bus.advance_to(bus.now() + GAP);
    drain(&mut bus, &mut link, framing);
    for unit in [1, 2] {
        let Some(id) = bus.find(unit) else { continue };
        let [high, low] = bus.drive(id).model().showcase().expect("a row").at.to_be_bytes();
        bus.receive(bus.now(), link, &framed(framing, &[unit, 3, high, low, 0, 1]));
        bus.advance_to(bus.now() + GAP);
        assert!(drain(&mut bus, &mut link, framing) > 0, "unit {unit} does not hear");
    }
});

/// `bytes`, unit first, as a good frame.
fn framed(framing: Framing, bytes: &[u8]) -> Frame {
    let (unit, pdu) = (bytes[0], &bytes[1..bytes.len().min(254)]);
    match framing {
        Framing::Rtu { .. } => rtu::encode(unit, pdu),
        Framing::Ascii { .. } => ascii::encode(unit, pdu),
        Framing::Mbap => mbap::encode(1, unit, pdu),
    }
}

/// Takes all that there is, and says how many frames left.
fn drain(bus: &mut Bus, link: &mut LinkId, framing: Framing) -> usize {
    let mut sent = 0;
    while let Some(output) = bus.poll_output() {
        match output {
            Output::Transmit { .. } => sent += 1,
            Output::Close(gone) => {
                bus.close(gone);
                *link = bus.open(framing);
            }
            Output::Event(event) => common::tell(&event),
            Output::Keep(_) | Output::Moved(_) => {}
        }
    }
    assert!(bus.poll_at().is_none_or(|wake| wake.at > bus.now()), "something is overdue");
    sent
}
