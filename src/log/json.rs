//! The log for programs: one JSON object an event.

use super::rows::{self, Item};
use super::{no_effect, text, why};
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::{Change, DeviceFault, Event, Outcome, Replanned, Transaction, What};
use crate::model::{Located, Row};
use crate::vocabulary::{Named, Refusal};
use crate::wire::Masks;
use crate::wire::hex::to_hex;
use serde_json::{Map, Value, json};

/// One event of the line called `name` as a JSON object.
///
/// Every object has `t` (seconds of the emulated world), `line`, `event` and `text`, the line of the text
/// log without its time. The other keys depend on the event.
pub fn object(event: &Event, name: &str, bus: &Bus) -> Value {
    let mut object = Map::new();
    object.insert("t".into(), json!(event.at.as_nanos() as f64 / 1e9));
    object.insert("line".into(), json!(name));
    let (kind, fields) = fields(&event.what, bus);
    object.insert("event".into(), json!(kind));
    if let Value::Object(fields) = fields {
        object.extend(fields);
    }
    let line = text::line(event, bus);
    let told = line.split_once(' ').map_or("", |(_, told)| told);
    object.insert("text".into(), json!(told));
    Value::Object(object)
}

fn fields(what: &What, bus: &Bus) -> (&'static str, Value) {
    match what {
        What::Transaction(it) => transaction(bus.drive(it.drive), it),
        What::Broadcast { drive, unit, request, refusal } => {
            let drive = bus.drive(*drive);
            let mut fields = json!({"unit": unit, "request": to_hex(request)});
            if let Some(refusal) = refusal {
                merge(&mut fields, refused(drive, refusal));
            }
            ("broadcast", fields)
        }
        What::BroadcastRead { request } => ("broadcast", json!({"request": to_hex(request)})),
        What::Foreign { unit, pdu, answer } => {
            ("foreign", json!({"unit": unit, "pdu": to_hex(pdu), "reply": answer}))
        }
        What::BadCrc { frame, crc, answered } => (
            "bad_crc",
            json!({
                "frame": to_hex(frame),
                "got": to_hex(&crc.got.to_le_bytes()),
                "expected": to_hex(&crc.want.to_le_bytes()),
                "exception": answered.map(|(_, code)| code),
            }),
        ),
        What::BadAscii { characters, why } => {
            let characters = String::from_utf8_lossy(characters);
            ("bad_ascii", json!({"characters": characters, "why": why::ascii(*why)}))
        }
        What::Noise { head, len, why } => {
            ("noise", json!({"bytes": to_hex(head), "length": len, "why": why::noise(*why, *len)}))
        }
        What::Moved(mode) => ("line_settings", json!({"mode": mode.to_string()})),
        What::Port { port, understood } => (
            "port_settings",
            json!({
                "baud": port.baud,
                "stop_bits": port.stop_bits,
                "line": port.line.to_string(),
                "fits": port.fits(),
                "passes": understood,
            }),
        ),
        What::Lost(why) => ("stream_closed", json!({"why": why::header(*why)})),
        What::Fault(hit) => ("fault", json!(hit)),
        What::Step(id) => {
            let remark = bus.remark(*id);
            let outcome = match remark.outcome {
                Outcome::Begins => "started",
                Outcome::Passed => "passed",
                Outcome::Failed => "failed",
            };
            let mut fields = json!({"step": remark.step, "outcome": outcome});
            if !remark.what.is_empty() {
                merge(&mut fields, json!({"why": remark.what}));
            }
            ("step", fields)
        }
        What::RepeatedCommand { unit, action, count, .. } => {
            ("repeated_command", json!({"unit": unit, "action": action.name(), "count": count}))
        }
        What::Drive { drive, unit, change } => change_fields(bus.drive(*drive), *unit, change),
    }
}

fn transaction(drive: &Drive, it: &Transaction) -> (&'static str, Value) {
    let mut fields = json!({
        "unit": it.unit,
        "request": to_hex(&it.request),
        "reply": to_hex(&it.answer),
    });
    let (kind, items) = match rows::request(drive, &it.request) {
        rows::DecodedRequest::Read(span) if it.refusal.is_none() => {
            ("read", rows::answer(drive, span, &it.answer))
        }
        rows::DecodedRequest::Read(_) => ("read", Vec::new()),
        rows::DecodedRequest::Write(_, items) => ("write", items),
        rows::DecodedRequest::Other => ("request", Vec::new()),
    };
    let rows = items.iter().map(|item| item_fields(drive, *item));
    merge(&mut fields, json!({"rows": rows.collect::<Vec<_>>()}));
    if let Some(refusal) = &it.refusal {
        merge(&mut fields, refused(drive, refusal));
    }
    (kind, fields)
}

