//! Input signals gathered from terminals, words and bits; output signals told from the state.

use super::Drive;
use crate::behaviour::PowerLevels;
use crate::event::{Ignored, Ordered};
use crate::model::{Monitor, Shown, Terminals};
use crate::motion::Switch;
use crate::time::Instant;
use crate::vocabulary::{AlarmCause, HomeStarter, Input, Inputs, Output, Outputs, RowId};

impl Drive {
    /// Looks at every source again and tells the behaviours what changed.
    pub(super) fn gather_inputs(&mut self) {
        if !self.powered {
            return;
        }
        let now = self.active_inputs(self.now);
        let before = std::mem::replace(&mut self.inputs, now);
        let risen = now.risen_since(before);
        self.look_at_inputs(before);
        self.look_at_what_is_so(risen);
        if now.has(Input::AlarmForce) {
            let order = risen.has(Input::AlarmForce).then_some(Ordered::Input(Input::AlarmForce));
            self.trip_by(AlarmCause::Forced, order);
        }
        self.uphold_causes();
        if risen.has(Input::AlarmReset) {
            let done = self.power_stage.reset();
            self.report_power_stage();
            self.heed(Input::AlarmReset, done);
        }
        self.power_stage.set_levels(PowerLevels {
            enable: now.has(Input::ServoOn),
            release: now.has(Input::Release),
            inhibit: now.has(Input::EnableInhibit),
        });
        self.report_power_stage();
        if before.risen_since(now).has(Input::ServoOn) && self.power_stage.is_latched_on() {
            self.ignore(Ordered::InputOff(Input::ServoOn), Ignored::Latched);
        }
        self.select_velocity();
        self.update_axis();
        if risen.has(Input::HomeStart) {
            self.home_by(HomeStarter::Input);
        }
        self.start_by_inputs(risen);
        self.tell_not_simulated();
    }

    /// Tells of signals that ask for what is so already.
    fn look_at_what_is_so(&mut self, risen: Inputs) {
        let enabled = self.power_stage.is_enabled();
        let so = [
            (Input::ServoOn, enabled.then_some(Ignored::AlreadyOn)),
            (Input::Release, (!enabled).then_some(Ignored::AlreadyOff)),
            (Input::Stop, self.why_no_stop(false)),
            (Input::QuickStop, self.why_no_stop(true)),
            (Input::InterruptUnlock, (!self.can_unlock_interrupt()).then_some(Ignored::NotLocked)),
        ];
        for (input, why) in so {
            if let Some(why) = why.filter(|_| risen.has(input)) {
                self.ignore(Ordered::Input(input), why);
            }
        }
    }

    /// The output signals, right now.
    pub(super) fn outputs(&self, now: Instant) -> Outputs {
        if !self.powered {
            return Outputs::default();
        }
        let enabled = self.power_stage.is_enabled();
        let beyond = |forward: bool| {
            self.soft_limits().is_some_and(|[low, high]| {
                let position = self.motor.state(now).position;
                if forward { position > high as f64 } else { position < low as f64 }
            })
        };
        let user = self.model.wiring.user_outputs.map_or(0, |row| self.bank.raw(row));
        let outputs = Outputs::default()
            .with(Output::Powered, true)
            .with(Output::Ready, self.power_stage.is_ready())
            .with(Output::Enabled, enabled)
            .with(Output::Alarm, self.power_stage.alarm().is_some())
            .with(Output::BrakeOpen, enabled)
            .with(Output::Moving, self.motor.is_moving() || self.motor.speed(now) != 0.0)
            .with(Output::HomeDone, self.home_done)
            .with(Output::AtLimitPos, self.inputs.has(Input::LimitPos))
            .with(Output::AtLimitNeg, self.inputs.has(Input::LimitNeg))
            .with(Output::BeyondPos, beyond(true))
            .with(Output::BeyondNeg, beyond(false))
            .with(Output::Selected0, self.inputs.has(Input::Select0))
            .with(Output::Selected1, self.inputs.has(Input::Select1))
            .with(Output::Selected2, self.inputs.has(Input::Select2))
            .with(Output::Selected3, self.inputs.has(Input::Select3))
            .with(Output::Segment0, self.segment & 1 != 0)
            .with(Output::Segment1, self.segment & 2 != 0)
            .with(Output::Segment2, self.segment & 4 != 0)
            .with(Output::Segment3, self.segment & 8 != 0)
            .with(Output::Segment4, self.segment & 16 != 0)
            .with(Output::User0, user & 1 != 0)
            .with(Output::User1, user >> 1 & 1 != 0)
            .with(Output::User2, user >> 2 & 1 != 0);
        self.with_positions(now, self.with_speeds(now, outputs))
    }

