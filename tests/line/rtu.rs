//! RTU: bytes in pieces, pieces of frames, frames in one piece, noise.

use super::{PATIENT_GAP, STRICT_GAP, banks, frame, in_step, one, silent, unchanged};
use crate::kit::MODELS;
use drivemu::event::EventKind;
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::wire::NoiseCause;

const READ: &str = "01 03 0023 0001";
const ANSWER: &str = "01 03 02 003C";
/// What a YAKO drive says to a broken frame.
const BROKEN: &str = "01 83 01";

fn yako(strict: bool) -> Rig {
    one("yako-closed-loop", strict)
}

/// Pushes byte by byte with `pause` behind each; what comes meanwhile.
fn drip(rig: &mut Rig, bytes: &[u8], pause: Duration) -> Vec<u8> {
    let mut got = Vec::new();
    for byte in bytes {
        got.extend(rig.push(&[*byte]));
        got.extend(rig.advance(pause));
    }
    got
}

#[test]
fn byte_by_byte() {
    for (strict, pause) in [(false, 0), (false, 1), (false, 16), (true, 0), (true, 1), (true, 3)] {
        let mut rig = yako(strict);
        let mut got = drip(&mut rig, &frame(READ), Duration::from_millis(pause));
        got.extend(rig.advance(STRICT_GAP));
        assert_eq!(got, frame(ANSWER), "{strict} {pause}");
        in_step(&mut rig);
    }
}

/// A patient line answers without waiting for silence, a strict one at the end of it and not before.
#[test]
fn when_the_answer_comes() {
    let mut rig = yako(false);
    assert_eq!(rig.push(&frame(READ)), frame(ANSWER));
    let mut rig = yako(true);
    assert_eq!(rig.push(&frame(READ)), [0_u8; 0]);
    assert_eq!(rig.advance(STRICT_GAP - Duration::from_nanos(1)), [0_u8; 0]);
    assert_eq!(rig.advance(Duration::from_nanos(1)), frame(ANSWER));
}

/// A pause as long as a gap cuts a frame in two, and neither half is one.
#[test]
fn a_pause_inside_a_frame_cuts_it() {
    for (strict, gap) in [(false, PATIENT_GAP), (true, STRICT_GAP)] {
        let whole = frame(READ);
        for at in 1..whole.len() {
            for (pause, cut) in [(gap - Duration::from_nanos(1), false), (gap, true)] {
                let mut rig = yako(strict);
                let mut got = rig.push(&whole[..at]);
                got.extend(rig.advance(pause));
                got.extend(rig.push(&whole[at..]));
                got.extend(rig.advance(gap));
                let halves = if at >= 4 { frame(BROKEN) } else { Vec::new() };
                assert_eq!(got, if cut { halves } else { frame(ANSWER) }, "{strict} at {at}");
                in_step(&mut rig);
            }
        }
    }
}

#[test]
fn frames_in_one_piece() {
    let all = [frame(READ), frame("01 06 0021 0007"), frame("01 03 0021 0001")].concat();
    let mut rig = yako(false);
    let want = [frame(ANSWER), frame("01 06 0021 0007"), frame("01 03 02 0007")].concat();
    assert_eq!(rig.push(&all), want);
    in_step(&mut rig);
    // Where silence alone ends a frame, this is one frame and no good one.
    let mut rig = yako(true);
    assert_eq!(rig.send(&all), frame(BROKEN));
    assert_eq!(rig.ask("01 03 0021 0001"), "01 03 02 00 64");
}

#[test]
fn garbage_then_a_gap_then_a_good_one() {
    for strict in [false, true] {
        for garbage in garbage() {
            let mut rig = yako(strict);
            let before = banks(&rig);
            // Unit 1 is ours: that much garbage in its name is answered as a frame with a wrong CRC.
            let named = garbage[0] == 1 && (4..=256).contains(&garbage.len());
            let want = if named { vec![1, garbage[1] | 0x80, 1] } else { Vec::new() };
            let got = rig.send(&garbage);
            assert_eq!(&got[..got.len().saturating_sub(2)], want, "{garbage:02X?}\n{}", rig.log());
            unchanged(&rig, &before);
            in_step(&mut rig);
        }
    }
}

/// Glued to garbage a good frame goes down with it; the next one does not.
#[test]
fn garbage_glued_to_a_good_one() {
    for strict in [false, true] {
        for garbage in garbage().iter().filter(|garbage| garbage[0] != 1) {
            let mut rig = yako(strict);
            silent(&mut rig, &[garbage, &*frame("01 06 0021 0007")].concat());
            in_step(&mut rig);
            assert_eq!(rig.ask("01 03 0021 0001"), "01 03 02 00 64");
        }
    }
}

/// Behind a good frame a patient line has answered before it looks at what follows.
#[test]
fn a_good_one_glued_to_garbage() {
    for garbage in garbage().iter().filter(|garbage| garbage[0] != 1) {
        let mut rig = yako(false);
        assert_eq!(rig.push(&[&*frame(READ), garbage].concat()), frame(ANSWER));
        in_step(&mut rig);
    }
}

