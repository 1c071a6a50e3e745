//! The ports of a line as a bench says them: one by a key of the line, or several in a list.

use super::raw::{RawBenchLine, RawPacing, RawPort};
use super::{BenchLine, PortSpec};
use crate::problem::{Path, Problem, bounds, has_unread, is_unread};

/// What a port is, and where the file says so.
pub(super) type PlacedPort = (PortSpec, Path);

/// The keys of which a port has one.
const KINDS: &str = "pty, serial, tcp, rtu_over_tcp";

/// Reads the ports of the line at `path`, and whether each key of the line has something to act on; what is wrong goes
/// to `problems`. None where that is so much that nobody can tell what they are.
pub(super) fn ports(
    raw: &RawBenchLine,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Vec<PlacedPort> {
    let own = placed(&raw.port(), path);
    let unread = |key: &&str| is_unread(problems, &path.key(key));
    let is_told = ["pty", "serial", "tcp", "rtu_over_tcp", "ports"].iter().any(unread);
    let ports = match (&raw.ports, own.as_slice()) {
        (None, []) if is_told => Vec::new(),
        (None, []) => {
            let problem = Problem::value(path.clone(), "this line has no port");
            problems.push(problem.advise(format!("add one of {KINDS}, or `ports`")));
            Vec::new()
        }
        (None, [_]) => own,
        (None, [_, (_, second), ..]) => {
            let problem = Problem::key(second.clone(), "this is a second port");
            problems.push(problem.advise("list both under `ports`"));
            Vec::new()
        }
        (Some(_), [(port, path), ..]) => {
            let what = format!("`{}` cannot be combined with `ports`", port.key());
            let problem = Problem::key(path.clone(), what);
            problems.push(problem.advise("list all ports under `ports`"));
            Vec::new()
        }
        (Some(list), []) => listed(list, &path.key("ports"), problems),
    };
    if !ports.is_empty() {
        no_effect(raw, &ports, path, problems);
    }
    ports
}

/// Refuses ports of the line that it has above, or that one of the `lines` above has.
pub(super) fn refuse_taken(ports: &[PlacedPort], lines: &[BenchLine], problems: &mut Vec<Problem>) {
    for (i, (port, path)) in ports.iter().enumerate() {
        let other = lines.iter().find(|line| line.ports.iter().any(|it| it.is_at_place_of(port)));
        let what = if let Some(other) = other {
            format!("line `{}` has the same port", other.name)
        } else if ports[..i].iter().any(|(it, _)| it.is_at_place_of(port)) {
            "this line has the same port above".to_owned()
        } else {
            continue;
        };
        problems.push(Problem::value(path.clone(), what));
    }
}

fn listed(list: &[RawPort], path: &Path, problems: &mut Vec<Problem>) -> Vec<PlacedPort> {
    if list.is_empty() {
        problems.push(Problem::value(path.clone(), "a line needs at least one port"));
    }
    if let Some(most) = bounds::count("ports", list.len(), bounds::PORTS, path) {
        problems.push(most);
        return Vec::new();
    }
    let mut ports = Vec::new();
    for (i, raw) in list.iter().enumerate() {
        let path = path.index(i);
        let mut given = placed(raw, &path).into_iter();
        match (given.next(), given.next()) {
            (None, _) if has_unread(problems, &path) => {}
            (None, _) => {
                problems.push(Problem::value(path, format!("a port needs one of {KINDS}")));
            }
            (Some(port), None) => ports.push(port),
            (Some(_), Some((_, second))) => {
                let problem = Problem::key(second, "this is a second port");
                problems.push(problem.advise("make it an item of its own"));
            }
        }
    }
    ports
}

/// The ports that `raw` names, each at the path of its key.
fn placed(raw: &RawPort, path: &Path) -> Vec<PlacedPort> {
    let pty = raw.pty.as_ref().map(|link| PortSpec::Pty((link != "auto").then(|| link.clone())));
    let given = [
        pty,
        raw.serial.clone().map(PortSpec::Serial),
        raw.tcp.clone().map(PortSpec::Tcp),
        raw.rtu_over_tcp.clone().map(PortSpec::RtuOverTcp),
    ];
    let place = |port: PortSpec| {
        let path = path.key(port.key());
        (port, path)
    };
    given.into_iter().flatten().map(place).collect()
}

/// A key that could change nothing on this line is a mistake, not a decoration.
fn no_effect(raw: &RawBenchLine, ports: &[PlacedPort], path: &Path, problems: &mut Vec<Problem>) {
    let given = [
        ("settings", raw.settings.is_some()),
        ("ascii", raw.ascii.is_some()),
        ("strict", raw.strict),
        ("match_baud", raw.match_baud),
        ("pacing", raw.pacing != RawPacing::Ideal),
        ("chunk", raw.chunk.is_some()),
        ("echo", raw.echo),
        ("chatter", raw.chatter.is_some()),
    ];
    let only_tcp = ports.iter().all(|(port, _)| port.is_tcp());
    let has_pty = ports.iter().any(|(port, _)| matches!(port, PortSpec::Pty(_)));
    for (key, _) in given.into_iter().filter(|(_, given)| *given) {
        let why = match raw.ascii {
            _ if only_tcp => "on Modbus TCP",
            _ if key == "match_baud" && !has_pty => "on a port other than a pseudo-terminal",
            Some(true) if key == "strict" => "with ASCII framing",
            _ => continue,
        };
        let what = format!("`{key}` has no effect {why}");
        problems.push(Problem::key(path.key(key), what).advise("remove it"));
    }
}
