//! Input signals, gathered from terminals with their contacts, from words that a master holds, and from bits of rows.

use super::axis::AxisView;
use super::effects::EffectQueue;
use super::registers::Registers;
use super::timer::Timer;
use crate::behaviour::Watchdog;
use crate::event::{DriveEvent, RowName};
use crate::model::{Model, Monitor, Terminals};
use crate::time::{Duration, Instant};
use crate::vocabulary::{Input, Inputs, RowId};

/// The sources of input signals, and which signals they make active.
#[derive(Debug)]
pub(super) struct InputSignals {
    /// Signals on the input terminals, bit by bit.
    terminals: u16,
    contacts: Contacts,
    /// Watchdogs of the input words.
    words: Vec<Watchdog>,
    active: Inputs,
}

/// Contacts that stick or bounce.
#[derive(Debug, Default)]
struct Contacts {
    /// Terminals that stick, bit by bit, and the signals that they keep.
    stuck: u16,
    kept: u16,
    /// Terminals that bounce right now, bit by bit.
    bounced: u16,
    bounces: Vec<Bounce>,
}

#[derive(Debug)]
struct Bounce {
    bit: u16,
    index: u8,
    edges: u32,
    every: Duration,
    next: Instant,
}

impl Contacts {
    /// The signals of input terminals as they get through their contacts.
    fn signals(&self, wired: u32) -> u32 {
        let (stuck, kept) = (u32::from(self.stuck), u32::from(self.kept));
        (wired ^ u32::from(self.bounced)) & !stuck | kept & stuck
    }
}

impl InputSignals {
    /// With signals on `terminals`, bit by bit.
    pub(super) fn new(model: &Model, terminals: u16) -> Self {
        let words = model.wiring.input_words.as_ref().map_or(0, |words| words.rows.len());
        Self {
            terminals,
            contacts: Contacts::default(),
            words: vec![Watchdog::default(); words],
            active: Inputs::default(),
        }
    }

    /// The signals that are active.
    pub(super) fn active(&self) -> Inputs {
        self.active
    }

    /// Other signals are active. Returns those that were.
    pub(super) fn set_active(&mut self, active: Inputs) -> Inputs {
        std::mem::replace(&mut self.active, active)
    }

    /// Has terminal `index` a signal, whatever its contact makes of it?
    pub(super) fn terminal(&self, index: u8) -> bool {
        self.terminals >> index & 1 != 0
    }

    /// Puts a signal on terminal `index`, or takes it off.
    pub(super) fn set_terminal(&mut self, index: u8, signal: bool) {
        let bit = 1 << index;
        self.terminals = if signal { self.terminals | bit } else { self.terminals & !bit };
    }

    /// Is the contact on terminal `index` stuck?
    pub(super) fn is_stuck(&self, index: u8) -> bool {
        self.contacts.stuck >> index & 1 != 0
    }

    /// The contact on terminal `index` sticks at the signal that it has, or no longer.
    pub(super) fn set_stuck(&mut self, axis: AxisView<'_>, index: u8, on: bool) {
        let (bit, now) = (1 << index, self.signals(axis) as u16);
        let Contacts { stuck, kept, .. } = &mut self.contacts;
        *stuck = if on { *stuck | bit } else { *stuck & !bit };
        *kept = *kept & !bit | now & bit;
    }

    /// The contact on terminal `index` leaves its level and comes back so many `times`, from `now` on.
    pub(super) fn set_bounce(&mut self, now: Instant, index: u8, times: u16, every: Duration) {
        let bit = 1 << index;
        self.contacts.bounces.retain(|bounce| bounce.bit != bit);
        self.contacts.bounced &= !bit;
        let edges = u32::from(times) * 2;
        self.contacts.bounces.push(Bounce { bit, index, edges, every, next: now });
    }

