//! The ready file: one JSON object, there whole or not at all.

use serde::Serialize;

/// What the ready file says.
#[derive(Debug, Clone, Serialize)]
pub struct Ready {
    /// The seed of the run.
    pub seed: u64,
    /// Where masters reach the drives.
    pub endpoints: Vec<Endpoint>,
}

/// One open port.
#[derive(Debug, Clone, Serialize)]
pub struct Endpoint {
    /// `pty`, `serial`, `tcp` or `rtu-over-tcp`.
    pub kind: &'static str,
    /// Path of the terminal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// The symlink to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Address and port.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub addr: Option<String>,
    /// The line's name.
    pub name: String,
    /// Speed and format: `9600-8N2`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<String>,
    /// `rtu`, `ascii` or `mbap`.
    pub framing: &'static str,
    /// Who answers.
    pub units: Vec<ReadyUnit>,
}

/// One unit address.
#[derive(Debug, Clone, Serialize)]
pub struct ReadyUnit {
    /// The address.
    pub unit: u8,
    /// The model that answers to it.
    pub model: String,
}
