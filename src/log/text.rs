//! The log for reading over a coffee: one line an event.

use super::{no_effect, rows, why};
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::{
    Change, DeviceFault, Event, FaultEffect, Outcome, Replanned, Transaction, What,
};
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
                    format!("broadcast to unit {unit}: {asked}: refused, {why} -> silence")
                }
            }
        }
        What::BroadcastRead { request } => {
            format!("broadcast {}: silence, a read has nobody to answer it", to_hex(request))
        }
        What::Foreign { unit, pdu, answer } => {
            let kind = if *answer { "answer of" } else { "request to" };
            let here =
                if *answer { String::new() } else { format!("; {}", who_is_here(*unit, bus)) };
            format!("foreign {kind} unit {unit}: {}: silence{here}", to_hex(pdu))
        }
        What::BadCrc { frame, crc, answered } => {
            let [got, want] = [crc.got, crc.want].map(|crc| to_hex(&crc.to_le_bytes()));
            let end = match answered {
                Some((_, code)) => format!("exception {code:02X}"),
                None => "silence".into(),
            };
            format!("wrong CRC {got}, should be {want}: {} -> {end}", to_hex(frame))
        }
        What::BadAscii { characters, why } => {
            let characters = String::from_utf8_lossy(characters).escape_debug().to_string();
            format!("bad ASCII frame `:{characters}`, {}: silence", why::ascii(*why))
        }
        What::Noise { head, len, why } => {
            let more = if *len > head.len() { " ..." } else { "" };
            format!("noise, {len} bytes {}: {}{more}: silence", why::noise(*why), to_hex(head))
        }
        What::Moved(mode) => format!("the line is {mode} from now on"),
        What::Port { port, understood } => {
            let (baud, stop_bits, why) = (port.baud, port.stop_bits, why::port(*port, *understood));
            let bits = if stop_bits == 1 { "bit" } else { "bits" };
            format!(
                "the master's port is set to {baud} baud and {stop_bits} stop {bits}, the line to {}: {why}",
                port.line
            )
        }
        What::Lost(why) => format!("stream closed, {}", why::header(*why)),
        What::Fault { rule, unit, effect, hit } => {
            let (name, _) = bus.faults().told(*rule);
            format!("fault {name}: {} (hit {hit})", effect_text(*unit, *effect))
        }
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
            format!(
                "unit {unit} repeated_command: {name} again, whose answer nobody heard (no. {count})"
            )
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
            Some(mode) => format!("the drive listens at {mode}"),
            None => "the drive hears nobody".into(),
        };
    }
    let mut units: Vec<u8> = bus.drives().map(|(_, drive)| drive.unit()).collect();
    units.sort_unstable();
    let units: Vec<_> = units.iter().map(u8::to_string).collect();
    match units.as_slice() {
        [only] => format!("here is unit {only}"),
        _ => format!("here are units {}", units.join(", ")),
    }
}

