//! Something to do to a drive or to the faults, as one line of text: `terminal I1 on`, `hold overload on`.
//!
//! Scenarios and transcripts speak this language.

use crate::bus::{BETWEEN_EDGES, Command};
use crate::event::{DeviceFault, DriveId};
use crate::model::Model;
use crate::problem::suggest;
use crate::time::{Duration, parse_duration};
use crate::vocabulary::{AlarmCause, Named};

/// What can be written.
const FORMS: [&str; 13] = [
    "terminal NAME on|off",
    "stick NAME on|off",
    "bounce NAME TIMES EVERY",
    "raise CAUSE",
    "hold CAUSE on|off",
    "block on|off",
    "encoder on|off",
    "freeze on|off",
    "power on",
    "power off",
    "power_cycle",
    "fault SPEC",
    "no_fault NAME",
];

/// Something to do, with terminals by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DriveOrder {
    /// Put a signal on a terminal, or take it off.
    Terminal(String, bool),
    /// Have a terminal keep its level, or no longer.
    Stick(String, bool),
    /// Have a terminal leave its level and come back so many times, with this time from edge to edge.
    Bounce(String, u16, Duration),
    /// Trip with an alarm.
    Raise(AlarmCause),
    /// Something is wrong from now on, or no longer.
    DeviceFault(DeviceFault, bool),
    /// Power on or off.
    Power(bool),
    /// Power off and on.
    PowerCycle,
    /// Put a fault rule in compact form on the line.
    Fault(String),
    /// Take the rule of that name off the line.
    NoFault(String),
}

/// Why a line is no order, or none for this drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoOrder {
    /// Why.
    pub what: String,
    /// What to do.
    pub advice: Option<String>,
}

impl DriveOrder {
    /// Reads one line.
    ///
    /// # Errors
    /// If it is none of the forms.
    pub fn parse(text: &str) -> Result<Self, NoOrder> {
        let words: Vec<&str> = text.split_whitespace().collect();
        Ok(match words.as_slice() {
            ["terminal", name, level] => Self::Terminal((*name).into(), is_on(level)?),
            ["stick", name, level] => Self::Stick((*name).into(), is_on(level)?),
            ["bounce", name, times, every] => {
                let count = times.parse().ok().filter(|count| *count > 0);
                let count = count.ok_or_else(|| {
                    no(format!("a contact bounces 1 to 65535 times, not `{times}`"))
                })?;
                let between = parse_duration(every).filter(|it| BETWEEN_EDGES.contains(it));
                let between = between.ok_or_else(|| NoOrder {
                    what: format!("the time between edges must be 1us to 1min, not `{every}`"),
                    advice: Some("write `bounce NAME 3 5ms`".into()),
                })?;
                Self::Bounce((*name).into(), count, between)
            }
            ["raise", cause] => Self::Raise(cause_of(cause)?),
            ["hold", cause, level] => {
                Self::DeviceFault(DeviceFault::Cause(cause_of(cause)?), is_on(level)?)
            }
            ["block", level] => Self::DeviceFault(DeviceFault::Blocked, is_on(level)?),
            ["encoder", level] => Self::DeviceFault(DeviceFault::EncoderLost, !is_on(level)?),
            ["freeze", level] => Self::DeviceFault(DeviceFault::Frozen, is_on(level)?),
            ["power", level] => Self::Power(is_on(level)?),
            ["power_cycle"] => Self::PowerCycle,
            // A value may have blanks inside.
            ["fault", spec @ ..] if !spec.is_empty() => Self::Fault(spec.join(" ")),
            ["no_fault", name] => Self::NoFault((*name).into()),
            [verb, ..] => return Err(no_form(verb)),
            [] => return Err(no_form("")),
        })
    }

    /// The command that it is for `drive`, which is of `model`; `None` where it is about the line.
    ///
    /// # Errors
    /// If the model has no such terminal or no such alarm.
    pub fn command(&self, drive: DriveId, model: &Model) -> Result<Option<Command>, NoOrder> {
        Ok(Some(match self {
            Self::Terminal(name, signal) => {
                Command::Terminal { drive, index: terminal(model, name)?, signal: *signal }
            }
            Self::Stick(name, on) => {
                let device_fault = DeviceFault::Stuck(terminal(model, name)?);
                Command::DeviceFault { drive, device_fault, on: *on }
            }
            Self::Bounce(name, times, every) => {
                let index = terminal(model, name)?;
                Command::Bounce { drive, index, times: *times, every: *every }
            }
            Self::Raise(cause) | Self::DeviceFault(DeviceFault::Cause(cause), _)
                if model.wiring.alarm(*cause).is_none() =>
            {
                return Err(no(format!("the model has no alarm for `{}`", cause.name())));
            }
            Self::Raise(cause) => Command::Raise { drive, cause: *cause },
            Self::DeviceFault(device_fault, on) => {
                Command::DeviceFault { drive, device_fault: *device_fault, on: *on }
            }
            Self::Power(on) => Command::Power { drive, on: *on },
            Self::PowerCycle => Command::PowerCycle { drive },
            Self::Fault(_) | Self::NoFault(_) => return Ok(None),
        }))
    }
}

fn no(what: impl Into<String>) -> NoOrder {
    NoOrder { what: what.into(), advice: None }
}

/// The verb is unknown, or something else should stand behind it.
fn no_form(verb: &str) -> NoOrder {
    let verb_of = |form: &'static str| form.split(' ').next().unwrap_or_default();
    let forms: Vec<_> = FORMS.into_iter().filter(|form| verb_of(form) == verb).collect();
    if let [first, ..] = forms.as_slice() {
        let form = if forms.len() > 1 { forms.join("` or `") } else { (*first).to_owned() };
        return NoOrder { what: format!("expected `{form}`"), advice: None };
    }
    let advice = suggest::did_you_mean(verb, FORMS.into_iter().map(verb_of));
    let known = advice.unwrap_or_else(|| format!("known: {}", FORMS.join(", ")));
    NoOrder { what: format!("unknown order `{verb}`"), advice: Some(known) }
}

fn is_on(level: &str) -> Result<bool, NoOrder> {
    match level {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(no(format!("expected `on` or `off`, found `{level}`"))),
    }
}

fn cause_of(name: &str) -> Result<AlarmCause, NoOrder> {
    AlarmCause::parse(name).ok_or_else(|| {
        let advice = suggest::did_you_mean(name, AlarmCause::ALL.iter().map(|it| it.name()));
        NoOrder { what: format!("unknown alarm cause `{name}`"), advice }
    })
}

fn terminal(model: &Model, name: &str) -> Result<u8, NoOrder> {
    let terminals = model.wiring.input_terminals.as_ref();
    let names: Vec<String> =
        terminals.map_or(Vec::new(), |it| (0..it.functions.len()).map(|i| it.name(i)).collect());
    let index = names.iter().position(|it| it == name);
    index.map(|index| index as u8).ok_or_else(|| {
        let advice = suggest::did_you_mean(name, names.iter().map(String::as_str));
        NoOrder { what: format!("unknown input terminal `{name}`"), advice }
    })
}
