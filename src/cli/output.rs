//! Words on stdout and stderr.

use super::{CliError, FAILED};
use crate::server::{plain, say};
use crate::text::lines;
use std::io::{ErrorKind, Write, stdout};

/// Prints to stdout. A reader that went away (`| head`) is no failure.
pub fn print(text: &str) -> Result<(), CliError> {
    let printed = stdout().write_all(lines(text).as_bytes()).and_then(|()| stdout().flush());
    match printed {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError {
            code: FAILED,
            text: format!("cannot write to stdout: {}", plain(&error)),
        }),
        _ => Ok(()),
    }
}

/// Says what went wrong, on stderr. Where that can't be said, nobody is told.
pub fn complain(text: &str) {
    if text.is_empty() {
        return;
    }
    let end = if text.ends_with('\n') { "" } else { "\n" };
    say(&format!("{}{end}", lines(text)));
}
