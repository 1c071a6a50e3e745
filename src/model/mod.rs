//! A model: what the manual says about one drive, checked and resolved.
//!
//! Three stages, three shapes. [`raw`] mirrors the file. [`load`](fn@load) lays the chosen options over
//! it, expands what is folded and checks every rule, all problems at once. [`Model`] is the result: immutable,
//! shared by all drives of its kind, with nothing left to look up by string at run time. No file system
//! here, and no running state.

pub mod builtin;
mod compile;
mod line;
mod load;
pub mod raw;
mod row;
mod wiring;

pub use crate::vocabulary::RowId;
pub use compile::duration;
pub use line::{LineRules, LongAccess, Refuse, RegisterOrder, UnitRule, WireFormat, WordOrder};
pub use load::{Choices, check, load};
pub use row::{Access, Applies, Layer, Located, Map, Row, RowKind, Window};
pub use wiring::*;

use raw::RawOption;

/// One drive of one vendor, as data.
#[derive(Debug)]
pub struct Model {
    /// The maker.
    pub vendor: String,
    /// The name to ask for it by.
    pub name: String,
    /// One line about it.
    pub about: String,
    /// Product names that it stands for.
    pub products: Vec<String>,
    /// The manual: title and revision.
    pub manual: String,
    /// Its options and what was chosen.
    pub options: Vec<OptionInfo>,
    /// How it talks.
    pub line: LineRules,
    /// Its registers.
    pub map: Map,
    /// The manual's names of its stations, at least one; and start values that differ from the rows'.
    pub stations: Vec<Station>,
    /// Which row, bit and terminal carries what.
    pub wiring: Wiring,
}

/// An option of a model, and what was chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OptionInfo {
    /// Name as in `--set NAME=CHOICE`.
    pub name: String,
    /// What it is about.
    pub about: String,
    /// Why the default is what it is.
    pub why: String,
    /// The choice in force unless told otherwise.
    pub default: String,
    /// The choice in force.
    pub chosen: String,
    /// Names of the choices, the default included.
    pub choices: Vec<String>,
}

impl OptionInfo {
    fn new(name: &str, raw: &RawOption, chosen: &str) -> Self {
        Self {
            name: name.into(),
            about: raw.about.clone(),
            why: raw.why.clone(),
            default: raw.default.clone(),
            chosen: chosen.into(),
            choices: raw.choices.keys().cloned().collect(),
        }
    }
}

/// One station of a device: what answers to one unit address.
#[derive(Debug)]
pub struct Station {
    /// The manual's name of it, empty where a device has only one.
    pub name: String,
    /// Start values that differ from the rows' own.
    pub init: Vec<(RowId, u32)>,
}

impl Model {
    /// The row that a newcomer would read first: where the axis stands, or else any row that may be read.
    pub fn showcase(&self) -> Option<&Row> {
        let position = self.wiring.row_of(crate::vocabulary::Quantity::PositionActual);
        let found = position.map(|id| self.map.row(id));
        found.or_else(|| {
            let mut rows = self.map.rows().map(|(_, row)| row);
            rows.find(|row| row.access != Access::Write)
        })
    }
}
