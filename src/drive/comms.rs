//! How a drive is spoken to: its unit address, how it talks, and how long a master may be silent.

use crate::bank::Bank;
use crate::behaviour::Watchdog;
use crate::event::Change;
use crate::model::{Applies, Model, WireFormat};
use crate::serial::{Mode, Settings};
use crate::time::{Duration, Instant};

/// What a drive answers to, and when it gives its master up.
#[derive(Debug)]
pub(super) struct Comms {
    /// The DIP switches: those of the address, above them those of the speed.
    switches: u8,
    unit: u8,
    mode: Option<Mode>,
    /// How long the master may be silent.
    silence: Watchdog,
}

impl Comms {
    /// Without supply.
    pub(super) fn new(switches: u8) -> Self {
        Self { switches, unit: 0, mode: None, silence: Watchdog::default() }
    }

    /// The unit address in force.
    pub(super) fn unit(&self) -> u8 {
        self.unit
    }

    /// The mode in force.
    pub(super) fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// The DIP switches.
    pub(super) fn switches(&self) -> u8 {
        self.switches
    }

    /// Power comes on: what switches and parameters ask for is in force. Returns the change of a mode that there was before.
    pub(super) fn power_on(&mut self, model: &Model, bank: &Bank) -> Option<Change> {
        self.silence.stop();
        self.unit = self.unit_asked_for(model, bank);
        let mode = self.mode_asked_for(model, bank);
        let from = std::mem::replace(&mut self.mode, mode);
        (from.is_some() && from != mode).then_some(Change::Mode { from, to: mode })
    }

    /// Power goes off.
    pub(super) fn power_off(&mut self) {
        self.silence.stop();
    }

    /// Puts a new address, speed or format in force, as far as it does not wait for power-on. Returns what has changed.
    pub(super) fn follow_settings(&mut self, model: &Model, bank: &Bank) -> [Option<Change>; 2] {
        let line = &model.line;
        let waits = |row| model.map.row(row).applies == Some(Applies::PowerOn);
        let mode_waits = waits(line.baud.row) || waits(line.format.row);
        let unit = if waits(line.unit.row) { self.unit } else { self.unit_asked_for(model, bank) };
        let mode = if mode_waits { self.mode } else { self.mode_asked_for(model, bank) };
        let from = std::mem::replace(&mut self.unit, unit);
        let moved = (from != unit).then_some(Change::Unit { from, to: unit });
        let from = std::mem::replace(&mut self.mode, mode);
        [moved, (from != mode).then_some(Change::Mode { from, to: mode })]
    }

    /// A master spoke: from `now` on it has `time` to speak again, or for ever.
    pub(super) fn hear(&mut self, now: Instant, time: Option<Duration>) {
        self.silence.refresh(now, time);
    }

    /// When the master will have been silent for too long.
    pub(super) fn silent_at(&self) -> Option<Instant> {
        self.silence.deadline()
    }

    /// Has no master spoken in time? The next one who does starts the time anew.
    pub(super) fn take_silence(&mut self, now: Instant) -> bool {
        self.silence.expired(now).is_some()
    }

    /// The unit address that switches and parameters ask for.
    fn unit_asked_for(&self, model: &Model, bank: &Bank) -> u8 {
        let rule = &model.line.unit;
        let register = bank.value(model, rule.row);
        let switches = self.switches & ((1u16 << rule.switches) - 1) as u8;
        match (switches, u8::try_from(register).unwrap_or(0)) {
            (0, 0) => rule.zero,
            (0, unit) => unit,
            (switches, _) => switches,
        }
    }

    /// The mode that the parameters ask for, or the switches in place of them.
    fn mode_asked_for(&self, model: &Model, bank: &Bank) -> Option<Mode> {
        let line = &model.line;
        let (baud, format) = match line.baud_switches {
            0 => (
                line.baud.decode(bank.value(model, line.baud.row)),
                line.format.decode(bank.value(model, line.format.row)),
            ),
            _ => {
                let code = i64::from(self.switches >> line.unit.switches);
                let row = model.map.row(line.format.row);
                let factory = line.format.decode(row.kind.value(row.init));
                (line.baud.codes.get(&code).copied(), factory)
            }
        };
        let WireFormat { ascii, format } = format?;
        Some(Mode { ascii, settings: Settings { baud: baud?, format } })
    }
}
