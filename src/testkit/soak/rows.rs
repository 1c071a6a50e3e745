//! What calls do to rows: what is refused or only read leaves all as it was, and a write is done whole.

use super::replies::SoakEvent;
use crate::bank::word_of;
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::{DriveId, What};
use crate::model::{Access, Located, WordOrder};
use crate::wire::{Pdu, Request};

/// Did anything happen in this call that may change rows?
pub fn may_change(seen: &[SoakEvent]) -> bool {
    seen.iter().any(|it| match it {
        SoakEvent::Told(What::Drive { .. }) => true,
        SoakEvent::Told(what) => accepted(what).is_some(),
        SoakEvent::Frame(_) => false,
    })
}

/// The drive and the request, if `what` is a write that a drive has accepted.
fn accepted(what: &What) -> Option<(DriveId, &Pdu)> {
    let (drive, request) = match what {
        What::Transaction(it) if it.refusal.is_none() => (it.drive, &it.request),
        What::Broadcast { drive, request, refusal: None, .. } => (*drive, request),
        _ => return None,
    };
    (request.first() != Some(&crate::wire::function::READ)).then_some((drive, request))
}

/// If the call was one write that was accepted and set nothing off, then the drive holds all that was written.
pub fn written(seen: &[SoakEvent], bus: &Bus) -> Result<(), String> {
    let set_off = |it: &&SoakEvent| matches!(it, SoakEvent::Told(What::Drive { .. }));
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
