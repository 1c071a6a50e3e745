//! How a drive is spoken to: its unit address, how it talks, and how long a master may be silent.

use super::registers::Registers;
use super::timer::Timer;
use crate::behaviour::Watchdog;
use crate::event::DriveEvent;
use crate::model::{Applies, WireFormat};
use crate::serial::{Mode, Settings};
use crate::time::Instant;

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
    pub(super) fn power_on(&mut self, registers: &Registers) -> Option<DriveEvent> {
        self.silence.stop();
        self.unit = self.unit_asked_for(registers);
        let mode = self.mode_asked_for(registers);
        let from = std::mem::replace(&mut self.mode, mode);
        (from.is_some() && from != mode).then_some(DriveEvent::ModeChanged { from, to: mode })
    }

    /// Power goes off.
    pub(super) fn power_off(&mut self) {
        self.silence.stop();
    }

    /// Puts a new address, speed or format in force, as far as it does not wait for power-on. Returns what has changed.
    pub(super) fn follow_settings(&mut self, registers: &Registers) -> [Option<DriveEvent>; 2] {
        let line = &registers.model().line;
        let waits = |row| registers.model().map.row(row).applies == Some(Applies::PowerOn);
        let mode_waits = waits(line.baud.row) || waits(line.format.row);
        let unit = if waits(line.unit.row) { self.unit } else { self.unit_asked_for(registers) };
        let mode = if mode_waits { self.mode } else { self.mode_asked_for(registers) };
        let from = std::mem::replace(&mut self.unit, unit);
        let moved = (from != unit).then_some(DriveEvent::UnitChanged { from, to: unit });
        let from = std::mem::replace(&mut self.mode, mode);
        [moved, (from != mode).then_some(DriveEvent::ModeChanged { from, to: mode })]
    }

    /// A master spoke: from `now` on it has the time that a row says to speak again, or for ever.
    pub(super) fn on_request(&mut self, now: Instant, registers: &Registers) {
        let rule = registers.model().wiring.timeout.as_ref();
        self.silence.refresh(now, registers.hold_time(rule));
    }

    /// When the master will have been silent for too long.
    pub(super) fn timer(&self) -> Option<(Instant, Timer)> {
        self.silence.deadline().map(|at| (at, Timer::MasterSilence))
    }

    /// Has no master spoken in time? The next one who does starts the time anew.
    pub(super) fn take_silence(&mut self, now: Instant) -> bool {
        self.silence.expired(now).is_some()
    }

    /// The unit address that switches and parameters ask for.
    fn unit_asked_for(&self, registers: &Registers) -> u8 {
        let rule = &registers.model().line.unit;
        let register = registers.value(rule.row);
        let switches = self.switches & ((1u16 << rule.switches) - 1) as u8;
        match (switches, u8::try_from(register).unwrap_or(0)) {
            (0, 0) => rule.zero,
            (0, unit) => unit,
            (switches, _) => switches,
        }
    }

    /// The mode that the parameters ask for, or the switches in place of them.
    fn mode_asked_for(&self, registers: &Registers) -> Option<Mode> {
        let line = &registers.model().line;
        let (baud, format) = match line.baud_switches {
            0 => (
                line.baud.decode(registers.value(line.baud.row)),
                line.format.decode(registers.value(line.format.row)),
            ),
            _ => {
                let code = i64::from(self.switches >> line.unit.switches);
                let row = registers.model().map.row(line.format.row);
                let factory = line.format.decode(row.kind.value(row.init));
                (line.baud.codes.get(&code).copied(), factory)
            }
        };
        let WireFormat { ascii, format } = format?;
        Some(Mode { ascii, settings: Settings { baud: baud?, format } })
    }
}
