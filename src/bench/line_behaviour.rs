//! LineBehaviour of a line as a bench says them: whether they can be, and whether somebody would notice.

use super::Device;
use super::raw::{RawBenchLine, RawChatter, RawPacing};
use crate::medium::{Chatter, LineBehaviour, Pacing};
use crate::model::duration;
use crate::problem::{Path, Problem};
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
