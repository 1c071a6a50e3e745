//! Orders that have no effect: what was ordered, and why nothing came of it.

use crate::time::Instant;
use crate::vocabulary::{Action, AlarmCause, Input, RowId};

/// Something that a master, or whoever wires the terminals, asks a drive for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ordered {
    /// An action, by a command row or a trigger bit.
    Action(Action),
    /// An input signal is active.
    Input(Input),
    /// An input signal is active no longer.
    InputOff(Input),
    /// A bit of a row was written.
    Bit {
        /// The row.
        row: RowId,
        /// The bit.
        bit: u8,
        /// Set, or cleared?
        on: bool,
    },
    /// A value was written.
    Write {
        /// The row.
        row: RowId,
        /// The value.
        value: i64,
    },
    /// A row was read.
    Read(RowId),
    /// An input terminal got another level, or was to get the one that it has.
    Terminal {
        /// Index from 0.
        index: u8,
        /// Carries a signal?
        on: bool,
    },
    /// A function that is not simulated, by its index among those of the model.
    Function(u8),
    /// An alarm was to be raised.
    Raise(AlarmCause),
}

/// Why an order has no effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ignored {
    /// The drive has no power.
    NoSupply,
    /// It is not ready yet.
    NotReady,
    /// An alarm is active.
    Alarm,
    /// The power stage is off.
    PowerOff,
    /// A signal keeps the power stage off.
    Released,
    /// A signal keeps the power stage from being switched on.
    Inhibited,
    /// It is so already: the power stage is on.
    AlreadyOn,
    /// The power stage is off.
    AlreadyOff,
    /// A signal keeps the power stage on.
    KeptOn,
    /// A command keeps the power stage on.
    Latched,
    /// The axis is at rest.
    AlreadyStopped,
    /// It is slowing down.
    Stopping,
    /// It has run, and nothing has unlocked it since.
    Locked,
    /// Nothing is locked.
    NotLocked,
    /// A stop level holds the axis.
    Held,
    /// The axis moves.
    Moving,
    /// It looks for its origin.
    Homing,
    /// There is a limit in that direction.
    Limit,
    /// The speed that it would go at is 0.
    NoSpeed,
    /// Other signals ask for another motion.
    Contradiction,
    /// An order has ended what the signal asked for; it must rise anew.
    Spent,
    /// The signal has been active for too long; it takes a rising edge.
    NoEdge {
        /// Since when it is.
        since: Instant,
    },
    /// A parameter says that something else starts it, or nothing does.
    Starter {
        /// The parameter.
        row: RowId,
        /// Its value.
        value: i64,
    },
    /// A parameter holds a value that stands for nothing that can be done.
    Unsupported {
        /// The parameter.
        row: RowId,
        /// Its value.
        value: i64,
    },
    /// A parameter holds a value that stands for nothing.
    NoMeaning,
    /// Nothing has the number that is selected.
    NoSegment,
    /// No chain waits for it.
    NoChain,
    /// No segment of the chain moves the axis.
    NoMotion,
    /// There is no alarm.
    NoAlarm,
    /// No reset clears this alarm.
    NotResettable(AlarmCause),
    /// The cause of the alarm is still there.
    CauseStands(AlarmCause),
    /// The alarm is another one.
    OtherAlarm(AlarmCause),
    /// The bit is not enabled.
    Disabled {
        /// The row that enables it.
        row: RowId,
        /// The bit in there; `None` where all of it is 0.
        bit: Option<u8>,
    },
    /// A setting gives the signal to something else.
    Overridden {
        /// The setting.
        row: RowId,
    },
    /// It stands for nothing.
    Nothing,
    /// It stands for something that is not simulated.
    NotSimulated,
    /// It is kept, and that is all.
    StoredOnly,
    /// The terminal has no function.
    NoFunction {
        /// The row with its function.
        row: RowId,
        /// Its value.
        value: i64,
    },
    /// The terminal is stuck.
    Stuck,
    /// It is so already.
    AlreadySo,
    /// Another source has the signal active.
    OtherSource(Input),
    /// Another order of the same request goes first.
    After(Action),
    /// It says something about an order, and there is none.
    NoOrder,
    /// It says something about a move, and another order is given.
    MovesOnly,
    /// It says something about a motion that takes the place of another, and a stop or a homing is ordered.
    MovesAndRunsOnly,
}

impl Ignored {
    /// Does the log tell of this by itself, when it comes about while a signal acts?
    pub fn shows_itself(self) -> bool {
        matches!(
            self,
            Self::NotReady
                | Self::Alarm
                | Self::PowerOff
                | Self::Moving
                | Self::Homing
                | Self::Limit
                | Self::Spent
        )
    }

    /// Is everything over then that an edge has started before, and would an edge be needed again?
    pub fn ends_motions(self) -> bool {
        matches!(
            self,
            Self::NotReady
                | Self::Alarm
                | Self::PowerOff
                | Self::Released
                | Self::Inhibited
                | Self::NoAlarm
        )
    }

    /// May it pass, so that the same order could act later on?
    pub fn passes(self) -> bool {
        matches!(
            self,
            Self::NotReady
                | Self::Alarm
                | Self::PowerOff
                | Self::Released
                | Self::Inhibited
                | Self::Held
                | Self::Moving
                | Self::Homing
                | Self::Locked
                | Self::Starter { .. }
                | Self::NoAlarm
                | Self::CauseStands(_)
        )
    }
}
