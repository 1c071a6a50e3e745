//! Functions that don't tell how long a frame is: a patient line ends them by their CRC.

use super::{PATIENT_GAP, STRICT_GAP, cell, frame, in_step, one, silent};
use crate::kit::MODELS;
use drivemu::event::EventKind;
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::wire::crc16;

/// 3.5 characters of 11 bits at 9600 baud are 4.0104 ms, which [`STRICT_GAP`] rounds up.
const LESS: Duration = Duration::from_micros(4010);
const MS: Duration = Duration::from_millis(1);

/// Requests of others and their answers; a broadcast has none.
const CONVERSATIONS: [(&str, &str); 8] = [
    ("09 08 0000 1234", "09 08 0000 1234"),
    ("09 14 07 06 0004 0001 0002", "09 14 06 05 06 0DFE 0020"),
    ("09 15 09 06 0004 0007 0001 06AF", "09 15 09 06 0004 0007 0001 06AF"),
    ("09 18 04DE", "09 18 0006 0002 01B8 1284"),
    ("09 2B 0E 01 00", "09 2B 0E 01 01 00 00 01 00 01 41"),
    ("09 41 01 02 03", "09 41 04"),
    ("09 41 01 02 03", "09 C1 01"),
    ("00 08 0001 0000", ""),
];

/// A read of unit 4 of the cell.
fn read() -> Vec<u8> {
    frame("04 03 0023 0001")
}

fn answer() -> Vec<u8> {
    frame("04 03 02 003C")
}

fn frames((request, answer): (&str, &str)) -> Vec<Vec<u8>> {
    [request, answer].iter().filter(|text| !text.is_empty()).map(|text| frame(text)).collect()
}

fn foreign(rig: &Rig) -> usize {
    rig.events().iter().filter(|it| matches!(it.kind, EventKind::Foreign { .. })).count()
}

/// The CRC and a silence of t3.5 end such a frame, and not a moment less.
#[test]
fn a_silence_of_a_frame_ends_it() {
    for conversation in CONVERSATIONS {
        let mut rig = cell(false);
        for (i, bytes) in frames(conversation).iter().enumerate() {
            let before = rig.now();
            assert!(rig.push(bytes).is_empty());
            let is_told = bytes[1] & 0x80 != 0 || bytes[0] == 0;
            assert!(rig.advance(LESS).is_empty());
            assert!(is_told || foreign(&rig) == i, "too early: {}", rig.log());
            assert!(rig.advance(STRICT_GAP - LESS).is_empty());
            let last = rig.events().last().expect("an event");
            assert!(last.at <= before + STRICT_GAP, "{}", rig.log());
        }
        assert_eq!(rig.push(&read()), answer(), "{conversation:?}\n{}", rig.log());
        assert!(!rig.log().contains("CRC"), "{}", rig.log());
        in_step(&mut rig);
    }
}

/// A master on a pseudo-terminal asks the next unit before the line was silent for long.
#[test]
fn a_request_that_follows_sooner_is_heard() {
    for pause in [Duration::ZERO, MS, 3 * MS, STRICT_GAP, 19 * MS, PATIENT_GAP] {
        for conversation in CONVERSATIONS {
            let mut rig = cell(false);
            for bytes in frames(conversation) {
                assert!(rig.push(&bytes).is_empty());
                assert!(rig.advance(pause).is_empty());
            }
            assert_eq!(rig.push(&read()), answer(), "{conversation:?} {pause:?}\n{}", rig.log());
            in_step(&mut rig);
        }
    }
}

/// Adapters and schedulers deliver all of it at once, or cut anywhere.
#[test]
fn in_one_piece_and_cut_anywhere() {
    for conversation in CONVERSATIONS {
        let mut all = frames(conversation).concat();
        all.extend(frame("09 03 0000 0001"));
        all.extend(frame("09 03 02 0007"));
        all.extend(read());
        for cut in 0..all.len() {
            let mut rig = cell(false);
            let mut got = rig.push(&all[..cut]);
            got.extend(rig.advance(MS));
            got.extend(rig.push(&all[cut..]));
            assert_eq!(got, answer(), "{conversation:?} cut at {cut}\n{}", rig.log());
            assert!(!rig.log().contains("CRC"), "{}", rig.log());
            in_step(&mut rig);
        }
    }
}

/// An answer of others whose question nobody here has heard, where the function tells a wrong length for it.
#[test]
fn an_answer_without_its_question_does_not_hide_what_follows() {
    for orphan in ["09 03 04 1234 5678", "09 03 02 0103", "09 10 0806 0002", "09 0F 0000 0008"] {
        for pause in [STRICT_GAP, 10 * MS] {
            let mut rig = cell(false);
            assert!(rig.push(&frame(orphan)).is_empty());
            assert!(rig.advance(pause).is_empty());
            assert_eq!(rig.push(&read()), answer(), "{orphan} {pause:?}\n{}", rig.log());
            in_step(&mut rig);
        }
    }
}

/// The answer that is awaited is not cut short by a CRC that happens to fit inside it, whatever pause an adapter makes.
#[test]
fn an_awaited_answer_is_waited_for() {
    let mut answer = drivemu::testkit::hex("09 03 0E 0000 00").expect("hex");
    answer.extend(crc16(&answer).to_le_bytes());
    answer.extend(frame("01 06 0304 0007"));
    answer.push(0);
    answer.extend(crc16(&answer).to_le_bytes());
    for cut in 1..answer.len() {
        let mut rig = cell(false);
        silent(&mut rig, &frame("09 03 0000 0007"));
        assert!(rig.push(&answer[..cut]).is_empty());
        assert!(rig.advance(16 * MS).is_empty());
        assert!(rig.push(&answer[cut..]).is_empty(), "cut at {cut}: {}", rig.log());
        assert_eq!(foreign(&rig), 2, "cut at {cut}: {}", rig.log());
        in_step(&mut rig);
    }
}

/// Our own drives refuse such a function after t3.5, not after the patience of the line.
#[test]
fn our_own_drives_refuse_soon() {
    for model in MODELS {
        let code = if model.starts_with("yako") { 2 } else { 1 };
        for (request, _) in &CONVERSATIONS[..6] {
            let mut rig = one(model, false);
            let request = request.replacen("09", "01", 1);
            let function = &request[3..5];
            let function = u8::from_str_radix(function, 16).expect("hex");
            let mut got = rig.push(&frame(&request));
            // 3.5 characters, of the K series 4.
            got.extend(rig.advance(STRICT_GAP * 8 / 7));
            let refusal = frame(&format!("01 {:02X} {code:02X}", function | 0x80));
            assert_eq!(got, refusal, "{model} {request}\n{}", rig.log());
        }
    }
}

/// The log tells a question from its answer here too.
#[test]
fn questions_and_answers_are_told_apart() {
    for conversation in &CONVERSATIONS[..7] {
        let mut rig = cell(false);
        for bytes in frames(*conversation) {
            silent(&mut rig, &bytes);
        }
        let kinds = rig.events().iter().filter_map(|it| match it.kind {
            EventKind::Foreign { reply, .. } => Some(reply),
            _ => None,
        });
        assert_eq!(kinds.collect::<Vec<_>>(), [false, true], "{}", rig.log());
    }
}
