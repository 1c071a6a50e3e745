//! What can be done to drives from outside their line: by a test, a bench, later a control port.

use super::Bus;
use crate::drive::Drive;
use crate::event::{DeviceFault, DriveId, EventKind, Remark};
use crate::medium::{FaultRule, LineBehaviour};
use crate::time::{Duration, Instant};
use crate::vocabulary::{AlarmCause, Named};
use std::ops::RangeInclusive;
use thiserror::Error;

/// The times that a contact which bounces may take from one edge to the next: a contact does nothing faster, and what
/// is slower is no bounce.
pub const BETWEEN_EDGES: RangeInclusive<Duration> =
    Duration::from_micros(1)..=Duration::from_secs(60);

/// Something to do from outside: by a scenario, a test, a control port. Whoever gives it, it goes through
/// [`Bus::command`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Command {
    /// To the line.
    Line(LineCommand),
    /// To one drive.
    Drive(DriveId, DriveOrder),
}

/// Something to do to a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineCommand {
    /// Put a fault rule behind those of the line.
    AddFault(FaultRule),
    /// Take the fault rule of that name off the line. What it holds back still leaves.
    RemoveFault(String),
    /// Give the line this behaviour from now on, in place of what it has.
    SetBehaviour(LineBehaviour),
    /// Tell of a step of a scenario.
    Tell(Remark),
}

/// Something to do to a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveOrder {
    /// Put a signal on an input terminal, or take it off.
    Terminal {
        /// Which terminal, from 0.
        index: u8,
        /// Carries a signal?
        signal: bool,
    },
    /// Have the contact on an input terminal bounce.
    Bounce {
        /// Which terminal, from 0.
        index: u8,
        /// So many times it leaves its level and comes back; 1 at least.
        times: u16,
        /// From one edge to the next, one of [`BETWEEN_EDGES`]; the first comes at once.
        every: Duration,
    },
    /// Trip with an alarm.
    Raise(AlarmCause),
    /// Something is wrong with the device from now on, or no longer.
    DeviceFault {
        /// What.
        device_fault: DeviceFault,
        /// From now on?
        on: bool,
    },
    /// Power on or off; all stations of the device with it. What is there already stays.
    Power(bool),
    /// Power off and on; all stations of the device with it.
    PowerCycle,
}

impl From<LineCommand> for Command {
    fn from(command: LineCommand) -> Self {
        Self::Line(command)
    }
}

/// The answer to a command that was carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reply {
    /// Done.
    Done,
}

/// Why a command was not carried out.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CommandError {
    /// No such drive.
    #[error("no drive {0} on this line")]
    NoDrive(u16),
    /// No such terminal.
    #[error("the drive has {have} input terminals; there is no number {got}")]
    NoTerminal {
        /// Asked for, from 0.
        got: u8,
        /// There are this many.
        have: usize,
    },
    /// A contact does not bounce so.
    #[error("a contact bounces 1 to 65535 times, with 1us to 1min between edges")]
    NoBounce,
    /// Nothing can happen in a drive that has no power.
    #[error("the drive has no power")]
    NoPower,
    /// The model has no alarm for the cause.
    #[error("the model has no alarm for `{0}`")]
    NoAlarm(&'static str),
    /// Another rule has the name.
    #[error("duplicate fault rule `{0}` on this line")]
    FaultTaken(String),
    /// No such rule.
    #[error("no fault rule `{0}` on this line")]
    NoFault(String),
    /// The rule can do nothing on this line.
    #[error("`{name}` has no effect here: {why}")]
    IdleFault {
        /// The rule.
        name: String,
        /// Why.
        why: &'static str,
    },
}

/// Makes sure that there is such an input terminal.
fn terminal(drive: &Drive, index: u8) -> Result<(), CommandError> {
    let terminals = drive.model().wiring.input_terminals.as_ref();
    let have = terminals.map_or(0, |terminals| terminals.functions.len());
    if usize::from(index) < have {
        Ok(())
    } else {
        Err(CommandError::NoTerminal { got: index, have })
    }
}

impl Bus {
    /// Carries out a command from outside the line at `now`.
    ///
    /// # Errors
    /// If there is no such drive, terminal, alarm or rule; nothing has happened then, but time.
    pub fn command(&mut self, now: Instant, command: Command) -> Result<Reply, CommandError> {
        self.advance_to(now);
        let reply = match command {
            Command::Line(command) => self.line_command(command),
            Command::Drive(drive, order) => self.drive_order(drive, order),
        };
        self.stations.ids().for_each(|id| self.after_drive(id));
        reply
    }

    fn line_command(&mut self, command: LineCommand) -> Result<Reply, CommandError> {
        match command {
            LineCommand::AddFault(rule) => return self.add_fault(rule),
            LineCommand::RemoveFault(name) => return self.remove_fault(name),
            LineCommand::SetBehaviour(behaviour) => self.medium.set_behaviour(self.now, behaviour),
            LineCommand::Tell(remark) => self.emit(EventKind::Step(remark)),
        }
        Ok(Reply::Done)
    }

    fn drive_order(&mut self, id: DriveId, order: DriveOrder) -> Result<Reply, CommandError> {
        let now = self.now;
        let drive = self.stations.get_mut(id).ok_or(CommandError::NoDrive(id.0))?;
        match order {
            DriveOrder::Terminal { index, signal } => {
                terminal(drive, index)?;
                drive.set_terminal(now, index, signal);
            }
            DriveOrder::Bounce { index, times, every } => {
                terminal(drive, index)?;
                if times == 0 || !BETWEEN_EDGES.contains(&every) {
                    return Err(CommandError::NoBounce);
                }
                drive.bounce_terminal(now, index, times, every);
            }
            DriveOrder::DeviceFault { device_fault, on } => {
                if let DeviceFault::Stuck(index) = device_fault {
                    terminal(drive, index)?;
                }
                if let (false, DeviceFault::Cause(cause)) =
                    (drive.set_device_fault(now, device_fault, on), device_fault)
                {
                    return Err(CommandError::NoAlarm(cause.name()));
                }
            }
            DriveOrder::Raise(cause) => {
                if !drive.is_powered() {
                    return Err(CommandError::NoPower);
                }
                if !drive.raise(now, cause) {
                    return Err(CommandError::NoAlarm(cause.name()));
                }
            }
            DriveOrder::Power(true) if drive.is_powered() => {}
            DriveOrder::Power(true) | DriveOrder::PowerCycle => {
                self.switch(id, Drive::power_cycle);
            }
            DriveOrder::Power(false) => self.switch(id, Drive::power_off),
        }
        Ok(Reply::Done)
    }

    fn add_fault(&mut self, rule: FaultRule) -> Result<Reply, CommandError> {
        let name = rule.name.clone();
        match self.medium.add_rule(rule) {
            Ok(true) => Ok(Reply::Done),
            Ok(false) => Err(CommandError::FaultTaken(name)),
            Err(why) => Err(CommandError::IdleFault { name, why }),
        }
    }

    fn remove_fault(&mut self, name: String) -> Result<Reply, CommandError> {
        match self.medium.remove_rule(&name) {
            true => Ok(Reply::Done),
            false => Err(CommandError::NoFault(name)),
        }
    }
}
