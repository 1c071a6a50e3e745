//! Where masters reach the drives of a run: the ports are opened here, told to programs in the ready file, and to people.

use super::line_server::LineServer;
use super::port::{Listener, TcpPort, TtyPort};
use super::ports::PortFrames;
use crate::bench::{BenchLine, PortSpec};
use crate::drive::Drive;
use crate::serial::{Parity, Settings};
use crate::wire::BROADCAST;
use serde::Serialize;
use std::io;
use std::path::Path;
use tracing::info;

/// What the ready file says: one JSON object, there whole or not at all.
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

/// Opens the port of `line` for `server`, which serves it. The path of a link is relative to `base`.
///
/// # Errors
/// Why it can't be opened, as a sentence.
pub fn open(line: &BenchLine, server: &mut LineServer, base: &Path) -> io::Result<Endpoint> {
    let (name, settings) = (server.name().to_owned(), line.wire.mode.settings);
    let unit = |drive: &Drive| ReadyUnit { unit: drive.unit(), model: drive.model().name.clone() };
    let mut endpoint = Endpoint {
        kind: match line.port {
            PortSpec::Pty(_) => "pty",
            PortSpec::Serial(_) => "serial",
            PortSpec::Tcp(_) => "tcp",
            PortSpec::RtuOverTcp(_) => "rtu-over-tcp",
        },
        path: None,
        link: None,
        addr: None,
        name: name.clone(),
        line: Some(settings.to_string()),
        framing: if line.wire.mode.ascii { "ascii" } else { "rtu" },
        units: server.bus().drives().map(|(_, drive)| unit(drive)).collect(),
    };
    match &line.port {
        PortSpec::Pty(link) => {
            let port = TtyPort::pty(name, link.as_ref().map(|link| base.join(link)), settings)?;
            (endpoint.path, endpoint.link) = port.paths();
            server.open(Box::new(port), PortFrames::Serial);
        }
        PortSpec::Serial(path) => {
            let port = TtyPort::serial(name, path.clone(), settings)?;
            (endpoint.path, endpoint.link) = port.paths();
            server.open(Box::new(port), PortFrames::Serial);
        }
        PortSpec::Tcp(addr) => {
            let listener = Listener::bind(addr)?;
            endpoint.addr = Some(listener.local_addr()?.to_string());
            (endpoint.line, endpoint.framing) = (None, "mbap");
            server.open(Box::new(TcpPort::new(name, listener)), PortFrames::Mbap);
        }
        PortSpec::RtuOverTcp(addr) => {
            let listener = Listener::bind(addr)?;
            endpoint.addr = Some(listener.local_addr()?.to_string());
            server.open(Box::new(TcpPort::new(name, listener)), PortFrames::Serial);
        }
    }
    Ok(endpoint)
}

/// Says who is where, and what a newcomer would type next.
pub fn introduce(line: &BenchLine, endpoint: &Endpoint) {
    let units = endpoint.units.iter().map(|it| format!("unit {} {}", it.unit, it.model));
    let units = units.collect::<Vec<_>>().join(", ");
    // The link as the user wrote it, rather than where that leads.
    let link = match &line.port {
        PortSpec::Pty(Some(link)) => Some(link),
        _ => None,
    };
    let place = link.or(endpoint.path.as_ref()).or(endpoint.addr.as_ref());
    let place = place.cloned().unwrap_or_default();
    let settings = match &endpoint.line {
        Some(settings) => format!("{settings} {}", endpoint.framing.to_uppercase()),
        None => "Modbus TCP".into(),
    };
    info!("{}: {units} on {place} ({settings})", endpoint.name);
    if !line.line_behaviour.is_empty() {
        info!("{}: {}", endpoint.name, line.line_behaviour);
    }
    let parity = line.wire.mode.settings.format.parity;
    if matches!(line.port, PortSpec::Pty(_)) && parity != Parity::None {
        info!("a pseudo-terminal carries no parity bit: open {place} with parity none");
    }
    if let Some(command) = suggestion(line, endpoint, &place) {
        info!("try: {command}");
    }
}

/// An `mbpoll` call that reads something from the first unit; mbpoll speaks no ASCII and no RTU over TCP.
fn suggestion(line: &BenchLine, endpoint: &Endpoint, place: &str) -> Option<String> {
    let device = line.devices.first()?;
    let unit = endpoint.units.iter().find(|it| it.unit != BROADCAST)?.unit;
    let row = device.model.showcase()?;
    let read = format!("-a {unit} -0 -r {} -c {} -1", row.at, row.kind.words());
    let Settings { baud, format } = line.wire.mode.settings;
    match &line.port {
        PortSpec::Pty(_) | PortSpec::Serial(_) if !line.wire.mode.ascii => {
            let parity = match format.parity {
                _ if matches!(line.port, PortSpec::Pty(_)) => "none",
                Parity::None => "none",
                Parity::Even => "even",
                Parity::Odd => "odd",
            };
            let stop = format.stop_bits;
            let place = quoted(place);
            Some(format!("mbpoll -m rtu -b {baud} -P {parity} -s {stop} {read} {place}"))
        }
        PortSpec::Tcp(_) => {
            let (host, port) = place.rsplit_once(':')?;
            Some(format!("mbpoll -m tcp -p {port} {read} {host}"))
        }
        _ => None,
    }
}

/// A path as a shell takes it.
fn quoted(path: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:,@%".contains(c);
    match path.chars().all(plain) {
        true => path.to_owned(),
        false => format!("'{}'", path.replace('\'', r"'\''")),
    }
}
