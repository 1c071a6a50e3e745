//! The log for reading over a coffee: one line an event.

use super::{no_effect, rows, why};
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::{Change, DeviceFault, Event, Outcome, Replanned, Transaction, What};
use crate::serial::Mode;
use crate::text::one_line;
use crate::vocabulary::{Named, Then};
use crate::wire::hex::to_hex;

/// Rows of one transaction that are told; the rest is counted.
const ROWS_TOLD: usize = 6;

/// `0.532 unit 1 write C03.04 jog speed = 7000: refused, range 0..6000 -> exception 03`. One line, whatever names of
/// drives, rows and steps hold.
pub fn line(event: &Event, bus: &Bus) -> String {
    let line = format!("{} {}", event.at, what(&event.what, bus));
    one_line(&line).into_owned()
}

fn what(what: &What, bus: &Bus) -> String {
    match what {
        What::Transaction(it) => transaction(bus.drive(it.drive), it),
        What::Broadcast { drive, unit, request, refusal } => {
            let drive = bus.drive(*drive);
            let tell = if refusal.is_some() { rows::refused_text } else { rows::text as Tell };
            let asked = asked(drive, request, tell);
            match refusal {
                None => format!("broadcast to unit {unit}: {asked}"),
                Some(refusal) => {
                    let why = why::refusal(drive, refusal);
                    format!("broadcast to unit {unit}: {asked}: refused, {why} -> no reply")
                }
            }
        }
        What::BroadcastRead { request } => {
            format!("broadcast {} -> no reply: reads cannot be broadcast", to_hex(request))
        }
        What::Foreign { unit, pdu, answer } => {
            let kind = if *answer { "reply from" } else { "request to" };
            let end = match answer {
                true => String::new(),
                false => format!(" -> no reply: {}", who_is_here(*unit, bus)),
            };
            format!("foreign {kind} unit {unit}: {}{end}", to_hex(pdu))
        }
        What::BadCrc { frame, crc, answered } => {
            let [got, want] = [crc.got, crc.want].map(|crc| to_hex(&crc.to_le_bytes()));
            let end = match answered {
                Some((_, code)) => format!("exception {code:02X}"),
                None => "no reply".into(),
            };
            format!("bad CRC {got}, expected {want}: {} -> {end}", to_hex(frame))
        }
        What::BadAscii { characters, why } => {
            let characters = String::from_utf8_lossy(characters).escape_debug().to_string();
            format!("bad ASCII frame `:{characters}`, {} -> no reply", why::ascii(*why))
        }
        What::Noise { head, len, why } => {
            let more = if *len > head.len() { " ..." } else { "" };
            format!("noise, {}: {}{more} -> no reply", why::noise(*why, *len), to_hex(head))
        }
        What::Moved(mode) => format!("line settings changed to {mode}"),
        What::Port { port, understood } => {
            let (baud, stop_bits, why) = (port.baud, port.stop_bits, why::port(*port, *understood));
            let bits = if stop_bits == 1 { "bit" } else { "bits" };
            format!(
                "master port set to {baud} baud, {stop_bits} stop {bits}; line set to {}: {why}",
                port.line
            )
        }
        What::Lost(why) => format!("stream closed: {}", why::header(*why)),
        What::Fault(hit) => hit.to_string(),
        What::Step(id) => {
            let remark = bus.remark(*id);
            match remark.outcome {
                Outcome::Begins => format!("step {}", remark.step),
                Outcome::Passed => format!("step {} passed", remark.step),
                Outcome::Failed => format!("step {} failed: {}", remark.step, remark.what),
            }
        }
        What::RepeatedCommand { unit, action, count, .. } => {
            let name = action.name();
            format!("unit {unit} {name} repeated; the first reply never arrived (#{count})")
        }
        What::Drive { drive, unit, change } => {
            format!("unit {unit} {}", change_text(bus.drive(*drive), bus.mode(), change))
        }
    }
}

fn transaction(drive: &Drive, it: &Transaction) -> String {
    let unit = it.unit;
    if let Some(refusal) = &it.refusal {
        let (asked, why) =
            (asked(drive, &it.request, rows::refused_text), why::refusal(drive, refusal));
        return format!("unit {unit} {asked}: refused, {why} -> exception {:02X}", refusal.code);
    }
    match rows::request(drive, &it.request) {
        rows::DecodedRequest::Read(span) => {
            let items = rows::answer(drive, span, &it.answer);
            format!("unit {unit} read {}", list(drive, &items, rows::text))
        }
        _ => format!("unit {unit} {}", asked(drive, &it.request, rows::text)),
    }
}

