//! Strangers on the line: their requests and answers are followed, never answered, never taken for ours.

use super::{PATIENT_GAP, STRICT_GAP, banks, cell, frame, in_step, unchanged};
use drivemu::event::EventKind;
use drivemu::testkit::{Rig, hex};
use drivemu::time::Duration;
use drivemu::wire::crc16;

/// Conversations with unit 9: request and answer.
fn conversations() -> Vec<(Vec<u8>, Vec<u8>)> {
    let pairs = [
        ("09 03 0000 0002", "09 03 04 1234 5678"),
        ("09 03 0000 0001", "09 03 02 0103"),
        ("09 06 0304 0007", "09 06 0304 0007"),
        ("09 10 0806 0002 04 0001 0000", "09 10 0806 0002"),
        ("09 04 0000 0001", "09 04 02 0301"),
        ("09 01 0000 0008", "09 01 01 00"),
        ("09 02 0000 0010", "09 02 02 0304"),
        ("09 05 0000 FF00", "09 05 0000 FF00"),
        ("09 07", "09 07 00"),
        ("09 0B", "09 0B 0000 0001"),
        ("09 0F 0000 0008 01 FF", "09 0F 0000 0008"),
        ("09 11", "09 11 03 01 02 03"),
        ("09 16 0304 FFFF 0000", "09 16 0304 FFFF 0000"),
        ("09 17 0000 0001 0000 0001 02 0007", "09 17 02 0007"),
        ("09 03 0000 00FF", "09 83 03"),
        ("09 06 0000 0000", "09 86 02"),
        ("09 10 0000 0001 02 0000", "09 90 02"),
        // Looks like a read of 0x0203 x 0x0178 once the next byte is there.
        ("09 04 0000 0001", "09 04 02 0178"),
    ];
    let mut pairs: Vec<_> = pairs.iter().map(|(ask, answer)| (frame(ask), frame(answer))).collect();
    pairs.push((frame("09 03 0000 0004"), frame(&format!("09 03 08 {}", spaced(&ours())))));
    pairs.push((frame("09 03 0000 0007"), two_in_one()));
    pairs
}

/// A write to unit 1, CRC and all.
fn ours() -> Vec<u8> {
    frame("01 06 0304 0007")
}

/// An answer of unit 9 whose first eight bytes are a good request to unit 9, behind which stands a good
/// request to unit 1: only who remembers the question knows that it is one answer.
fn two_in_one() -> Vec<u8> {
    let mut answer = hex("09 03 0E 0000 00").expect("hex");
    answer.extend(crc16(&answer).to_le_bytes());
    answer.extend(ours());
    answer.push(0);
    let crc = crc16(&answer);
    answer.extend(crc.to_le_bytes());
    assert_eq!(answer.len(), 5 + 14);
    answer
}

fn spaced(bytes: &[u8]) -> String {
    drivemu::testkit::to_hex(bytes)
}

/// Plays pieces of traffic with silences and asserts that nobody says anything.
fn overhear<'a>(rig: &mut Rig, pieces: impl IntoIterator<Item = &'a [u8]>, pause: Duration) {
    for piece in pieces {
        let mut got = rig.push(piece);
        got.extend(rig.advance(pause));
        assert!(got.is_empty(), "{piece:02X?}: {got:02X?}\n{}", rig.log());
    }
}

#[test]
fn a_conversation_of_others_is_left_alone() {
    for strict in [false, true] {
        let gap = if strict { STRICT_GAP } else { PATIENT_GAP };
        for (request, answer) in conversations() {
            let mut rig = cell(strict);
            let before = banks(&rig);
            // An answer comes sooner on a patient line than silence would end the request.
            let soon = if strict { gap } else { Duration::from_millis(2) };
            overhear(&mut rig, [&*request, &*answer], soon);
            assert_eq!(kinds(&rig), ["request", "answer"], "{}", rig.log());
            overhear(&mut rig, [&*request, &*answer], gap);
            // Nobody was there the first time.
            overhear(&mut rig, [&*request, &*request, &*answer], gap);
            unchanged(&rig, &before);
            in_step(&mut rig);
        }
    }
}

/// Adapters and schedulers deliver a whole conversation at once, with a request to us at its end.
#[test]
fn a_conversation_of_others_in_one_piece_with_a_request_to_us() {
    for (request, answer) in conversations() {
        let mut rig = cell(false);
        let mine = frame("04 03 0023 0001");
        let all = [&*request, &*answer, &*mine].concat();
        assert_eq!(rig.push(&all), frame("04 03 02 003C"), "{}\n{}", spaced(&all), rig.log());
        in_step(&mut rig);
    }
}