fn refused(drive: &Drive, refusal: &Refusal) -> Value {
    json!({
        "refused": refusal.cause.name(),
        "exception": refusal.code,
        "why": why::refusal(drive, refusal),
    })
}

fn item_fields(drive: &Drive, item: Item) -> Value {
    let map = &drive.model().map;
    let named = |row: &Row| json!({"row": row.id, "address": row.at, "name": row.name});
    match item {
        Item::Row(id, value) => {
            let mut fields = named(map.row(id));
            merge(&mut fields, json!({"value": value}));
            fields
        }
        Item::Half(id, word) => {
            let mut fields = named(map.row(id));
            merge(&mut fields, json!({"word": word}));
            fields
        }
        Item::Bare(address, word) => json!({"address": address, "word": word}),
        Item::Unlisted(first, last) => {
            json!({"address": first, "words": last - first + 1, "mapped": false})
        }
        Item::Masked(address, Masks { and, or }) => {
            let mut fields = match map.locate(address) {
                Located::Word { row, .. } => named(map.row(row)),
                Located::Hole | Located::Beyond => json!({}),
            };
            merge(&mut fields, json!({"address": address, "and": and, "or": or}));
            fields
        }
    }
}

fn change_fields(drive: &Drive, unit: u8, change: &Change) -> (&'static str, Value) {
    let mut fields = json!({"unit": unit});
    let (kind, more) = match change {
        Change::PoweredOn => ("power_on", json!({})),
        Change::PoweredOff => ("power_off", json!({})),
        Change::Ready => ("ready", json!({})),
        Change::Enabled(on) => ("servo", json!({"on": on})),
        Change::Alarm { cause, code } => ("alarm", json!({"cause": cause.name(), "code": code})),
        Change::AlarmCleared => ("alarm_cleared", json!({})),
        Change::AlarmHistoryCleared => ("alarm_history_cleared", json!({})),
        Change::WordExpired { word, hold, held_ms } => {
            let map = &drive.model().map;
            let (word, hold) = (&map.row(*word).id, &map.row(*hold).id);
            ("word_expired", json!({"row": word, "hold": hold, "held_ms": held_ms}))
        }
        Change::PositionCleared => ("position_cleared", json!({})),
        Change::TurnsCleared => ("turns_cleared", json!({})),
        Change::Stored => ("stored", json!({})),
        Change::Wear { row, writes, within } => {
            let row = row.map(|row| &drive.model().map.row(row).id);
            let within_s = within.map(|within| within.as_secs());
            ("excessive_writes", json!({"row": row, "writes": writes, "within_s": within_s}))
        }
        Change::FactoryRestored => ("factory_restored", json!({})),
        Change::Unit { from, to } => ("unit_changed", json!({"from": from, "to": to})),
        Change::Mode { from, to } => {
            let text = |mode: &Option<crate::serial::Mode>| mode.map(|mode| mode.to_string());
            ("mode_changed", json!({"from": text(from), "to": text(to)}))
        }
        Change::Moves { to } => ("moving", json!({"to": to})),
        Change::Runs { mrpm } => ("running", json!({"rpm": text::rpm(*mrpm)})),
        Change::Jogs { mrpm } => ("jogging", json!({"rpm": text::rpm(*mrpm)})),
        Change::PositionSegment { number, to } => {
            ("position_segment", json!({"segment": number, "to": to}))
        }
        Change::VelocitySegment { number, mrpm } => {
            ("velocity_segment", json!({"segment": number, "rpm": text::rpm(*mrpm)}))
        }
        Change::ChainStep { from, to, why } => {
            let why = why::chain_step(*why);
            ("chain_step", json!({"from": from, "to": to, "why": why}))
        }
        Change::ChainEnded { at, why } => {
            let (reason, why) = (no_effect::name(*why), no_effect::reason(drive, *why));
            ("chain_ended", json!({"segment": at, "reason": reason, "why": why}))
        }
        Change::Replans(what) => ("replanned", replanned(what)),
        Change::Pauses => ("pausing", json!({})),
        Change::Resumes { to } => ("resumed", json!({"to": to})),
        Change::DeviationCleared { counts } => ("deviation_cleared", json!({"counts": counts})),
        Change::Stops => ("stopping", json!({})),
        Change::Coasts => ("coasting", json!({})),
        Change::Stands { at } => ("stopped", json!({"at": at})),
        Change::Limit { forward, soft } => ("limit", json!({"positive": forward, "soft": soft})),
        Change::Hits { at } => ("hard_stop", json!({"at": at})),
        Change::Deviates => ("position_deviation", json!({})),
        Change::Homes { method } => ("homing_started", json!({"method": method})),
        Change::Seeks { method, step, mrpm } => {
            let (rpm, until) = (text::rpm(*mrpm), why::until(step.until));
            ("homing_moving", json!({"method": method, "rpm": rpm, "until": until}))
        }
        Change::Finds { method, step, at } => {
            let (until, then) = (why::until(step.until), step.then.name());
            ("homing_found", json!({"method": method, "until": until, "at": at, "then": then}))
        }
        Change::FindsLimit { method, forward, turns, at } => {
            let fields =
                json!({"method": method, "positive": forward, "reverses": turns, "at": at});
            ("homing_limit", fields)
        }
        Change::Refines { method, forward } => {
            ("homing_index", json!({"method": method, "positive": forward}))
        }
        Change::Origin { method, at } => ("homing_origin", json!({"method": method, "at": at})),
        Change::Homed { method, position } => {
            ("homing_complete", json!({"method": method, "position": position}))
        }
        Change::HomingLost { method, why } => {
            ("homing_aborted", json!({"method": method, "why": why.name()}))
        }
        Change::NoEffect { order, why } => ("no_effect", no_effect::fields(drive, *order, *why)),
        Change::DeviceFault { device_fault, on } => {
            let more = match device_fault {
                DeviceFault::Cause(cause) => {
                    json!({"device_fault": "cause", "cause": cause.name()})
                }
                DeviceFault::Blocked => json!({"device_fault": "blocked"}),
                DeviceFault::EncoderLost => json!({"device_fault": "encoder_lost"}),
                DeviceFault::Frozen => json!({"device_fault": "frozen"}),
                DeviceFault::Stuck(index) => {
                    json!({"device_fault": "stuck", "terminal": rows::terminal(drive, *index)})
                }
            };
            merge(&mut fields, json!({"on": on}));
            ("device_fault", more)
        }
        Change::Bounces { index, times, every } => {
            let (terminal, every) = (rows::terminal(drive, *index), every.as_secs_f64() * 1000.0);
            ("bouncing", json!({"terminal": terminal, "times": times, "every_ms": every}))
        }
        Change::Terminal { index, signal } => {
            ("terminal", json!({"terminal": rows::terminal(drive, *index), "signal": signal}))
        }
    };
    merge(&mut fields, more);
    (kind, fields)
}

fn replanned(what: &Replanned) -> Value {
    let slope = |it: &Option<i64>| it.map(text::rpm);
    match what {
        Replanned::Target { to } => json!({"target": to}),
        Replanned::Speed { mrpm } => json!({"rpm": text::rpm(*mrpm)}),
        Replanned::SlowSpeed { mrpm } => json!({"slow_rpm": text::rpm(*mrpm)}),
        Replanned::StartSpeed { mrpm } => json!({"start_rpm": text::rpm(*mrpm)}),
        Replanned::Acceleration { mrpm_per_s } => json!({"acceleration_rpm_s": slope(mrpm_per_s)}),
        Replanned::Deceleration { mrpm_per_s } => json!({"deceleration_rpm_s": slope(mrpm_per_s)}),
        Replanned::HomeOffset { by } => json!({"offset": by}),
        Replanned::TimeLimit { time } => {
            json!({"time_limit_s": time.map(|time| time.as_secs_f64())})
        }
    }
}

pub(super) fn merge(into: &mut Value, more: Value) {
    if let (Value::Object(into), Value::Object(more)) = (into, more) {
        into.extend(more);
    }
}
