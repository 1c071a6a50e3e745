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
    /// The seed of the run; `--seed` wins over it. Default: drawn and printed.
    pub seed: Option<u64>,
    /// The lines.
    pub lines: Vec<RawBenchLine>,
}

/// One line. Exactly one of `pty`, `serial`, `tcp` and `rtu_over_tcp` says where masters reach it, or `ports` lists
/// several such ways.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBenchLine {
    /// Its name in the log; default `line-1`, `line-2` ...
    pub name: Option<String>,
    /// A pseudo-terminal of our own: the path of a symlink to it, relative to this file, or `auto` for none.
    pub pty: Option<String>,
    /// A serial device.
    pub serial: Option<String>,
    /// Modbus TCP: address and port to listen on; port 0 picks a free one.
    pub tcp: Option<String>,
    /// Serial frames over TCP: address and port to listen on.
    pub rtu_over_tcp: Option<String>,
    /// Several ports onto the same drives, such as a serial line and a TCP gateway.
    pub ports: Option<Vec<RawPort>>,
    /// Speed and character format, `9600-8N2`; every drive on the line is set to it. Default: what the
    /// first drive's own parameters say.
    pub settings: Option<String>,
    /// ASCII framing instead of RTU. Default: what the first drive's own parameters say.
    pub ascii: Option<bool>,
    /// End RTU frames by silence alone, as the standard says, instead of closing a complete one at once.
    #[serde(default)]
    pub strict: bool,
    /// Only with `pty`: carry nothing while the master's port is set to another baud than the line, as a wire does.
    /// Default: the log tells of it, and all bytes pass.
    #[serde(default)]
    pub match_baud: bool,
    /// When replies leave; default `ideal`.
    #[serde(default)]
    pub pacing: RawPacing,
    /// The latency timer of a USB adapter, `16ms`: it hands over 62 bytes at once, and fewer whenever that
    /// timer ends, which runs freely. Default: there is no adapter.
    pub chunk: Option<String>,
    /// The master hears what it says, as on a 2-wire line whose receiver stays on.
    #[serde(default)]
    pub echo: bool,
    /// Another master and its units talk between our transactions. Default: nobody does.
    pub chatter: Option<RawChatter>,
    /// The drives.
    pub drives: Vec<RawBenchDrive>,
    /// Communication faults: rules. Of all that hold for a request, the first acts.
    #[serde(default)]
    pub faults: Vec<RawFault>,
}

/// One port of several; exactly one of its keys is given.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawPort {
    /// A pseudo-terminal of our own: the path of a symlink to it, relative to this file, or `auto` for none.
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

/// When replies leave.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RawPacing {
    /// As soon as a request is understood.
    #[default]
    Ideal,
    /// No earlier than the silence behind the request, the drive and the reply's characters take.
    Line,
}

/// Another master and its units.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawChatter {
    /// Whom it asks; none of them is a drive of this line.
    pub units: Vec<u8>,
    /// From one conversation to the next, on average; default `50ms`.
    pub every: Option<String>,
}

/// One drive on a line.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawBenchDrive {
    /// A built-in model, a product, or the path of a model file relative to this file.
    pub model: String,
    /// Unit address; of a drive with several stations the first one's. Default: the model's.
    pub unit: Option<u8>,
    /// The model's options, by name.
    #[serde(default)]
    pub options: BTreeMap<String, String>,
    /// Start values, by register: the row's name, or an address.
    #[serde(default, deserialize_with = "by_register")]
    pub set: BTreeMap<String, i64>,
    /// The DIP switches as a number, SW1 being bit 0: those of the address, above them those of the speed where the
    /// drive has such. Those of the speed, all off, are set to the line's.
    pub switches: Option<u8>,
    /// Input terminals that carry a signal from the start.
    #[serde(default)]
    pub terminals: Vec<String>,
    /// The machine on its axis.
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

/// The machine on the axis of a drive. Its positions are in its own coordinate, which homing never shifts.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(default)]
pub struct RawMachine {
    /// Where the axis stands at power-on, in counts; default 0.
    pub start: i32,
    /// What the drive's position register says at power-on, in counts; default 0.
    pub position: i32,
    /// The home switch is active from the first count to before the second; default: there is none.
    pub home: Option<[i32; 2]>,
    /// The negative limit switch is active below this count; default: there is none.
    pub negative_limit: Option<i32>,
    /// The positive limit switch is active from this count on; default: there is none.
    pub positive_limit: Option<i32>,
    /// The axis gets from the first count to the second and no further; default: it has no end.
    pub hard_stop: Option<[i32; 2]>,
    /// Index pulses of the encoder; default: one a revolution, one of them at 0.
    pub index: Option<RawIndex>,
}

/// Index pulses of an encoder.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawIndex {
    /// Counts from one to the next.
    pub every: i32,
    /// The count of one of them; default 0.
    #[serde(default)]
    pub offset: i32,
}

/// JSON Schema of a bench file, for editors.
#[cfg(feature = "cli")]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(RawBench).to_value()
}
