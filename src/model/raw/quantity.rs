//! The row of a number, and when a value written to it counts.

use serde::Deserialize;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// The row that holds a number, or a number with its unit where an output goes by it.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawQuantity {
    /// The row, or the number.
    #[serde(rename = "a string (a row)")]
    Register(String),
    /// The row of a setting, and when its values count.
    #[serde(rename = "a map (register, taken)")]
    Setting(RawSetting),
}

/// The row of a setting, and when its values count.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RawSetting {
    /// The row.
    pub register: String,
    /// When a value counts that is written to it: `live`, `at_order` or `at_start`. Default: as the row's
    /// `applies` says (`now` is `live`, `at_stop` is `at_start`), else as `settings_taken`.
    pub taken: Option<String>,
}

impl RawQuantity {
    /// The row, or the number.
    pub fn register(&self) -> &str {
        match self {
            Self::Register(it) => it,
            Self::Setting(it) => &it.register,
        }
    }

    /// When values count, where it says so.
    pub fn taken(&self) -> Option<&str> {
        match self {
            Self::Register(_) => None,
            Self::Setting(it) => it.taken.as_deref(),
        }
    }
}
