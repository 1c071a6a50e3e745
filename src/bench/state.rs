//! The state file: what the drives of a run keep over power-off, as text that people read and compare.
//!
//! [`StateFile`] writes it, [`Saved`] reads it. Rows go by their ids, so that a file outlives a change of the
//! register map, and only those are in it that somebody has stored or set. Deliberately no file system; where
//! the text lies, and when it is safe there, is the server's. The format: docs/state.md.

mod read;
mod write;

pub use read::Saved;
pub use write::StateFile;

use crate::model::Station;

/// The format that is written and read here.
const FORMAT: u32 = 1;

/// What a drive is called in the file: its line, which device of the line it is, counted from 1, and which
/// station of a device that has several.
fn name(line: &str, device: usize, station: &Station) -> String {
    match station.name.as_str() {
        "" => format!("{line}/{}", device + 1),
        station => format!("{line}/{}/{station}", device + 1),
    }
}
