//! A USB adapter delivers bytes in chunks, and a 2-wire line echoes what the master sends.

use super::{ANSWER, Bench, MS, READ, characters, frame};
use drivemu::time::{Duration, Instant};
use drivemu::wire::rtu;

/// Reads 20 words of a k-series, in 45 bytes.
const LONG: &[u8] = &[3, 0x00, 0x10, 0, 20];

fn dual(line_behaviour: &str) -> Bench {
    let drives = "drives: [{model: k-series}]";
    Bench::new(&format!("pty: auto, settings: 9600-8N2, {line_behaviour}, {drives}"))
}

/// When the timer of an adapter ends for the first time: the seed draws it, and nothing else moves it.
fn phase(seed: u64, millis: u32) -> Duration {
    let line_behaviour = format!("pty: auto, chunk: {millis}ms, drives: [{{model: hcfa-x}}]");
    let mut bench = Bench::seeded(&line_behaviour, seed);
    bench.receive(&frame(READ));
    bench.wait(millis * MS);
    into(bench.sent[0].0, millis)
}

/// How far into a period of the timer an instant lies.
fn into(at: Instant, millis: u32) -> Duration {
    let period = (millis * MS).as_nanos();
    Duration::from_nanos((at.since(Instant::ZERO).as_nanos() % period) as u64)
}

#[test]
fn what_fills_no_packet_waits_for_the_timer() {
    for millis in [1, 4, 16, 255] {
        let phase = phase(0, millis);
        let mut bench = Bench::servo(&format!("chunk: {millis}ms"));
        for pause in [0, 1, 7, 15, 16, 40, 300] {
            bench.wait(pause * MS + Duration::from_micros(137));
            let asked = bench.bus.now();
            bench.sent.clear();
            bench.receive(&frame(READ));
            bench.wait(millis * MS);
            let [(at, reply)] = bench.sent.as_slice() else { panic!("{:?}", bench.sent) };
            assert_eq!(*reply, frame(ANSWER));
            assert!(*at > asked && at.since(asked) <= millis * MS, "{millis} ms: {at}");
            assert_eq!(into(*at, millis), phase, "the timer runs freely");
        }
    }
}

/// One seed, one phase; others have others, all over the period.
#[test]
fn the_seed_draws_the_phase() {
    let phases: Vec<_> = (0..32).map(|seed| phase(seed, 16)).collect();
    assert_eq!(phases, (0..32).map(|seed| phase(seed, 16)).collect::<Vec<_>>());
    for quarter in 0..4 {
        let here = phases.iter().filter(|phase| phase.as_millis() / 4 == quarter).count();
        assert!((2..=16).contains(&here), "{phases:?}");
    }
}

#[test]
fn a_full_packet_does_not_wait() {
    let got = dual("chunk: 16ms, faults: [{do: duplicate}]").ask(LONG);
    assert_eq!(got.iter().map(|(_, bytes)| bytes.len()).collect::<Vec<_>>(), [62, 28]);
    assert!(got[0].0.is_zero() && got[1].0 <= 16 * MS, "{got:?}");
    let bytes = [&got[0].1[..], &got[1].1].concat();
    assert_eq!(bytes[..45], bytes[45..], "in order");
    assert!(rtu::decode(&bytes[..45]).is_ok());
}

/// At 9600 baud 14 or 13 characters arrive within 16 ms; the first and the last chunk have what is left for them.
#[test]
fn a_slow_line_fills_chunks_by_time() {
    for seed in 0..16 {
        let drives = "drives: [{model: k-series}]";
        let line = format!("pty: auto, settings: 9600-8N2, chunk: 16ms, pacing: line, {drives}");
        let mut bench = Bench::seeded(&line, seed);
        // Four characters of silence and 2 ms.
        let begins = bench.bus.now() + Duration::from_nanos(4_583_333) + 2 * MS;
        bench.receive(&frame(LONG));
        bench.wait(1000 * MS);
        let mut arrived = 0;
        for (at, bytes) in &bench.sent {
            assert_eq!(into(*at, 16), phase(seed, 16));
            arrived += bytes.len();
            let by_now = (1..=45).filter(|n| begins + characters(*n, 11, 9600) < *at).count();
            assert!(arrived.abs_diff(by_now) <= 1, "{:?}", bench.sent);
        }
        assert_eq!(arrived, 45);
        assert!((3..=5).contains(&bench.sent.len()), "{:?}", bench.sent);
        let whole: Vec<u8> = bench.sent.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
        assert!(rtu::decode(&whole).is_ok());
    }
}

/// A reply of one register takes 8 ms of the 16: about half of all seeds tear it, at any place.
#[test]
fn a_short_reply_is_torn_at_any_place() {
    let mut first_pieces = std::collections::BTreeMap::new();
    for seed in 0..64 {
        let line = "pty: auto, chunk: 16ms, pacing: line, drives: [{model: hcfa-x}]";
        let mut bench = Bench::seeded(line, seed);
        let got = bench.ask(READ);
        let whole: Vec<u8> = got.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
        assert_eq!(whole, frame(ANSWER));
        assert!(got.len() <= 2, "{got:?}");
        *first_pieces.entry(got[0].1.len()).or_insert(0) += 1;
    }
    assert_eq!(first_pieces.keys().copied().collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6, 7]);
    let torn: usize = (1..7).map(|len| first_pieces[&len]).sum();
    assert!((16..=48).contains(&torn), "{first_pieces:?}");
}

/// What has arrived when the timer ends goes along, of however many replies.
#[test]
fn bytes_of_two_replies_share_a_chunk() {
    let mut bench = Bench::servo("chunk: 255ms");
    bench.receive(&frame(READ));
    bench.wait(255 * MS);
    // Right behind the end of a period.
    bench.until(bench.sent[0].0 + 256 * MS);
    bench.sent.clear();
    bench.receive(&frame(READ));
    bench.wait(10 * MS);
    bench.receive(&frame(READ));
    bench.wait(255 * MS);
    let [(at, bytes)] = bench.sent.as_slice() else { panic!("{:?}", bench.sent) };
    assert_eq!((into(*at, 255), bytes), (phase(0, 255), &[frame(ANSWER), frame(ANSWER)].concat()));
}

#[test]
fn an_echo_comes_before_the_reply() {
    let got = Bench::servo("echo: true").ask(READ);
    assert_eq!(got, [(Duration::ZERO, frame(READ)), (Duration::ZERO, frame(ANSWER))]);
    let got = Bench::servo("echo: true, chunk: 4ms").ask(READ);
    let [(took, bytes)] = got.as_slice() else { panic!("{got:?}") };
    assert!(*took <= 4 * MS, "through the adapter");
    assert_eq!(*bytes, [frame(READ), frame(ANSWER)].concat());
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
    bench.wait(MS);
    bench.bus.close(bench.link);
    bench.wait(100 * MS);
    assert!(bench.sent.is_empty() && bench.bus.poll_at().is_none());
}
