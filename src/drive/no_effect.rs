//! Orders that have no effect: the log says why, once.
//!
//! An action or a rising edge without effect is reported when it comes. A level that is
//! active without effect is reported when it rises, and again when the reason changes; so is an edge that came too
//! early, once it would act if it came anew ([`NoEffectReports::report_inactive`]). A bit that does not reach its signal is reported when
//! it is set. Nothing is told again because a master writes it again.

use super::acts::{Acts, acts, asks_for_run};
use super::context::DriveContext;
use super::effects::EffectQueue;
use super::inputs::{active_bits, active_positions};
use super::registers::Registers;
use super::view::View;
use crate::bank::WritePlan;
use crate::event::{Ignored, Ordered};
use crate::model::Wiring;
use crate::time::Instant;
use crate::vocabulary::{Input, Inputs, Named, RowId};

const INPUTS: usize = Input::ALL.len();

/// What has been told.
#[derive(Debug)]
pub(super) struct NoEffectReports {
    /// What became of each input signal that is active.
    inputs: [Active; INPUTS],
    /// Bits that are set, by source: input words first, then rows of input bits.
    sources: Box<[Bits]>,
    /// Output words that nothing was enabled of when they were read, as bits by index.
    dark: u16,
    /// Rows that are only stored and have been written, a bit each.
    stored: Box<[u64]>,
    /// Functions that are not simulated and that were asked for since power came on, as bits by index.
    not_simulated: u64,
}

/// An input signal that is active.
#[derive(Debug, Clone, Copy, Default)]
struct Active {
    since: Instant,
    told: Reported,
}

/// What was reported about an active signal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Reported {
    /// Nothing yet.
    #[default]
    Nothing,
    /// It acts, or has acted.
    Acts,
    /// Why it does not.
    Why(Ignored),
}

/// Bits of a row that are set.
#[derive(Debug, Clone, Copy, Default)]
struct Bits {
    /// Those that make their signals active.
    reach: u16,
    /// Those that something keeps from it.
    kept: u16,
    /// Those that stand for nothing.
    idle: u16,
    /// Those, set or not, of which something is to be told.
    untold: u16,
}

impl NoEffectReports {
    /// Nothing has been told.
    pub(super) fn new(wiring: &Wiring) -> Self {
        let words = wiring.input_words.as_ref().map_or(0, |words| words.rows.len());
        Self {
            inputs: [Active::default(); INPUTS],
            sources: vec![Bits::default(); words + wiring.input_bits.len()].into(),
            dark: 0,
            stored: vec![0; wiring.shows.len().div_ceil(64)].into(),
            not_simulated: 0,
        }
    }

    /// Tells of an input signal that rose and has no effect, if it has none. One that acts as a level is looked at
    /// later.
    pub(super) fn report_edge(
        &mut self,
        view: View<'_>,
        out: &mut EffectQueue,
        input: Input,
        done: Result<(), Ignored>,
    ) {
        let cx = view.axis().context();
        if matches!(acts(view, input), Acts::Level(_)) {
            return;
        }
        let told = match done {
            Ok(()) => Reported::Acts,
            Err(why) => {
                cx.ignore(out, Ordered::Input(input), why);
                Reported::Why(cx.root_of(why))
            }
        };
        self.inputs[input as usize].told = told;
    }

    /// Power comes on: what is not simulated is reported again.
    pub(super) fn power_on(&mut self) {
        self.not_simulated = 0;
    }

    /// What was active before power came on is nobody's order.
    pub(super) fn power_on_inputs(&mut self, view: View<'_>) {
        let cx = view.axis().context();
        self.inputs = [Active { since: cx.now, told: Reported::Nothing }; INPUTS];
        for input in Input::ALL {
            let told = match acts(view, *input) {
                Acts::Level(why) => why.map_or(Reported::Acts, Reported::Why),
                Acts::Edge(_) => Reported::Why(Ignored::PowerOff),
                Acts::Other => Reported::Acts,
            };
            self.inputs[*input as usize].told = told;
        }
        for source in 0..self.sources.len() {
            self.sources[source] = bits_of(cx, source);
        }
    }

    /// Looks at the signals that have risen, while `before` were active.
    pub(super) fn note_inputs(&mut self, view: View<'_>, before: Inputs) {
        let cx = view.axis().context();
        for input in cx.inputs.risen_since(before).iter() {
            self.inputs[input as usize] = Active { since: cx.now, told: Reported::Nothing };
        }
        self.note_bits(view, before);
    }