fn garbage() -> Vec<Vec<u8>> {
    vec![
        vec![0xFF],
        vec![0x01],
        vec![0x01, 0x03, 0x00],
        vec![0xFF, 0x00, 0x55],
        vec![0x55; 7],
        vec![0x01, 0x03, 0x02, 0x00, 0x3C, 0x00, 0x00],
        vec![0x01, 0x10, 0x00, 0x21, 0x00, 0x02, 0xFF, 0x00],
        vec![0xFF; 64],
        vec![0xA5; 256],
        vec![0x01; 256],
        b"GET / HTTP/1.1\r\n\r\n".to_vec(),
        b":010300230001D8\r\n".to_vec(),
    ]
}

#[test]
fn cut_short_then_a_good_one() {
    let whole = frame("01 10 0021 0002 04 0007 0008");
    for strict in [false, true] {
        for len in 1..whole.len() {
            let mut rig = yako(strict);
            let got = rig.send(&whole[..len]);
            let want = if len < 4 { Vec::new() } else { frame("01 90 01") };
            assert_eq!(got, want, "{len} bytes\n{}", rig.log());
            in_step(&mut rig);
            assert_eq!(rig.ask("01 03 0021 0002"), "01 03 04 00 64 00 64");
        }
        // Without a gap the two are one broken frame.
        for len in 1..whole.len() {
            let mut rig = yako(strict);
            let got = rig.send(&[&whole[..len], &*frame("01 06 0021 0009")].concat());
            let function = if len == 1 { 0x01 } else { 0x10 };
            assert_eq!(got[..3], [1, function | 0x80, 1], "{len} bytes\n{}", rig.log());
            in_step(&mut rig);
            assert_eq!(rig.ask("01 03 0021 0001"), "01 03 02 00 64");
        }
    }
}

#[test]
fn too_long() {
    for strict in [false, true] {
        for len in [257, 300, 511, 512, 513, 600, 5000] {
            for first in [1, 9] {
                let mut rig = yako(strict);
                let mut bytes = vec![0x03; len];
                bytes[0] = first;
                silent(&mut rig, &bytes);
                let noise = rig.events().iter().find_map(|event| match event.kind {
                    EventKind::Noise { len, why, .. } => Some((len, why)),
                    _ => None,
                });
                assert_eq!(noise, Some((len, NoiseCause::TooLong)), "{}", rig.log());
                in_step(&mut rig);
            }
        }
    }
}

/// The longest frame there is, whole and with a good CRC: 256 bytes.
#[test]
fn as_long_as_can_be() {
    for strict in [false, true] {
        let mut rig = one("hcfa-x", strict);
        let words = "0000".repeat(123);
        assert_eq!(rig.send(&frame(&format!("01 10 0304 007B F6 {words}"))), frame("01 90 02"));
        let tail = "00".repeat(252);
        let longest = frame(&format!("01 41 {tail}"));
        assert_eq!((longest.len(), rig.send(&longest)), (256, frame("01 C1 01")));
        in_step(&mut rig);
    }
}

/// Unknown functions get an exception, whatever stands behind them; known ones an answer to what they say.
/// With the exception bit it is no request but an answer, our own echo maybe, and gets none.
#[test]
fn every_function_code() {
    for strict in [false, true] {
        for model in MODELS {
            let mut rig = one(model, strict);
            let line = &rig.drive().model().line;
            let known = line.functions.clone();
            let code = if model.starts_with("yako") { 2 } else { 1 };
            for function in 0..=255u8 {
                for data in
                    ["", "FF", "FF FF FF FF", "FF FF 00 01 02 00 00", "FF FF FF FF 01 00 00 00"]
                {
                    let got = rig.send(&frame(&format!("01 {function:02X} {data}")));
                    // Behind a frame that an unlucky CRC closed early the rest is still to come.
                    rig.advance(PATIENT_GAP);
                    let exception = frame(&format!("01 {:02X} {code:02X}", function | 0x80));
                    match function {
                        0x80.. => assert_eq!(got, [0_u8; 0], "{model} {data}\n{}", rig.log()),
                        // All of these ask for nothing that there is.
                        it if known.contains(&it) => assert_eq!(got[..2], exception[..2], "{data}"),
                        _ => assert_eq!(got, exception, "{model} {data}\n{}", rig.log()),
                    }
                }
                in_step(&mut rig);
            }
        }
    }
}

/// A byte count that disagrees with the data is told so, whichever way it lies.
#[test]
fn byte_counts_that_lie() {
    for strict in [false, true] {
        for (model, address, code) in [("yako-closed-loop", "0021", "07"), ("hcfa-x", "0905", "03")]
        {
            let mut rig = one(model, strict);
            let before = banks(&rig);
            for count in (0..=255).filter(|count| *count != 4) {
                let got = rig.send(&frame(&format!("01 10 {address} 0002 {count:02X} 0007 0008")));
                assert_eq!(got, frame(&format!("01 90 {code}")), "{count}\n{}", rig.log());
            }
            for count in (0..=255).filter(|count| *count != 2) {
                let request = format!("01 10 {address} {count:04X} 04 0007 0008");
                assert_eq!(
                    rig.send(&frame(&request)),
                    frame(&format!("01 90 {code}")),
                    "{request}"
                );
            }
            for tail in ["00", "00 00", "00 01 02 03 04 05 06 07"] {
                let got = rig.send(&frame(&format!("01 03 {address} 0001 {tail}")));
                assert_eq!(got, frame(&format!("01 83 {code}")));
            }
            unchanged(&rig, &before);
            in_step(&mut rig);
        }
    }
}
