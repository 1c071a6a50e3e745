//! Any text as a scenario for one drive: every problem can be drawn, and what is let in can be played.

#![no_main]

mod common;

use drivemu::bench::{BenchLine, parse};
use drivemu::scenario;
use drivemu::testkit::Rig;
use drivemu::time::Duration;
use libfuzzer_sys::fuzz_target;

const BENCH: &str =
    "lines: [{rtu_over_tcp: '127.0.0.1:0', drives: [{model: yako-closed-loop, unit: 1}]}]";

fuzz_target!(|input: &[u8]| {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let line: BenchLine = parse(BENCH, &common::Compiled).expect("a good bench").lines.remove(0);
    if let Err(problems) = scenario::parse(text, std::slice::from_ref(&line)) {
        return common::render_all(&problems, text);
    }
    let mut rig = Rig::line(line).with_scenario(text).expect("it was read before");
    rig.advance(Duration::from_secs(30));
    rig.finish();
});
