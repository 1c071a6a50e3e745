//! A bench: lines, the drives on each line, what each drive is set to.
//!
//! Built from a YAML file ([`parse`](fn@parse)) or from command-line flags and tests ([`DeviceSpec`]). Pure: it
//! opens nothing. Model files are fetched through a [`Library`], which is the shell's to provide.

mod device;
mod match_line;
mod parse;
pub mod raw;

pub use device::{Device, DeviceSpec, SpecProblem, Wish};
pub use match_line::match_line;
pub use parse::{kind_of, parse};

use crate::bus::Bus;
use crate::line::{Framing, Settings};
use crate::model::builtin::Builtin;
use crate::time::Duration;

/// Where model files come from.
pub trait Library {
    /// File name for messages and text of the model called `name`: a built-in, a product, or a path.
    ///
    /// # Errors
    /// One sentence that says why there is none and what to do.
    fn fetch(&self, name: &str) -> Result<(String, String), String>;
}

/// The embedded models and no files.
#[derive(Debug, Clone, Copy, Default)]
pub struct BuiltinLibrary;

impl Library for BuiltinLibrary {
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        match Builtin::find(name) {
            Some(builtin) => Ok((builtin.file.into(), builtin.text.into())),
            None => Err(no_model(name)),
        }
    }
}

/// What to say about a model that does not exist.
pub fn no_model(name: &str) -> String {
    let names: Vec<_> = Builtin::all().map(|it| it.stem()).collect();
    match crate::problem::suggest::did_you_mean(name, names.iter().copied()) {
        Some(advice) => format!("no model or product `{name}`; {advice}"),
        None => format!("no model or product `{name}`; there are {}", names.join(", ")),
    }
}

/// Lines and their drives.
#[derive(Debug)]
pub struct Bench {
    /// The seed, if the bench fixes one.
    pub seed: Option<u64>,
    /// The lines, in order.
    pub lines: Vec<BenchLine>,
}

/// One line of a bench.
#[derive(Debug)]
pub struct BenchLine {
    /// Its name in the log.
    pub name: String,
    /// Where masters reach it.
    pub port: PortSpec,
    /// How the line is set.
    pub wire: WireSpec,
    /// What is on it.
    pub devices: Vec<Device>,
}

/// Where masters reach a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PortSpec {
    /// A pseudo-terminal of our own, with a symlink to it if a path is given.
    Pty(Option<String>),
    /// A serial device.
    Serial(String),
    /// Modbus TCP.
    Tcp(String),
    /// Serial frames over TCP.
    RtuOverTcp(String),
}

/// How a line is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WireSpec {
    /// Speed and character format.
    pub settings: Settings,
    /// ASCII framing instead of RTU.
    pub ascii: bool,
    /// RTU frames end by silence only.
    pub strict: bool,
    /// Characters of silence that end a frame.
    pub silence: f64,
}

/// Silence that a patient line waits for at least: schedulers and USB adapters stretch a pause inside a
/// frame to 3-16 ms.
pub const PATIENT_GAP: Duration = Duration::from_millis(20);

/// Longest pause inside an ASCII frame (serial line, 2.5.2.1).
const ASCII_GAP: Duration = Duration::from_secs(1);

impl WireSpec {
    /// The framing of a serial line at `rate` emulated seconds per wall second: a patient gap is a
    /// fact of the wall, so it grows with the rate.
    pub fn framing(&self, rate: f64) -> Framing {
        if self.ascii {
            return Framing::Ascii { gap: ASCII_GAP.mul_f64(rate) };
        }
        let silence = self.settings.silence(self.silence);
        match self.strict {
            true => Framing::Rtu { gap: silence, patient: false },
            false => Framing::Rtu { gap: silence.max(PATIENT_GAP).mul_f64(rate), patient: true },
        }
    }
}

impl BenchLine {
    /// A bus with all drives of this line on it, switched on.
    pub fn bus(&self) -> Bus {
        let mut bus = Bus::new();
        for (i, device) in self.devices.iter().enumerate() {
            for setup in &device.setups {
                bus.add(device.model.clone(), setup, i as u16);
            }
        }
        bus
    }
}
