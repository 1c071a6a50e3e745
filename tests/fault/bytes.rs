//! The bytes on the wire, for each kind.

use super::{ANSWER, READ, SILENCE, WRITE, ask, drive, drive_of, effects, frame, jog_speed};
use crate::kit::{drain, line_of, text_of};
use drivemu::bench::{DeviceSpec, PortSpec};
use drivemu::bus::WakeReason;
use drivemu::line::Framing;
use drivemu::medium::{FaultKind, Preset};
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::wire::{ascii, mbap, rtu};

const MS: Duration = Duration::from_millis(1);

/// What comes at once, and what comes in the ten seconds after it.
fn both(rig: &mut Rig, pdu: &[u8]) -> [Vec<u8>; 2] {
    [ask(rig, pdu), rig.advance(10_000 * MS)]
}

/// A kind that is not tested here fails.
#[test]
fn each_kind_on_rtu() {
    for kind in FaultKind::ALL {
        let whole = frame(ANSWER);
        let rig = |spec: &str| drive(&[spec]);
        match kind.name {
            "lose_request" => {
                let mut rig = rig("lose_request");
                assert_eq!(both(&mut rig, WRITE), [SILENCE, SILENCE]);
                assert_eq!(jog_speed(&mut rig), 100, "never seen");
            }
            "lose_reply" => {
                let mut rig = rig("lose_reply");
                assert_eq!(both(&mut rig, WRITE), [SILENCE, SILENCE]);
                assert_eq!(jog_speed(&mut rig), 7, "executed");
            }
            "bad_crc" => {
                let mut bad = whole.clone();
                bad[5..].iter_mut().for_each(|byte| *byte ^= 0xFF);
                assert_eq!(ask(&mut rig("bad_crc"), READ), bad);
            }
            "flip_bits" => {
                for bits in [1, 16] {
                    let got = ask(&mut rig(&format!("flip_bits:bits={bits}")), READ);
                    let turned: u32 =
                        got.iter().zip(&whole).map(|(a, b)| (a ^ b).count_ones()).sum();
                    assert_eq!((got.len(), turned), (whole.len(), bits));
                }
                let got = ask(&mut rig("flip_bits"), READ);
                assert!(rtu::decode(&got).is_err(), "one by default, which no CRC misses");
            }
            "truncate" => {
                assert_eq!(ask(&mut rig("truncate:bytes=3"), READ), whole[..4]);
                assert_eq!(ask(&mut rig("truncate"), READ), whole[..6]);
                assert_eq!(ask(&mut rig("truncate:bytes=200"), READ), whole[..1]);
            }
            "extra" => {
                let got = ask(&mut rig("extra:bytes=3"), READ);
                assert_eq!((&got[..7], got.len()), (&whole[..], 10));
                assert_eq!(ask(&mut rig("extra"), READ).len(), 8);
            }
            "garbage" => {
                let got = ask(&mut rig("garbage:bytes=3"), READ);
                assert_eq!((&got[3..], got.len()), (&whole[..], 10));
                assert_eq!(ask(&mut rig("garbage"), READ).len(), 8);
            }
            "delay" => {
                let mut rig = rig("delay:ms=200");
                assert_eq!(ask(&mut rig, WRITE), SILENCE);
                assert_eq!(jog_speed(&mut rig), 7, "executed at once");
                let wake = rig.bus().poll_at().expect("a deadline");
                assert!(matches!(wake.reason, WakeReason::Reply(_)));
                assert_eq!(rig.advance(199 * MS), SILENCE);
                assert_eq!(rig.advance(MS), frame(WRITE));
            }
            "late" => {
                let mut rig = rig("late:count=1");
                assert_eq!(both(&mut rig, WRITE), [SILENCE, SILENCE]);
                assert_eq!(ask(&mut rig, READ), [frame(WRITE), frame(&[3, 2, 0, 7])].concat());
            }
            "reorder" => {
                let mut rig = rig("reorder:count=1");
                assert_eq!(ask(&mut rig, WRITE), SILENCE);
                assert_eq!(jog_speed(&mut rig), 7, "executed at once");
                assert_eq!(ask(&mut rig, READ), [frame(&[3, 2, 0, 7]), frame(WRITE)].concat());
                assert_eq!(rig.advance(10_000 * MS), SILENCE);
            }
            "duplicate" => {
                assert_eq!(ask(&mut rig("duplicate"), READ), [&whole[..], &whole].concat());
            }
            "split" => {
                let pieces = |a: &[u8], b: &[u8]| [a.to_vec(), b.to_vec()];
                let got = both(&mut rig("split:at=2,gap_ms=50"), READ);
                assert_eq!(got, pieces(&whole[..2], &whole[2..]));
                let mut rig = rig("split");
                assert_eq!(ask(&mut rig, READ), whole[..3], "half by default");
                assert_eq!(rig.advance(19 * MS), SILENCE);
                assert_eq!(rig.advance(MS), whole[3..], "20 ms by default");
                let mut rig = drive(&["split:at=300"]);
                assert_eq!(ask(&mut rig, READ), whole[..6], "two pieces always");
            }
            "wrong_unit" => {
                let from = |unit| rtu::encode(unit, ANSWER).to_vec();
                assert_eq!(ask(&mut rig("wrong_unit:to=9"), READ), from(9));
                assert_eq!(ask(&mut rig("wrong_unit"), READ), from(2));
                let mut rig = rig("wrong_unit:to=1");
                assert_eq!(ask(&mut rig, READ), whole, "that is the right one");
                assert!(effects(&rig).is_empty());
            }
            "wrong_function" => {
                let of = |function| frame(&[&[function], &ANSWER[1..]].concat());
                assert_eq!(ask(&mut rig("wrong_function:to=0x10"), READ), of(0x10));
                assert_eq!(ask(&mut rig("wrong_function"), READ), of(0x04));
                assert_eq!(ask(&mut rig("wrong_function"), &[0x2B]), frame(&[0xAC, 1]));
            }
            "exception" => {
                let mut rig = rig("exception:code=0x0B");
                assert_eq!(both(&mut rig, WRITE), [frame(&[0x86, 0x0B]), vec![]]);
                assert_eq!(jog_speed(&mut rig), 100, "not executed");
            }
            "busy" => {
                let mut rig = rig("busy");
                assert_eq!(both(&mut rig, WRITE), [frame(&[0x86, 0x06]), vec![]]);
                assert_eq!(jog_speed(&mut rig), 100, "not executed");
            }
            "echo" => {
                assert_eq!(ask(&mut rig("echo"), READ), [frame(READ), whole].concat());
                let mut rig = rig("echo");
                let broadcast = rtu::encode(0, WRITE);
                assert_eq!(rig.send(&broadcast), broadcast.to_vec());
                assert_eq!(jog_speed(&mut rig), 7, "executed");
            }
            _ => panic!("nobody tests `{kind}`"),
        }
    }
}

