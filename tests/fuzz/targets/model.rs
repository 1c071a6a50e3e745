//! Any text as a model: every problem can be drawn, and what is let in runs.

#![no_main]

mod common;

use drivemu::bench::DeviceSpec;
use drivemu::model::{Choices, check};
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use drivemu::wire::rtu;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let problems = check(text);
    if !problems.is_empty() {
        return common::render_all(&problems, text);
    }
    let spec = DeviceSpec::default();
    let Ok(mut rig) = Rig::model(text, &Choices::new(), &spec) else { return };
    let rows: Vec<u16> = rig.drive().model().map.rows().map(|(_, row)| row.at).take(64).collect();
    for address in rows {
        let ([high, low], unit) = (address.to_be_bytes(), rig.drive().unit());
        for pdu in [&[3, high, low, 0, 2][..], &[6, high, low, 0, 1]] {
            rig.send(&rtu::encode(unit, pdu));
        }
        rig.advance(Duration::from_millis(100));
    }
    rig.log();
});
