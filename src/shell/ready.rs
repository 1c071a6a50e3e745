//! The ready file: one JSON object, there whole or not at all.

use super::store::folder;
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

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
    pub units: Vec<Unit>,
}

/// One unit address.
#[derive(Debug, Clone, Serialize)]
pub struct Unit {
    /// The address.
    pub unit: u8,
    /// The model that answers to it.
    pub model: String,
}

/// Writes `ready` to `path`.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, ready: &Ready) -> io::Result<()> {
    let text = serde_json::to_string(ready)?;
    write_whole(path, &format!("{text}\n"))
}

/// Writes `text` to `path`: beside it first, then moved over it, so that nobody reads half of it.
///
/// # Errors
/// What the file system says.
pub fn write_whole(path: &Path, text: &str) -> io::Result<()> {
    let folder = folder(path);
    // As readable as any other file that a program makes.
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o644);
    let mut file = tempfile::Builder::new().permissions(mode).tempfile_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.persist(path).map_err(|failed| failed.error)?;
    Ok(())
}
