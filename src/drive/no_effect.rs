//! Orders that have no effect: the log says why, once.
//!
//! An action or a rising edge that comes to nothing is told of when it comes ([`Drive::ignore`]). A level that is
//! active and does nothing is told of when it rises, and again when the reason changes; so is an edge that came too
//! early, once it would act if it came anew ([`Drive::explain`]). A bit that does not reach its signal is told of when
//! it is set. Nothing is told again because a master writes it again.

use super::Drive;
use crate::bank::WritePlan;
use crate::behaviour::{Control, Phase};
use crate::event::{Change, Ignored, Ordered};
use crate::model::{Shows, Wiring};
use crate::time::Instant;
use crate::vocabulary::{Input, Inputs, Lasts, Named, RowId};

const INPUTS: usize = Input::ALL.len();

/// What has been told.
#[derive(Debug)]
pub(super) struct NoEffect {
    /// What became of each input signal that is active.
    inputs: [Active; INPUTS],
    /// Bits that are set, by source: input words first, then rows of input bits.
    sources: Box<[Bits]>,
    /// Output words that nothing was enabled of when they were read.
    dark: u16,
    /// Rows that are only stored and have been written, a bit each.
    stored: Box<[u64]>,
}

/// An input signal that is active.
#[derive(Debug, Clone, Copy, Default)]
struct Active {
    since: Instant,
    told: Reported,
}

/// What was told of an active signal.
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

/// How an input signal acts.
enum Acts {
    /// While active. Why it does not, if it does not.
    Level(Option<Ignored>),
    /// When it rises. Why it could not, if it rose now.
    Edge(Option<Ignored>),
    /// In a way that is told when it rises, or by itself not at all.
    Other,
}

impl NoEffect {
    /// Nothing has been told.
    pub(super) fn new(wiring: &Wiring) -> Self {
        let words = wiring.input_words.as_ref().map_or(0, |words| words.rows.len());
        Self {
            inputs: [Active::default(); INPUTS],
            sources: vec![Bits::default(); words + wiring.input_bits.len()].into(),
            dark: 0,
            stored: vec![0; wiring.shows.len().div_ceil(64)].into(),
        }
    }
}

impl Drive {
    /// Tells of an order that has no effect. What the axis says of the power stage is traced to what keeps that off.
    pub(super) fn ignore(&mut self, order: Ordered, why: Ignored) {
        let why = self.root_of(why);
        self.changes.push_back(Change::NoEffect { order, why });
    }

    /// Tells of an input signal that rose and has no effect, if it has none. One that acts as a level is looked at
    /// later.
    pub(super) fn heed(&mut self, input: Input, done: Result<(), Ignored>) {
        if matches!(self.acts(input), Acts::Level(_)) {
            return;
        }
        let told = match done {
            Ok(()) => Reported::Acts,
            Err(why) => {
                self.ignore(Ordered::Input(input), why);
                Reported::Why(self.root_of(why))
            }
        };
        self.no_effect.inputs[input as usize].told = told;
    }

    /// What was active before power came on is nobody's order.
    pub(super) fn begin_explaining(&mut self) {
        self.no_effect.inputs = [Active { since: self.now, told: Reported::Nothing }; INPUTS];
        for input in Input::ALL {
            let told = match self.acts(*input) {
                Acts::Level(why) => why.map_or(Reported::Acts, Reported::Why),
                Acts::Edge(_) => Reported::Why(Ignored::PowerOff),
                Acts::Other => Reported::Acts,
            };
            self.no_effect.inputs[*input as usize].told = told;
        }
        for source in 0..self.no_effect.sources.len() {
            self.no_effect.sources[source] = self.bits_of(source);
        }
    }

    /// Looks at the signals that have risen, while `before` were active.
    pub(super) fn look_at_inputs(&mut self, before: Inputs) {
        let (now, inputs) = (self.now, self.inputs);
        for input in inputs.risen_since(before).iter() {
            self.no_effect.inputs[input as usize] = Active { since: now, told: Reported::Nothing };
        }
        self.look_at_bits(before);
    }

    /// Looks at active signals that have no effect. To be called when everything that came at one instant has been
    /// done.
    pub(super) fn explain(&mut self) {
        if !self.powered {
            return;
        }
        for input in self.inputs.iter() {
            let Active { since, told } = self.no_effect.inputs[input as usize];
            let told = match (self.acts(input), told) {
                (Acts::Other, told) => told,
                (Acts::Level(None), _) => Reported::Acts,
                (Acts::Level(Some(why)), told) => {
                    let known = told == Reported::Why(why);
                    let shown = told == Reported::Acts && why.shows_itself();
                    if !known && !shown && !self.is_older(input, why) {
                        self.ignore(Ordered::Input(input), why);
                    }
                    Reported::Why(why)
                }
                // What it has started is over: from now on it takes another edge.
                (Acts::Edge(Some(why)), Reported::Acts) if why.ends_motions() => Reported::Why(why),
                (Acts::Edge(None), Reported::Why(why)) if why.passes() => {
                    let why = Ignored::NoEdge { since };
                    self.ignore(Ordered::Input(input), why);
                    Reported::Why(why)
                }
                (Acts::Edge(_), told) => told,
            };
            self.no_effect.inputs[input as usize].told = told;
        }
        self.explain_bits();
    }

