//! The same master says the same to the same drives, in virtual time and on the wall: docs/determinism.md.

use super::program::{Program, file, wait_for};
use drivemu::bench::BuiltinLibrary;
use drivemu::testkit::Rig;
use drivemu::wire::rtu;
use std::fs::{OpenOptions, read_to_string};
use std::io::{Read, Write};
use std::time::Duration;

/// FaultSet that depends on draws, and on no time.
const BENCH: &str = "
seed: 11
lines:
  - name: cell
    pty: auto
    drives:
      - {model: yako-closed-loop, unit: 1}
      - {model: yako-open-loop, unit: 2}
    faults:
      - {do: lose_reply, function: 6, probability: 0.4}
      - {do: flip_bits, bits: 3, probability: 0.3}
      - {do: busy, unit: 2, probability: 0.3}
      - {do: extra, bytes: 5, probability: 0.3}
";

/// Longer than any motion here and what an encoder is behind.
const REST: Duration = Duration::from_secs(5);

/// Both drives: a distance, relative moves with many a retry, reads, refusals, a broadcast, a broken frame.
fn requests() -> Vec<Vec<u8>> {
    let distance = [0x10, 0, 0x24, 0, 2, 4, 0, 0, 0x03, 0xE8];
    let pdus =
        [&distance[..], &[6, 0, 0x27, 0, 1], &[6, 0, 0x27, 0, 1], &[3, 0, 0x0A, 0, 2], &[0x2B]];
    let asked = |unit: u8| pdus.map(|pdu| rtu::encode(unit, pdu).to_vec());
    let mut all: Vec<Vec<u8>> = (0..4).flat_map(|_| [asked(1), asked(2)].concat()).collect();
    all.push(rtu::encode(0, &[6, 0, 0x27, 0, 1]).to_vec());
    all.push(vec![1, 3, 0, 0x0A, 0, 2, 0, 0]);
    all
}

/// What came of one request: the bytes that left, and the log so far.
struct Outcome {
    bytes: Vec<u8>,
    log: String,
}

/// In virtual time: each request, and time enough for what it has set off.
fn virtually() -> Vec<Outcome> {
    let mut rig = Rig::bench(BENCH, &BuiltinLibrary).expect("a good bench");
    let ask = |request: &Vec<u8>| {
        let mut bytes = rig.send(request);
        bytes.extend(rig.advance(REST));
        Outcome { bytes, log: rig.log() }
    };
    requests().iter().map(ask).collect()
}

#[test]
fn two_runs_are_the_same_byte_for_byte() {
    let [first, second] = [virtually(), virtually()];
    for (first, second) in first.iter().zip(&second) {
        assert_eq!((&first.bytes, &first.log), (&second.bytes, &second.log));
    }
    let log = &first.last().expect("requests").log;
    for word in
        ["fault lose_reply", "fault flip_bits", "fault busy", "reply never arrived", "stopped at"]
    {
        assert!(log.contains(word), "{word} never happens:\n{log}");
    }
}

/// Only the times differ, which are those of the wall.
#[test]
#[allow(clippy::disallowed_methods)] // What moves comes to rest in the program's time, and nothing tells of the encoder.
fn on_the_wall_it_is_the_same_but_for_the_times() {
    let folder = tempfile::tempdir().expect("a folder");
    let (bench, log) = (file(&folder, "bench.yaml", BENCH), folder.path().join("log"));
    let [bench, log] = [&bench, &log].map(|path| path.to_str().expect("text"));
    let rate = 200;
    let program = Program::run(&[bench, "--rate", &rate.to_string(), "--log-file", log]);
    let mut port =
        OpenOptions::new().read(true).write(true).open(program.path()).expect("the terminal opens");
    let said = || read_to_string(log).expect("the log");
    for (request, Outcome { bytes, log }) in requests().iter().zip(virtually()) {
        port.write_all(request).expect("written");
        let mut got = vec![0; bytes.len()];
        port.read_exact(&mut got).expect("the answer");
        assert_eq!(got, bytes);
        // As long as in virtual time.
        std::thread::sleep(REST / rate);
        wait_for("the events", || said().matches('\n').count() >= log.lines().count());
        let untimed = |line: &str| line.split_once(' ').map(|(_, told)| told.to_owned());
        let want: Vec<String> = log.lines().filter_map(untimed).collect();
        let text = |line: &str| {
            let event: serde_json::Value = serde_json::from_str(line).expect("an object");
            event["text"].as_str().expect("text").to_owned()
        };
        let got: Vec<String> = said().lines().map(text).collect();
        assert_eq!(got, want);
    }
}
