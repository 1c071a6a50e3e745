//! A scenario file as it is written: the reference of the format.

use serde::Deserialize;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// A scenario: steps that happen one after the other, on each line for itself.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawScenario {
    /// The run ends here, in emulated time (`60s`), and steps that have not come by then have failed. Default: never.
    pub limit: Option<String>,
    /// The steps. Each waits until the one above it on its line is done.
    pub steps: Vec<RawScenarioStep>,
}

/// One step: what it waits for, what it does, and what it expects then. At most one of `at`, `wait`, `after` and
/// `when` says what it waits for; without any it comes right behind the step above.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawScenarioStep {
    /// Its name in the log and in the report.
    pub name: String,
    /// The line that it is about. Default: the first of the bench.
    pub line: Option<String>,
    /// The drive that it is about, by the unit address it has at power-on. Default: the first of the line.
    pub unit: Option<u8>,
    /// Wait for this emulated time since the run began: `5s`, `1500ms`, `2min`.
    pub at: Option<String>,
    /// Wait so long after the step above was done.
    pub wait: Option<String>,
    /// Wait for so many transactions after the step above was done.
    pub after: Option<RawCount>,
    /// Wait until this holds.
    pub when: Option<RawCondition>,
    /// Do it several times.
    pub repeat: Option<RawStepRepeat>,
    /// What is done, in this order: `terminal I1 on`, `hold overload on`, `fault lose_reply:every=10` ...
    #[serde(default, rename = "do")]
    pub orders: Vec<String>,
    /// What has to hold then, all of it at once.
    #[serde(default)]
    pub expect: Vec<RawCondition>,
    /// It may take so long until all of it holds. Default: it must hold at once.
    pub within: Option<String>,
}

/// Transactions: requests that a drive got and answered, refused ones too. Broadcasts are none.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawCount {
    /// How many, 1 or more.
    pub n: u64,
    /// Only reads, or only writes. Default: any.
    #[serde(default)]
    pub kind: RawKind,
    /// Only with this drive. Default: with any of the line.
    pub unit: Option<u8>,
}

/// Which transactions count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawKind {
    /// Reads.
    Read,
    /// Writes.
    Write,
    /// All of them.
    #[default]
    Any,
}

/// Something that holds or does not: a signal, a quantity or a register, and what it has to be.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawCondition {
    /// The drive. Default: that of the step.
    pub unit: Option<u8>,
    /// An output signal.
    pub signal: Option<String>,
    /// A number that the drive computes, in the base unit of its dimension.
    pub quantity: Option<String>,
    /// What a register shows: the row's name, or an address.
    pub register: Option<RawRegister>,
    /// `on` or `off`, or the number that it is.
    pub is: Option<RawLevel>,
    /// It is more than this.
    pub above: Option<i64>,
    /// It is less than this.
    pub below: Option<i64>,
}

/// A register.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawRegister {
    /// By address.
    #[serde(rename = "a number (an address)")]
    Address(u16),
    /// By the row's name.
    #[serde(rename = "a string (a name)")]
    Name(String),
}

/// What something has to be.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawLevel {
    /// A number.
    #[serde(rename = "a number")]
    Number(i64),
    /// `on` or `off`.
    #[serde(rename = "a string (`on` or `off`)")]
    Word(String),
}

/// Several times.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawStepRepeat {
    /// From one time to the next.
    pub every: String,
    /// How many times in all, 2 or more.
    pub times: u32,
}

/// JSON Schema of a scenario file, for editors.
#[cfg(feature = "cli")]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(RawScenario).to_value()
}
