//! README.md tells the truth: its benches are valid, and its log lines come as it shows them.
//!
//! Its tour is typed in `tests/masters`, its Rust is a doctest, its faults and its scenario are held by the tests of those.

use super::fenced;
use crate::expect::{read, root};
use crate::kit::Files;
use drivemu::bench::{BuiltinLibrary, parse};
use drivemu::problem::render::render;
use drivemu::testkit::transcript;

#[test]
fn the_benches_are_valid() {
    let texts = fenced(&read(&root("README.md")), "yaml");
    let benches: Vec<_> = texts.iter().filter(|it| it.starts_with("lines:")).collect();
    assert_eq!(benches.len(), 3);
    for text in benches {
        let problems = parse(text, &BuiltinLibrary).err().unwrap_or_default();
        assert!(problems.is_empty(), "{}", render(&problems, "README.md", text));
    }
}

/// The block of text that contains `mark`, as `log` lines of a transcript.
fn logged(mark: &str) -> Vec<String> {
    let texts = fenced(&read(&root("README.md")), "text");
    let text = texts.iter().find(|it| it.contains(mark)).expect("a block of the log");
    text.lines().map(|line| format!("log {line}")).collect()
}

#[test]
fn orders_without_effect_are_told_as_shown() {
    let [not_enabled, servo_off, no_edge, word] = &logged("has no effect")[..] else {
        panic!("four lines")
    };
    let play = format!(
        "model hcfa-x unit 1\n\
         set P09.06 0x0204\n\
         set P08.06 1000000\n\
         set P09.11 60\n\
         > 06 3607 0002\n\
         {not_enabled}\n\
         > 06 3608 0204\n\
         {servo_off}\n\
         + 1s\n\
         > 06 3608 0200\n\
         > 06 0905 0002\n\
         {no_edge}\n\
         > 03 3688 0001\n\
         < 03 02 0000\n\
         {word}\n"
    );
    transcript::run(&play, &Files).unwrap_or_else(|failure| panic!("{failure}\n{play}"));
}

/// All of it but the instants, which are those of a hand on a keyboard.
#[test]
fn a_stepper_moves_as_shown() {
    let lines = logged("moving to 5000");
    let without_time = |line: &str| line.rsplit_once(" unit 1 ").map_or("", |it| it.1).to_owned();
    let told: Vec<_> = lines.iter().map(|line| without_time(line)).collect();
    let [speed, order, moves, _, stands, run, runs, stop, stops, _] = &told[..] else {
        panic!("ten lines")
    };
    let play = format!(
        "model yako-closed-loop\n\
         > 06 0023 0258\nlog {speed}\n\
         > 06 0027 0001\nlog {order}\nlog {moves}\n\
         + 1s\nlog {stands}\n\
         > 06 0027 0002\nlog {run}\nlog {runs}\n\
         + 1s\n\
         > 06 0027 0100\nlog {stop}\nlog {stops}\n"
    );
    transcript::run(&play, &Files).unwrap_or_else(|failure| panic!("{failure}\n{play}"));
}
