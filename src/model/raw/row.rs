//! Rows of the file: one register, a repeated group, an area.

use serde::Deserialize;
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// One register (16 bits) or one register pair (32 bits): a row of the manual's table.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawRow {
    /// PDU address; of a pair the lower one. In a repeat: of the first of them.
    pub at: u16,
    /// Width and sign; default `u16`.
    #[serde(default, rename = "type")]
    pub kind: RawType,
    /// Values that a write may carry: `[low, high]`, or a list of such pairs. Default: those of `values`,
    /// and without such a list all of the type.
    pub range: Option<RawRange>,
    /// Value as it leaves the factory; default 0.
    #[serde(default)]
    pub init: i64,
    /// Unit of the value (`rpm`, `0.1 rpm`, `ms`, `s`, `counts`, `%` ...).
    pub unit: Option<String>,
    /// What a master may do: `r`, `w` or `rw` (the default).
    #[serde(default)]
    pub access: RawAccess,
    /// When a new value takes effect, as printed. Left out where nothing is printed: then at once, but for the
    /// settings of motions, of which `settings_taken` tells.
    pub applies: Option<RawApplies>,
    /// While this holds, a write is refused with cause `state`.
    pub lock: Option<RawLock>,
    /// Never kept over power-off, whatever the window or a save command says.
    #[serde(default)]
    pub volatile: bool,
    /// Each write is kept over power-off, without a window or a command that saves.
    #[serde(default)]
    pub autosave: bool,
    /// The drive sets it back to 0 by itself once it has acted on a write; never kept over power-off either.
    #[serde(default)]
    pub clears: bool,
    /// Word order of this pair, where it does not follow the line's.
    pub word_order: Option<RawOrder>,
    /// English name.
    pub name: String,
    /// Name as printed in the manual.
    pub zh: Option<String>,
    /// Section of the manual.
    pub see: String,
    /// What single values mean. Without a `range` a write may carry no other.
    #[serde(default)]
    pub values: BTreeMap<i64, String>,
    /// What single bits mean, from bit 0.
    #[serde(default)]
    pub bits: BTreeMap<u8, String>,
    /// Hex digits, from the right, from 0, that ask for something which is not simulated while they are not 0; the log
    /// says so with these words.
    #[serde(default)]
    pub not_simulated: BTreeMap<u8, String>,
    /// A remark for the reader.
    pub note: Option<String>,
    /// The manual is silent on something said here: what was assumed, and why.
    pub assumed: Option<String>,
    /// `none`: the row is stored and read back, and nothing else happens.
    pub sim: Option<RawSim>,
}

/// Width and sign of a row.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawType {
    /// One word, 0..65535.
    #[default]
    U16,
    /// One word, two's complement.
    I16,
    /// Two words, 0..4294967295.
    U32,
    /// Two words, two's complement.
    I32,
}

/// One span of values, or several.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawRange {
    /// `[low, high]`, both included.
    #[serde(rename = "a list of numbers [low, high]")]
    One([i64; 2]),
    /// `[[low, high], ...]`.
    #[serde(rename = "a list of lists")]
    Many(Vec<[i64; 2]>),
}

/// What a master may do with a row.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawAccess {
    /// Read only.
    R,
    /// Write only; what a read gives is `line.write_only_reads`.
    W,
    /// Read and write.
    #[default]
    Rw,
}

/// When a written value takes effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawApplies {
    /// Immediately.
    Now,
    /// At standstill.
    AtStop,
    /// At the next power-on.
    PowerOn,
}

/// A state of the drive that locks a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawLock {
    /// Power stage on.
    Enabled,
}

/// The only thing `sim` can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawSim {
    /// Stored and read back, without any other effect.
    None,
}

/// Which word of a pair stands at the lower address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawOrder {
    /// High word first.
    HighWordFirst,
    /// Low word first.
    LowWordFirst,
}

/// A group of rows that repeats at a fixed stride.
///
/// In keys and texts of the rows, `{n}` is the number of the copy and `{n:02}` the same with leading zeros. `at` is
/// the address of the first copy.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawRowRepeat {
    /// First and last number of a copy.
    pub n: [u16; 2],
    /// Distance from one copy to the next, in addresses.
    pub stride: u16,
    /// The rows of one copy.
    pub registers: BTreeMap<String, RawRow>,
}

/// 16-bit rows for all addresses of a range that no other row uses.
///
/// In `id` and the row's texts `{n}` stands for the address in decimal, `{n:03}` for the same with
/// leading zeros, `{n:04X}` for the address in hex.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawFill {
    /// First and last address.
    pub span: [u16; 2],
    /// Key of each row, with `{n}`.
    pub id: String,
    /// What a master may do with them: `r`, `w` or `rw` (the default).
    #[serde(default)]
    pub access: RawAccess,
    /// English name, with `{n}`.
    pub name: String,
    /// Name as printed in the manual.
    pub zh: Option<String>,
    /// Section of the manual.
    pub see: String,
    /// What was assumed, and why.
    pub assumed: Option<String>,
}
