//! Resolves the wiring of a file: names to rows, words to roles.

use super::not_simulated::split;
use super::{
    Alarm, AlarmStop, HoldTime, InputWords, Monitor, OutputWords, Reaction, ServoWiring, Shows,
    Terminals, Wiring,
};
use crate::model::raw::{
    RawAlarmStop, RawHold, RawInputs, RawLine, RawModel, RawOutputs, RawShows, RawTerminals,
};
use crate::model::rows::Compiled;
use crate::problem::{At, Path, Problem};
use crate::time::Duration;
use crate::units::Dimension;
use crate::vocabulary::RowId;
use crate::vocabulary::{AlarmCause, Input, Taken};

pub(in crate::model) fn compile(
    raw: &RawModel,
    rows: &Compiled,
    problems: &mut Vec<Problem>,
) -> Wiring {
    let len = rows.map.len();
    let wiring = Wiring {
        shows: vec![None; len],
        reactions: vec![Reaction::None; len],
        ..Wiring::default()
    };
    let mut wirer = Wirer { rows, problems, wiring, taken: Taken::AtOrder };
    wirer.quantities(raw);
    let signals = Path::root().key("signals");
    wirer.inputs(&raw.signals.inputs, &signals.key("inputs"));
    wirer.outputs(&raw.signals.outputs, &signals.key("outputs"));
    wirer.digits_not_simulated();
    wirer.thresholds_fit();
    wirer.line(&raw.line);
    wirer.servo(raw);
    wirer.alarms(raw);
    raw.homing.iter().for_each(|homing| wirer.homing(homing));
    wirer.limits(raw.limits.as_ref());
    wirer.axis(raw.axis.as_ref());
    wirer.settings_taken(raw);
    wirer.deviation_fits();
    wirer.alarm_history(&raw.alarm_history);
    wirer.alarms_fit(raw);
    wirer.wiring
}

/// What everything below needs: rows to find, a place for problems, the result.
pub(super) struct Wirer<'a> {
    pub(super) rows: &'a Compiled,
    pub(super) problems: &'a mut Vec<Problem>,
    pub(super) wiring: Wiring,
    /// When settings count of which the file says nothing.
    pub(super) taken: Taken,
}