    /// The next edges of contacts that bounce have come.
    pub(super) fn bounce(&mut self, axis: AxisView<'_>, out: &mut EffectQueue) {
        let now = axis.context().now;
        let mut edges = 0;
        for bounce in self.contacts.bounces.iter_mut().filter(|it| it.next <= now) {
            bounce.edges -= 1;
            bounce.next += bounce.every;
            self.contacts.bounced ^= bounce.bit;
            edges |= bounce.bit;
        }
        let signals = self.signals(axis);
        let free = edges & !self.contacts.stuck;
        for bounce in self.contacts.bounces.iter().filter(|it| it.bit & free != 0) {
            let signal = signals & u32::from(bounce.bit) != 0;
            let terminal = axis.context().registers.terminal_name(bounce.index);
            out.change(DriveEvent::Terminal { terminal, signal });
        }
        self.contacts.bounces.retain(|bounce| bounce.edges > 0);
    }

    /// When contacts bounce, and when words expire.
    pub(super) fn timers(&self) -> impl Iterator<Item = (Instant, Timer)> {
        let bounce = |it: &Bounce| (it.next, Timer::Bounce(it.index));
        self.contacts.bounces.iter().map(bounce).chain(self.word_timers())
    }

    /// When words expire.
    pub(super) fn word_timers(&self) -> impl Iterator<Item = (Instant, Timer)> {
        let words = (0u8..).map(Timer::HoldWord).zip(&self.words);
        words.filter_map(|(timer, word)| Some((word.deadline()?, timer)))
    }

    /// A master has written word `word`.
    pub(super) fn refresh_word(&mut self, now: Instant, word: u16, time: Option<Duration>) {
        self.words[usize::from(word)].refresh(now, time);
    }

    /// Word `word` is 0 and holds nothing.
    pub(super) fn stop_word(&mut self, word: u16) {
        self.words[usize::from(word)].stop();
    }

    /// No word holds anything.
    pub(super) fn stop_words(&mut self) {
        self.words.iter_mut().for_each(Watchdog::stop);
    }

    /// Words hold for `time` since they were written.
    pub(super) fn retime_words(&mut self, time: Option<Duration>) {
        self.words.iter_mut().for_each(|word| word.retime(time));
    }

    /// Lets words fall back to 0 that were not refreshed by `now`. Are there any?
    pub(super) fn expire_words(
        &mut self,
        now: Instant,
        registers: &mut Registers,
        out: &mut EffectQueue,
    ) -> bool {
        let model = registers.model().clone();
        let Some(words) = &model.wiring.input_words else { return false };
        let mut any = false;
        for (watchdog, word) in self.words.iter_mut().zip(&words.rows) {
            let (Some(held), Some(rule)) = (watchdog.expired(now), &words.hold) else { continue };
            registers.set(*word, 0);
            let held_ms = u32::try_from(held.as_millis()).unwrap_or(u32::MAX);
            let [word, hold] = [*word, rule.row].map(|row| RowName(registers.decoder(), row));
            out.change(DriveEvent::WordExpired { word, hold, held_ms });
            any = true;
        }
        any
    }

    /// The signals that their sources make active.
    pub(super) fn gather(&self, axis: AxisView<'_>) -> Inputs {
        let registers = axis.context().registers;
        let wiring = &registers.model().wiring;
        let mut inputs = Inputs::default();
        let mut insert = |signal| inputs.insert(signal);
        if let Some(terminals) = &wiring.input_terminals {
            self.active_codes(axis, &terminals.codes, &mut insert);
        }
        for signal in &wiring.machine_inputs {
            if axis.switch(*signal).is_some_and(|switch| axis.is_switched(switch)) {
                insert(*signal);
            }
        }
        if let Some(words) = &wiring.input_words {
            active_positions(registers, &words.positions, &mut insert);
        }
        active_bits(registers, &wiring.input_bits, &mut insert);
        inputs
    }

    /// What active terminals stand for, by their function numbers.
    pub(super) fn active_codes<S: Copy>(
        &self,
        axis: AxisView<'_>,
        codes: &[(u16, S)],
        mut each: impl FnMut(S),
    ) {
        let registers = axis.context().registers;
        let Some(terminals) = &registers.model().wiring.input_terminals else { return };
        let active = self.active_terminals(axis, terminals);
        for (i, row) in terminals.functions.iter().enumerate() {
            let number = registers.raw(*row);
            let function = codes.iter().find(|(code, _)| u32::from(*code) == number);
            function.filter(|_| active >> i & 1 != 0).into_iter().for_each(|(_, it)| each(*it));
        }
    }

