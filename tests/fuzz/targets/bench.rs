//! Any text as a bench: every problem can be drawn, and what is let in can be switched on.

#![no_main]

mod common;

use drivemu::bench::parse;
use drivemu::time::{Duration, Instant};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: &[u8]| {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let bench = match parse(text, &common::Compiled) {
        Ok(bench) => bench,
        Err(problems) => return common::render_all(&problems, text),
    };
    for line in &bench.lines {
        let mut bus = line.bus(bench.seed.unwrap_or(0));
        bus.advance_to(Instant::ZERO + Duration::from_secs(2));
        while bus.poll_output().is_some() {}
    }
});