impl Wirer<'_> {
    /// Rows that are not there were told of with the line.
    fn line(&mut self, raw: &RawLine) {
        let path = Path::root().key("line");
        let registers = [
            ("unit", &raw.unit.register),
            ("baud", &raw.baud.register),
            ("format", &raw.format.register),
        ];
        // Switches that hold the speed leave nothing to do for its row, nor for that of the format.
        let by_rows = if raw.baud.switches.is_some() { 1 } else { registers.len() };
        for (key, register) in registers.into_iter().take(by_rows) {
            if let Some((row, _)) = self.rows.map.rows().find(|(_, row)| row.id == *register) {
                self.react(row, Reaction::Line, &path.key(key).key("register"), At::Value);
            }
        }
        if let Some(raw) = &raw.timeout {
            let path = path.key("timeout");
            let timeout = self.hold(raw, &path);
            if let Some(timeout) = &timeout {
                self.react(timeout.row, Reaction::Timeout, &path.key("register"), At::Value);
            }
            self.wiring.timeout = timeout;
        }
    }

    fn inputs(&mut self, raw: &RawInputs, path: &Path) {
        let prefix = prefix(raw.terminals.as_ref());
        let codes = self.codes(&raw.codes, prefix, &path.key("codes"), |wirer, name, path| {
            wirer.word::<Input>(name, "input signal", path)
        });
        self.codes_used(&raw.codes, raw.terminals.is_some() || raw.words.is_some(), path);
        for (i, name) in raw.machine.iter().enumerate() {
            let path = path.key("machine").index(i);
            if raw.machine[..i].contains(name) {
                self.problems.push(Problem::value(path, format!("`{name}` is listed twice")));
                continue;
            }
            let signal = self.switch(name, &path);
            self.wiring.machine_inputs.extend(signal);
        }
        if let Some(raw) = &raw.terminals {
            let path = path.key("terminals");
            self.monitor(raw, &path, Shows::InputTerminals);
            let signals = split(&codes, &mut self.wiring.not_simulated.input_codes);
            let terminals = self.terminals(raw, &path, signals);
            for row in terminals.functions.clone().into_iter().chain(terminals.normally_closed) {
                self.react(row, Reaction::Inputs, &path, At::Key);
            }
            self.wiring.input_terminals = Some(terminals);
        }
        if let Some(raw) = &raw.words {
            let path = path.key("words");
            let (rows, enabled_by) = self.words(&raw.registers, &raw.enabled_by, &path);
            for (i, row) in rows.iter().enumerate() {
                let path = path.key("registers").index(i);
                self.writable(*row, &path, At::Value);
                self.react(*row, Reaction::InputWord(i as u16), &path, At::Value);
            }
            for (i, row) in enabled_by.iter().enumerate() {
                self.react(*row, Reaction::Inputs, &path.key("enabled_by").index(i), At::Value);
            }
            let by_terminals = self.wiring.input_terminals.is_some();
            let words = raw.registers.len();
            let positions = self.positions(&codes, &raw.positions, words, by_terminals, &path);
            let positions = split(&positions, &mut self.wiring.not_simulated.input_positions);
            let hold = raw.hold.as_ref().and_then(|raw| self.hold(raw, &path.key("hold")));
            self.wiring.input_words = Some(InputWords { rows, enabled_by, positions, hold });
        }
        for (register, bits) in &raw.bits {
            let path = path.key("bits").key(register);
            let Some(row) = self.row_key(register, &path) else { continue };
            self.writable(row, &path, At::Key);
            let (mut map, mut absent) = (Vec::new(), Vec::new());
            for (bit, name) in bits {
                let path = path.key(bit);
                self.bit(*bit, row, &path);
                let place = self.place_of_bit(row, *bit);
                match self.not_simulated(name, &place, &path) {
                    Some(index) => absent.push((*bit, index)),
                    None => {
                        let signal = self.word::<Input>(name, "input signal", &path);
                        map.extend(signal.map(|it| (*bit, it)));
                    }
                }
            }
            self.react(row, Reaction::Inputs, &path, At::Key);
            self.wiring.input_bits.push((row, map));
            self.wiring.not_simulated.input_bits.push((row, absent));
        }
        for (monitor, register) in &raw.monitors {
            let path = path.key("monitors").key(monitor);
            let Some(row) = self.row_key(monitor, &path) else { continue };
            let Some(of) = self.row(register, &path) else { continue };
            match self.wiring.input_bits.iter().position(|(row, _)| *row == of) {
                Some(index) => self.show(row, Shows::InputBits(index), &path, At::Key),
                None => {
                    let what = format!("{register} is not a row of `bits`");
                    self.problems.push(Problem::value(path, what));
                }
            }
        }
        self.bit_overrides(raw, &path.key("claims"));
        self.commands(&raw.commands, &path.key("commands"));
        self.triggers(&raw.triggers, &path.key("triggers"));
    }

    fn outputs(&mut self, raw: &RawOutputs, path: &Path) {
        let prefix = prefix(raw.terminals.as_ref());
        let codes = self.codes(&raw.codes, prefix, &path.key("codes"), |wirer, name, path| {
            wirer.shown(name, path)
        });
        self.codes_used(&raw.codes, raw.terminals.is_some() || raw.words.is_some(), path);
        if let Some(raw) = &raw.terminals {
            let path = path.key("terminals");
            self.monitor(raw, &path, Shows::OutputTerminals);
            let signals = split(&codes, &mut self.wiring.not_simulated.output_codes);
            self.wiring.output_terminals = Some(self.terminals(raw, &path, signals));
        }
        if let Some(raw) = &raw.words {
            let path = path.key("words");
            let (rows, enabled_by) = self.words(&raw.registers, &raw.enabled_by, &path);
            for (i, row) in rows.iter().enumerate() {
                let path = path.key("registers").index(i);
                self.show(*row, Shows::OutputWord(i as u16), &path, At::Value);
            }
            let words = raw.registers.len();
            let by_terminals = self.wiring.output_terminals.is_some();
            let positions = self.positions(&codes, &raw.positions, words, by_terminals, &path);
            let positions = split(&positions, &mut self.wiring.not_simulated.output_positions);
            self.wiring.output_words = Some(OutputWords { enabled_by, positions });
        }
        for (register, bits) in &raw.bits {
            let path = path.key("bits").key(register);
            let Some(row) = self.row_key(register, &path) else { continue };
            let mut map = Vec::new();
            for (bit, name) in bits {
                let path = path.key(bit);
                self.bit(*bit, row, &path);
                map.extend(self.shown(name, &path).map(|it| (*bit, it)));
            }
            self.show(row, Shows::Bits(map), &path, At::Key);
        }
        self.user_outputs(raw.user.as_deref(), path);
    }

    /// Words of signals with their enable words: the rows of both.
    fn words(
        &mut self,
        registers: &[String],
        enabled_by: &[String],
        path: &Path,
    ) -> (Vec<RowId>, Vec<RowId>) {
        let rows = self.row_list(registers, &path.key("registers"));
        for (i, row) in rows.iter().enumerate() {
            self.one_word(*row, &path.key("registers").index(i));
        }
        (rows, self.enable_words(enabled_by, registers.len(), path))
    }

    fn terminals<S>(
        &mut self,
        raw: &RawTerminals,
        path: &Path,
        codes: Vec<(u16, S)>,
    ) -> Terminals<S> {
        let functions = self.row_list(&raw.functions, &path.key("functions"));
        if functions.len() > 16 {
            let what = "a word has 16 bits, one per terminal";
            self.problems.push(Problem::value(path.key("functions"), what));
        }
        let normally_closed = match &raw.normally_closed {
            Some(register) => self.row(register, &path.key("normally_closed")),
            None => None,
        };
        let (prefix, first) = (raw.prefix.clone(), raw.first);
        Terminals { prefix, first, functions, normally_closed, codes }
    }

    fn monitor(&mut self, raw: &RawTerminals, path: &Path, shows: fn(Monitor) -> Shows) {
        let Some(monitor) = &raw.monitor else { return };
        let path = path.key("monitor").key("register");
        let Some(row) = self.row(&monitor.register, &path) else { return };
        let kind = match monitor.shows {
            RawShows::Signal => Monitor::Signal,
            RawShows::NoSignal => Monitor::NoSignal,
            RawShows::Active => Monitor::Active,
        };
        self.show(row, shows(kind), &path, At::Value);
    }

    fn hold(&mut self, raw: &RawHold, path: &Path) -> Option<HoldTime> {
        let row = self.row(&raw.register, &path.key("register"))?;
        let unit = self.rows.map.row(row).unit;
        if unit.dimension != Dimension::Time {
            let what = format!("{} must be a time", raw.register);
            let problem = Problem::value(path.key("register"), what);
            self.problems.push(problem.advise("give the row `unit: s` or `unit: ms`"));
        }
        let zero = self.duration(raw.zero.as_deref(), &path.key("zero"));
        Some(HoldTime { row, unit, zero })
    }

    fn servo(&mut self, raw: &RawModel) {
        let path = Path::root().key("servo").key("ready_after");
        let ready_after = self.duration(raw.servo.ready_after.as_deref(), &path);
        self.wiring.servo = ServoWiring {
            ready_after: ready_after.unwrap_or(Duration::ZERO),
            enabled_at_power_on: raw.servo.enabled_at_power_on,
        };
    }

    fn alarms(&mut self, raw: &RawModel) {
        for (name, alarm) in &raw.alarms {
            let path = Path::root().key("alarms").key(name);
            if alarm.code == 0 {
                let what = "code 0 means no alarm";
                self.problems.push(Problem::value(path.key("code"), what));
            }
            let cause = self.word_key::<AlarmCause>(name, "alarm cause", &path);
            let (code, resettable, stop) = (alarm.code, alarm.resettable, stop(alarm.stop));
            let bus_voltage = alarm.bus_voltage.as_ref().and_then(|it| self.bus_voltage(it, &path));
            let alarm = cause.map(|cause| Alarm { cause, code, resettable, bus_voltage, stop });
            self.wiring.alarms.extend(alarm);
        }
    }
}

/// What the log writes before a function number.
fn prefix(terminals: Option<&RawTerminals>) -> &str {
    terminals.map_or("function", |it| it.prefix.as_str())
}

fn stop(raw: RawAlarmStop) -> AlarmStop {
    match raw {
        RawAlarmStop::Coast => AlarmStop::Coast,
        RawAlarmStop::Ramp => AlarmStop::Ramp,
        RawAlarmStop::Quick => AlarmStop::Quick,
    }
}