    /// Of signals that contradict each other only the last is told of.
    fn is_older(&self, input: Input, why: Ignored) -> bool {
        let age = |input: Input| (self.no_effect.inputs[input as usize].since, input);
        let mut others = self.inputs.iter().filter(|other| asks_for_run(*other));
        why == Ignored::Contradiction && others.any(|other| age(other) > age(input))
    }

    fn acts(&self, input: Input) -> Acts {
        let edge = |may: Result<(), Ignored>| Acts::Edge(may.err().map(|why| self.root_of(why)));
        match input {
            Input::ServoOn => {
                Acts::Level((!self.power_stage.is_enabled()).then(|| self.power_stage.why_off()))
            }
            Input::SegmentRun if self.velocity_lasts() == Some(Lasts::Edge) => {
                edge(self.motor.may_start(false))
            }
            Input::HomeStart if !self.may_home_by_input() => Acts::Other,
            Input::HomeStart => edge(self.motor.may_start(false)),
            Input::MoveStart | Input::SegmentStart => edge(self.motor.may_move(false)),
            Input::InterruptStart => edge(self.may_interrupt()),
            Input::ClearDeviation | Input::CommandInhibit => {
                Acts::Level(self.why_not_held_back(input))
            }
            Input::AlarmReset => Acts::Edge(self.power_stage.may_reset().err()),
            _ if asks_for_run(input) => Acts::Level(self.why_no_run(input)),
            _ => Acts::Other,
        }
    }

    /// Why `input` does not hold the command of the motion under way back, if there is one and it does not.
    fn why_not_held_back(&self, input: Input) -> Option<Ignored> {
        let by_position = self.motor.control() == Some(Control::Position);
        match self.motor.phase() {
            Phase::Homing => Some(Ignored::Homing),
            Phase::Jogging { .. } if by_position || input == Input::CommandInhibit => {
                Some(Ignored::Moving)
            }
            _ => None,
        }
    }

    /// Why the run that `input` asks for is not under way, if it is not.
    fn why_no_run(&self, input: Input) -> Option<Ignored> {
        if self.runs_by(input) {
            return None;
        }
        match self.motor.may_start(false) {
            Err(Ignored::Moving) if self.motor.phase().is_slowing() => {}
            Err(Ignored::Moving) if self.motor.phase().is_jogging() => {}
            Err(why) => return Some(self.root_of(why)),
            Ok(()) => {}
        }
        let Some(level) = self.level() else {
            let alone = input == Input::SegmentRun && self.velocity.is_none();
            return Some(if alone { Ignored::NoSegment } else { Ignored::Contradiction });
        };
        if level.input() != input {
            return Some(Ignored::Moving);
        }
        if self.inputs.has(Input::ZeroSpeedClamp) {
            return Some(Ignored::Inhibited);
        }
        let Some((_, ramp)) = self.wanted_run() else { return Some(Ignored::NoSpeed) };
        if self.motor.is_jog_spent() {
            return Some(Ignored::Spent);
        }
        self.motor.may_go(self.now, ramp.speed).err()
    }

    /// The reason behind `why`: what keeps the power stage off, what an alarm stops.
    fn root_of(&self, why: Ignored) -> Ignored {
        match why {
            Ignored::PowerOff => self.power_stage.why_off(),
            Ignored::Held if self.power_stage.is_braking() => Ignored::Alarm,
            why => why,
        }
    }

    /// Why an order to stop has no effect, if it has none; one that stops `at_once` also ends a ramp.
    pub(super) fn why_no_stop(&self, at_once: bool) -> Option<Ignored> {
        let slowing = self.motor.phase().is_slowing();
        match () {
            () if self.chain.is_under_way() => None,
            () if !self.motor.is_moving() => Some(Ignored::AlreadyStopped),
            () if slowing && !(at_once && self.power_stage.is_enabled()) => Some(Ignored::Stopping),
            () => None,
        }
    }

    /// Looks at bits that were set or cleared, while `before` were active.
    fn look_at_bits(&mut self, before: Inputs) {
        for source in 0..self.no_effect.sources.len() {
            let mut now = self.bits_of(source);
            let was = self.no_effect.sources[source];
            let fresh = (now.kept & !was.kept) | (now.idle & !was.idle);
            let (set, cleared) = (now.reach & !was.reach, was.reach & !now.reach & !now.kept);
            now.untold = was.untold | fresh;
            for bit in (0..16u8).filter(|bit| (set | cleared) >> bit & 1 != 0) {
                let signal = self.bit(source, bit);
                let alike = signal.is_ok_and(|it| before.has(it) == self.inputs.has(it));
                now.untold |= u16::from(alike) << bit;
            }
            self.no_effect.sources[source] = now;
        }
    }

