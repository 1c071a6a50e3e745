//! A bench file as it is written: the reference of the format.

use crate::medium::raw::RawFault;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;

#[cfg(feature = "cli")]
use schemars::JsonSchema;

/// A bench: lines and the drives on them.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBench {
    /// Seed of the run; `--seed` takes precedence. Default: random, and printed.
    pub seed: Option<u64>,
    /// The lines.
    pub lines: Vec<RawBenchLine>,
}

/// One line. Exactly one of `pty`, `serial`, `tcp` and `rtu_over_tcp` says where masters reach it, or `ports` lists
/// several such ways.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBenchLine {
    /// Name in the log; default `line-1`, `line-2` ...
    pub name: Option<String>,
    /// A new pseudo-terminal: the path of a symlink to it, relative to this file, or `auto` for no symlink.
    pub pty: Option<String>,
    /// A serial device.
    pub serial: Option<String>,
    /// Modbus TCP: address and port to listen on; port 0 picks a free one.
    pub tcp: Option<String>,
    /// Serial frames over TCP: address and port to listen on.
    pub rtu_over_tcp: Option<String>,
    /// Several ports onto the same drives, such as a serial line and a TCP gateway.
    pub ports: Option<Vec<RawPort>>,
    /// Baud rate and character format, `9600-8N2`; all drives on the line are set to it. Default: from the parameters
    /// of the first drive.
    pub settings: Option<String>,
    /// ASCII framing instead of RTU. Default: from the parameters of the first drive.
    pub ascii: Option<bool>,
    /// End RTU frames only by t3.5 of silence, as in the standard, instead of accepting a complete frame immediately.
    #[serde(default)]
    pub strict: bool,
    /// Only with `pty`: pass no bytes while the master's port is set to another baud rate than the line. Default: the
    /// log reports it, and all bytes pass.
    #[serde(default)]
    pub match_baud: bool,
    /// Reply timing; default `ideal`.
    #[serde(default)]
    pub pacing: RawPacing,
    /// Latency timer of a USB adapter, 1 ms to 255 ms: the adapter delivers 62 bytes at once, and fewer whenever its
    /// free-running timer expires. Default: no adapter.
    pub chunk: Option<String>,
    /// Echo: the master receives its own bytes, as on a 2-wire line whose receiver stays enabled.
    #[serde(default)]
    pub echo: bool,
    /// Traffic of another master and its units between our transactions. Default: none.
    pub chatter: Option<RawChatter>,
    /// The drives.
    pub drives: Vec<RawBenchDrive>,
    /// Communication fault rules. Of all that match a request, the first acts.
    #[serde(default)]
    pub faults: Vec<RawFault>,
}

/// One port of several; exactly one of its keys is given.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawPort {
    /// A new pseudo-terminal: the path of a symlink to it, relative to this file, or `auto` for no symlink.
    pub pty: Option<String>,
    /// A serial device.
    pub serial: Option<String>,
    /// Modbus TCP: address and port to listen on; port 0 picks a free one.
    pub tcp: Option<String>,
    /// Serial frames over TCP: address and port to listen on.
    pub rtu_over_tcp: Option<String>,
}

impl RawBenchLine {
    /// The port that its own keys name.
    pub(super) fn port(&self) -> RawPort {
        RawPort {
            pty: self.pty.clone(),
            serial: self.serial.clone(),
            tcp: self.tcp.clone(),
            rtu_over_tcp: self.rtu_over_tcp.clone(),
        }
    }
}

/// Reply timing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawPacing {
    /// Immediately after the request.
    #[default]
    Ideal,
    /// After the end-of-frame silence, the reply delay of the drive and the character times of the reply.
    Line,
}

/// Another master and its units.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawChatter {
    /// Unit addresses of its requests, 1 to 247; none of them may be a drive on this line.
    pub units: Vec<u8>,
    /// Average interval between its transactions, 1 ms to 1 h; default `50ms`.
    pub every: Option<String>,
}

/// One drive on a line.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBenchDrive {
    /// A built-in model, a product name, or the path of a model file relative to this file.
    pub model: String,
    /// Unit address, 1 to 247; for a drive with several stations, that of the first one. Default: from the model.
    pub unit: Option<u8>,
    /// Choices of model options, by name.
    #[serde(default)]
    pub options: BTreeMap<String, String>,
    /// Initial values of registers, by name or address.
    #[serde(default, deserialize_with = "by_register")]
    pub set: BTreeMap<String, i64>,
    /// Setting of the DIP switches as a number, SW1 being bit 0: those of the unit address, then those of the baud
    /// rate where the drive has them. If the latter are all off, they are set to the baud rate of the line.
    pub switches: Option<u8>,
    /// Input terminals that are active from the start.
    #[serde(default)]
    pub terminals: Vec<String>,
    /// Switches and stops along the axis.
    #[serde(default)]
    pub machine: RawMachine,
}

/// An address is a number to YAML, a name is a text: both are keys here.
fn by_register<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<String, i64>, D::Error> {
    #[derive(Deserialize, PartialEq, Eq, PartialOrd, Ord)]
    enum BenchKey {
        #[serde(rename = "a number (an address)")]
        Address(u16),
        #[serde(rename = "a string (a name)")]
        Name(String),
    }
    let values = BTreeMap::<BenchKey, i64>::deserialize(from)?.into_iter();
    let named = |(key, value)| match key {
        BenchKey::Address(address) => (address.to_string(), value),
        BenchKey::Name(name) => (name, value),
    };
    Ok(values.map(named).collect())
}

/// Switches and stops along the axis of a drive, in counts of a fixed coordinate that homing does not shift.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawMachine {
    /// Position of the axis at power-on, in counts; default 0.
    pub start: i32,
    /// Value of the position register at power-on, in counts; default 0.
    pub position: i32,
    /// The home switch is active from the first count up to, but not at, the second; default: no home switch.
    pub home: Option<[i32; 2]>,
    /// The negative limit switch is active below this count; default: no such switch.
    pub negative_limit: Option<i32>,
    /// The positive limit switch is active from this count upwards; default: no such switch.
    pub positive_limit: Option<i32>,
    /// Hard stops: the ends of travel; default: unlimited travel.
    pub hard_stop: Option<[i32; 2]>,
    /// Index pulses of the encoder; default: one per revolution, starting at count 0.
    pub index: Option<RawIndex>,
}

/// Index pulses of an encoder.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawIndex {
    /// Counts between two pulses, at least 1.
    pub every: i32,
    /// Position of one pulse, in counts; default 0.
    #[serde(default)]
    pub offset: i32,
}

/// JSON Schema of a bench file, for editors.
#[cfg(feature = "cli")]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(RawBench).to_value()
}
