//! A USB adapter hands bytes over in lumps, and a 2-wire line gives back what the master says.

use super::{ANSWER, Bench, MS, READ, characters, frame};
use drivemu::time::Duration;
use drivemu::wire::rtu;

/// Reads 20 words of a k-series, in 45 bytes.
const LONG: &[u8] = &[3, 0x00, 0x10, 0, 20];

fn dual(habits: &str) -> Bench {
    let drives = "drives: [{model: k-series}]";
    Bench::new(&format!("pty: auto, settings: 9600-8N2, {habits}, {drives}"))
}

fn lengths(sent: &[(Duration, Vec<u8>)]) -> Vec<(Duration, usize)> {
    sent.iter().map(|(at, bytes)| (*at, bytes.len())).collect()
}

#[test]
fn what_fills_no_packet_waits_for_the_timer() {
    assert_eq!(Bench::servo("chunk: 16ms").ask(READ), [(16 * MS, frame(ANSWER))]);
    assert_eq!(Bench::servo("chunk: 1ms").ask(READ), [(MS, frame(ANSWER))]);
}

#[test]
fn a_full_packet_does_not_wait() {
    let got = dual("chunk: 16ms, faults: [{do: duplicate}]").ask(LONG);
    assert_eq!(lengths(&got), [(Duration::ZERO, 62), (16 * MS, 28)]);
    let bytes = [&got[0].1[..], &got[1].1].concat();
    assert_eq!(bytes[..45], bytes[45..], "in order");
    assert!(rtu::decode(&bytes[..45]).is_ok());
}

/// At 9600 baud 14 characters come within 16 ms of the first.
#[test]
fn a_slow_line_fills_lumps_by_time() {
    let got = dual("chunk: 16ms, pacing: line").ask(LONG);
    // Four characters of silence and 2 ms.
    let begins = Duration::from_nanos(4_583_333) + 2 * MS;
    let due = |first| begins + characters(first, 11, 9600) + 16 * MS;
    assert_eq!(lengths(&got), [(due(1), 14), (due(15), 14), (due(29), 14), (due(43), 3)]);
    let whole: Vec<u8> = got.into_iter().flat_map(|(_, bytes)| bytes).collect();
    assert!(rtu::decode(&whole).is_ok());
}

/// The timer begins with the first byte: what comes before it ends goes along.
#[test]
fn bytes_of_two_replies_share_a_lump() {
    let mut bench = Bench::servo("chunk: 16ms");
    let asked = bench.bus.now();
    bench.receive(&frame(READ));
    bench.wait(10 * MS);
    bench.receive(&frame(READ));
    bench.wait(6 * MS);
    let both = [frame(ANSWER), frame(ANSWER)].concat();
    assert_eq!(bench.sent, [(asked + 16 * MS, both)]);
    bench.receive(&frame(READ));
    bench.wait(100 * MS);
    assert_eq!(bench.sent[1], (asked + 32 * MS, frame(ANSWER)));
}

#[test]
fn an_echo_comes_before_the_reply() {
    let got = Bench::servo("echo: true").ask(READ);
    assert_eq!(got, [(Duration::ZERO, frame(READ)), (Duration::ZERO, frame(ANSWER))]);
    let got = Bench::servo("echo: true, chunk: 4ms").ask(READ);
    assert_eq!(got, [(4 * MS, [frame(READ), frame(ANSWER)].concat())], "through the adapter");
    let got = Bench::servo("echo: true, pacing: line").ask(READ);
    assert_eq!(got[0], (Duration::ZERO, frame(READ)), "a request ends as it arrives");
    assert_eq!(got[1], (Duration::from_nanos(14_031_250), frame(ANSWER)));
}

/// The receiver hears bytes, whatever they are: broadcasts, requests to others, noise, pieces.
#[test]
fn everything_is_echoed() {
    let broadcast = rtu::encode(0, &[6, 0x03, 0x04, 0, 7]).to_vec();
    let foreign = rtu::encode(9, READ).to_vec();
    for bytes in [&broadcast[..], &foreign, &[0x55], &[0xAA; 600]] {
        for piece in [1, bytes.len()] {
            let mut bench = Bench::servo("echo: true");
            bytes.chunks(piece).for_each(|bytes| bench.receive(bytes));
            bench.wait(100 * MS);
            let heard: Vec<u8> = bench.sent.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
            assert_eq!(heard, bytes);
        }
    }
}

/// What waits in the adapter of a link that is gone is forgotten.
#[test]
fn a_closed_link_gets_nothing() {
    let mut bench = Bench::servo("chunk: 16ms, pacing: line");
    bench.receive(&frame(READ));
    bench.wait(20 * MS);
    bench.bus.close(bench.link);
    bench.wait(100 * MS);
    assert!(bench.sent.is_empty() && bench.bus.poll_at().is_none());
}
