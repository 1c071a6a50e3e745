//! Fault rules of a line: read for the drives that are on it.

use super::BenchLine;
use crate::medium::{self, FaultContext, FaultRules, FaultSet, LineBehaviour, Medium, NoRow};
use crate::problem::{Problem, suggest};
use crate::time::Instant;
use crate::wire::Span;

impl FaultContext for BenchLine {
    fn is_tcp(&self) -> bool {
        !self.is_serial()
    }

    fn line_behaviour(&self) -> &LineBehaviour {
        &self.line_behaviour
    }

    /// Where all drives that know the name have the row. One place must be right for all of them: a rule
    /// doesn't ask which drive a request is for.
    fn spans(&self, name: &str) -> Result<Vec<Span>, NoRow> {
        let maps = self.devices.iter().map(|device| &device.model.map);
        let mut places = maps.clone().filter_map(|map| {
            let (id, _) = map.rows().find(|(_, row)| row.id == name)?;
            Some(map.spans(id))
        });
        let Some(first) = places.next() else {
            let ids = maps.flat_map(|map| map.rows().map(|(_, row)| row.id.as_str()));
            let advice = suggest::did_you_mean(name, ids);
            let what = format!("no drive on this line has a register `{name}`");
            return Err(NoRow { what, advice });
        };
        match places.all(|other| other == first) {
            true => Ok(first),
            false => {
                let what = format!("the drives on this line have `{name}` at different addresses");
                Err(NoRow { what, advice: Some("write the address instead".into()) })
            }
        }
    }
}

impl BenchLine {
    /// Reads the compact form of a fault rule (`lose_reply:every=10`) for this line.
    ///
    /// # Errors
    /// Everything that is wrong with it, each with its place in `spec`.
    pub fn fault(&self, spec: &str, taken: &[&str]) -> Result<FaultSet, Vec<Problem>> {
        medium::parse(spec, self, taken)
    }

    /// Puts such a rule behind those that the line has.
    ///
    /// # Errors
    /// As [`fault`](Self::fault).
    pub fn add_fault(&mut self, spec: &str) -> Result<(), Vec<Problem>> {
        let fault_set = self.fault(spec, &self.rule_names())?;
        self.put(fault_set);
        Ok(())
    }

    /// The names of the rules, in order.
    pub(super) fn rule_names(&self) -> Vec<&str> {
        self.faults.iter().map(|rule| rule.name.as_str()).collect()
    }

    /// Puts what was read behind what the line has.
    pub(super) fn put(&mut self, fault_set: FaultSet) {
        self.faults.extend(fault_set.rules);
        self.line_behaviour =
            std::mem::take(&mut self.line_behaviour).and(fault_set.line_behaviour);
    }

    /// What lies between masters and drives, before anything has passed. What its rules draw depends on `seed`.
    pub(super) fn medium(&self, seed: u64) -> Medium {
        let mut rules = FaultRules::new(seed, &self.name);
        for rule in &self.faults {
            // Names are unique once they are read.
            let added = rules.add(rule.clone());
            debug_assert!(added);
        }
        let mut medium = Medium::new(rules);
        medium.set_behaviour(Instant::ZERO, self.line_behaviour.clone());
        medium
    }
}
