//! Modbus TCP: the length field says all, nothing waits, and a stream that lies is closed.

use crate::kit::{bench_line, drain, line_of, text_of};
use drivemu::bench::DeviceSpec;
use drivemu::bus::{Bus, LinkId};
use drivemu::event::EventKind;
use drivemu::line::Framing;
use drivemu::time::Instant;
use drivemu::vocabulary::Cause;
use drivemu::wire::mbap::encode;

/// A port with a YAKO drive as unit 1 on it.
fn port() -> (Bus, LinkId) {
    port_of("yako-closed-loop")
}

fn port_of(model: &str) -> (Bus, LinkId) {
    let mut bus = line_of(text_of(model), &[], &DeviceSpec::default()).bus(0);
    let link = bus.open(Framing::Mbap);
    bus.advance_to(Instant::from_millis(2000));
    drain(&mut bus);
    (bus, link)
}

fn send(bus: &mut Bus, link: LinkId, bytes: &[u8]) -> Vec<u8> {
    let now = bus.now();
    bus.receive(now, link, bytes);
    let drained = drain(bus);
    assert!(!drained.closed, "{bytes:02X?}");
    drained.sent
}

fn read(transaction: u16, unit: u8) -> Vec<u8> {
    encode(transaction, unit, &[3, 0, 0x23, 0, 1]).to_vec()
}

fn answer(transaction: u16, unit: u8) -> Vec<u8> {
    encode(transaction, unit, &[3, 2, 0, 0x3C]).to_vec()
}

#[test]
fn split_anywhere() {
    let whole = read(0x1234, 1);
    for at in 0..=whole.len() {
        let (mut bus, link) = port();
        let mut got = send(&mut bus, link, &whole[..at]);
        // Nothing waits for silence, so a pause means nothing, an hour neither.
        bus.advance_to(Instant::from_millis(3_600_000));
        got.extend(send(&mut bus, link, &whole[at..]));
        assert_eq!(got, answer(0x1234, 1), "at {at}");
    }
    let (mut bus, link) = port();
    let got: Vec<u8> = whole.iter().flat_map(|byte| send(&mut bus, link, &[*byte])).collect();
    assert_eq!(got, answer(0x1234, 1));
}

#[test]
fn glued_requests_are_answered_in_order() {
    let (mut bus, link) = port();
    let all = [read(7, 1), read(7, 9), encode(8, 1, &[0x2B]).to_vec(), read(0xFFFF, 1), read(0, 1)];
    let all = all.concat();
    let want = [answer(7, 1), encode(8, 1, &[0xAB, 2]).to_vec(), answer(0xFFFF, 1), answer(0, 1)];
    let want = want.concat();
    for cut in 0..=all.len() {
        let mut got = send(&mut bus, link, &all[..cut]);
        got.extend(send(&mut bus, link, &all[cut..]));
        assert_eq!(got, want, "cut at {cut}");
    }
    let hundred: Vec<u8> = (0..100).flat_map(|transaction| read(transaction, 1)).collect();
    let answers: Vec<u8> = (0..100).flat_map(|transaction| answer(transaction, 1)).collect();
    assert_eq!(send(&mut bus, link, &hundred), answers);
}

#[test]
fn a_stream_that_lies_is_closed_once_and_not_answered() {
    for lie in [
        "0001 0001 0006 01 03 0023 0001",
        "0001 0000 0000 01",
        "0001 0000 0001 01",
        "0001 0000 00FF 01",
        "0001 0000 FFFF 01",
    ] {
        let lie = drivemu::testkit::hex(lie).expect("hex");
        for at in 0..=lie.len() {
            let (mut bus, link) = port();
            assert_eq!(send(&mut bus, link, &read(1, 1)), answer(1, 1));
            let now = bus.now();
            let mut closes = 0;
            let mut lost = 0;
            for piece in [&lie[..at], &lie[at..], &read(2, 1), &read(3, 1)] {
                bus.receive(now, link, piece);
                let drained = drain(&mut bus);
                assert_eq!(drained.sent, [0_u8; 0], "{lie:02X?}");
                closes += usize::from(drained.closed);
                lost += drained
                    .events
                    .iter()
                    .filter(|it| matches!(it.kind, EventKind::StreamClosed { .. }))
                    .count();
            }
            assert_eq!((closes, lost), (1, 1), "{lie:02X?} at {at}");
            assert_eq!(bus.poll_at(), None);
            // Another client is none the worse for it.
            let other = bus.open(Framing::Mbap);
            assert_eq!(send(&mut bus, other, &read(4, 1)), answer(4, 1));
        }
    }
}

/// What stands before the lie is answered.
#[test]
fn good_requests_before_a_lie() {
    let (mut bus, link) = port();
    let now = bus.now();
    bus.receive(now, link, &[read(1, 1), vec![0, 2, 0, 9]].concat());
    let drained = drain(&mut bus);
    assert_eq!((drained.sent, drained.closed), (answer(1, 1), true));
}

