//! The master of a soak test: requests that make sense, requests that almost do, and what they may do to rows.

use super::replies::SoakEvent;
use super::scene::{Draws, Scene};
use crate::bank::word_of;
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::{DriveId, EventKind};
use crate::model::{Access, Located, WordOrder};
use crate::model::{Model, Row, RowId, SettingRow};
use crate::wire::function::{READ, WRITE_MANY, WRITE_ONE};
use crate::wire::{Pdu, Request};

/// A request: to whom, and what.
pub fn request(scene: &Scene, draws: &mut Draws) -> (u8, Vec<u8>) {
    let at = draws.between(0, scene.line.devices.len() as u64 - 1) as usize;
    let device = &scene.line.devices[at];
    let model = device.model.clone();
    let unit = match draws.between(0, 11) {
        0 => 0,
        1 => draws.byte(),
        2 => draws.between(1, 6) as u8,
        _ => scene.unit(at) + draws.between(0, device.setups.len() as u64 - 1) as u8,
    };
    let pdu = match draws.between(0, 19) {
        0 => draws.bytes(12),
        1..6 => read(&model, draws),
        6..10 => write_many(&model, draws),
        10..15 => order(&model, draws),
        _ => write_one(&model, draws),
    };
    (unit, pdu)
}

fn read(model: &Model, draws: &mut Draws) -> Vec<u8> {
    let count = if draws.one_in(12) { draws.word() } else { draws.between(0, 20) as u16 };
    [&[READ][..], &address(model, draws).to_be_bytes(), &count.to_be_bytes()].concat()
}

fn write_one(model: &Model, draws: &mut Draws) -> Vec<u8> {
    let row = row(model, draws);
    one(row.at, value(row, draws) as u16)
}

/// A write of one register.
pub fn one(address: u16, value: u16) -> Vec<u8> {
    [&[WRITE_ONE][..], &address.to_be_bytes(), &value.to_be_bytes()].concat()
}

/// A row or several from it on, each with a value that mostly fits; now and then the lengths lie.
fn write_many(model: &Model, draws: &mut Draws) -> Vec<u8> {
    let first = row(model, draws);
    let later = model.map.rows().filter(|(_, row)| row.at >= first.at);
    let rows = draws.between(1, 4) as usize;
    let mut words = Vec::new();
    for (_, row) in later.take(rows) {
        let value = value(row, draws) as u32;
        let halves = [(value >> 16) as u16, value as u16];
        match (row.kind.words(), draws.one_in(2)) {
            (1, _) => words.push(halves[1]),
            (_, true) => words.extend(halves),
            (_, false) => words.extend([halves[1], halves[0]]),
        }
    }
    let count = words.len() as u16 + u16::from(draws.one_in(15));
    let head = [&[WRITE_MANY][..], &first.at.to_be_bytes(), &count.to_be_bytes()].concat();
    let data = words.iter().flat_map(|word| word.to_be_bytes());
    head.into_iter().chain([words.len() as u8 * 2]).chain(data).collect()
}

/// Something that makes the drive act, or the rows that it acts by.
fn order(model: &Model, draws: &mut Draws) -> Vec<u8> {
    let wiring = &model.wiring;
    let commands = wiring.commands.iter();
    let commands =
        commands.flat_map(|it| it.actions.iter().map(|(value, _)| (it.row, *value as u16)));
    let triggers = wiring.triggers.iter();
    let triggers = triggers.flat_map(|it| it.actions.iter().map(|(bit, _)| (it.row, 1 << *bit)));
    let bits = wiring.input_bits.iter();
    let bits = bits.flat_map(|(row, bits)| bits.iter().map(|(bit, _)| (*row, 1 << *bit)));
    let words = wiring.input_words.iter();
    let words = words.flat_map(|it| it.rows.iter().chain(&it.enabled_by));
    let words = words.flat_map(|row| (0..16).map(|bit| (*row, 1 << bit)));
    let orders: Vec<(RowId, u16)> = commands.chain(triggers).chain(bits).chain(words).collect();
    let Some((row, value)) = draws.pick(&orders) else { return write_one(model, draws) };
    let more = if draws.one_in(4) { draws.word() & 0x3F } else { 0 };
    one(model.map.row(*row).at, value | more)
}

