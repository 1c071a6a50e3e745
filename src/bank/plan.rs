//! Plans: requests that were decided about, and nothing has changed yet.

use super::{Bank, Causes, Gate, with_word, word_of};
use crate::model::{Access, Layer, Located, LongAccess, Model, RowId};
use crate::vocabulary::{Cause, Detail, Refusal};
use crate::wire::{Span, Words};

/// Most registers in a 0x10 request (application protocol, 6.12).
const WRITE_MAX: usize = 123;

/// A read that may happen: proof that every address of the span may be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadPlan {
    span: Span,
}

/// A write that may happen: the rows from `first` on, each with its new value, and each value fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WritePlan {
    first: RowId,
    len: usize,
    raws: [u32; WRITE_MAX],
    layer: Layer,
}

impl ReadPlan {
    /// Puts the words of the span into `into`, in order, and returns how many. `show` tells what a row
    /// shows right now.
    pub fn read(
        self,
        bank: &Bank,
        model: &Model,
        mut show: impl FnMut(RowId) -> u32,
        into: &mut [u16; 125],
    ) -> usize {
        let mut shown: Option<(RowId, u32)> = None;
        for (slot, address) in into.iter_mut().zip(self.span.addresses()) {
            let Located::Word { row: id, word, .. } = model.map.locate(address) else {
                *slot = 0;
                continue;
            };
            let row = model.map.row(id);
            // Both words of a pair come from one look at it.
            let raw = match shown {
                Some((seen, raw)) if seen == id => raw,
                _ if row.access == Access::Write => 0,
                _ => show(id),
            };
            shown = Some((id, raw));
            *slot = word_of(row, bank.order(model, row), raw, word);
        }
        usize::from(self.span.count())
    }
}

impl WritePlan {
    /// Where the values go.
    pub fn layer(&self) -> Layer {
        self.layer
    }

    /// Each row with its new value, by address.
    pub fn values(&self) -> impl Iterator<Item = (RowId, u32)> + '_ {
        let raws = self.raws[..self.len].iter();
        raws.enumerate().map(|(i, raw)| (RowId(self.first.0 + i as u16), *raw))
    }

    /// Those of them that are kept over power-off.
    pub fn stored<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (RowId, u32)> + 'a {
        let all = self.layer == Layer::RamAndStore;
        self.values().filter(move |(row, _)| {
            let row = model.map.row(*row);
            (all || row.autosave) && !row.volatile
        })
    }
}

impl Bank {
    /// Decides about reading `span`.
    ///
    /// # Errors
    /// The refusal that the model puts first among all the causes that hold.
    pub fn plan_read(&self, model: &Model, span: Span) -> Result<ReadPlan, Refusal> {
        let mut causes = Causes::default();
        quantity(span, model.line.max_read, &mut causes);
        let zero = model.line.unlisted_reads_zero;
        for address in span.addresses() {
            if zero && model.map.locate(address) == Located::Hole {
                continue;
            }
            let Some((row, ..)) = locate(model, address, &mut causes) else { continue };
            if model.map.row(row).access == Access::Write && !model.line.write_only_reads_zero {
                causes.meet(Cause::WriteOnly, Detail::Row(row));
            }
            whole_pair(model, row, span, address, &mut causes);
        }
        match causes.refusal(&model.line.refuse) {
            None => Ok(ReadPlan { span }),
            Some(refusal) => Err(refusal),
        }
    }

    /// Decides about writing `words` to `span`, which are equally many.
    ///
    /// # Errors
    /// The refusal that the model puts first among all the causes that hold.
    pub fn plan_write(
        &self,
        model: &Model,
        span: Span,
        words: Words<'_>,
        gate: Gate,
    ) -> Result<WritePlan, Refusal> {
        let mut causes = Causes::default();
        quantity(span, model.line.max_write, &mut causes);
        let mut plan: Option<WritePlan> = None;
        for (address, value) in span.addresses().zip(words.iter()) {
            let Some((id, word, layer)) = locate(model, address, &mut causes) else { continue };
            let plan =
                plan.get_or_insert(WritePlan { first: id, len: 0, raws: [0; WRITE_MAX], layer });
            let index = usize::from(id.0.wrapping_sub(plan.first.0));
            if index > plan.len || layer != plan.layer {
                // The span runs from one window into another, or across a hole.
                causes.meet(Cause::Address, Detail::Address(address));
                continue;
            }
            let row = model.map.row(id);
            if index == plan.len {
                plan.raws[index] = self.raw(id);
                plan.len += 1;
                may_write(model, id, gate, &mut causes);
                whole_pair(model, id, span, address, &mut causes);
            }
            let order = self.order(model, row);
            plan.raws[index] = with_word(row, order, plan.raws[index], word, value);
        }
        for (row, raw) in plan.iter().flat_map(WritePlan::values) {
            let got = model.map.row(row).kind.value(raw);
            if !model.map.row(row).admits(got) {
                causes.meet(Cause::Range, Detail::Value { row, got });
            }
        }
        match (causes.refusal(&model.line.refuse), plan) {
            (None, Some(plan)) => Ok(plan),
            (Some(refusal), _) => Err(refusal),
            (None, None) => unreachable!("a span without any row has met a cause"),
        }
    }
}

fn quantity(span: Span, most: u16, causes: &mut Causes) {
    if span.count() > most {
        causes.meet(Cause::Quantity, Detail::Quantity { got: span.count(), most });
    }
}

fn locate(model: &Model, address: u16, causes: &mut Causes) -> Option<(RowId, u8, Layer)> {
    match model.map.locate(address) {
        Located::Word { row, word, layer } => return Some((row, word, layer)),
        Located::Hole => causes.meet(Cause::Address, Detail::Address(address)),
        Located::Beyond => causes.meet(Cause::AddressBeyond, Detail::Address(address)),
    }
    None
}

fn may_write(model: &Model, id: RowId, gate: Gate, causes: &mut Causes) {
    let row = model.map.row(id);
    if row.access == Access::Read {
        causes.meet(Cause::ReadOnly, Detail::Row(id));
    }
    if row.locked_while_enabled && gate.enabled {
        causes.meet(Cause::State, Detail::Row(id));
    }
}

/// Where pairs go whole or not at all: is all of `row`, met at `address`, inside the span?
fn whole_pair(model: &Model, id: RowId, span: Span, address: u16, causes: &mut Causes) {
    let row = model.map.row(id);
    if model.line.long_access == LongAccess::Any || row.kind.words() == 1 {
        return;
    }
    let Located::Word { word, .. } = model.map.locate(address) else { return };
    let first = address - u16::from(word);
    if first < span.start() || first == u16::MAX || first + 1 > span.last() {
        causes.meet(Cause::SplitLong, Detail::Row(id));
    }
}
