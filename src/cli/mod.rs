//! The command line: flags, what they mean, exit codes.
//!
//! 0: a clean end, also by SIGINT, SIGTERM and SIGHUP. 1: the run failed, a step of its scenario, or an output that could not be written. 2: usage,
//! or an invalid file. 3: a port can't be opened. Machine output goes to stdout, everything else to stderr.

mod args;
mod check;
mod run;
mod show;

use crate::server::{plain, said, say};
use args::{Args, CliCommand};
use clap::Parser;
use std::process::ExitCode;
use crate::text::lines;
use std::io::{ErrorKind, Write, stdout};

/// The run failed.
const FAILED: u8 = 1;
/// Usage, or an invalid file.
const INVALID: u8 = 2;
/// A port can't be opened.
const NO_PORT: u8 = 3;

/// Why a command ends with something else than 0: the code, and what to say.
#[derive(Debug)]
struct CliError {
    code: u8,
    text: String,
}

impl CliError {
    fn invalid(text: impl Into<String>) -> Self {
        Self { code: INVALID, text: text.into() }
    }
}

pub fn main() -> ExitCode {
    let result = match Args::try_parse() {
        Ok(args) => act(args.command),
        Err(error) => usage(&error),
    };
    let code = match result {
        Ok(()) => 0,
        Err(CliError { code, text }) => {
            complain(&text);
            code
        }
    };
    said();
    ExitCode::from(code)
}

fn act(command: CliCommand) -> Result<(), CliError> {
    match command {
        CliCommand::Run(args) => run::run(*args),
        CliCommand::Models => show::models(),
        CliCommand::Show(args) => show::show(&args),
        CliCommand::Check(args) => check::check(&args),
        CliCommand::Schema(args) => check::schema(&args),
    }
}

/// What clap has to say: help and version on stdout, a mistake on stderr.
fn usage(error: &clap::Error) -> Result<(), CliError> {
    let printed = error.print();
    match printed {
        _ if error.use_stderr() => Err(CliError::invalid("")),
        Err(why) if why.kind() != ErrorKind::BrokenPipe => {
            let text = format!("cannot write to stdout: {}", plain(&why));
            Err(CliError { code: FAILED, text })
        }
        _ => Ok(()),
    }
}

/// Prints to stdout. A reader that went away (`| head`) is no failure.
fn print(text: &str) -> Result<(), CliError> {
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
fn complain(text: &str) {
    if text.is_empty() {
        return;
    }
    let end = if text.ends_with('\n') { "" } else { "\n" };
    say(&format!("{}{end}", lines(text)));
}
