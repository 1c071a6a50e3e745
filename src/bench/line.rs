//! A line with its drives and fault rules, as it is before anybody switches it on; and how one is put together.

use super::{Device, WireSpec, match_line};
use crate::bus::{Bus, Carrier};
use crate::medium::{
    self, FaultContext, FaultRule, FaultRules, FaultSet, LineBehaviour, Medium, NoRow,
};
use crate::problem::{Problem, suggest};
use crate::serial::Settings;
use crate::time::Instant;
use crate::wire::Span;

/// One line of a bench.
#[derive(Debug, Clone)]
pub struct BenchLine {
    /// Its name in the log.
    pub name: String,
    /// Where masters reach it; one at least.
    pub ports: Vec<PortSpec>,
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

    /// What carries the bytes of its links.
    pub fn carrier(&self) -> Carrier {
        match self {
            Self::Pty(_) | Self::RtuOverTcp(_) => Carrier::Serial,
            Self::Serial(_) => Carrier::Uart,
            Self::Tcp(_) => Carrier::Tcp,
        }
    }

    /// Do both take the same path or address? Of port 0 there are many.
    pub fn is_at_place_of(&self, other: &Self) -> bool {
        let (Some(place), Some(others)) = (self.place(), other.place()) else { return false };
        match self {
            Self::Pty(_) | Self::Serial(_) => spelt(place).eq(spelt(others)),
            Self::Tcp(_) | Self::RtuOverTcp(_) => place == others && !place.ends_with(":0"),
        }
    }

    /// The path or address that it takes, if it asks for one.
    pub fn place(&self) -> Option<&str> {
        match self {
            Self::Pty(link) => link.as_deref(),
            Self::Serial(place) | Self::Tcp(place) | Self::RtuOverTcp(place) => Some(place),
        }
    }
}

impl BenchLine {
    /// Has it a port with speed and format, as all have but Modbus TCP?
    pub fn is_serial(&self) -> bool {
        self.ports.iter().any(|port| !port.is_tcp())
    }

    /// A bus with all drives of this line on it, switched on. On a serial line they hear what is said in
    /// the line's mode; on Modbus TCP there is none. What its fault rules draw depends on `seed`.
    pub fn bus(&self, seed: u64) -> Bus {
        let mut bus = Bus::with_medium(self.medium(seed));
        if self.is_serial() {
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

/// The parts of a path, however it is spelt; `..` stays, since only a file system knows where it leads.
fn spelt(path: &str) -> impl Iterator<Item = std::path::Component<'_>> {
    let parts = std::path::Path::new(path).components();
    parts.filter(|it| *it != std::path::Component::CurDir)
}

/// Puts a line together: on a pseudo-terminal, with the speed and format that its first drive has by itself, without
/// faults and with ideal replies, unless told otherwise.
#[derive(Debug)]
pub struct LineBuilder {
    name: String,
    ports: Vec<PortSpec>,
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
            ports: vec![PortSpec::Pty(None)],
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
        self.ports(vec![port])
    }

    /// Where masters reach it, by each of `ports`.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn ports(self, ports: Vec<PortSpec>) -> Self {
        assert!(!ports.is_empty());
        Self { ports, ..self }
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
        if self.ports.iter().any(|port| !port.is_tcp()) {
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
        let Self { name, ports, devices, line_behaviour, .. } = self;
        BenchLine { name, ports, wire, devices, faults: Vec::new(), line_behaviour }
    }
}

impl FaultContext for BenchLine {
    fn is_tcp(&self) -> bool {
        !self.is_serial()
    }

    fn line_behaviour(&self) -> &LineBehaviour {
        &self.line_behaviour
    }

    /// Where all drives that know the name have the row. One place must be right for all of them: a rule
    /// doesn't ask which drive a request is for.
    fn spans(&self, name: &str) -> Result<Vec<Span>, NoRow> {
        let maps = self.devices.iter().map(|device| &device.model.map);
        let mut places = maps.clone().filter_map(|map| {
            let (id, _) = map.rows().find(|(_, row)| row.id == name)?;
            Some(map.spans(id))
        });
        let Some(first) = places.next() else {
            let ids = maps.flat_map(|map| map.rows().map(|(_, row)| row.id.as_str()));
            let advice = suggest::did_you_mean(name, ids);
            let what = format!("no drive on this line has a register `{name}`");
            return Err(NoRow { what, advice });
        };
        match places.all(|other| other == first) {
            true => Ok(first),
            false => {
                let what = format!("the drives on this line have `{name}` at different addresses");
                Err(NoRow { what, advice: Some("write the address instead".into()) })
            }
        }
    }
}

impl BenchLine {
    /// Reads the compact form of a fault rule (`lose_reply:every=10`) for this line.
    ///
    /// # Errors
    /// Everything that is wrong with it, each with its place in `spec`.
    pub fn fault(&self, spec: &str, taken: &[&str]) -> Result<FaultSet, Vec<Problem>> {
        medium::parse(spec, self, taken)
    }

    /// Puts such a rule behind those that the line has.
    ///
    /// # Errors
    /// As [`fault`](Self::fault).
    pub fn add_fault(&mut self, spec: &str) -> Result<(), Vec<Problem>> {
        let fault_set = self.fault(spec, &self.rule_names())?;
        self.put(fault_set);
        Ok(())
    }

    /// The names of the rules, in order.
    pub(super) fn rule_names(&self) -> Vec<&str> {
        self.faults.iter().map(|rule| rule.name.as_str()).collect()
    }

    /// Puts what was read behind what the line has.
    pub(super) fn put(&mut self, fault_set: FaultSet) {
        self.faults.extend(fault_set.rules);
        self.line_behaviour =
            std::mem::take(&mut self.line_behaviour).and(fault_set.line_behaviour);
    }

    /// What lies between masters and drives, before anything has passed. What its rules draw depends on `seed`.
    pub(super) fn medium(&self, seed: u64) -> Medium {
        let mut rules = FaultRules::new(seed, &self.name);
        for rule in &self.faults {
            // Names are unique once they are read.
            let added = rules.add(rule.clone());
            debug_assert!(added);
        }
        let mut medium = Medium::new(rules);
        medium.set_behaviour(Instant::ZERO, self.line_behaviour.clone());
        medium
    }
}