    /// What has come of row `of` of those whose bits are signals, bit by bit.
    pub(super) fn input_bits(&self, of: usize) -> u32 {
        let (row, bits) = &self.model.wiring.input_bits[of];
        bits.iter().fold(self.bank.raw(*row), |word, (bit, signal)| {
            word & !(1 << bit) | u32::from(self.inputs.has(*signal)) << bit
        })
    }

    /// Input terminals as `monitor` shows them, bit by bit.
    pub(super) fn monitor_inputs(&self, now: Instant, monitor: Monitor) -> u32 {
        let Some(terminals) = &self.model.wiring.input_terminals else { return 0 };
        let closed = self.normally_closed(terminals);
        monitored(monitor, self.active_terminals(now, terminals), closed, terminals)
    }

    /// Output terminals as `monitor` shows them, bit by bit.
    pub(super) fn monitor_outputs(&self, now: Instant, monitor: Monitor) -> u32 {
        let Some(terminals) = &self.model.wiring.output_terminals else { return 0 };
        let outputs = self.outputs(now);
        let mut active = 0;
        for (i, row) in terminals.functions.iter().enumerate() {
            let shown = terminals.meaning(self.bank.raw(*row));
            active |= u32::from(shown.is_some_and(|shown| shown.is_active(outputs))) << i;
        }
        monitored(monitor, active, self.normally_closed(terminals), terminals)
    }

    /// Input terminals that are active, bit by bit. One that has the function of a switch of the machine is wired
    /// to it, as a normally open or closed one.
    fn active_terminals(&self, now: Instant, terminals: &Terminals<Input>) -> u32 {
        self.signals_on(now, terminals) ^ self.normally_closed(terminals)
    }

    /// The signals on input terminals, bit by bit.
    pub(super) fn terminal_signals(&self, now: Instant) -> u32 {
        self.model.wiring.input_terminals.as_ref().map_or(0, |it| self.signals_on(now, it))
    }

    fn signals_on(&self, now: Instant, terminals: &Terminals<Input>) -> u32 {
        let closed = self.normally_closed(terminals);
        let mut active = u32::from(self.terminals) ^ closed;
        for (i, row) in terminals.functions.iter().enumerate() {
            let signal = terminals.meaning(self.bank.raw(*row));
            let switch = signal.and_then(|signal| self.switch(signal));
            if let Some(switch) = switch.filter(|it| self.motor.machine().has(*it)) {
                let on = self.is_switched(now, switch) || u32::from(self.terminals) >> i & 1 != 0;
                active = active & !(1 << i) | u32::from(on) << i;
            }
        }
        self.device_faults.signals(active ^ closed)
    }

    /// The switch of the machine that `signal` is wired to. Which end of the machine is its positive one does not
    /// depend on which way the drive counts.
    fn switch(&self, signal: Input) -> Option<Switch> {
        match (signal, self.reversed) {
            (Input::HomeSwitch, _) => Some(Switch::Home),
            (Input::LimitPos, false) | (Input::LimitNeg, true) => Some(Switch::PositiveLimit),
            (Input::LimitNeg, false) | (Input::LimitPos, true) => Some(Switch::NegativeLimit),
            _ => None,
        }
    }

    fn is_switched(&self, now: Instant, switch: Switch) -> bool {
        let state = self.motor.state(now);
        self.motor.machine().is_active(switch, state.position)
    }

