//! Conversations as text: what a master says, what the drive answers, what time does in between.
//!
//! ```text
//! model acme-s1.yaml unit 1            # more such lines put more drives on the line
//! line 19200 8N1 strict                # optional; `ascii`, `strict`
//! option crc_error exception           # optional, for the model line above
//! set C003 20                          # optional, likewise; also `switches 5`, `terminal I1`, `machine {home: [50, 60]}`
//! fault lose_reply:count=1,from=30     # optional: a fault rule on the line
//!
//! > 03 1003 0001                       # unit and checksum are added; `>2 03 ...` asks unit 2
//! < 03 02 0014
//! > 06 1003 001E                       # without a `<` line the answer must be an echo of the request
//! > 06 1003 0064
//! < 86 42
//! >> 01 03 10 03 00 01 00 00           # bytes as they are
//! << 01 83 7F 00 D0
//! >> ":0103100300018"                  # characters, CR LF is added
//! << -                                 # silence
//! + 200ms                              # time passes; what comes meanwhile is for a `<` or `<<` line
//! ? alarm off  C003 30                 # signals, quantities and registers of the drive
//! ! power_cycle                        # also `terminal I1 on` and every other line that a scenario can `do`
//! log refused, range 0..50             # the log says so, later than what the last such line found
//! ```
//!
//! What stands behind `#` is a comment.

mod run;
mod script;

pub use run::run;
pub use script::{Check, Script, TranscriptStep};

use thiserror::Error;

/// Where and why a transcript failed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {what}")]
pub struct TranscriptFailure {
    /// Line of the transcript, from 1.
    pub line: usize,
    /// What came instead of what.
    pub what: String,
}