    /// What has come of row `of` of those whose bits are signals, bit by bit.
    pub(super) fn bits(&self, registers: &Registers, of: usize) -> u32 {
        let (row, bits) = &registers.model().wiring.input_bits[of];
        bits.iter().fold(registers.raw(*row), |word, (bit, signal)| {
            word & !(1 << bit) | u32::from(self.active.has(*signal)) << bit
        })
    }

    /// Terminals as `monitor` shows them, bit by bit.
    pub(super) fn monitor(&self, axis: AxisView<'_>, monitor: Monitor) -> u32 {
        let registers = axis.context().registers;
        let Some(terminals) = &registers.model().wiring.input_terminals else { return 0 };
        let closed = registers.normally_closed(terminals);
        monitored(monitor, self.active_terminals(axis, terminals), closed, terminals)
    }

    /// Terminals that are active, bit by bit. One that has the function of a switch of the machine is wired to it, as a
    /// normally open or closed one.
    fn active_terminals(&self, axis: AxisView<'_>, terminals: &Terminals<Input>) -> u32 {
        self.signals_on(axis, terminals) ^ axis.context().registers.normally_closed(terminals)
    }

    /// The signals on the terminals, bit by bit.
    fn signals(&self, axis: AxisView<'_>) -> u32 {
        let terminals = axis.context().model().wiring.input_terminals.as_ref();
        terminals.map_or(0, |it| self.signals_on(axis, it))
    }

    fn signals_on(&self, axis: AxisView<'_>, terminals: &Terminals<Input>) -> u32 {
        let registers = axis.context().registers;
        let closed = registers.normally_closed(terminals);
        let mut active = u32::from(self.terminals) ^ closed;
        for (i, row) in terminals.functions.iter().enumerate() {
            let signal = terminals.meaning(registers.raw(*row));
            let switch = signal.and_then(|signal| axis.switch(signal));
            if let Some(switch) = switch.filter(|it| axis.has_switch(*it)) {
                let on = axis.is_switched(switch) || u32::from(self.terminals) >> i & 1 != 0;
                active = active & !(1 << i) | u32::from(on) << i;
            }
        }
        self.contacts.signals(active ^ closed)
    }
}

/// What enabled bits of input words stand for, by their positions.
pub(super) fn active_positions<S: Copy>(
    registers: &Registers,
    positions: &[(u16, S)],
    mut each: impl FnMut(S),
) {
    let Some(words) = &registers.model().wiring.input_words else { return };
    for (position, it) in positions {
        let (word, bit) = (usize::from(position / 16), position % 16);
        let enabled = words.enabled_by.get(word).is_none_or(|row| registers.is_set(*row, bit));
        if enabled && registers.is_set(words.rows[word], bit) {
            each(*it);
        }
    }
}

/// What bits of rows stand for that no setting overrides.
pub(super) fn active_bits<S: Copy>(
    registers: &Registers,
    rows: &[(RowId, Vec<(u8, S)>)],
    mut each: impl FnMut(S),
) {
    for (row, bits) in rows {
        for (bit, it) in bits {
            let is_set = registers.is_set(*row, u16::from(*bit));
            if is_set && registers.overridden_by(*row, *bit).is_none() {
                each(*it);
            }
        }
    }
}

/// `terminals` as `monitor` shows them, where those in `active` are active and those in `closed` normally closed.
pub(super) fn monitored<S>(
    monitor: Monitor,
    active: u32,
    closed: u32,
    terminals: &Terminals<S>,
) -> u32 {
    let all = (1u32 << terminals.functions.len()) - 1;
    match monitor {
        Monitor::Active => active,
        // A normally closed terminal carries a signal while it is inactive.
        Monitor::Signal => active ^ closed,
        Monitor::NoSignal => !(active ^ closed) & all,
    }
}
