//! How large a file may be, and what is in it: no file that means something comes near, and none may eat the memory or
//! the time of whoever reads it.

use super::{Path, Problem};

/// Bytes of a file.
pub const SIZE: usize = 16 << 20;
/// Values of a file: scalars, maps and lists.
pub const VALUES: usize = 1_000_000;
/// Levels of maps and lists.
pub const DEPTH: usize = 64;
/// Characters of a text.
pub const TEXT: usize = 4096;
/// Characters of a key. Each place below it repeats it.
pub const KEY: usize = 256;
/// Problems of a file that are looked for.
pub const PROBLEMS: usize = 1000;
/// Problems of a file that are told.
pub const TOLD: usize = 100;
/// Bytes of text that the rows of a model have when copies are written out.
pub const EXPANDED: usize = 64 << 20;

/// Lines of a bench, drives of a line, rules of a line.
pub const LINES: usize = 256;
/// A line has no more addresses than that.
pub const DRIVES: usize = 247;
/// Ports of a line.
pub const PORTS: usize = 16;
/// Fault rules of a line.
pub const FAULTS: usize = 256;
/// Steps of a scenario.
pub const STEPS: usize = 10_000;
/// Orders of a step, and conditions.
pub const OF_A_STEP: usize = 100;
/// Choices of all options of a model together: each is checked with all the rest.
pub const CHOICES: usize = 100;

/// More of `what` than may be, if `count` is more than `most`.
pub fn count(what: &str, count: usize, most: usize, path: &Path) -> Option<Problem> {
    let told = || format!("at most {most} {what} are allowed here, not {count}");
    (count > most).then(|| Problem::value(path.clone(), told()))
}

/// Copies of rows that have too much text together.
pub fn expanded() -> String {
    length("the total text of all copies", EXPANDED, "bytes")
}

/// A text, a key or a file that is too long.
pub fn length(what: &str, most: usize, unit: &str) -> String {
    format!("{what} may have at most {most} {unit}")
}