/// How a row and its value are told.
type Tell = fn(&Drive, rows::Item) -> String;

/// What a request asks for, without an answer.
fn asked(drive: &Drive, request: &[u8], tell: Tell) -> String {
    match rows::request(drive, request) {
        rows::DecodedRequest::Read(span) => match span.count() {
            1 => format!("read 0x{:04X}", span.start()),
            count => format!("read 0x{:04X} x {count}", span.start()),
        },
        rows::DecodedRequest::Write(_, items) => format!("write {}", list(drive, &items, tell)),
        rows::DecodedRequest::Other => {
            format!("function {}", to_hex(request))
        }
    }
}

fn list(drive: &Drive, items: &[rows::Item], tell: Tell) -> String {
    let told = items.iter().take(ROWS_TOLD).map(|item| tell(drive, *item));
    let told = told.collect::<Vec<_>>().join(", ");
    match items.len().checked_sub(ROWS_TOLD) {
        None | Some(0) => told,
        Some(more) => format!("{told}, and {more} more"),
    }
}

/// Why nobody answers a request to `unit`.
fn who_is_here(unit: u8, bus: &Bus) -> String {
    if let Some((_, deaf)) = bus.drives().find(|(_, drive)| drive.unit() == unit) {
        return match deaf.mode() {
            _ if !deaf.is_powered() => "the drive has no power".into(),
            Some(mode) => format!("the drive is set to {mode}"),
            None => "the drive is set to an undefined baud or format code".into(),
        };
    }
    let mut units: Vec<u8> = bus.drives().map(|(_, drive)| drive.unit()).collect();
    units.sort_unstable();
    let units: Vec<_> = units.iter().map(u8::to_string).collect();
    match units.as_slice() {
        [only] => format!("the only unit on this line is {only}"),
        _ => format!("the units on this line are {}", units.join(", ")),
    }
}

fn change_text(drive: &Drive, line: Option<Mode>, change: &Change) -> String {
    match change {
        Change::PoweredOn => "power on".into(),
        Change::PoweredOff => "power off".into(),
        Change::Ready => "ready".into(),
        Change::Enabled(true) => "servo on".into(),
        Change::Enabled(false) => "servo off".into(),
        Change::Alarm { cause, code } => format!("alarm {code}: {}", cause.about()),
        Change::AlarmCleared => "alarm cleared".into(),
        Change::AlarmHistoryCleared => "alarm history cleared".into(),
        Change::WordExpired { word, hold, held_ms } => {
            let map = &drive.model().map;
            let held = f64::from(*held_ms) / 1000.0;
            let (word, hold) = (rows::label(map.row(*word)), &map.row(*hold).id);
            format!("{word} reset to 0: not refreshed for {held} s ({hold})")
        }
        Change::PositionCleared => "position set to 0".into(),
        Change::TurnsCleared => "encoder turns set to 0".into(),
        Change::Stored => "all parameters stored".into(),
        Change::Wear { row, writes, within } => {
            let row = row.map(|row| rows::label(drive.model().map.row(row)));
            let row = row.unwrap_or_else(|| "all parameters".into());
            let within = within.map(|within| format!(" within {} s", within.as_secs()));
            let within = within.unwrap_or_default();
            format!("excessive EEPROM writes: {row} stored {writes} times{within}")
        }
        Change::FactoryRestored => "factory defaults restored".into(),
        Change::Unit { from, to } => {
            format!("unit address changed from {from} to {to}")
        }
        Change::Mode { to: Some(to), .. } => match line {
            Some(line) if line != *to => {
                format!("serial settings changed to {to}; unreachable: the line is set to {line}")
            }
            _ => format!("serial settings changed to {to}"),
        },
        Change::Mode { to: None, .. } => "unreachable: undefined baud or format code".into(),
        Change::Moves { to } => format!("moving to {to}"),
        Change::Runs { mrpm } => format!("running at {} rpm", rpm(*mrpm)),
        Change::Jogs { mrpm } => format!("jogging at {} rpm", rpm(*mrpm)),
        Change::PositionSegment { number, to } => {
            format!("position segment {number}: moving to {to}")
        }
        Change::VelocitySegment { number, mrpm } => {
            format!("velocity segment {number}: running at {} rpm", rpm(*mrpm))
        }
        Change::ChainStep { from, to, why } => {
            format!("segment {from} chained to segment {to}: {}", why::chain_step(*why))
        }
        Change::ChainEnded { at, why } => {
            format!("chain ended at segment {at}: {}", no_effect::reason(drive, *why))
        }
        Change::Replans(what) => replanned(what),
        Change::Pauses => "pausing".into(),
        Change::Resumes { to } => format!("resumed: moving to {to}"),
        Change::DeviationCleared { counts } => {
            format!("position deviation cleared: {counts} counts")
        }
        Change::Stops => "stopping".into(),
        Change::Coasts => "coasting: servo off".into(),
        Change::Stands { at } => format!("stopped at {at}"),
        Change::Limit { forward, soft } => {
            let kind = if *soft { "soft limit" } else { "limit switch" };
            format!("{} {kind} reached", side(*forward))
        }
        Change::Hits { at } => format!("hard stop hit at {at}"),
        Change::Deviates => "position deviation above threshold".into(),
        Change::Homes { method } => format!("homing method {method} started"),
        Change::Seeks { method, step, mrpm } => {
            let (until, rpm) = (why::until(step.until), rpm(*mrpm));
            format!("homing method {method}: moving at {rpm} rpm until {until}")
        }
        Change::Finds { method, step, at } => {
            let until = why::until(step.until);
            let then = match step.then {
                Then::Ramp => "decelerating",
                Then::Keep => "continuing",
                Then::Origin => "taken as origin",
            };
            format!("homing method {method}: {until} at {at}, {then}")
        }
        Change::FindsLimit { method, forward, turns, at } => {
            let then = if *turns { "reversing" } else { "waiting for the time limit" };
            format!("homing method {method}: {} limit at {at}, {then}", side(*forward))
        }
        Change::Refines { method, forward } => {
            let way = if *forward { "forward" } else { "backward" };
            format!("homing method {method}: moving {way} to the next index pulse")
        }
        Change::Origin { method, at } => format!("homing method {method}: origin at {at}"),
        Change::Homed { method, position } => {
            format!("homing method {method} complete, position {position}")
        }
        Change::HomingLost { method, why } => {
            format!("homing method {method} aborted: {}", why.about())
        }
        Change::NoEffect { order, why } => no_effect::text(drive, *order, *why),
        Change::DeviceFault { device_fault, on } => device_fault_text(drive, *device_fault, *on),
        Change::Bounces { index, times, every } => {
            let (name, every) = (rows::terminal(drive, *index), every.as_secs_f64() * 1000.0);
            format!("terminal {name} bouncing {times} times, {every} ms between edges")
        }
        Change::Terminal { index, signal } => {
            format!("terminal {} {}", rows::terminal(drive, *index), on_off(*signal))
        }
    }
}

