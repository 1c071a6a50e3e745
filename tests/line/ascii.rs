//! ASCII: a colon begins, CR LF ends, a second of silence gives up.

use crate::kit::rig;
use drivemu::bench::DeviceSpec;
use drivemu::line::Framing;
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::wire::ascii::encode;

const GAP: Duration = Duration::from_secs(1);

/// P304 is 500.
const READ: &[u8] = b":010301300001CA\r\n";
const ANSWER: &[u8] = b":01030201F405\r\n";

fn k_series() -> Rig {
    let rig = rig("k-series", &[], &DeviceSpec::default());
    rig.with_framing(Framing::Ascii { gap: GAP })
}

fn silent(rig: &mut Rig, characters: &[u8]) {
    let got = rig.send(characters);
    assert!(got.is_empty(), "{}\n{}", characters.escape_ascii(), rig.log());
}

fn in_step(rig: &mut Rig) {
    let left_over = rig.advance(GAP);
    assert!(left_over.is_empty(), "{}", left_over.escape_ascii());
    assert_eq!(rig.push(READ), ANSWER, "{}", rig.log());
}

#[test]
fn in_one_piece_and_in_many() {
    let mut rig = k_series();
    assert_eq!(rig.push(READ), ANSWER);
    assert_eq!(rig.push(&[READ, READ].concat()), [ANSWER, ANSWER].concat());
    for (i, byte) in READ.iter().enumerate() {
        let got = rig.push(&[*byte]);
        assert_eq!(got, if i + 1 == READ.len() { ANSWER } else { b"" });
    }
    in_step(&mut rig);
}

#[test]
fn small_letters_are_understood_and_capitals_sent() {
    let mut rig = k_series();
    assert_eq!(rig.push(&READ.to_ascii_lowercase()), ANSWER);
    assert_eq!(rig.push(b":010601300aBcfd\r\n"), b"", "{}", rig.log());
    let write = encode(1, &[6, 1, 0x30, 0x0A, 0xBC]);
    assert_eq!(rig.push(&write.to_ascii_lowercase()), &*write);
    assert_eq!(rig.push(READ), &*encode(1, &[3, 2, 0x0A, 0xBC]));
}

#[test]
fn a_colon_begins_anew() {
    let mut rig = k_series();
    for head in
        [&b":"[..], b"::::", b":0", b":01060130", b":0106013000FFC8", b":0106013000FFC8\r", b":zz"]
    {
        assert_eq!(rig.push(&[head, READ].concat()), ANSWER, "{}", head.escape_ascii());
    }
    in_step(&mut rig);
}

/// A pause of up to a second inside a frame is nothing, longer ones end it.
#[test]
fn a_second_of_silence() {
    let tick = Duration::from_nanos(1);
    for at in 1..READ.len() {
        let mut rig = k_series();
        assert_eq!(rig.push(&READ[..at]), b"");
        assert_eq!(rig.advance(GAP - tick), b"");
        assert_eq!(rig.push(&READ[at..]), ANSWER, "at {at}");
        let mut rig = k_series();
        rig.push(&READ[..at]);
        rig.advance(GAP);
        assert!(rig.log().contains("incomplete frame"), "{}", rig.log());
        assert_eq!(rig.push(&READ[at..]), b"", "at {at}");
        in_step(&mut rig);
    }
    // Each character begins the second anew.
    let mut rig = k_series();
    let mut got = Vec::new();
    for byte in READ {
        got.extend(rig.push(&[*byte]));
        rig.advance(GAP - tick);
    }
    assert_eq!(got, ANSWER);
}

#[test]
fn garbage_between_frames() {
    let mut rig = k_series();
    for garbage in [
        &b"\0"[..],
        b"\xFF\xFE",
        b"010601300007C1\r\n",
        b"\r\n\r\n",
        b"hello",
        b"\x01\x03\x01\x30\0\x01\x85\xF9",
    ] {
        assert_eq!(rig.push(&[garbage, READ, garbage, READ].concat()), [ANSWER, ANSWER].concat());
        silent(&mut rig, garbage);
        in_step(&mut rig);
    }
}

#[test]
fn frames_that_do_not_add_up() {
    for bad in [
        &b":\r\n"[..],
        b":01\r\n",
        b":0103\r\n",
        b":010301300001CB\r\n",
        b":01030130001CA\r\n",
        b":0103013000010CA\r\n",
        b":01030130000gCA\r\n",
        b":01 03 01 30 00 01 CA\r\n",
        b":010301300001CA\n",
        b":010301300001CA\r",
        b":010301300001CA",
        b":010301300001CA\r\r\n",
        b":\xFF\xFF\xFF\xFF\xFF\xFF\r\n",
    ] {
        let mut rig = k_series();
        silent(&mut rig, bad);
        in_step(&mut rig);
        // And with no gap at all: the next colon is enough.
        let mut rig = k_series();
        assert_eq!(rig.push(&[bad, READ].concat()), ANSWER, "{}", bad.escape_ascii());
    }
}

#[test]
fn too_long() {
    for len in [511, 512, 513, 600, 2000] {
        let mut rig = k_series();
        let long = [b":", &*b"0".repeat(len), b"\r\n"].concat();
        silent(&mut rig, &long);
        in_step(&mut rig);
        assert_eq!(rig.push(&[&*long, READ].concat()), ANSWER);
    }
}

#[test]
fn others_and_all() {
    let mut rig = k_series();
    silent(&mut rig, &encode(9, &[3, 1, 0x30, 0, 1]));
    silent(&mut rig, &encode(9, &[3, 2, 1, 0xF4]));
    silent(&mut rig, &encode(0, &[3, 1, 0x30, 0, 1]));
    in_step(&mut rig);
    silent(&mut rig, &encode(0, &[6, 1, 0x30, 0, 7]));
    silent(&mut rig, &encode(0, &[6, 0, 0x64, 0, 7]));
    for unit in [1, 2] {
        assert_eq!(rig.push(&encode(unit, &[3, 1, 0x30, 0, 1])), &*encode(unit, &[3, 2, 0, 7]));
        assert_eq!(rig.push(&encode(unit, &[3, 0, 0x64, 0, 1])), &*encode(unit, &[3, 2, 0, 0]));
    }
}

#[test]
fn every_function_code() {
    let mut rig = k_series();
    for function in (0..=255u8).filter(|function| ![3, 6].contains(function)) {
        for len in [0, 1, 4, 9, 252] {
            let request = encode(1, &[&[function][..], &vec![0; len]].concat());
            let exception = encode(1, &[function | 0x80, 1]);
            // With the exception bit it is an answer, and gets none.
            let want = if function < 0x80 { &*exception } else { b"" };
            assert_eq!(rig.push(&request), want, "function {function} with {len}");
        }
    }
}
