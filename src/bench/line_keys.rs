//! The keys of a line in a bench file: its ports, its behaviour, and whether each has something to act on.

use super::raw::{RawBenchLine, RawChatter, RawPacing, RawPort};
use super::{BenchLine, Device, PortSpec};
use crate::medium::{Chatter, LineBehaviour, Pacing};
use crate::model::duration;
use crate::problem::{Path, Problem, bounds, has_unread, is_unread};
use crate::time::Duration;
use crate::wire::BROADCAST;

/// The latency timers that adapters have, in milliseconds.
const LATENCIES: std::ops::RangeInclusive<u128> = 1..=255;

/// From one conversation of others to the next, if nobody says.
const EVERY: Duration = Duration::from_millis(50);

/// Others that talk more often leave our master no room, and less often nobody waits for them.
const PAUSES: std::ops::RangeInclusive<Duration> =
    Duration::from_millis(1)..=Duration::from_secs(3600);

/// Reads the line behaviour of the line at `path`; what is wrong with them goes to `problems`.
pub(super) fn line_behaviour(
    raw: &RawBenchLine,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> LineBehaviour {
    let pacing = match raw.pacing {
        RawPacing::Ideal => Pacing::Ideal,
        RawPacing::Line => Pacing::Line,
    };
    let chunk = raw.chunk.as_deref().and_then(|text| {
        let path = path.key("chunk");
        let latency = duration(text, &path, problems)?;
        if !LATENCIES.contains(&latency.as_millis()) {
            let what = format!("`chunk` must be 1 ms to 255 ms, not {latency:?}");
            problems.push(Problem::value(path, what));
        }
        Some(latency)
    });
    let chatter = raw.chatter.as_ref().map(|raw| chatter(raw, &path.key("chatter"), problems));
    LineBehaviour { pacing, chunk, echo: raw.echo, chatter }
}

fn chatter(raw: &RawChatter, path: &Path, problems: &mut Vec<Problem>) -> Chatter {
    let units = path.key("units");
    if raw.units.is_empty() {
        problems.push(Problem::value(units.clone(), "`units` must list at least one unit"));
    }
    for (i, unit) in raw.units.iter().enumerate() {
        if *unit == BROADCAST || *unit > 247 {
            let what = format!("a unit must be 1 to 247, not {unit}");
            problems.push(Problem::value(units.index(i), what));
        }
    }
    let every = raw.every.as_deref();
    let every = every.and_then(|text| duration(text, &path.key("every"), problems));
    let every = every.unwrap_or(EVERY);
    if !PAUSES.contains(&every) {
        let what = format!("`every` must be 1 ms to 1 h, not {every:?}");
        problems.push(Problem::value(path.key("every"), what));
    }
    Chatter { units: raw.units.clone(), every }
}

/// Nobody else answers for a drive that is here.
pub(super) fn strangers(
    line_behaviour: &LineBehaviour,
    devices: &[Device],
    path: &Path,
    problems: &mut Vec<Problem>,
) {
    let Some(chatter) = &line_behaviour.chatter else { return };
    let ours: Vec<u8> = devices.iter().flat_map(Device::units).collect();
    for (i, unit) in chatter.units.iter().enumerate().filter(|(_, unit)| ours.contains(unit)) {
        let path = path.key("chatter").key("units").index(i);
        let what = format!("unit {unit} is a drive on this line");
        problems
            .push(Problem::value(path, what).advise("list units that no drive on this line has"));
    }
}

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
