//! Words on stdout and stderr. A reader that went away (`| head`) is no failure.

use drivemu::text::lines;
use std::io::{Write, stderr, stdout};

/// Prints to stdout.
pub fn print(text: &str) {
    let _ = stdout().write_all(lines(text).as_bytes()).and_then(|()| stdout().flush());
}

/// Says what went wrong, on stderr.
pub fn complain(text: &str) {
    let end = if text.ends_with('\n') { "" } else { "\n" };
    let _ = write!(stderr(), "{}{end}", lines(text));
}
