//! With line behaviour as without: how finely time is sliced changes nothing, and no traffic brings a line down.

use crate::kit::Files;
use crate::properties::traffic::{Piece, pieces};
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use proptest::prelude::*;

const BEHAVIOURS: [&str; 4] = [
    "pacing: line, chatter: {units: [7, 8], every: 20ms}",
    "pacing: line, chunk: 16ms, echo: true",
    "strict: true, chunk: 3ms, chatter: {units: [7, 8], every: 20ms}, faults: [{do: duplicate, every: 3}]",
    "settings: 9600-8N2, pacing: line, echo: true, faults: [{do: crowded_line}, {do: usb_adapter}]",
];

/// Bytes and log of a line where each pause has so many slices.
fn run(line_behaviour: &str, seed: u64, traffic: &[Piece], slices: u32) -> (Vec<u8>, String) {
    let drives = "[{model: yako-closed-loop}, {model: hcfa-x, unit: 2}]";
    let text = format!("lines: [{{pty: auto, {line_behaviour}, drives: {drives}}}]");
    let mut rig = Rig::bench(&text, &Files).expect("a good bench").with_seed(seed);
    let mut sent = Vec::new();
    for Piece { bytes, pause } in traffic {
        sent.extend(rig.push(bytes));
        let slice = *pause / slices;
        (1..slices).for_each(|_| sent.extend(rig.advance(slice)));
        sent.extend(rig.advance(*pause - slice * (slices - 1)));
    }
    sent.extend(rig.advance(Duration::from_secs(1)));
    (sent, rig.log())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..Default::default() })]

    #[test]
    fn slices_of_time_change_nothing(seed: u64, traffic in pieces(1..20)) {
        for line_behaviour in BEHAVIOURS {
            let whole = run(line_behaviour, seed, &traffic, 1);
            prop_assert_eq!(&whole, &run(line_behaviour, seed, &traffic, 7), "{}", line_behaviour);
        }
    }
}