#[test]
fn each_rule_of_a_preset_acts() {
    for preset in Preset::ALL {
        let mut rig = drive(&[preset.name]);
        (0..4000).for_each(|_| {
            ask(&mut rig, READ);
            rig.advance(100 * MS);
        });
        let mut rules = rig.bus().faults().names();
        let idle = rules.find(|name| super::hits(&rig, name) == 0);
        assert_eq!(idle, None, "each rule of {} acts", preset.name);
    }
}

#[test]
fn faults_apply_to_exceptions_too() {
    let mut rig = drive(&["bad_crc:count=1", "delay:ms=5"]);
    let refused = frame(&[0xAB, 1]);
    let mut bad = refused.clone();
    bad[3..].iter_mut().for_each(|byte| *byte ^= 0xFF);
    assert_eq!(both(&mut rig, &[0x2B]), [bad, vec![]]);
    assert_eq!(both(&mut rig, &[0x2B]), [vec![], refused]);
}

/// Only what happens to a request can happen to a broadcast.
#[test]
fn a_broadcast_can_only_be_lost() {
    let broadcast = rtu::encode(0, WRITE);
    let mut rig = drive(&["bad_crc", "busy", "lose_request:count=1", "duplicate"]);
    assert_eq!(rig.send(&broadcast), SILENCE);
    assert_eq!((jog_speed(&mut rig), effects(&rig)), (100, vec!["lose_request"]));
    assert_eq!(rig.send(&broadcast), SILENCE);
    assert_eq!((jog_speed(&mut rig), effects(&rig).len()), (7, 1));
}

/// A drive sends what it has held back whether or not somebody speaks meanwhile.
#[test]
fn a_new_request_does_not_stop_a_delayed_reply() {
    let mut rig = drive(&["delay:ms=50,function=3"]);
    assert_eq!(ask(&mut rig, READ), SILENCE);
    rig.advance(20 * MS);
    assert_eq!(ask(&mut rig, READ), SILENCE);
    assert_eq!(rig.advance(10 * MS), SILENCE);
    assert_eq!(ask(&mut rig, WRITE), frame(WRITE));
    assert_eq!(rig.advance(20 * MS), frame(ANSWER));
    assert_eq!(rig.advance(20 * MS), frame(ANSWER), "each at its own time, as it was then");
}

/// Any master's request counts, also one to somebody else.
#[test]
fn a_late_reply_lands_in_a_foreign_transaction() {
    let mut rig = drive(&["late"]);
    assert_eq!(ask(&mut rig, READ), SILENCE);
    assert_eq!(rig.push(&rtu::encode(9, READ)), frame(ANSWER));
    assert_eq!(ask(&mut rig, READ), SILENCE);
    assert_eq!(rig.push(&rtu::encode(0, WRITE)), frame(ANSWER));
}

