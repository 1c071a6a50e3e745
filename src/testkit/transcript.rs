//! Conversations as text: what a master says, what the drive answers, what time does in between.
//!
//! ```text
//! model yako-closed-loop unit 1        # more such lines put more drives on the line
//! line 115200 8N1 strict               # optional; `ascii`, `strict`
//! option crc_error silent              # optional, for the model line above
//! set accel_time 200                   # optional, likewise; also `switches 5`, `terminal X0`, `position 5000`
//!
//! > 03 0021 0001                       # unit and checksum are added; `>2 03 ...` asks unit 2
//! < 03 02 00C8                         # without a `<` line the answer must be an echo of the request
//! > 06 0000 0001
//! < 86 06
//! >> 01 03 00 20 00 01 85 C1           # bytes as they are
//! << 01 83 01 80 F0
//! >> ":010302000002F8"                 # characters, CR LF is added
//! << -                                 # silence
//! + 200ms                              # time passes
//! ? alarm off  accel_time 200          # signals, quantities and registers of the drive
//! ! power_cycle                        # also `terminal X0 on`, `raise overload`
//! log refused, range 0..3000           # the log since the last such line says so
//! ```
//!
//! What stands behind `#` is a comment.

mod run;
mod script;

pub use run::run;
pub use script::{Check, Script, Step};

use thiserror::Error;

/// Where and why a transcript failed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {what}")]
pub struct Failure {
    /// Line of the transcript, from 1.
    pub line: usize,
    /// What came instead of what.
    pub what: String,
}