/// A write of a setting that motions go by, of a modest size.
pub fn setting(model: &Model, draws: &mut Draws) -> Vec<u8> {
    let Some(SettingRow { row: id, .. }) = draws.pick(&model.wiring.axis.settings) else {
        return write_one(model, draws);
    };
    let row = model.map.row(*id);
    let (low, high) = row.spans.first().copied().unwrap_or(row.kind.limits());
    let value = draws.signed(low.max(-3000), high.min(3000));
    let halves = [(value >> 16) as u16, value as u16];
    let [first, second] = if draws.one_in(2) { halves } else { [halves[1], halves[0]] };
    let ([a, b], [c, d]) = (row.at.to_be_bytes(), first.to_be_bytes());
    match row.kind.words() {
        1 => one(row.at, value as u16),
        _ => [&[WRITE_MANY, a, b, 0, 2, 4, c, d][..], &second.to_be_bytes()].concat(),
    }
}

/// A row, more often one that motions go by or that has the line's settings.
fn row<'a>(model: &'a Model, draws: &mut Draws) -> &'a Row {
    let wiring = &model.wiring;
    let settings = wiring.axis.settings.iter().map(|it| it.row);
    let terminals = wiring.input_terminals.iter().flat_map(|it| it.functions.iter().copied());
    let line = [model.line.unit.row, model.line.baud.row, model.line.format.row];
    let hot: Vec<RowId> = settings.chain(terminals).chain(line).collect();
    let id = match draws.one_in(2) {
        true => *draws.pick(&hot).expect("a line has settings"),
        false => RowId(draws.between(0, model.map.len() as u64 - 1) as u16),
    };
    model.map.row(id)
}

fn address(model: &Model, draws: &mut Draws) -> u16 {
    match draws.between(0, 9) {
        0 => draws.word(),
        1 => row(model, draws).at.wrapping_add(draws.between(1, 3) as u16),
        _ => row(model, draws).at,
    }
}

/// A value that fits, mostly, and one of the ends of what does now and then.
fn value(row: &Row, draws: &mut Draws) -> i64 {
    let (low, high) = match draws.pick(&row.spans) {
        Some(span) => *span,
        None => row.kind.limits(),
    };
    match draws.between(0, 9) {
        0 => i64::from(draws.word()),
        1 => low,
        2 => high,
        3 => high.saturating_add(1),
        4..7 => draws.signed(low, high.min(low.saturating_add(600))),
        _ => draws.signed(low, high),
    }
}

/// Did anything happen in this call that may change rows?
pub fn may_change(seen: &[SoakEvent]) -> bool {
    seen.iter().any(|it| match it {
        SoakEvent::Told(EventKind::Drive { .. }) => true,
        SoakEvent::Told(what) => accepted(what).is_some(),
        SoakEvent::Frame(_) => false,
    })
}

/// The drive and the request, if `what` is a write that a drive has accepted.
fn accepted(what: &EventKind) -> Option<(DriveId, &Pdu)> {
    let (drive, request) = match what {
        EventKind::Transaction(it) if it.refusal.is_none() => (it.drive, &it.request),
        EventKind::Broadcast(it) if it.refusal.is_none() => (it.drive, &it.request),
        _ => return None,
    };
    (request.first() != Some(&crate::wire::function::READ)).then_some((drive, request))
}

/// If the call was one write that was accepted and set nothing off, then the drive holds all that was written.
pub fn written(seen: &[SoakEvent], bus: &Bus) -> Result<(), String> {
    let set_off = |it: &&SoakEvent| matches!(it, SoakEvent::Told(EventKind::Drive { .. }));
    let mut writes = seen.iter().filter_map(|it| match it {
        SoakEvent::Told(what) => accepted(what),
        SoakEvent::Frame(_) => None,
    });
    match (writes.next(), writes.next(), seen.iter().find(set_off)) {
        (Some((id, request)), None, None) => holds(bus.drive(id), request),
        _ => Ok(()),
    }
}

/// Does the drive hold what `request` wrote, where rows simply hold it?
fn holds(drive: &Drive, request: &[u8]) -> Result<(), String> {
    let model = drive.model();
    let (span, values) = match Request::parse(request, model.line.length_check) {
        Ok(Request::WriteOne { address, value }) => (crate::wire::Span::one(address), value),
        Ok(Request::WriteMany { span, values }) => (span, values),
        _ => return Ok(()),
    };
    for (i, address) in span.addresses().enumerate() {
        let Located::Word { row: id, word, .. } = model.map.locate(address) else { continue };
        let row = model.map.row(id);
        // Words of a pair lie as the order was before the write.
        let fixed = matches!(model.line.word_order, WordOrder::Fixed(_)) || row.order.is_some();
        let plain = !row.clears && row.access == Access::Both && (fixed || row.kind.words() == 1);
        let got = word_of(row, drive.bank().order(model, row), drive.bank().raw(id), word);
        if plain && values.get(i) != Some(got) {
            return Err(format!("0x{address:04X} holds {got} and not what was written"));
        }
    }
    Ok(())
}
