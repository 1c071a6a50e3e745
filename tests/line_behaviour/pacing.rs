//! A paced reply begins and ends when the theory of the serial line says.

use super::{ANSWER, Bench, MS, READ, characters, frame};
use crate::expect::{read, root};
use drivemu::bus::{Output, WakeReason};
use drivemu::time::Duration;
use drivemu::wire::{ascii, rtu};

/// Line, turnaround in microseconds and hundredths, bits of a character, baud.
fn paced(line: &str, request: &[u8], silence: Duration, delay: Duration, bits: u64, baud: u64) {
    for strict in ["", "strict: true, "] {
        if line.contains("ascii") && !strict.is_empty() {
            continue;
        }
        let mut bench = Bench::new(&format!("pty: auto, pacing: line, {strict}{line}"));
        let asked = bench.bus.now();
        bench.receive(request);
        let wake = bench.bus.poll_at().expect("a deadline");
        if !strict.is_empty() {
            assert_eq!((wake.at, wake.reason), (asked + silence, WakeReason::Silence(bench.link)));
            bench.bus.advance_to(wake.at);
        }
        let begins = asked + silence + delay;
        let wake = bench.bus.poll_at().expect("a deadline");
        assert_eq!((wake.at, wake.reason), (begins, WakeReason::Reply(bench.link)), "{line}");
        bench.until(begins);
        let wake = bench.bus.poll_at().expect("a deadline");
        assert_eq!(wake.reason, WakeReason::Through(bench.link));
        assert!(bench.sent.is_empty());
        bench.until(begins + 1000 * MS);
        let [(ends, reply)] = bench.sent.as_slice() else { panic!("one piece: {:?}", bench.sent) };
        assert_eq!(wake.at, *ends);
        assert_eq!(*ends, begins + characters(reply.len() as u64, bits, baud), "{line}");
    }
}

#[test]
fn a_reply_begins_and_ends_as_the_theory_says() {
    let read = |unit: u8| rtu::encode(unit, &[3, 0x03, 0x04, 0, 1]).to_vec();
    // 3.5 characters of 11 bits.
    let silence = Duration::from_nanos(4_010_417);
    let servo = "drives: [{model: hcfa-x}]";
    paced(servo, &read(1), silence, 2 * MS, 11, 9600);
    let write = rtu::encode(1, &[0x10, 0x08, 0x06, 0, 2, 4, 0, 1, 0, 0]);
    paced(servo, &write, silence, 2 * MS, 11, 9600);
    // Above 19200 baud silence is fixed.
    let fast = "settings: 115200-8N1, drives: [{model: hcfa-x}]";
    paced(fast, &read(1), Duration::from_micros(1750), 2 * MS, 10, 115_200);
    // Four characters.
    let four = "settings: 19200-8E1, drives: [{model: k-series}]";
    let silence = Duration::from_nanos(2_291_667);
    paced(four, &rtu::encode(1, &[3, 0x02, 0x59, 0, 1]), silence, 2 * MS, 11, 19_200);
    // Five, and a drive that takes its time.
    let made_up = "settings: 9600-8N1, drives: [{model: acme-s1.yaml}]";
    let silence = Duration::from_nanos(5_208_333);
    paced(made_up, &rtu::encode(5, &[3, 0x20, 0x01, 0, 1]), silence, 3 * MS, 10, 9600);
    // CR LF ends a frame: nobody waits for silence.
    let ascii = "settings: 9600-7E1, ascii: true, drives: [{model: k-series}]";
    let request = ascii::encode(1, &[3, 0x02, 0x59, 0, 1]);
    paced(ascii, &request, Duration::ZERO, 2 * MS, 10, 9600);
}

#[test]
fn it_is_the_same_reply() {
    let got = Bench::servo("pacing: line").ask(READ);
    assert_eq!(got, [(Duration::from_nanos(14_031_250), frame(ANSWER))]);
    let got = Bench::servo("pacing: ideal").ask(READ);
    assert_eq!(got, [(Duration::ZERO, frame(ANSWER))]);
}

/// Where bytes come one by one, the last of them counts.
#[test]
fn a_request_ends_with_its_last_byte() {
    let mut bench = Bench::servo("pacing: line");
    let request = frame(READ);
    for byte in &request[..7] {
        bench.receive(&[*byte]);
        bench.wait(2 * MS);
    }
    let last = bench.bus.now();
    bench.receive(&request[7..]);
    bench.wait(100 * MS);
    assert_eq!(bench.sent, [(last + Duration::from_nanos(14_031_250), frame(ANSWER))]);
}

/// A port that takes the time of characters itself gets a reply when it begins.
#[test]
fn a_serial_port_takes_the_time_itself() {
    let mut bench = Bench::new("serial: /dev/none, pacing: line, drives: [{model: hcfa-x}]");
    assert_eq!(bench.ask(READ), [(Duration::from_nanos(6_010_417), frame(ANSWER))]);
}

/// Faults come on top: of what begins later, of what follows, of what is cut in two.
#[test]
fn faults_are_paced_too() {
    let with = |fault: &str| {
        let faults = format!("pacing: line, faults: [{{{fault}}}]");
        Bench::servo(&faults).ask(READ)
    };
    let (begins, reply) = (Duration::from_nanos(6_010_417), frame(ANSWER));
    let after = |count| begins + characters(count, 11, 9600);
    assert_eq!(with("do: delay, ms: 50"), [(after(7) + 50 * MS, reply.clone())]);
    let [first, second] = <[_; 2]>::try_from(with("do: duplicate")).expect("twice");
    assert_eq!(first, (after(7), reply.clone()));
    assert!(second.0.abs_diff(after(14)) <= Duration::from_nanos(1), "{second:?}");
    let pieces = with("do: split, at: 3, gap_ms: 20");
    assert_eq!(pieces[0], (after(3), reply[..3].to_vec()));
    assert!(pieces[1].0.abs_diff(after(7) + 20 * MS) <= Duration::from_nanos(1), "{pieces:?}");
    assert_eq!(with("do: echo")[0], (Duration::ZERO, frame(READ)));
    assert_eq!(with("do: exception, code: 4"), [(after(5), frame(&[0x83, 4]))]);
}

/// The reply to a write of the speed leaves in the old one, and then the port moves.
#[test]
fn the_port_moves_behind_the_reply() {
    let mut bench = Bench::servo("pacing: line");
    let asked = bench.bus.now();
    bench.bus.receive(asked, bench.link, &frame(&[6, 0x09, 0x01, 0, 6]));
    let (mut order, mut at) = (Vec::new(), asked);
    loop {
        while let Some(output) = bench.bus.poll_output() {
            match output {
                Output::Transmit { .. } => order.push(("reply", at)),
                Output::Moved(_) => order.push(("moved", at)),
                _ => {}
            }
        }
        let Some(wake) = bench.bus.poll_at() else { break };
        at = wake.at;
        bench.bus.advance_to(at);
    }
    let ends = asked + Duration::from_nanos(6_010_417) + characters(8, 11, 9600);
    assert_eq!(order, [("reply", ends), ("moved", ends)]);
}

/// The page tells the same numbers.
#[test]
fn the_example_of_the_page_is_right() {
    let page = read(&root("docs/faults.md"));
    for number in ["4.010 ms", "2 ms", "8.021 ms", "14.031 ms"] {
        assert!(page.contains(number), "{number}");
    }
}
