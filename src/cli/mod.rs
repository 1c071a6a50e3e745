//! The command line: flags, what they mean, exit codes.
//!
//! 0: a clean end, also by SIGINT and SIGTERM. 1: the run failed, or a step of its scenario. 2: usage, or an invalid file. 3: a port can't be
//! opened. Machine output goes to stdout, everything else to stderr.

mod args;
mod check;
mod models;
mod output;
mod run;
mod schema;
mod show;
mod state;

use args::{Args, Command};
use clap::Parser;
use std::process::ExitCode;

/// The run failed.
const FAILED: u8 = 1;
/// Usage, or an invalid file.
const INVALID: u8 = 2;
/// A port can't be opened.
const NO_PORT: u8 = 3;

/// Why a command ends with something else than 0: the code, and what to say.
#[derive(Debug)]
struct Failure {
    code: u8,
    text: String,
}

impl Failure {
    fn invalid(text: impl Into<String>) -> Self {
        Self { code: INVALID, text: text.into() }
    }
}

pub fn main() -> ExitCode {
    let result = match Args::parse().command {
        Command::Run(args) => run::run(*args),
        Command::Models => models::models(),
        Command::Show(args) => show::show(&args),
        Command::Check(args) => check::check(&args),
        Command::Schema(args) => schema::schema(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure { code, text }) => {
            output::complain(&text);
            ExitCode::from(code)
        }
    }
}
