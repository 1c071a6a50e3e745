//! Where masters reach the drives of a run: the ports are opened here, told to programs in the ready file, and to people.

use super::line_server::LineServer;
use super::port::{Listener, Port, TcpPort, TtyPort};
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

/// Opens the ports of `line` for `server`, which serves them. The path of a link is relative to `base`.
///
/// # Errors
/// Why one can't be opened, as a sentence.
pub fn open(line: &BenchLine, server: &mut LineServer, base: &Path) -> io::Result<Vec<Endpoint>> {
    (0..line.ports.len()).map(|i| open_port(line, i, server, base)).collect()
}

fn open_port(
    line: &BenchLine,
    number: usize,
    server: &mut LineServer,
    base: &Path,
) -> io::Result<Endpoint> {
    let (name, settings) = (port_name(line, number), line.wire.mode.settings);
    let mut endpoint = endpoint(line, &line.ports[number], server);
    let spec = &line.ports[number];
    let port: Box<dyn Port> = match spec {
        PortSpec::Pty(link) => {
            let port = TtyPort::pty(name, link.as_ref().map(|link| base.join(link)), settings)?;
            (endpoint.path, endpoint.link) = port.paths();
            Box::new(port)
        }
        PortSpec::Serial(path) => {
            let port = TtyPort::serial(name, path.clone(), settings)?;
            (endpoint.path, endpoint.link) = port.paths();
            Box::new(port)
        }
        PortSpec::Tcp(addr) | PortSpec::RtuOverTcp(addr) => {
            let listener = Listener::bind(addr)?;
            endpoint.addr = Some(listener.local_addr()?.to_string());
            Box::new(TcpPort::new(name, listener))
        }
    };
    server.open(port, spec.carrier());
    Ok(endpoint)
}

/// What diagnostics call port number `number` of `line`: like the line, and where that has several, of which kind it is.
fn port_name(line: &BenchLine, number: usize) -> String {
    let (before, port) = (&line.ports[..number], &line.ports[number]);
    let same = before.iter().filter(|it| it.key() == port.key()).count();
    match (line.ports.len(), same) {
        (1, _) => line.name.clone(),
        (_, 0) => format!("{} {}", line.name, port.key()),
        (_, same) => format!("{} {} {}", line.name, port.key(), same + 1),
    }
}

/// A port of `line` that is not open yet.
fn endpoint(line: &BenchLine, port: &PortSpec, server: &LineServer) -> Endpoint {
    let unit = |drive: &Drive| ReadyUnit { unit: drive.unit(), model: drive.model().name.clone() };
    Endpoint {
        kind: match port {
            PortSpec::Pty(_) => "pty",
            PortSpec::Serial(_) => "serial",
            PortSpec::Tcp(_) => "tcp",
            PortSpec::RtuOverTcp(_) => "rtu-over-tcp",
        },
        path: None,
        link: None,
        addr: None,
        name: line.name.clone(),
        line: (!port.is_tcp()).then(|| line.wire.mode.settings.to_string()),
        framing: match line.wire.mode.ascii {
            _ if port.is_tcp() => "mbap",
            true => "ascii",
            false => "rtu",
        },
        units: server.bus().drives().map(|(_, drive)| unit(drive)).collect(),
    }
}

/// Says who is where, and what a newcomer would type next.
pub fn introduce(line: &BenchLine, endpoints: &[Endpoint]) {
    let ports = || line.ports.iter().zip(endpoints);
    for (port, endpoint) in ports() {
        let units = endpoint.units.iter().map(|it| format!("unit {} {}", it.unit, it.model));
        let units = units.collect::<Vec<_>>().join(", ");
        let settings = match &endpoint.line {
            Some(settings) => format!("{settings} {}", endpoint.framing.to_uppercase()),
            None => "Modbus TCP".into(),
        };
        info!("{}: {units} on {} ({settings})", endpoint.name, place(port, endpoint));
    }
    if !line.line_behaviour.is_empty() {
        info!("{}: {}", line.name, line.line_behaviour);
    }
    let has_parity = line.wire.mode.settings.format.parity != Parity::None;
    for (port, endpoint) in ports().filter(|(it, _)| has_parity && matches!(it, PortSpec::Pty(_))) {
        let place = place(port, endpoint);
        info!("a pseudo-terminal carries no parity bit: open {place} with parity none");
    }
    if let Some(command) = ports().find_map(|(port, endpoint)| suggestion(line, port, endpoint)) {
        info!("try: {command}");
    }
}

/// Where it is: a link as the user wrote it, rather than where that leads.
fn place(port: &PortSpec, endpoint: &Endpoint) -> String {
    let link = match port {
        PortSpec::Pty(Some(link)) => Some(link),
        _ => None,
    };
    let place = link.or(endpoint.path.as_ref()).or(endpoint.addr.as_ref());
    place.cloned().unwrap_or_default()
}

/// An `mbpoll` call that reads something from the first unit; mbpoll speaks no ASCII and no RTU over TCP.
fn suggestion(line: &BenchLine, port: &PortSpec, endpoint: &Endpoint) -> Option<String> {
    let place = place(port, endpoint);
    let device = line.devices.first()?;
    let unit = endpoint.units.iter().find(|it| it.unit != BROADCAST)?.unit;
    let row = device.model.showcase()?;
    let read = format!("-a {unit} -0 -r {} -c {} -1", row.at, row.kind.words());
    let Settings { baud, format } = line.wire.mode.settings;
    match port {
        PortSpec::Pty(_) | PortSpec::Serial(_) if !line.wire.mode.ascii => {
            let parity = match format.parity {
                _ if matches!(port, PortSpec::Pty(_)) => "none",
                Parity::None => "none",
                Parity::Even => "even",
                Parity::Odd => "odd",
            };
            let stop = format.stop_bits;
            let place = quoted(&place);
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