#[test]
fn a_conversation_of_others_byte_by_byte() {
    for (request, answer) in conversations() {
        for strict in [false, true] {
            let mut rig = cell(strict);
            let before = banks(&rig);
            for frame in [&request, &answer] {
                overhear(&mut rig, frame.chunks(1), Duration::from_millis(1));
                overhear(&mut rig, [&[][..]], STRICT_GAP);
            }
            assert_eq!(kinds(&rig), ["request", "answer"], "{}", rig.log());
            unchanged(&rig, &before);
            in_step(&mut rig);
        }
    }
}

/// Whoever joins in the middle hears an answer without its question.
#[test]
fn an_answer_without_its_question() {
    for strict in [false, true] {
        for (_, answer) in conversations() {
            // Without the question this one can't be told from two requests, by anybody.
            if !strict && answer == two_in_one() {
                continue;
            }
            let mut rig = cell(strict);
            let before = banks(&rig);
            overhear(&mut rig, [&*answer], PATIENT_GAP);
            unchanged(&rig, &before);
            in_step(&mut rig);
        }
    }
}

/// The answer never comes; the next request to us follows after a gap.
#[test]
fn a_question_without_an_answer() {
    for strict in [false, true] {
        for (request, _) in conversations() {
            let mut rig = cell(strict);
            overhear(&mut rig, [&*request], PATIENT_GAP);
            in_step(&mut rig);
            // A request to us ends the other conversation: what looks like its answer is one no more.
            overhear(&mut rig, [&*request], PATIENT_GAP);
            in_step(&mut rig);
        }
    }
}

/// A master in a hurry asks a unit that is not there twice, and then us: the second time must not be taken for the
/// beginning of an answer that is longer.
#[test]
fn a_question_asked_twice_and_a_request_to_us() {
    let more = ["09 04 2000 0001", "09 01 2000 0001", "09 0C", "09 17 2000 0001 0000 0001 02 0007"];
    let all = conversations().into_iter().map(|(request, _)| request).chain(more.map(frame));
    for request in all {
        for pause in [1, 3, 10].map(Duration::from_millis) {
            let mut rig = cell(false);
            overhear(&mut rig, [&*request, &*request], pause);
            let mine = frame("04 03 0023 0001");
            assert_eq!(rig.push(&mine), frame("04 03 02 003C"), "{request:02X?}\n{}", rig.log());
            assert_eq!(rig.log().matches("foreign ").count(), 2, "{}", rig.log());
        }
    }
}

/// An unknown function has no length, so silence has to end it; then all is well again.
#[test]
fn a_conversation_in_an_unknown_function() {
    for strict in [false, true] {
        let mut rig = cell(strict);
        let pieces = [frame("09 2B 0E 01 00"), frame("09 2B 0E 01 01 00 00 01 00 01 41")];
        overhear(&mut rig, pieces.iter().map(Vec::as_slice), PATIENT_GAP);
        in_step(&mut rig);
    }
}

/// A damaged request or answer of others.
#[test]
fn a_damaged_conversation_of_others() {
    for strict in [false, true] {
        for (request, answer) in conversations() {
            for at in [0, 1, 2, 3] {
                let mut rig = cell(strict);
                let before = banks(&rig);
                let mut bad = answer.clone();
                bad[at] ^= 0x10;
                overhear(&mut rig, [&*request, &*bad], PATIENT_GAP);
                in_step(&mut rig);
                // Behind a question that nobody could read this one can't be told from two requests.
                if !strict && answer == two_in_one() {
                    continue;
                }
                let mut bad = request.clone();
                bad[at] ^= 0x10;
                overhear(&mut rig, [&*bad, &*answer], PATIENT_GAP);
                unchanged(&rig, &before);
                in_step(&mut rig);
            }
        }
    }
}

fn kinds(rig: &Rig) -> Vec<&'static str> {
    let kind = |event: &drivemu::event::Event| match event.kind {
        EventKind::Foreign { reply: false, .. } => Some("request"),
        EventKind::Foreign { reply: true, .. } => Some("answer"),
        EventKind::Drive { .. } => None,
        _ => Some("something else"),
    };
    rig.events().iter().filter_map(kind).collect()
}