fn device_fault_text(drive: &Drive, device_fault: DeviceFault, on: bool) -> String {
    let fault = match device_fault {
        DeviceFault::Cause(cause) => cause.about().into(),
        DeviceFault::Blocked => "axis blocked".into(),
        DeviceFault::EncoderLost => "encoder lost".into(),
        DeviceFault::Frozen => "position feedback frozen".into(),
        DeviceFault::Stuck(index) => format!("terminal {} stuck", rows::terminal(drive, index)),
    };
    format!("device fault {}: {fault}", on_off(on))
}

/// What has become different about a motion under way.
fn replanned(what: &Replanned) -> String {
    let slope = |it: &Option<i64>| match it {
        Some(mrpm_per_s) => format!("changed to {} rpm/s", rpm(*mrpm_per_s)),
        None => "without a ramp".into(),
    };
    match what {
        Replanned::Target { to } => format!("target changed to {to}"),
        Replanned::Speed { mrpm } => format!("speed changed to {} rpm", rpm(*mrpm)),
        Replanned::SlowSpeed { mrpm } => format!("slow speed changed to {} rpm", rpm(*mrpm)),
        Replanned::StartSpeed { mrpm } => format!("start speed changed to {} rpm", rpm(*mrpm)),
        Replanned::Acceleration { mrpm_per_s } => format!("acceleration {}", slope(mrpm_per_s)),
        Replanned::Deceleration { mrpm_per_s } => format!("deceleration {}", slope(mrpm_per_s)),
        Replanned::HomeOffset { by } => format!("home offset changed to {by}"),
        Replanned::TimeLimit { time: Some(time) } => {
            format!("homing time limit changed to {} s", time.as_secs_f64())
        }
        Replanned::TimeLimit { time: None } => "homing time limit removed".into(),
    }
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

fn side(forward: bool) -> &'static str {
    if forward { "positive" } else { "negative" }
}

/// Thousandths of a revolution a minute in revolutions a minute.
pub(super) fn rpm(mrpm: i64) -> f64 {
    mrpm as f64 / 1000.0
}
