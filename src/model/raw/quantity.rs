//! The row of a quantity, and when a written value takes effect.

use serde::Deserialize;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// The row that holds a value, or for a threshold a number with its unit.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawQuantity {
    /// The row, or the number.
    #[serde(rename = "a string (a row)")]
    Register(String),
    /// The row of a setting, and its effect time.
    #[serde(rename = "a map (register, taken)")]
    Setting(RawSetting),
}

/// The row of a setting, and its effect time.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RawSetting {
    /// The row.
    pub register: String,
    /// Effect time: `live`, `at_order` or `at_start`. Default: from `applies` of the row (`now` is `live`, `at_stop`
    /// is `at_start`), else `settings_taken`.
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
