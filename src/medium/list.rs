//! The rules of one line, in order, and what each has done.

use super::{FaultKind, FaultRule};
use crate::event::{FaultEffect, RuleId};
use crate::rng::{Fork, Rng};
use crate::time::Instant;

/// The rules of one line.
///
/// Each rule counts its occurrences, also those that a rule above it takes, and what it draws depends on the
/// seed, the names of line and rule and the number of the occurrence only. So a rule decides the same
/// whatever stands beside it.
#[derive(Debug, Default)]
pub struct Faults {
    seed: u64,
    line: String,
    rules: Vec<ActiveRule>,
    /// Name and kind of every rule that ever stood here, by number.
    told: Vec<(String, FaultKind)>,
}

#[derive(Debug)]
struct ActiveRule {
    rule: FaultRule,
    id: RuleId,
    fork: Fork,
    seen: u64,
    hits: u64,
}

/// A rule that acts on a request or its reply.
#[derive(Debug, Clone)]
pub struct FaultHit {
    /// Which rule.
    pub rule: RuleId,
    /// How often it has acted by now.
    pub hit: u64,
    /// What it does.
    pub effect: FaultEffect,
    /// For the bytes that it makes up.
    pub rng: Rng,
}

impl Faults {
    /// No rules yet, for the line called `line` in a run with `seed`.
    pub fn new(seed: u64, line: &str) -> Self {
        Self { seed, line: line.to_owned(), ..Self::default() }
    }

    /// Puts `rule` behind all others, unless there is one of that name. Was it put there? One that was
    /// removed before begins anew.
    #[must_use]
    pub fn add(&mut self, rule: FaultRule) -> bool {
        if self.names().any(|name| name == rule.name) {
            return false;
        }
        let known = self.told.iter().position(|(name, _)| *name == rule.name);
        let number = known.unwrap_or_else(|| {
            self.told.push((rule.name.clone(), rule.act.kind()));
            self.told.len() - 1
        });
        self.told[number].1 = rule.act.kind();
        let fork = self.fork(&rule.name);
        self.rules.push(ActiveRule { rule, id: RuleId(number as u16), fork, seen: 0, hits: 0 });
        true
    }

    /// Takes the rule called `name` away. Was there one?
    pub fn remove(&mut self, name: &str) -> bool {
        let before = self.rules.len();
        self.rules.retain(|it| it.rule.name != name);
        self.rules.len() < before
    }

    /// The streams of random numbers for something else on this line.
    pub fn fork(&self, name: &str) -> Fork {
        Fork::new(self.seed, &self.line, name)
    }

    /// The names of the rules, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.rules.iter().map(|it| it.rule.name.as_str())
    }

    /// How often the rule called `name` has acted, if there is one.
    pub fn hits(&self, name: &str) -> Option<u64> {
        self.rules.iter().find(|it| it.rule.name == name).map(|it| it.hits)
    }

    /// Name and kind of a rule, also of one that was removed.
    pub fn told(&self, rule: RuleId) -> (&str, FaultKind) {
        let (name, kind) = &self.told[usize::from(rule.0)];
        (name, *kind)
    }

    /// What happens to a request to `unit` at `now`: the first rule that holds acts.
    pub fn fault_hit(&mut self, now: Instant, unit: u8, request: &[u8]) -> Option<FaultHit> {
        let mut fault_hit = None;
        for it in &mut self.rules {
            if !it.rule.concerns(now, unit, request) {
                continue;
            }
            it.seen += 1;
            if fault_hit.is_none() {
                fault_hit = it.fault_hit(unit, request);
            }
        }
        fault_hit
    }
}

impl ActiveRule {
    /// Acts, if it is its turn and its luck.
    fn fault_hit(&mut self, unit: u8, request: &[u8]) -> Option<FaultHit> {
        let when = &self.rule.when;
        let spent = when.count.is_some_and(|count| self.hits >= count);
        if spent || !when.is_turn(self.seen) {
            return None;
        }
        let mut rng = self.fork.stream(self.seen);
        if when.chance.is_some_and(|chance| !rng.happens(chance)) {
            return None;
        }
        self.hits += 1;
        let function = request.first().copied().unwrap_or(0);
        let effect = self.rule.act.effect(unit, function, &mut rng);
        Some(FaultHit { rule: self.id, hit: self.hits, effect, rng })
    }
}
