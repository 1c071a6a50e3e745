//! A line with its drives, as it is before anybody switches it on; and how one is put together.

use super::{Device, WireSpec, match_line};
use crate::bus::Bus;
use crate::medium::{FaultRule, LineBehaviour, Pacing};
use crate::serial::Settings;

/// One line of a bench.
#[derive(Debug, Clone)]
pub struct BenchLine {
    /// Its name in the log.
    pub name: String,
    /// Where masters reach it.
    pub port: PortSpec,
    /// How the line is set.
    pub wire: WireSpec,
    /// What is on it.
    pub devices: Vec<Device>,
    /// Fault rules, in order.
    pub faults: Vec<FaultRule>,
    /// What the line always does.
    pub line_behaviour: LineBehaviour,
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

impl PortSpec {
    /// Does it carry Modbus TCP, which has neither speed nor format?
    pub fn is_tcp(&self) -> bool {
        matches!(self, Self::Tcp(_))
    }

    /// The key of a bench file that says it.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Pty(_) => "pty",
            Self::Serial(_) => "serial",
            Self::Tcp(_) => "tcp",
            Self::RtuOverTcp(_) => "rtu_over_tcp",
        }
    }

    /// The path or address that it takes, if it asks for one.
    pub fn place(&self) -> Option<&str> {
        match self {
            Self::Pty(link) => link.as_deref(),
            Self::Serial(place) | Self::Tcp(place) | Self::RtuOverTcp(place) => Some(place),
        }
    }

    /// How replies are paced on such a port.
    pub fn pacing(&self) -> Pacing {
        match self {
            Self::Serial(_) => Pacing::Port,
            Self::Pty(_) | Self::Tcp(_) | Self::RtuOverTcp(_) => Pacing::Line,
        }
    }
}

impl BenchLine {
    /// A bus with all drives of this line on it, switched on. On a serial line they hear what is said in
    /// the line's mode; on Modbus TCP there is none. What its fault rules draw depends on `seed`.
    pub fn bus(&self, seed: u64) -> Bus {
        let mut bus = Bus::with_medium(self.medium(seed));
        if !self.port.is_tcp() {
            bus.set_mode(self.wire.mode);
        }
        for (i, device) in self.devices.iter().enumerate() {
            for setup in &device.setups {
                bus.add(device.model.clone(), setup, i as u16);
            }
        }
        bus
    }
}

/// Puts a line together: on a pseudo-terminal, with the speed and format that its first drive has by itself, without
/// faults and with ideal replies, unless told otherwise.
#[derive(Debug)]
pub struct LineBuilder {
    name: String,
    port: PortSpec,
    devices: Vec<Device>,
    settings: Option<Settings>,
    ascii: Option<bool>,
    strict: bool,
    match_baud: bool,
    line_behaviour: LineBehaviour,
}

/// A drive that can't be on the line as that is set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mismatch {
    /// The number of its device, from 0.
    pub device: usize,
    /// Why, as a sentence.
    pub what: String,
}

impl LineBuilder {
    /// A line called `name` with `devices` on it.
    pub fn new(name: impl Into<String>, devices: Vec<Device>) -> Self {
        Self {
            name: name.into(),
            port: PortSpec::Pty(None),
            devices,
            settings: None,
            ascii: None,
            strict: false,
            match_baud: false,
            line_behaviour: LineBehaviour::default(),
        }
    }

    /// Where masters reach it.
    #[must_use]
    pub fn port(self, port: PortSpec) -> Self {
        Self { port, ..self }
    }

    /// Speed and character format; `None` for those of the first drive.
    #[must_use]
    pub fn settings(self, settings: Option<Settings>) -> Self {
        Self { settings, ..self }
    }

    /// ASCII framing or RTU; `None` for that of the first drive.
    #[must_use]
    pub fn ascii(self, ascii: Option<bool>) -> Self {
        Self { ascii, ..self }
    }

    /// RTU frames end by silence only.
    #[must_use]
    pub fn strict(self, strict: bool) -> Self {
        Self { strict, ..self }
    }

    /// A pseudo-terminal carries nothing at another speed than the line's.
    #[must_use]
    pub fn match_baud(self, match_baud: bool) -> Self {
        Self { match_baud, ..self }
    }

    /// What the line always does.
    #[must_use]
    pub fn behaviour(self, line_behaviour: LineBehaviour) -> Self {
        Self { line_behaviour, ..self }
    }

    /// How the line will be set.
    pub fn wire(&self) -> WireSpec {
        let wire = WireSpec::of(&self.devices, self.settings, self.ascii, self.strict);
        WireSpec { match_baud: self.match_baud, ..wire }
    }

    /// The line, each drive on it set to its speed and format; and the drives for which that can't be. Unless
    /// somebody has told the line how to talk, what masters have stored in an earlier run stays. Modbus TCP has neither
    /// speed nor format, so nothing is set there.
    pub fn build(mut self) -> (BenchLine, Vec<Mismatch>) {
        let mode = self.wire().mode;
        let told = self.settings.is_some() || self.ascii.is_some();
        let mut mismatches = Vec::new();
        if !self.port.is_tcp() {
            for (device, it) in self.devices.iter_mut().enumerate() {
                let what = match_line(it, mode, told).err();
                mismatches.extend(what.map(|what| Mismatch { device, what }));
            }
        }
        (self.build_unmatched(), mismatches)
    }

    /// The same line with each drive as its own parameters say, which may be deaf to it.
    pub fn build_unmatched(self) -> BenchLine {
        let wire = self.wire();
        let Self { name, port, devices, line_behaviour, .. } = self;
        BenchLine { name, port, wire, devices, faults: Vec::new(), line_behaviour }
    }
}