fn effect_text(unit: u8, effect: FaultEffect) -> String {
    let reply = format!("the reply of unit {unit}");
    match effect {
        FaultEffect::RequestLost => format!("the request to unit {unit} was lost"),
        FaultEffect::ReplyLost => format!("{reply} was lost"),
        FaultEffect::BadChecksum => format!("{reply} left with a wrong checksum"),
        FaultEffect::BitsFlipped(bits) => format!("{bits} bit(s) of {reply} were turned over"),
        FaultEffect::Truncated(bytes) => format!("{bytes} byte(s) of {reply} were cut off"),
        FaultEffect::Extra(bytes) => format!("{bytes} byte(s) followed {reply}"),
        FaultEffect::Garbage(bytes) => format!("{bytes} byte(s) came before {reply}"),
        FaultEffect::Delayed(by) => {
            format!("{reply} leaves {} ms later", by.as_secs_f64() * 1000.0)
        }
        FaultEffect::Late => format!("{reply} waits for the next request"),
        FaultEffect::Duplicated => format!("{reply} left twice"),
        FaultEffect::Split { gap, .. } => {
            format!("{reply} leaves in pieces, {} ms apart", gap.as_millis())
        }
        FaultEffect::WrongUnit(other) => format!("{reply} named unit {other}"),
        FaultEffect::WrongFunction(other) => format!("{reply} named function {other:02X}"),
        FaultEffect::Exception(code) => {
            format!("exception {code:02X} answered for unit {unit}, nothing was executed")
        }
        FaultEffect::Busy => format!("unit {unit} was busy, nothing was executed"),
        FaultEffect::Echoed => format!("the request to unit {unit} came back"),
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
            format!("{word} = 0: not refreshed for {held} s ({hold})")
        }
        Change::PositionCleared => "position set to 0".into(),
        Change::TurnsCleared => "encoder turns set to 0".into(),
        Change::Stored => "all parameters stored".into(),
        Change::Wear { row, writes, within } => {
            let row = row.map(|row| rows::label(drive.model().map.row(row)));
            let row = row.unwrap_or_else(|| "all parameters".into());
            let within = within.map(|within| format!(" within {} s", within.as_secs()));
            let within = within.unwrap_or_default();
            format!("wears out its memory: {row} stored {writes} times{within}")
        }
        Change::FactoryRestored => "all parameters as from the factory".into(),
        Change::Unit { from, to } => {
            format!("answers to unit {to} from now on, no longer to {from}")
        }
        Change::Mode { to: Some(to), .. } => match line {
            Some(line) if line != *to => {
                format!("listens at {to} from now on; the line is {line}, so it is deaf")
            }
            _ => format!("listens at {to} from now on"),
        },
        Change::Mode { to: None, .. } => {
            "hears nobody: its parameters hold codes that stand for no speed or format".into()
        }
        Change::Moves { to } => format!("moves to {to}"),
        Change::Runs { mrpm } => format!("runs at {} rpm", rpm(*mrpm)),
        Change::Jogs { mrpm } => format!("jogs at {} rpm", rpm(*mrpm)),
        Change::PositionSegment { number, to } => format!("position segment {number} to {to}"),
        Change::VelocitySegment { number, mrpm } => {
            format!("velocity segment {number} at {} rpm", rpm(*mrpm))
        }
        Change::ChainStep { from, to, why } => {
            format!("segment {from} goes on with segment {to}: {}", why::chain_step(*why))
        }
        Change::ChainEnded { at, why } => {
            format!("chain ended at segment {at}: {}", no_effect::reason(drive, *why))
        }
        Change::Replans(what) => replanned(what),
        Change::Pauses => "pauses".into(),
        Change::Resumes { to } => format!("goes on to {to}"),
        Change::DeviationCleared { counts } => {
            format!("position deviation cleared: {counts} counts")
        }
        Change::Stops => "stops".into(),
        Change::Coasts => "runs out, the servo is off".into(),
        Change::Stands { at } => format!("stands at {at}"),
        Change::Limit { forward, soft } => {
            let kind = if *soft { "soft limit" } else { "limit switch" };
            format!("stopped by the {} {kind}", side(*forward))
        }
        Change::Hits { at } => format!("runs against a hard stop at {at}"),
        Change::Deviates => "position deviation above its threshold".into(),
        Change::Homes { method } => format!("homing method {method} begins"),
        Change::Seeks { method, step, mrpm } => {
            let (until, rpm) = (why::until(step.until), rpm(*mrpm));
            format!("homing method {method}: at {rpm} rpm until {until}")
        }
        Change::Finds { method, step, at } => {
            let until = why::until(step.until);
            let then = match step.then {
                Then::Ramp => "slowing",
                Then::Keep => "going on",
                Then::Origin => "the origin",
            };
            format!("homing method {method}: {until} at {at}, {then}")
        }
        Change::FindsLimit { method, forward, turns, at } => {
            let then = if *turns { "turning back" } else { "waiting there for the time limit" };
            format!("homing method {method}: {} limit at {at}, {then}", side(*forward))
        }
        Change::Refines { method, forward } => {
            let way = if *forward { "forward" } else { "backward" };
            format!("homing method {method}: {way} to the next index pulse")
        }
        Change::Origin { method, at } => format!("homing method {method}: origin at {at}"),
        Change::Homed { method, position } => {
            format!("homing method {method} done, position {position}")
        }
        Change::HomingLost { method, why } => {
            format!("homing method {method} ended without an origin: {}", why.about())
        }
        Change::NoEffect { order, why } => no_effect::text(drive, *order, *why),
        Change::DeviceFault { device_fault, on } => device_fault_text(drive, *device_fault, *on),
        Change::Bounces { index, times, every } => {
            let (name, every) = (rows::terminal(drive, *index), every.as_secs_f64() * 1000.0);
            format!("terminal {name} bounces {times} times, {every} ms from edge to edge")
        }
        Change::Terminal { index, signal } => {
            format!("terminal {} {}", rows::terminal(drive, *index), on_off(*signal))
        }
    }
}

fn device_fault_text(drive: &Drive, device_fault: DeviceFault, on: bool) -> String {
    match (device_fault, on) {
        (DeviceFault::Cause(cause), true) => format!("suffers from now on: {}", cause.about()),
        (DeviceFault::Cause(cause), false) => format!("suffers no longer: {}", cause.about()),
        (DeviceFault::Blocked, true) => "is blocked where it stands".into(),
        (DeviceFault::Blocked, false) => "is free again".into(),
        (DeviceFault::EncoderLost, true) => "has lost its encoder".into(),
        (DeviceFault::EncoderLost, false) => "has its encoder again".into(),
        (DeviceFault::Frozen, true) => "sees its position frozen".into(),
        (DeviceFault::Frozen, false) => "sees its position again".into(),
        (DeviceFault::Stuck(index), true) => {
            format!("terminal {} sticks", rows::terminal(drive, index))
        }
        (DeviceFault::Stuck(index), false) => {
            format!("terminal {} sticks no longer", rows::terminal(drive, index))
        }
    }
}

/// What has become different about a motion under way.
fn replanned(what: &Replanned) -> String {
    let slope = |it: &Option<i64>| match it {
        Some(mrpm_per_s) => format!("{} rpm/s", rpm(*mrpm_per_s)),
        None => "at once".into(),
    };
    match what {
        Replanned::Target { to } => format!("target now {to}"),
        Replanned::Speed { mrpm } => format!("speed now {} rpm", rpm(*mrpm)),
        Replanned::SlowSpeed { mrpm } => format!("slow speed now {} rpm", rpm(*mrpm)),
        Replanned::StartSpeed { mrpm } => format!("start speed now {} rpm", rpm(*mrpm)),
        Replanned::Acceleration { mrpm_per_s } => format!("acceleration now {}", slope(mrpm_per_s)),
        Replanned::Deceleration { mrpm_per_s } => format!("deceleration now {}", slope(mrpm_per_s)),
        Replanned::HomeOffset { by } => format!("offset from the origin now {by}"),
        Replanned::TimeLimit { time: Some(time) } => {
            format!("homing time limit now {} s", time.as_secs_f64())
        }
        Replanned::TimeLimit { time: None } => "no homing time limit now".into(),
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
