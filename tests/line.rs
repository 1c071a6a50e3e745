//! Lines as they really are: several drives, strangers that talk, bytes in pieces, noise.
//!
//! Everywhere the same two demands: a right answer or silence, and in step again after one gap.

mod ascii;
mod foreign;
mod lengthless;
mod rtu;
mod shared;
mod tcp;

use crate::kit::bench_line;
use drivemu::bench::{BenchLine, DeviceSpec};
use drivemu::line::Framing;
use drivemu::testkit::{Rig, hex};
use drivemu::time::Duration;
use drivemu::wire::rtu::encode;
use std::sync::OnceLock;

/// Silence that ends a frame: on the patient lines of these tests, and at 9600-8N2.
const PATIENT_GAP: Duration = Duration::from_millis(20);
const STRICT_GAP: Duration = Duration::from_micros(4011);

/// All kinds of drive on one line: HCFA is unit 1, the K series' axes are 2 and 3, YAKO is 4.
pub fn cell(strict: bool) -> Rig {
    static CELL: OnceLock<BenchLine> = OnceLock::new();
    let cell = CELL.get_or_init(|| {
        bench_line(
            "lines:
  - pty: auto
    settings: 9600-8N2
    drives:
      - {model: hcfa-x, unit: 1}
      - {model: k-series, unit: 2}
      - {model: yako-closed-loop, unit: 4}
",
        )
    });
    let mut cell = cell.clone();
    cell.wire.strict = strict;
    Rig::line(cell)
}

/// One drive, patient as on a port or strict as the standard has it.
fn one(model: &str, strict: bool) -> Rig {
    let rig = crate::kit::rig(model, &[], &DeviceSpec::default());
    if strict {
        rig.with_framing(Framing::Rtu { silence: STRICT_GAP, patience: None })
    } else {
        rig
    }
}

/// A frame from unit, function and data in hex.
fn frame(text: &str) -> Vec<u8> {
    let bytes = hex(text).expect("hex");
    encode(bytes[0], &bytes[1..]).to_vec()
}

/// Asserts that nobody answers `bytes`, also not behind a gap.
fn silent(rig: &mut Rig, bytes: &[u8]) {
    let got = rig.send(bytes);
    assert!(got.is_empty(), "{bytes:02X?} was answered with {got:02X?}\n{}", rig.log());
}

/// Asserts that after a gap each unit answers a read of its own that fits in a frame.
fn in_step(rig: &mut Rig) {
    let left_over = rig.advance(PATIENT_GAP);
    assert!(left_over.is_empty(), "{left_over:02X?}\n{}", rig.log());
    let units: Vec<u8> = rig.bus().drives().map(|(_, drive)| drive.unit()).collect();
    for unit in units {
        let (request, answer) = match rig.unit(unit).expect("a unit").model().name.as_str() {
            "hcfa-x" => ("03 085C 0001", "03 02 01F4"),
            "k-series" => ("03 0130 0001", "03 02 01F4"),
            _ => ("03 0023 0001", "03 02 003C"),
        };
        let got = rig.send(&frame(&format!("{unit:02X} {request}")));
        assert_eq!(got, frame(&format!("{unit:02X} {answer}")), "unit {unit}\n{}", rig.log());
    }
}

/// Every value of every drive.
fn banks(rig: &Rig) -> Vec<drivemu::bank::Bank> {
    rig.bus().drives().map(|(_, drive)| drive.bank().clone()).collect()
}

/// Asserts that every value is as it was, without printing thousands of numbers.
fn unchanged(rig: &Rig, before: &[drivemu::bank::Bank]) {
    assert!(banks(rig) == before, "{}", rig.log());
}