    /// Looks at active signals that have no effect. To be called when everything that came at one instant has been
    /// done.
    pub(super) fn report_inactive(&mut self, view: View<'_>, out: &mut EffectQueue) {
        let cx = view.axis().context();
        if !view.is_powered() {
            return;
        }
        for input in cx.inputs.iter() {
            let Active { since, told } = self.inputs[input as usize];
            let told = match (acts(view, input), told) {
                (Acts::Other, told) => told,
                (Acts::Level(None), _) => Reported::Acts,
                (Acts::Level(Some(why)), told) => {
                    let known = told == Reported::Why(why);
                    let shown = told == Reported::Acts && why.shows_itself();
                    if !known && !shown && !self.is_older(cx, input, why) {
                        cx.ignore(out, Ordered::Input(input), why);
                    }
                    Reported::Why(why)
                }
                // What it has started is over: from now on it takes another edge.
                (Acts::Edge(Some(why)), Reported::Acts) if why.ends_motions() => Reported::Why(why),
                (Acts::Edge(None), Reported::Why(why)) if why.passes() => {
                    let why = Ignored::NoEdge { since };
                    cx.ignore(out, Ordered::Input(input), why);
                    Reported::Why(why)
                }
                (Acts::Edge(_), told) => told,
            };
            self.inputs[input as usize].told = told;
        }
        self.report_bits(view, out);
    }

    /// Of signals that contradict each other only the last is reported.
    fn is_older(&self, cx: DriveContext<'_>, input: Input, why: Ignored) -> bool {
        let age = |input: Input| (self.inputs[input as usize].since, input);
        let mut others = cx.inputs.iter().filter(|other| asks_for_run(*other));
        why == Ignored::Contradiction && others.any(|other| age(other) > age(input))
    }

    /// Looks at bits that were set or cleared, while `before` were active.
    fn note_bits(&mut self, view: View<'_>, before: Inputs) {
        let cx = view.axis().context();
        for source in 0..self.sources.len() {
            let mut now = bits_of(cx, source);
            let was = self.sources[source];
            let fresh = (now.kept & !was.kept) | (now.idle & !was.idle);
            let (set, cleared) = (now.reach & !was.reach, was.reach & !now.reach & !now.kept);
            now.untold = was.untold | fresh;
            for bit in (0..16u8).filter(|bit| (set | cleared) >> bit & 1 != 0) {
                let signal = signal_of(cx, source, bit);
                let alike = signal.is_ok_and(|it| before.has(it) == cx.inputs.has(it));
                now.untold |= u16::from(alike) << bit;
            }
            self.sources[source] = now;
        }
    }

    /// Tells of bits that were set and reach no signal, and of those that another source keeps as it is.
    fn report_bits(&mut self, view: View<'_>, out: &mut EffectQueue) {
        let cx = view.axis().context();
        for source in 0..self.sources.len() {
            let untold = std::mem::take(&mut self.sources[source].untold);
            let Some(row) = source_row(cx, source).filter(|_| untold != 0) else { continue };
            for bit in (0..16u8).filter(|bit| untold >> bit & 1 != 0) {
                let on = cx.registers.raw(row) >> bit & 1 != 0;
                let why = signal_of(cx, source, bit).map_or_else(|why| why, Ignored::OtherSource);
                cx.ignore(out, Ordered::Bit { row, bit, on }, why);
            }
        }
    }

    /// Takes note of rows that `plan` has written and that are only stored.
    pub(super) fn note_written(&mut self, view: View<'_>, out: &mut EffectQueue, plan: &WritePlan) {
        let cx = view.axis().context();
        for (id, raw) in plan.values() {
            let row = cx.model().map.row(id);
            let (word, bit) = (usize::from(id.0 / 64), 1 << (id.0 % 64));
            if row.inert && self.stored[word] & bit == 0 {
                self.stored[word] |= bit;
                let order = Ordered::Write { row: id, value: row.kind.value(raw) };
                cx.ignore(out, order, Ignored::StoredOnly);
            }
        }
    }

    /// Output words of which nothing is enabled, and that were not read since that is so, as bits by index.
    pub(super) fn dark(&self, registers: &Registers) -> u16 {
        let mut dark = 0;
        for (i, word) in registers.model().wiring.output_words.iter().enumerate() {
            let is_dark = word.enabled_by.is_some_and(|row| registers.raw(row) == 0);
            dark |= u16::from(is_dark) << i;
        }
        dark & !self.dark
    }

    /// Takes note of output words that were read and of which nothing is enabled, as bits by index.
    pub(super) fn note_read(&mut self, cx: DriveContext<'_>, out: &mut EffectQueue, read: u16) {
        if read | self.dark == 0 {
            return;
        }
        for (i, word) in cx.model().wiring.output_words.iter().enumerate() {
            let Some(enable) = word.enabled_by else { continue };
            if cx.registers.raw(enable) != 0 {
                self.dark &= !(1 << i);
            } else if read >> i & 1 != 0 {
                self.dark |= 1 << i;
                let why = Ignored::Disabled { row: enable, bit: None };
                cx.ignore(out, Ordered::Read(word.row), why);
            }
        }
    }