/// A unit row that holds no usable address, such as 0, does not make a drive unreachable here.
#[test]
fn who_answers() {
    let (mut bus, link) = port();
    for unit in 2..255 {
        assert_eq!(send(&mut bus, link, &read(1, unit)), [0_u8; 0], "unit {unit}");
    }
    // 0 and 255 are whoever is there, where there is only one.
    for unit in [0, 255] {
        assert_eq!(send(&mut bus, link, &read(5, unit)), answer(5, unit));
        let write = encode(6, unit, &[6, 0, 0x23, 0, 60]);
        assert_eq!(send(&mut bus, link, &write), *write);
        let refused = send(&mut bus, link, &encode(6, unit, &[6, 0, 0, 0, 1]));
        assert_eq!(refused, *encode(6, unit, &[0x86, 6]));
    }
}

/// Among several drives 0 is a broadcast, as on a serial line, and 255 is nobody.
#[test]
fn who_answers_among_several() {
    let (mut bus, link) = port_of("k-series");
    let [read, write] = [[3, 1, 0x30, 0, 1], [6, 1, 0x30, 0, 7]];
    assert_eq!(send(&mut bus, link, &encode(1, 255, &read)), [0_u8; 0]);
    assert_eq!(send(&mut bus, link, &encode(1, 2, &read)), *encode(1, 2, &[3, 2, 1, 0xF4]));
    assert_eq!(send(&mut bus, link, &encode(1, 0, &read)), [0_u8; 0]);
    assert_eq!(send(&mut bus, link, &encode(1, 0, &write)), [0_u8; 0]);
    for unit in [1, 2] {
        assert_eq!(send(&mut bus, link, &encode(3, unit, &read)), *encode(3, unit, &[3, 2, 0, 7]));
    }
}

/// A rule about the drive's unit is about what the drive is asked under 0 and 255, too.
#[test]
fn faults_act_whatever_the_drive_is_called() {
    for unit in [0, 1, 255] {
        let text = "lines: [{tcp: '127.0.0.1:0', drives: [{model: yako-closed-loop}], \
                    faults: [{do: exception, code: 4, unit: 1}]}]";
        let mut bus = bench_line(text).bus(0);
        let link = bus.open(Framing::Mbap);
        assert_eq!(send(&mut bus, link, &read(1, unit)), *encode(1, unit, &[0x83, 4]));
    }
}

/// On a serial line the exception bit makes an answer; a TCP client says nothing but requests.
#[test]
fn a_function_with_the_exception_bit_is_refused() {
    let (mut bus, link) = port();
    let now = bus.now();
    bus.receive(now, link, &encode(1, 1, &[0x83, 2]));
    let drained = drain(&mut bus);
    assert_eq!(drained.sent, *encode(1, 1, &[0x83, 2]));
    let refused = drained.events.iter().any(|it| match &it.kind {
        EventKind::Transaction(it) => it.refusal.is_some_and(|it| it.cause == Cause::Function),
        _ => false,
    });
    assert!(refused, "{:?}", drained.events);
    let (mut bus, link) = port_of("hcfa-x");
    assert_eq!(send(&mut bus, link, &encode(1, 1, &[0xFF])), *encode(1, 1, &[0xFF, 1]));
}

#[test]
fn clients_do_not_disturb_each_other() {
    let (mut bus, first) = port();
    let second = bus.open(Framing::Mbap);
    let half = read(1, 1);
    assert_eq!(send(&mut bus, first, &half[..9]), [0_u8; 0]);
    assert_eq!(send(&mut bus, second, &read(2, 1)), answer(2, 1));
    assert_eq!(send(&mut bus, first, &half[9..]), answer(1, 1));
    // What was half said on a closed link is forgotten, and a closed link says nothing.
    assert_eq!(send(&mut bus, first, &half[..9]), [0_u8; 0]);
    bus.close(first);
    assert_eq!(send(&mut bus, first, &half[9..]), [0_u8; 0]);
    assert_eq!(send(&mut bus, second, &read(3, 1)), answer(3, 1));
}

#[test]
fn every_function_code_and_length() {
    let (mut bus, link) = port();
    for function in 0..=255u8 {
        for len in [0, 1, 4, 5, 252] {
            let pdu = [&[function][..], &vec![0; len]].concat();
            let got = send(&mut bus, link, &encode(1, 1, &pdu));
            match function {
                3 | 6 | 16 => assert_eq!(got[7], function | 0x80, "{function} {len}"),
                _ => assert_eq!(got, *encode(1, 1, &[function | 0x80, 2]), "{function} {len}"),
            }
        }
    }
    assert_eq!(send(&mut bus, link, &read(9, 1)), answer(9, 1));
}