/// Only a reply goes ahead of it, whatever a rule does to that; with no reply it leaves by itself.
#[test]
fn a_held_reply_waits_for_another_reply() {
    let mut rig = drive(&["reorder:count=1,ms=300", "lose_reply:count=1", "extra:count=1"]);
    assert_eq!(ask(&mut rig, WRITE), SILENCE);
    assert_eq!(rig.push(&rtu::encode(9, READ)), SILENCE, "a foreign request");
    assert_eq!(ask(&mut rig, READ), SILENCE, "its reply is lost");
    let sent = ask(&mut rig, READ);
    let (whole, held) = (frame(&[3, 2, 0, 7]), frame(WRITE));
    assert_eq!((&sent[..7], &sent[8..]), (&whole[..], &held[..]), "behind all of it");
    let mut rig = drive(&["reorder:ms=300"]);
    assert_eq!(ask(&mut rig, WRITE), SILENCE);
    assert_eq!(rig.advance(299 * MS), SILENCE);
    assert_eq!(rig.advance(MS), frame(WRITE), "alone");
    for _ in 0..2 {
        assert_eq!(ask(&mut rig, WRITE), SILENCE);
        assert_eq!(ask(&mut rig, READ), [&whole[..], &held].concat(), "in pairs");
    }
}

/// On a line that takes time, it begins when the other has ended.
#[test]
fn a_held_reply_follows_at_the_pace_of_the_line() {
    let pacing = drivemu::medium::LineBehaviour {
        pacing: drivemu::medium::Pacing::Line,
        ..Default::default()
    };
    let arrives = |specs: &[&str]| {
        let mut rig = drive(specs).with_line_behaviour(pacing.clone());
        (0..2).for_each(|_| assert_eq!(ask(&mut rig, WRITE), SILENCE));
        let first = (0..1000).find(|_| !rig.advance(MS).is_empty()).expect("a reply");
        let next = (0..1000).find(|_| !rig.advance(MS).is_empty()).expect("another");
        (first, next)
    };
    let (first, next) = arrives(&["reorder:count=1"]);
    assert!(first > 0 && next > 5, "8 characters take more than 5 ms: {first}, {next}");
}

#[test]
fn ascii_has_an_lrc_and_seven_bits() {
    let gap = Duration::from_secs(1);
    let request = ascii::encode(1, &[3, 0, 5, 0, 1]);
    let with = |spec: &str| {
        let mut rig = drive_of("k-series", &[spec], 0).with_framing(Framing::Ascii { gap });
        rig.send(&request)
    };
    let whole = with("lose_request:unit=9");
    let (end, mut bad) = (whole.len(), with("bad_crc"));
    let digits = |frame: &[u8]| {
        u8::from_str_radix(std::str::from_utf8(&frame[end - 4..end - 2]).unwrap(), 16).unwrap()
    };
    assert_eq!(digits(&bad), !digits(&whole));
    bad[end - 4..].copy_from_slice(&whole[end - 4..]);
    assert_eq!(bad, whole, "nothing else is touched");
    let flipped = with("flip_bits:bits=16");
    assert!(flipped.iter().all(|it| *it < 0x80) && flipped != whole);
    assert_eq!(with("echo"), [&request, &whole[..]].concat());
    assert!(with("wrong_unit").starts_with(b":0203"));
}

#[test]
fn tcp_keeps_its_header() {
    let with = |spec: &str| {
        let mut line = line_of(text_of("hcfa-x"), &[], &DeviceSpec::default());
        line.ports = vec![PortSpec::Tcp("127.0.0.1:0".into())];
        line.add_fault(spec).unwrap_or_else(|problems| panic!("{}", problems[0]));
        let mut bus = line.bus(0);
        let link = bus.open(Framing::Mbap);
        let sent = [7, 8].map(|id| {
            bus.receive(bus.now(), link, &mbap::encode(id, 1, READ));
            drain(&mut bus).sent
        });
        bus.advance_to(bus.now() + 10_000 * MS);
        (sent, drain(&mut bus).sent)
    };
    let [first, second] = [7, 8].map(|id| mbap::encode(id, 1, ANSWER).to_vec());
    let (sent, _) = with("flip_bits:bits=16");
    assert!(sent[0][..6] == first[..6] && sent[0] != first && sent[0].len() == first.len());
    assert_eq!(with("late:count=1").0, [vec![], [&first[..], &second].concat()], "its own number");
    assert_eq!(with("truncate:count=1").0, [first[..10].to_vec(), second.clone()]);
    let (sent, later) = with("split:at=1,count=1");
    assert_eq!((sent, later), ([first[..1].to_vec(), second.clone()], first[1..].to_vec()));
    assert_eq!(with("wrong_unit:to=5").0[0], mbap::encode(7, 5, ANSWER).to_vec());
}

/// What waits for a link that is gone is forgotten.
#[test]
fn a_closed_link_gets_nothing() {
    let mut line = line_of(text_of("hcfa-x"), &[], &DeviceSpec::default());
    line.add_fault("delay:ms=5,every=2").expect("a good rule");
    line.add_fault("late").expect("a good rule");
    let mut bus = line.bus(0);
    let link = bus.open(line.wire.framing(1.0));
    for _ in 0..2 {
        bus.receive(bus.now(), link, &frame(READ));
    }
    drain(&mut bus);
    assert!(matches!(bus.poll_at().map(|it| it.reason), Some(WakeReason::Reply(_))));
    bus.close(link);
    bus.advance_to(bus.now() + 100 * MS);
    assert_eq!(drain(&mut bus).sent, SILENCE);
}