    /// Tells of bits that were set and reach no signal, and of those that another source keeps as it is.
    fn explain_bits(&mut self) {
        for source in 0..self.no_effect.sources.len() {
            let untold = std::mem::take(&mut self.no_effect.sources[source].untold);
            let Some(row) = self.source_row(source).filter(|_| untold != 0) else { continue };
            for bit in (0..16u8).filter(|bit| untold >> bit & 1 != 0) {
                let on = self.bank.raw(row) >> bit & 1 != 0;
                let why = self.bit(source, bit).map_or_else(|why| why, Ignored::OtherSource);
                self.ignore(Ordered::Bit { row, bit, on }, why);
            }
        }
    }

    /// The bits of a source that are set.
    fn bits_of(&self, source: usize) -> Bits {
        let mut bits = Bits::default();
        let Some(row) = self.source_row(source) else { return bits };
        let raw = self.bank.raw(row) as u16;
        for bit in (0..16u8).filter(|bit| raw >> bit & 1 != 0) {
            let kind = match self.bit(source, bit) {
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

    fn source_row(&self, source: usize) -> Option<RowId> {
        let wiring = &self.model.wiring;
        let words = wiring.input_words.as_ref().map_or(&[][..], |words| &words.rows);
        let bits = || wiring.input_bits.get(source - words.len()).map(|(row, _)| *row);
        words.get(source).copied().or_else(bits)
    }

    /// The signal that a bit of a source makes active, or why it makes none active.
    fn bit(&self, source: usize, bit: u8) -> Result<Input, Ignored> {
        let wiring = &self.model.wiring;
        let words = wiring.input_words.as_ref().filter(|words| source < words.rows.len());
        let absent = &wiring.not_simulated;
        if let Some(words) = words {
            let position = (source as u16) << 4 | u16::from(bit);
            let enable = words.enabled_by.get(source).copied();
            let disabled = enable.filter(|row| self.bank.raw(*row) >> bit & 1 == 0);
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
        match self.overridden_by(*row, bit) {
            Some(row) => Err(Ignored::Overridden { row }),
            None if is_absent => Err(Ignored::NotSimulated),
            None => signal.ok_or(Ignored::Nothing),
        }
    }

    /// Why another level on input terminal `index` has no effect on its signal, if it has none, while `before` were
    /// active.
    pub(super) fn why_no_signal(&self, index: u8, before: Inputs) -> Option<Ignored> {
        let terminals = self.model.wiring.input_terminals.as_ref()?;
        let row = *terminals.functions.get(usize::from(index))?;
        let value = self.bank.value(&self.model, row);
        match terminals.meaning(self.bank.raw(row)) {
            _ if !self.powered => Some(Ignored::NoSupply),
            _ if self.is_stuck(index) => Some(Ignored::Stuck),
            None if self.is_absent(row) => None,
            None => Some(Ignored::NoFunction { row, value }),
            Some(signal) => (before.has(signal) == self.inputs.has(signal))
                .then_some(Ignored::OtherSource(signal)),
        }
    }

    /// Does `row` give a terminal a function that is not simulated?
    fn is_absent(&self, row: RowId) -> bool {
        let number = self.bank.raw(row);
        self.model
            .wiring
            .not_simulated
            .input_codes
            .iter()
            .any(|(code, _)| u32::from(*code) == number)
    }

    /// Takes note of rows that `plan` has written and that are only stored.
    pub(super) fn look_at_stored(&mut self, plan: &WritePlan) {
        let model = self.model.clone();
        for (id, raw) in plan.values() {
            let row = model.map.row(id);
            let (word, bit) = (usize::from(id.0 / 64), 1 << (id.0 % 64));
            if row.inert && self.no_effect.stored[word] & bit == 0 {
                self.no_effect.stored[word] |= bit;
                let order = Ordered::Write { row: id, value: row.kind.value(raw) };
                self.ignore(order, Ignored::StoredOnly);
            }
        }
    }

    /// The output word that `row` shows, if nothing of it is enabled; else it has been seen.
    pub(super) fn dark_word(&self, row: RowId) -> Option<u16> {
        let Some(Shows::OutputWord(word)) = self.model.wiring.shows(row) else { return None };
        let enable = self.model.wiring.output_words[usize::from(*word)].enabled_by?;
        (self.bank.raw(enable) == 0).then_some(*word)
    }

    /// Takes note of output words that were read and of which nothing is enabled, as bits.
    pub(super) fn look_at_dark(&mut self, read: u16) {
        if read | self.no_effect.dark == 0 {
            return;
        }
        let model = self.model.clone();
        let fresh = read & !self.no_effect.dark;
        self.no_effect.dark |= read;
        for (i, word) in model.wiring.output_words.iter().enumerate() {
            let Some(enable) = word.enabled_by else { continue };
            if self.bank.raw(enable) != 0 {
                self.no_effect.dark &= !(1 << i);
            }
            if fresh >> i & 1 != 0 {
                let why = Ignored::Disabled { row: enable, bit: None };
                self.ignore(Ordered::Read(word.row), why);
            }
        }
    }
}

/// Does it ask for a run as long as it is active?
fn asks_for_run(input: Input) -> bool {
    matches!(
        input,
        Input::JogPos
            | Input::JogNeg
            | Input::InchPos
            | Input::InchNeg
            | Input::Run
            | Input::SegmentRun
    )
}
