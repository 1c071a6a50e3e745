//! Any text as a fault rule of the command line: every problem can be drawn, and a rule that is let in can act.

#![no_main]

mod common;

use drivemu::bench::{BenchLine, parse};
use drivemu::bus::{LineCommand, Output};
use drivemu::time::Duration;
use drivemu::wire::rtu;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static LINE: LazyLock<BenchLine> = LazyLock::new(|| {
    let bench = "lines: [{pty: auto, drives: [{model: hcfa-x, unit: 1}]}]";
    let bench = parse(bench, &common::Compiled).expect("a good bench");
    bench.lines.into_iter().next().expect("a line")
});

fuzz_target!(|input: &[u8]| {
    let Ok(spec) = std::str::from_utf8(input) else { return };
    let fault_set = match LINE.fault(spec, &[]) {
        Ok(fault_set) => fault_set,
        Err(problems) => return common::render_all(&problems, spec),
    };
    let mut bus = LINE.bus(1);
    let link = bus.open(LINE.wire.framing(1.0));
    let rules = fault_set.rules.into_iter().map(LineCommand::AddFault);
    for command in rules.chain([LineCommand::SetBehaviour(fault_set.line_behaviour)]) {
        bus.command(bus.now(), command.into()).expect("a fault that was read is possible");
    }
    for pdu in [&[3, 3, 4, 0, 1][..], &[6, 3, 4, 0, 7], &[16, 8, 6, 0, 2, 4, 0, 0, 0, 1], &[0x2B]] {
        let now = bus.now() + Duration::from_secs(1);
        bus.receive(now, link, &rtu::encode(1, pdu));
        while let Some(output) = bus.poll_output() {
            if let Output::Event(event) = output {
                common::tell(&event);
            }
        }
    }
});
