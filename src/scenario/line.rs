//! One line as a scenario is read for it: who is on it, and which fault rules stand there by now.

use super::order::{NoOrder, Order};
use crate::bench::BenchLine;
use crate::bus::{Bus, Command, LineCommand};
use crate::event::DriveId;
use crate::medium::{FaultSet, LineBehaviour};
use crate::model::Model;
use crate::problem::{Path, Problem, bounds, suggest};

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