    /// Tells of what is asked for and not simulated, once each.
    pub(super) fn report_not_simulated(&mut self, view: View<'_>, out: &mut EffectQueue) {
        let cx = view.axis().context();
        if cx.model().wiring.not_simulated.is_empty() || !view.is_powered() {
            return;
        }
        let asked = inputs_not_simulated(view) | settings_not_simulated(cx);
        let mut new = asked & !self.not_simulated;
        self.not_simulated |= asked;
        while new != 0 {
            let function = new.trailing_zeros() as u8;
            cx.ignore(out, Ordered::Function(function), Ignored::NotSimulated);
            new &= new - 1;
        }
    }
}

/// The bits of a source that are set.
fn bits_of(cx: DriveContext<'_>, source: usize) -> Bits {
    let mut bits = Bits::default();
    let Some(row) = source_row(cx, source) else { return bits };
    let raw = cx.registers.raw(row) as u16;
    for bit in (0..16u8).filter(|bit| raw >> bit & 1 != 0) {
        let kind = match signal_of(cx, source, bit) {
            Ok(_) => &mut bits.reach,
            Err(Ignored::Disabled { .. } | Ignored::Overridden { .. }) => &mut bits.kept,
            // The log tells of such a function once, whatever asks for it.
            Err(Ignored::NotSimulated) => continue,
            Err(_) => &mut bits.idle,
        };
        *kind |= 1 << bit;
    }
    bits
}

fn source_row(cx: DriveContext<'_>, source: usize) -> Option<RowId> {
    let wiring = &cx.model().wiring;
    let words = wiring.input_words.as_ref().map_or(&[][..], |words| &words.rows);
    let bits = || wiring.input_bits.get(source - words.len()).map(|(row, _)| *row);
    words.get(source).copied().or_else(bits)
}

/// The signal that a bit of a source makes active, or why it makes none active.
fn signal_of(cx: DriveContext<'_>, source: usize, bit: u8) -> Result<Input, Ignored> {
    let wiring = &cx.model().wiring;
    let words = wiring.input_words.as_ref().filter(|words| source < words.rows.len());
    let absent = &wiring.not_simulated;
    if let Some(words) = words {
        let position = (source as u16) << 4 | u16::from(bit);
        let enable = words.enabled_by.get(source).copied();
        let disabled = enable.filter(|row| cx.registers.raw(*row) >> bit & 1 == 0);
        let signal = words.positions.iter().find(|(it, _)| *it == position);
        let is_absent = absent.input_positions.iter().any(|(it, _)| *it == position);
        return match (disabled, signal) {
            (Some(row), _) => Err(Ignored::Disabled { row, bit: Some(bit) }),
            (None, Some((_, signal))) => Ok(*signal),
            (None, None) if is_absent => Err(Ignored::NotSimulated),
            (None, None) => Err(Ignored::Nothing),
        };
    }
    let words = wiring.input_words.as_ref().map_or(0, |words| words.rows.len());
    let (row, bits) = &wiring.input_bits[source - words];
    let signal = bits.iter().find(|(it, _)| *it == bit).map(|(_, signal)| *signal);
    let mut absent = absent.input_bits.iter().filter(|(it, _)| it == row);
    let is_absent = absent.any(|(_, bits)| bits.iter().any(|(it, _)| *it == bit));
    match cx.registers.overridden_by(*row, bit) {
        Some(row) => Err(Ignored::Overridden { row }),
        None if is_absent => Err(Ignored::NotSimulated),
        None => signal.ok_or(Ignored::Nothing),
    }
}

/// Input functions that are active, as bits by index.
fn inputs_not_simulated(view: View<'_>) -> u64 {
    let cx = view.axis().context();
    let absent = &cx.model().wiring.not_simulated;
    let mut asked = 0;
    let mut ask = |index: u8| asked |= 1 << index;
    view.inputs().active_codes(view.axis(), &absent.input_codes, &mut ask);
    active_positions(cx.registers, &absent.input_positions, &mut ask);
    active_bits(cx.registers, &absent.input_bits, &mut ask);
    asked
}

/// Output functions that something is to show, and digits of rows that are not 0, as bits by index.
fn settings_not_simulated(cx: DriveContext<'_>) -> u64 {
    let wiring = &cx.model().wiring;
    let absent = &wiring.not_simulated;
    let mut asked = 0;
    let functions = wiring.output_terminals.iter().flat_map(|it| &it.functions);
    for number in functions.map(|row| cx.registers.raw(*row)) {
        let of_number = absent.output_codes.iter().filter(|it| u32::from(it.0) == number);
        of_number.for_each(|(_, index)| asked |= 1 << index);
    }
    for (position, index) in &absent.output_positions {
        let word = wiring.output_words.get(usize::from(position / 16));
        let row = word.and_then(|it| it.enabled_by);
        let enabled = row.is_some_and(|row| cx.registers.is_set(row, position % 16));
        asked |= u64::from(enabled) << index;
    }
    for (digit, index) in &absent.digits {
        let is_set = digit.of(cx.registers.value(digit.row)) != 0;
        asked |= u64::from(is_set) << index;
    }
    asked
}
