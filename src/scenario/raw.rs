//! A scenario file as it is written: the reference of the format.

use serde::Deserialize;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// A scenario: steps that are executed in order, separately for each line.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawScenario {
    /// Emulated time at which the run ends (`60s`); steps not reached by then have failed. Default: no limit.
    pub limit: Option<String>,
    /// The steps. Each begins when the previous step of its line is done.
    pub steps: Vec<RawScenarioStep>,
}

/// A step: a trigger, orders, and expectations. At most one of `at`, `wait`, `after` and `when` is the trigger;
/// without any, the step follows the previous one immediately.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawScenarioStep {
    /// Name in the log and in the report.
    pub name: String,
    /// The line it applies to. Default: the first line of the bench.
    pub line: Option<String>,
    /// The drive it applies to, by its unit address at power-on. Default: the first drive on the line.
    pub unit: Option<u8>,
    /// Wait until this emulated time since the start of the run: `5s`, `1500ms`, `2min`.
    pub at: Option<String>,
    /// Wait this long after the previous step was done.
    pub wait: Option<String>,
    /// Wait for a number of transactions after the previous step was done.
    pub after: Option<RawCount>,
    /// Wait until this condition is true.
    pub when: Option<RawCondition>,
    /// Repeat the orders.
    pub repeat: Option<RawStepRepeat>,
    /// Orders, executed in this order: `terminal I1 on`, `hold overload on`, `fault lose_reply:every=10` ...
    #[serde(default, rename = "do")]
    pub orders: Vec<String>,
    /// Conditions that must then be true, all at the same time.
    #[serde(default)]
    pub expect: Vec<RawCondition>,
    /// Time allowed until all conditions are true. Default: they must be true immediately.
    pub within: Option<String>,
}

/// Transactions: requests that a drive received and answered or refused. Broadcasts do not count.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawCount {
    /// Number of transactions, at least 1.
    pub n: u64,
    /// Only reads, or only writes. Default: any.
    #[serde(default)]
    pub kind: RawKind,
    /// Only with this drive. Default: any drive on the line.
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

/// A condition: a signal, a quantity or a register, and its expected value.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawCondition {
    /// The drive. Default: that of the step.
    pub unit: Option<u8>,
    /// An output signal, which `is` `on` or `off`.
    pub signal: Option<String>,
    /// A value that the drive computes, in the base unit of its dimension: counts, rpm.
    pub quantity: Option<String>,
    /// The value of a register, by name or address.
    pub register: Option<RawRegister>,
    /// `on` or `off` for a signal, or a number to be equal to.
    pub is: Option<RawLevel>,
    /// Greater than this number.
    pub above: Option<i64>,
    /// Less than this number.
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

/// The expected value.
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
