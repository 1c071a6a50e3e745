//! The flags, as close to the command line as possible.

use clap::{Args as ClapArgs, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// An emulator for Modbus motor drives.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true, max_term_width = 100)]
pub struct Args {
    #[command(subcommand)]
    pub command: CliCommand,
}

#[derive(Debug, Subcommand)]
pub enum CliCommand {
    /// Emulate drives
    Run(Box<RunArgs>),
    /// List the built-in models, their products and options
    Models,
    /// Print the register map of a model, or one register in detail
    Show(ShowArgs),
    /// Check model, bench and scenario files; report every mistake with line and caret
    Check(CheckArgs),
    /// Print the JSON Schema of a file format, for use in editors
    Schema(SchemaArgs),
}

#[derive(Debug, ClapArgs)]
pub struct RunArgs {
    /// A model, a product name, a model file, or a bench file
    #[arg(value_name = "MODEL | BENCH.yaml")]
    pub target: Option<String>,
    /// Unit address (default: the model's)
    #[arg(short = 'a', long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=247))]
    pub unit: Option<u8>,
    /// Setting of the DIP switches as a number, SW1 being bit 0: unit address, and baud rate where the drive has
    /// switches for it
    #[arg(long, value_name = "N")]
    pub switches: Option<u8>,
    /// A pseudo-terminal (the default); LINK is a symlink to it for the duration of the run
    #[arg(long, value_name = "LINK", num_args = 0..=1, group = "port")]
    pub pty: Option<Option<PathBuf>>,
    /// A real serial port
    #[arg(long, value_name = "DEVICE", group = "port")]
    pub serial: Option<String>,
    /// Modbus TCP [default ADDR: 127.0.0.1:5020]; port 0 picks a free one. At most 64 clients at once:
    /// a further one disconnects the longest idle one
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = "127.0.0.1:5020", group = "port")]
    pub tcp: Option<String>,
    /// RTU or ASCII frames over TCP; same client limit as --tcp
    #[arg(long, value_name = "ADDR", group = "port")]
    pub rtu_over_tcp: Option<String>,
    /// ASCII framing instead of RTU
    #[arg(long)]
    pub ascii: bool,
    /// Baud rate (default: from the parameters of the model)
    #[arg(short = 'b', long, value_name = "N")]
    pub baud: Option<u32>,
    /// Data bits, 7 or 8 (default: from the parameters of the model)
    #[arg(short = 'd', long, value_name = "7|8", value_parser = clap::value_parser!(u8).range(7..=8))]
    pub data_bits: Option<u8>,
    /// Parity (default: from the parameters of the model)
    #[arg(short = 'P', long, value_name = "none|even|odd", hide_possible_values = true)]
    pub parity: Option<ParityArg>,
    /// Stop bits, 1 or 2 (default: from the parameters of the model)
    #[arg(short = 's', long, value_name = "1|2", value_parser = clap::value_parser!(u8).range(1..=2))]
    pub stop_bits: Option<u8>,
    /// A model option (crc_error=silent) or the initial value of a register (accel_time=200); repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Keep the non-volatile memory of the drives in FILE between runs; --set takes precedence
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// A fault rule, applied to every line of a bench: KIND, or KIND:KEY=VALUE,... such as
    /// lose_reply:every=10 (see docs/faults.md); repeatable
    #[arg(long, value_name = "SPEC")]
    pub fault: Vec<String>,
    /// A timeline of faults, orders and expectations (see docs/scenarios.md); exit code 1 if an
    /// expectation is not met
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Write the results of the scenario steps as JUnit XML, atomically at the end of the run
    #[arg(long, value_name = "FILE", requires = "scenario")]
    pub junit: Option<PathBuf>,
    /// Seed for all random draws, printed on stderr and in the ready file (default: random)
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Emulated seconds per second of real time
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    pub rate: f64,
    /// Pseudo-terminal only: pass no bytes while the master's port is set to another baud rate than
    /// the line, as on a real line
    #[arg(long)]
    pub match_baud: bool,
    /// Reply timing: immediate, or according to character times and the reply delay of the drive
    #[arg(long, value_name = "ideal|line", hide_possible_values = true, default_value = "ideal")]
    pub pacing: PacingArg,
    /// Write a JSON object with ports and units, atomically when every port is open; removed at
    /// the end of the run
    #[arg(long, value_name = "FILE")]
    pub ready_file: Option<PathBuf>,
    /// Format of the event log on stdout, one line per event
    #[arg(long, value_name = "text|json", hide_possible_values = true, default_value = "text")]
    pub format: LogFormatArg,
    /// Also write the event log to FILE, as JSON lines
    #[arg(long, value_name = "FILE")]
    pub log_file: Option<PathBuf>,
    /// Only warnings and errors on stderr
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ParityArg {
    None,
    Even,
    Odd,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PacingArg {
    Ideal,
    Line,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormatArg {
    Text,
    Json,
}

#[derive(Debug, ClapArgs)]
pub struct ShowArgs {
    /// A model, a product name, or a model file
    pub model: String,
    /// One register, by name or address (0x1234, 1234H, 4660)
    #[arg(value_name = "ROW|ADDR")]
    pub row: Option<String>,
    /// Output format
    #[arg(long, default_value = "table")]
    pub format: TableFormat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TableFormat {
    Table,
    Markdown,
    Json,
}

#[derive(Debug, ClapArgs)]
pub struct CheckArgs {
    /// Model, bench and scenario files
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
}

#[derive(Debug, ClapArgs)]
pub struct SchemaArgs {
    /// File format
    pub format: SchemaFormat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SchemaFormat {
    Model,
    Bench,
    Scenario,
    /// The lines of `run --format json` and `--log-file`
    Log,
}