    pub(super) fn active_inputs(&self, now: Instant) -> Inputs {
        let wiring = &self.model.wiring;
        let mut inputs = Inputs::default();
        let mut insert = |signal| inputs.insert(signal);
        if let Some(terminals) = &wiring.input_terminals {
            self.active_codes(now, &terminals.codes, &mut insert);
        }
        for signal in &wiring.machine_inputs {
            if self.switch(*signal).is_some_and(|switch| self.is_switched(now, switch)) {
                insert(*signal);
            }
        }
        if let Some(words) = &wiring.input_words {
            self.active_positions(&words.positions, &mut insert);
        }
        self.active_bits(&wiring.input_bits, &mut insert);
        inputs
    }

    /// What active input terminals stand for, by their function numbers.
    pub(super) fn active_codes<S: Copy>(
        &self,
        now: Instant,
        codes: &[(u16, S)],
        mut each: impl FnMut(S),
    ) {
        let Some(terminals) = &self.model.wiring.input_terminals else { return };
        let active = self.active_terminals(now, terminals);
        for (i, row) in terminals.functions.iter().enumerate() {
            let number = self.bank.raw(*row);
            let function = codes.iter().find(|(code, _)| u32::from(*code) == number);
            function.filter(|_| active >> i & 1 != 0).into_iter().for_each(|(_, it)| each(*it));
        }
    }

    /// What enabled bits of input words stand for, by their positions.
    pub(super) fn active_positions<S: Copy>(
        &self,
        positions: &[(u16, S)],
        mut each: impl FnMut(S),
    ) {
        let Some(words) = &self.model.wiring.input_words else { return };
        for (position, it) in positions {
            let (word, bit) = (usize::from(position / 16), position % 16);
            let enabled = words.enabled_by.get(word).is_none_or(|row| self.is_set(*row, bit));
            if enabled && self.is_set(words.rows[word], bit) {
                each(*it);
            }
        }
    }

    /// What bits of rows stand for that nobody bit_overrides.
    pub(super) fn active_bits<S: Copy>(
        &self,
        rows: &[(RowId, Vec<(u8, S)>)],
        mut each: impl FnMut(S),
    ) {
        for (row, bits) in rows {
            for (bit, it) in bits {
                if self.is_set(*row, u16::from(*bit)) && !self.is_overridden(*row, *bit) {
                    each(*it);
                }
            }
        }
    }

    fn is_set(&self, row: RowId, bit: u16) -> bool {
        self.bank.raw(row) >> bit & 1 != 0
    }

    /// Is the signal of this bit somebody else's?
    fn is_overridden(&self, row: RowId, bit: u8) -> bool {
        self.overridden_by(row, bit).is_some()
    }

    /// The setting that gives the signal of this bit to somebody else.
    pub(super) fn overridden_by(&self, row: RowId, bit: u8) -> Option<RowId> {
        let mut bit_overrides =
            self.model.wiring.bit_overrides.iter().filter(|it| (it.row, it.bit) == (row, bit));
        let claim = bit_overrides
            .find(|claim| claim.by.of(self.bank.value(&self.model, claim.by.row)) != 0);
        claim.map(|claim| claim.by.row)
    }

    fn normally_closed<S>(&self, terminals: &Terminals<S>) -> u32 {
        let all = (1u32 << terminals.functions.len()) - 1;
        terminals.normally_closed.map_or(0, |row| self.bank.raw(row) & all)
    }
}

impl Shown {
    /// Does it show as active, issued the signals?
    pub(super) fn is_active(self, outputs: Outputs) -> bool {
        outputs.has(self.signal) != self.inverted
    }
}

fn monitored<S>(monitor: Monitor, active: u32, closed: u32, terminals: &Terminals<S>) -> u32 {
    let all = (1u32 << terminals.functions.len()) - 1;
    match monitor {
        Monitor::Active => active,
        // A normally closed terminal carries a signal while it is inactive.
        Monitor::Signal => active ^ closed,
        Monitor::NoSignal => !(active ^ closed) & all,
    }
}
