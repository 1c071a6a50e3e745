//! An order to a drive or to the faults, as one line of text: `terminal I1 on`, `hold overload on`; and the commands that
//! carry it out on a line.
//!
//! Scenarios and transcripts speak this language.

use crate::bench::BenchLine;
use crate::bus::{BETWEEN_EDGES, Bus, Command, DriveOrder, LineCommand};
use crate::event::{DeviceFault, DriveId};
use crate::medium::{FaultSet, LineBehaviour};
use crate::model::Model;
use crate::problem::{Path, Problem, bounds, suggest};
use crate::time::parse_duration;
use crate::vocabulary::{AlarmCause, Named};
use std::fmt;

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

/// Something to do, as a line of text says it for one drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Order {
    /// To that drive.
    Drive(DriveOrder),
    /// Put a fault rule in compact form on its line.
    Fault(String),
    /// Take the rule of that name off its line.
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

impl fmt::Display for NoOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.advice {
            Some(advice) => write!(f, "{} ({advice})", self.what),
            None => f.write_str(&self.what),
        }
    }
}

impl Order {
    /// Reads one line, which is for a drive of `model`.
    ///
    /// # Errors
    /// If it is none of the forms, or the model has no such terminal or no such alarm.
    pub fn parse(text: &str, model: &Model) -> Result<Self, NoOrder> {
        let order = read(text, &|name| terminal(model, name))?;
        match order {
            Self::Drive(
                DriveOrder::Raise(cause)
                | DriveOrder::DeviceFault { device_fault: DeviceFault::Cause(cause), .. },
            ) if model.wiring.alarm(cause).is_none() => {
                Err(no(format!("the model has no alarm for `{}`", cause.name())))
            }
            order => Ok(order),
        }
    }

    /// Is it one of the forms, whatever drive it is for?
    ///
    /// # Errors
    /// If it is none.
    pub fn check(text: &str) -> Result<(), NoOrder> {
        read(text, &|_| Ok(0)).map(|_| ())
    }
}

/// Reads one line; `terminal` finds an input terminal by its name.
fn read(text: &str, terminal: &dyn Fn(&str) -> Result<u8, NoOrder>) -> Result<Order, NoOrder> {
    let device_fault = |device_fault, on| DriveOrder::DeviceFault { device_fault, on };
    let words: Vec<&str> = text.split_whitespace().collect();
    Ok(Order::Drive(match words.as_slice() {
        ["terminal", name, level] => {
            let signal = is_on(level)?;
            DriveOrder::Terminal { index: terminal(name)?, signal }
        }
        ["stick", name, level] => {
            let on = is_on(level)?;
            device_fault(DeviceFault::Stuck(terminal(name)?), on)
        }
        ["bounce", name, times, every] => {
            let count = times.parse().ok().filter(|count| *count > 0);
            let times = count
                .ok_or_else(|| no(format!("a contact bounces 1 to 65535 times, not `{times}`")))?;
            let between = parse_duration(every).filter(|it| BETWEEN_EDGES.contains(it));
            let every = between.ok_or_else(|| NoOrder {
                what: format!("the time between edges must be 1us to 1min, not `{every}`"),
                advice: Some("write `bounce NAME 3 5ms`".into()),
            })?;
            DriveOrder::Bounce { index: terminal(name)?, times, every }
        }
        ["raise", cause] => DriveOrder::Raise(cause_of(cause)?),
        ["hold", cause, level] => device_fault(DeviceFault::Cause(cause_of(cause)?), is_on(level)?),
        ["block", level] => device_fault(DeviceFault::Blocked, is_on(level)?),
        ["encoder", level] => device_fault(DeviceFault::EncoderLost, !is_on(level)?),
        ["freeze", level] => device_fault(DeviceFault::Frozen, is_on(level)?),
        ["power", level] => DriveOrder::Power(is_on(level)?),
        ["power_cycle"] => DriveOrder::PowerCycle,
        // A value may have blanks inside.
        ["fault", spec @ ..] if !spec.is_empty() => return Ok(Order::Fault(spec.join(" "))),
        ["no_fault", name] => return Ok(Order::NoFault((*name).into())),
        [verb, ..] => return Err(no_form(verb)),
        [] => return Err(no_form("")),
    }))
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

/// One line.
pub(super) struct ScenarioLine<'a> {
    pub(super) line: &'a BenchLine,
    /// Its drives, just switched on.
    bus: Bus,
    /// Names of rules that stand on it, as far as the steps are read.
    rules: Vec<String>,
    /// The line behaviour of the line by then.
    line_behaviour: LineBehaviour,
}

impl<'a> ScenarioLine<'a> {
    pub(super) fn new(line: &'a BenchLine) -> Self {
        let rules = line.faults.iter().map(|rule| rule.name.clone()).collect();
        Self { line, bus: line.bus(0), rules, line_behaviour: line.line_behaviour.clone() }
    }

    /// The drive that answers to `unit`.
    pub(super) fn find(&self, unit: u8) -> Option<DriveId> {
        self.bus.find(unit)
    }

    /// What a drive is.
    pub(super) fn model(&self, drive: DriveId) -> &Model {
        self.bus.drive(drive).model()
    }

    /// The commands that carry out the order in `text`. A preset has several rules.
    pub(super) fn commands(&mut self, text: &str, drive: DriveId) -> Result<Vec<Command>, NoOrder> {
        match Order::parse(text, self.model(drive))? {
            Order::Drive(order) => Ok(vec![Command::Drive(drive, order)]),
            Order::Fault(spec) => self.add(&spec),
            Order::NoFault(name) => self.remove(&name),
        }
    }

    fn add(&mut self, spec: &str) -> Result<Vec<Command>, NoOrder> {
        let taken: Vec<_> = self.rules.iter().map(String::as_str).collect();
        let FaultSet { rules, line_behaviour } =
            self.line.fault(spec, &taken).map_err(|problems| {
                let first = problems.into_iter().next();
                let told = |it: Problem| match it.path.is_root() {
                    true => NoOrder { what: it.what, advice: it.advice },
                    false => {
                        NoOrder { what: format!("{}: {}", it.path, it.what), advice: it.advice }
                    }
                };
                first.map_or(NoOrder { what: String::new(), advice: None }, told)
            })?;
        if let Some(most) =
            bounds::count("rules", self.rules.len() + rules.len(), bounds::FAULTS, &Path::root())
        {
            return Err(NoOrder { what: most.what, advice: None });
        }
        self.rules.extend(rules.iter().map(|rule| rule.name.clone()));
        let mut commands: Vec<_> = rules.into_iter().map(LineCommand::AddFault).collect();
        if !line_behaviour.is_empty() {
            self.line_behaviour = self.line_behaviour.clone().and(line_behaviour);
            commands.push(LineCommand::SetBehaviour(self.line_behaviour.clone()));
        }
        Ok(commands.into_iter().map(Command::Line).collect())
    }

    fn remove(&mut self, name: &str) -> Result<Vec<Command>, NoOrder> {
        let below = format!("{name}.");
        let (gone, left): (Vec<_>, Vec<_>) =
            self.rules.drain(..).partition(|it| it == name || it.starts_with(&below));
        self.rules = left;
        if gone.is_empty() {
            let advice = suggest::did_you_mean(name, self.rules.iter().map(String::as_str));
            let what = format!("no fault rule `{name}` on this line at that point");
            return Err(NoOrder { what, advice });
        }
        Ok(gone.into_iter().map(|name| LineCommand::RemoveFault(name).into()).collect())
    }
}
