//! The row of a number, and when a value written to it counts.

use serde::de::Error;
use serde::{Deserialize, Deserializer};
use serde_yaml::Value;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// The row that holds a number, or a number with its unit where an output goes by it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawQuantity {
    /// The row, or the number.
    Register(String),
    /// The row of a setting, and when its values count.
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

/// Told apart by their shape, so that what is wrong with one is not told of the other.
impl<'de> Deserialize<'de> for RawQuantity {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(from)?;
        let read = match value {
            Value::Mapping(_) => RawSetting::deserialize(value).map(Self::Setting),
            _ => String::deserialize(value).map(Self::Register),
        };
        read.map_err(D::Error::custom)
    }
}
