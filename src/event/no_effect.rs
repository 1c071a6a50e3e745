//! Orders that have no effect: what was ordered, and why nothing came of it.

use super::decoder::{Decoder, Item};
use crate::time::Instant;
use crate::vocabulary::{Action, AlarmCause, Input, Named, RowId};
use serde::Serialize;
use std::fmt;

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

/// What is said of a reason.
#[derive(Debug)]
pub struct ReasonEntry {
    /// Its name in JSON.
    pub name: &'static str,
    /// Its text; `{}` is what it is about.
    pub text: &'static str,
    classes: u8,
}

/// The log tells of it by itself, when it comes about while a signal acts.
const SHOWN: u8 = 1;
/// Everything is over then that an edge has started before, and an edge would be needed again.
const ENDS: u8 = 2;
/// It may pass, so that the same order could act later on.
const PASSES: u8 = 4;

/// The one table of reasons: documentation, variant with what it is about, name in JSON, text, classes.
macro_rules! reasons {
    ($($(#[doc = $doc:literal])* $variant:ident $({ $($field:ident: $type:ty),* })? $(($inner:ty))?
       $name:literal $text:literal [$($class:ident)*];)*) => {
        /// Why an order has no effect.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs)] // What a reason is about says its documentation.
        pub enum Ignored {
            $($(#[doc = $doc])* $variant $({ $($field: $type),* })? $(($inner))?,)*
        }

        /// What is said of each reason, in order.
        pub const REASONS: &[ReasonEntry] =
            &[$(ReasonEntry { name: $name, text: $text, classes: 0 $(| $class)* },)*];

        impl Ignored {
            fn entry(self) -> ReasonEntry {
                match self {
                    $(Self::$variant { .. } => {
                        ReasonEntry { name: $name, text: $text, classes: 0 $(| $class)* }
                    })*
                }
            }
        }
    };
}

reasons! {
    /// The drive has no power.
    NoSupply "no_power" "the drive has no power" [];
    /// It is not ready yet.
    NotReady "not_ready" "the drive is not ready yet" [SHOWN ENDS PASSES];
    /// An alarm is active.
    Alarm "alarm" "an alarm is active" [SHOWN ENDS PASSES];
    /// The power stage is off.
    PowerOff "servo_off" "the servo is off" [SHOWN ENDS PASSES];
    /// A signal keeps the power stage off.
    Released "released" "an input keeps the servo off" [ENDS PASSES];
    /// A signal keeps the power stage from being switched on.
    Inhibited "inhibited" "an input inhibits it" [ENDS PASSES];
    /// The power stage is on already.
    AlreadyOn "already_on" "the servo is already on" [];
    /// The power stage is off already.
    AlreadyOff "already_off" "the servo is already off" [];
    /// A signal keeps the power stage on.
    KeptOn "kept_on" "an input keeps the servo on" [];
    /// A command keeps the power stage on.
    Latched "latched" "a command keeps the servo on" [];
    /// The axis is at rest.
    AlreadyStopped "already_stopped" "already stopped" [];
    /// It is slowing down.
    Stopping "stopping" "already stopping" [];
    /// It has run, and nothing has unlocked it since.
    Locked "locked" "locked since its last run" [PASSES];
    /// Nothing is locked.
    NotLocked "not_locked" "nothing is locked" [];
    /// A stop level holds the axis.
    Held "stop_active" "a stop input is active" [PASSES];
    /// The axis moves.
    Moving "moving" "the axis is moving" [SHOWN PASSES];
    /// A homing is in progress.
    Homing "homing" "homing in progress" [SHOWN PASSES];
    /// There is a limit in that direction.
    Limit "limit" "a limit is active in that direction" [SHOWN];
    /// The speed that it would have is 0.
    NoSpeed "speed_zero" "speed is 0" [];
    /// Other signals ask for another motion.
    Contradiction "contradiction" "another input requests a different motion" [];
    /// A command has ended what the signal asked for; it must rise anew.
    Spent "spent" "ended by a command; needs a rising edge" [SHOWN];
    /// The signal has been active for too long; it takes a rising edge.
    NoEdge { since: Instant } "no_edge" "on since {}; needs a rising edge" [];
    /// A parameter says that something else starts it, or nothing does.
    Starter { row: RowId, value: i64 } "not_allowed" "{} does not allow it" [PASSES];
    /// A parameter holds a value that stands for nothing that can be done.
    Unsupported { row: RowId, value: i64 } "not_supported" "{} is not supported" [];
    /// A parameter holds a value that stands for nothing.
    NoMeaning "undefined_parameter" "a parameter holds an undefined value" [];
    /// Nothing has the number that is selected.
    NoSegment "no_segment" "no such segment" [];
    /// No chain waits for it.
    NoChain "no_chain" "no segment is waiting for it" [];
    /// No segment of the chain moves the axis.
    NoMotion "no_motion" "no segment of the chain moves the axis" [];
    /// There is no alarm.
    NoAlarm "no_alarm" "no alarm is active" [ENDS PASSES];
    /// No reset clears this alarm.
    NotResettable(AlarmCause) "not_resettable" "a reset cannot clear this alarm: {}" [];
    /// The cause of the alarm is still there.
    CauseStands(AlarmCause) "cause_present" "the cause of the alarm is still present: {}" [PASSES];
    /// The alarm is another one.
    OtherAlarm(AlarmCause) "other_alarm" "a different alarm is active: {}" [];
    /// The bit is not enabled: all of the row is 0, or the bit in there.
    Disabled { row: RowId, bit: Option<u8> } "disabled" "{} is 0" [];
    /// A setting gives the signal to something else.
    Overridden { row: RowId } "assigned_elsewhere" "{} assigns the signal to another function" [];
    /// It stands for nothing.
    Nothing "undefined" "undefined" [];
    /// It stands for something that is not simulated.
    NotSimulated "not_simulated" "not simulated" [];
    /// It is kept, and that is all.
    StoredOnly "stored_only" "stored; not simulated" [];
    /// The terminal has no function.
    NoFunction { row: RowId, value: i64 } "no_function" "{}" [];
    /// The terminal is stuck.
    Stuck "stuck" "the terminal is stuck" [];
    /// What was ordered is the case already.
    AlreadySo "no_change" "already in that state" [];
    /// Another source has the signal active.
    OtherSource(Input) "other_source" "another source keeps {} on" [];
    /// Another action of the same request goes first.
    After(Action) "lower_priority" "{} in the same write takes precedence" [];
    /// It modifies a command, and there is none.
    NoOrder "no_order" "no command in the same write" [];
    /// It modifies a move, and another command is given.
    MovesOnly "moves_only" "applies to move_start only" [];
    /// It says that a motion takes the place of another, and a stop or a homing is ordered.
    MovesAndRunsOnly "moves_and_runs_only" "applies to move_start and run_start only" [];
}

impl Ignored {
    /// Does the log tell of this by itself, when it comes about while a signal acts?
    pub fn shows_itself(self) -> bool {
        self.entry().classes & SHOWN != 0
    }

    /// Is everything over then that an edge has started before, and would an edge be needed again?
    pub fn ends_motions(self) -> bool {
        self.entry().classes & ENDS != 0
    }

    /// May it pass, so that the same order could act later on?
    pub fn passes(self) -> bool {
        self.entry().classes & PASSES != 0
    }

    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Why, as people read it.
    pub fn text(self, decoder: &Decoder) -> String {
        let code = |row| decoder.row(row).code();
        let about = match self {
            Self::NoEdge { since } => since.to_string(),
            Self::Starter { row, value }
            | Self::Unsupported { row, value }
            | Self::NoFunction { row, value } => decoder.text(Item::Row(row, value)),
            Self::NotResettable(cause) | Self::CauseStands(cause) | Self::OtherAlarm(cause) => {
                cause.about().into()
            }
            Self::Disabled { row, bit: Some(bit) } => format!("{} bit {bit}", code(row)),
            Self::Disabled { row, bit: None } | Self::Overridden { row } => code(row),
            Self::OtherSource(signal) => signal.name().into(),
            Self::After(action) => action.name().into(),
            _ => return self.entry().text.into(),
        };
        self.entry().text.replacen("{}", &about, 1)
    }
}

/// An order that has no effect, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "NoEffectFields")]
pub struct NoEffect {
    /// Whose rows they are.
    pub decoder: Decoder,
    /// What was ordered.
    pub order: Ordered,
    /// Why nothing comes of it.
    pub why: Ignored,
}

impl NoEffect {
    /// The order: `C01 bit 1 enable`.
    fn order_text(&self) -> String {
        let decoder = &self.decoder;
        match self.order {
            Ordered::Action(action) => action.name().into(),
            Ordered::Input(input) => input.name().into(),
            Ordered::InputOff(input) => format!("{} off", input.name()),
            Ordered::Bit { row, bit, on } => {
                let (row, off) = (decoder.row(row), if on { "" } else { " = 0" });
                let name = row.bits.get(&bit).map(|name| format!(" {name}")).unwrap_or_default();
                format!("{} bit {bit}{name}{off}", row.code())
            }
            Ordered::Write { row, value } => decoder.text(Item::Row(row, value)),
            Ordered::Read(row) => decoder.row(row).code(),
            Ordered::Terminal { index, on } => {
                format!("terminal {} {}", decoder.terminal(index), if on { "on" } else { "off" })
            }
            Ordered::Function(index) => decoder.not_simulated(index).into(),
            Ordered::Raise(cause) => format!("raise {}", cause.name()),
        }
    }
}

impl fmt::Display for NoEffect {
    /// `C01 bit 1 enable has no effect: C11 bit 1 is 0`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (order, why) = (self.order_text(), self.why.text(&self.decoder));
        match self.order {
            Ordered::Read(_) => write!(f, "{order} reads 0: {why}"),
            Ordered::Function(_) => write!(f, "{order}: {why}"),
            _ => write!(f, "{order} has no effect: {why}"),
        }
    }
}

/// What was ordered, in JSON.
#[derive(Debug, Serialize)]
#[serde(tag = "order", rename_all = "snake_case")]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema), schemars(transform = describe_order))]
enum OrderFields {
    /// An action, by a command register or a trigger bit.
    Action {
        /// Which.
        action: Action,
    },
    /// An input signal.
    Input {
        /// Which.
        input: Input,
        /// Active, or no longer?
        on: bool,
    },
    /// A bit of a register.
    Bit {
        /// The code of the row.
        row: String,
        /// The bit, from 0.
        bit: u8,
        /// Set, or cleared?
        on: bool,
    },
    /// A write of a register.
    Write {
        /// The code of the row.
        row: String,
        /// The value.
        value: i64,
    },
    /// A read of a register.
    Read {
        /// The code of the row.
        row: String,
    },
    /// An input terminal.
    Terminal {
        /// Its name.
        terminal: String,
        /// With a signal, or without?
        on: bool,
    },
    /// A function that is not simulated.
    Function {
        /// Its name.
        function: String,
    },
    /// An alarm that was to be raised.
    Raise {
        /// Its cause.
        cause: AlarmCause,
    },
}

/// Says what the tag is.
#[cfg(feature = "cli")]
fn describe_order(schema: &mut schemars::Schema) {
    let shapes = schema.get_mut("oneOf").and_then(serde_json::Value::as_array_mut);
    for shape in shapes.into_iter().flatten() {
        shape["properties"]["order"]["description"] = "What kind of order it was.".into();
    }
}

/// The keys of the event.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(super) struct NoEffectFields {
    #[serde(flatten)]
    order: OrderFields,
    /// Why, as a word of the list of reasons.
    #[cfg_attr(feature = "cli", schemars(extend("enum" = reason_names())))]
    reason: &'static str,
    /// Why, as a sentence.
    why: String,
    /// The code of the row that decides, where one does.
    #[serde(skip_serializing_if = "Option::is_none")]
    by: Option<String>,
    /// The value that it holds, where that decides.
    #[serde(skip_serializing_if = "Option::is_none")]
    by_value: Option<i64>,
    /// Its bit, where that decides.
    #[serde(skip_serializing_if = "Option::is_none")]
    by_bit: Option<u8>,
    /// The cause of the alarm that is in the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    alarm: Option<AlarmCause>,
    /// The signal that something else keeps active.
    #[serde(skip_serializing_if = "Option::is_none")]
    signal: Option<Input>,
    /// The action that took precedence.
    #[serde(skip_serializing_if = "Option::is_none")]
    after: Option<Action>,
    /// Since when the signal has been active, in seconds of emulated time.
    #[serde(skip_serializing_if = "Option::is_none")]
    since: Option<f64>,
}

/// The names of all reasons.
#[cfg(feature = "cli")]
pub fn reason_names() -> Vec<&'static str> {
    REASONS.iter().map(|reason| reason.name).collect()
}

