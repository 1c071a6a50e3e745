//! Drives of three makers on one line: each answers its own, and a broadcast reaches them all.

use super::{banks, cell, frame, in_step, silent, unchanged};
use drivemu::event::EventKind;
use drivemu::testkit::Rig;

#[test]
fn each_answers_its_own_and_nobody_elses() {
    for strict in [false, true] {
        let mut rig = cell(strict);
        in_step(&mut rig);
        for unit in (5..=255).filter(|unit| *unit != 0) {
            silent(&mut rig, &frame(&format!("{unit:02X} 03 0023 0001")));
        }
        in_step(&mut rig);
    }
}

#[test]
fn a_write_changes_one_drive() {
    for strict in [false, true] {
        for (i, write) in
            ["06 0304 0007", "06 0304 0007", "06 0304 0007", "06 0021 0007"].iter().enumerate()
        {
            let mut rig = cell(strict);
            let before = banks(&rig);
            let request = frame(&format!("{:02X} {write}", i + 1));
            assert_eq!(rig.send(&request), request);
            let changed = banks(&rig)
                .iter()
                .zip(&before)
                .map(|(now, before)| now != before)
                .collect::<Vec<_>>();
            let want: Vec<bool> = (0..4).map(|drive| drive == i).collect();
            assert_eq!(changed, want, "unit {}", i + 1);
        }
    }
}

#[test]
fn each_refuses_with_its_own_code() {
    let mut rig = cell(false);
    for (unit, code) in [(1, "02"), (2, "02"), (3, "02"), (4, "04")] {
        assert_eq!(rig.ask(&format!("{unit:02X} 06 F000 0001")), format!("{unit:02X} 86 {code}"));
    }
    for (unit, code) in [(1, "01"), (2, "01"), (3, "01"), (4, "02")] {
        assert_eq!(rig.ask(&format!("{unit:02X} 2B 0E")), format!("{unit:02X} AB {code}"));
    }
}

#[test]
fn a_broadcast_reaches_all_and_nobody_answers() {
    for strict in [false, true] {
        let mut rig = cell(strict);
        silent(&mut rig, &frame("00 06 0304 0007"));
        assert_eq!(values(&rig, "0x0304"), [Some(7), Some(7), Some(7), None]);
        silent(&mut rig, &frame("00 06 0021 0009"));
        assert_eq!(values(&rig, "0x0021"), [None, Some(9), Some(9), Some(9)]);
        // Only one of them knows function 0x10 at 0x0806, only one at 0x0021.
        silent(&mut rig, &frame("00 10 0806 0002 04 0001 0000"));
        assert_eq!(values(&rig, "0x0806"), [Some(1), None, None, None]);
        silent(&mut rig, &frame("00 10 0021 0002 04 0005 0006"));
        assert_eq!(values(&rig, "0x0021"), [None, Some(9), Some(9), Some(5)]);
        in_step(&mut rig);
    }
}

#[test]
fn a_broadcast_that_is_refused_is_refused_in_silence() {
    for strict in [false, true] {
        let mut rig = cell(strict);
        let before = banks(&rig);
        for request in [
            "00 06 F000 0001",
            "00 06 0064 FFFF",
            "00 10 0064 0001 02 FFFF",
            "00 10 0021 0001 04 0007 0007",
            "00 03 0023 0001",
            "00 2B 0E 01 00",
            "00 08 0000 A537",
            "00 86 02",
        ] {
            silent(&mut rig, &frame(request));
        }
        // A wrong CRC, on a line where one of the drives answers that with an exception.
        silent(&mut rig, &[0, 6, 0, 0x21, 0, 7, 0, 0]);
        unchanged(&rig, &before);
        in_step(&mut rig);
    }
}

#[test]
fn the_log_tells_of_every_drive_that_a_broadcast_reached() {
    let mut rig = cell(false);
    let before = rig.events().len();
    silent(&mut rig, &frame("00 06 0304 0007"));
    let refused: Vec<bool> = rig.events()[before..]
        .iter()
        .filter_map(|event| match &event.kind {
            EventKind::Broadcast(it) => Some(it.refusal.is_some()),
            _ => None,
        })
        .collect();
    assert_eq!(refused, [false, false, false, true]);
}

#[test]
fn only_the_drive_in_a_broken_frame_answers_it() {
    for strict in [false, true] {
        let mut rig = cell(strict);
        for unit in [1, 2, 3, 5, 9] {
            silent(&mut rig, &[unit, 3, 0, 0x23, 0, 1, 0, 0]);
        }
        assert_eq!(rig.send(&[4, 3, 0, 0x23, 0, 1, 0, 0]), frame("04 83 01"));
        in_step(&mut rig);
    }
}

/// The value at `address` of each drive that has one.
fn values(rig: &Rig, address: &str) -> Vec<Option<i64>> {
    let value = |(_, drive): (_, &drivemu::drive::Drive)| {
        let model = drive.model();
        Some(drive.bank().value(model, model.map.find(address)?))
    };
    rig.bus().drives().map(value).collect()
}