impl From<NoEffect> for NoEffectFields {
    fn from(it: NoEffect) -> Self {
        let decoder = &it.decoder;
        let id = |row: RowId| decoder.row(row).id.clone();
        let order = match it.order {
            Ordered::Action(action) => OrderFields::Action { action },
            Ordered::Input(input) => OrderFields::Input { input, on: true },
            Ordered::InputOff(input) => OrderFields::Input { input, on: false },
            Ordered::Bit { row, bit, on } => OrderFields::Bit { row: id(row), bit, on },
            Ordered::Write { row, value } => OrderFields::Write { row: id(row), value },
            Ordered::Read(row) => OrderFields::Read { row: id(row) },
            Ordered::Terminal { index, on } => {
                OrderFields::Terminal { terminal: decoder.terminal(index), on }
            }
            Ordered::Function(index) => {
                OrderFields::Function { function: decoder.not_simulated(index).into() }
            }
            Ordered::Raise(cause) => OrderFields::Raise { cause },
        };
        let mut fields = Self {
            order,
            reason: it.why.name(),
            why: it.why.text(decoder),
            by: None,
            by_value: None,
            by_bit: None,
            alarm: None,
            signal: None,
            after: None,
            since: None,
        };
        match it.why {
            Ignored::NoEdge { since } => fields.since = Some(since.as_secs_f64()),
            Ignored::Starter { row, value }
            | Ignored::Unsupported { row, value }
            | Ignored::NoFunction { row, value } => {
                (fields.by, fields.by_value) = (Some(id(row)), Some(value));
            }
            Ignored::Disabled { row, bit } => (fields.by, fields.by_bit) = (Some(id(row)), bit),
            Ignored::Overridden { row } => fields.by = Some(id(row)),
            Ignored::NotResettable(cause)
            | Ignored::CauseStands(cause)
            | Ignored::OtherAlarm(cause) => fields.alarm = Some(cause),
            Ignored::OtherSource(signal) => fields.signal = Some(signal),
            Ignored::After(action) => fields.after = Some(action),
            _ => {}
        }
        fields
    }
}
