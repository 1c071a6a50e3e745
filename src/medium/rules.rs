//! The fault rules of one line, in order: whose turn it is, and what each has done.

#[cfg(feature = "cli")]
use super::kinds::FaultKind;
use super::kinds::{FaultEffect, Passage};
use crate::rng::{Chance, Fork, Rng};
use crate::time::Instant;
use crate::wire::{BROADCAST, LengthCheck, Request, Span};
use serde::{Serialize, Serializer};
use std::fmt;
use std::sync::Arc;

/// A rule: when it acts, and what it does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultRule {
    /// Its name on its line.
    pub name: String,
    /// When it acts.
    pub when: When,
    /// The kind of fault, or a preset.
    pub effect: FaultEffect,
}

/// When a rule acts. Requests that `unit` to `until` hold for are its occurrences; the others choose among them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct When {
    /// Only requests to this unit; 0 is a broadcast.
    pub unit: Option<u8>,
    /// Only these functions; empty is every one.
    pub functions: Vec<u8>,
    /// Only requests that touch one of these; empty is every request.
    pub spans: Vec<Span>,
    /// Only from here on.
    pub from: Instant,
    /// Only before.
    pub until: Option<Instant>,
    /// Occurrences that pass first.
    pub skip: u64,
    /// Then it is the turn of every Nth; at least 1.
    pub every: u64,
    /// Whose turn it is is hit with this chance; `None` always is.
    pub chance: Option<Chance>,
    /// This many hits and no more.
    pub count: Option<u64>,
}

/// A rule has acted on a request or its reply.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultHit {
    /// The name of the rule.
    pub rule: Arc<str>,
    /// The unit that was asked.
    pub unit: u8,
    /// What it did.
    pub effect: FaultEffect,
    /// How often it has acted by now.
    pub hit: u64,
}

/// A hit on a request that was not replied to yet.
#[derive(Debug)]
pub struct PendingHit {
    pub(super) hit: FaultHit,
    /// What the rule draws from.
    pub(super) rng: Rng,
}

impl PendingHit {
    /// What becomes of the request.
    pub fn passage(&self) -> Passage {
        self.hit.effect.passage()
    }

    /// What the rule did, once the reply went its way.
    pub fn finish(self) -> FaultHit {
        self.hit
    }
}

/// The rules of one line.
///
/// Each rule counts its occurrences, also those that a rule above it takes, and what it draws depends on the
/// seed, the names of line and rule and the number of the occurrence only. So a rule decides the same
/// whatever stands beside it.
#[derive(Debug, Default)]
pub struct FaultRules {
    seed: u64,
    line: String,
    rules: Vec<ActiveRule>,
}

#[derive(Debug)]
struct ActiveRule {
    name: Arc<str>,
    when: When,
    effect: FaultEffect,
    fork: Fork,
    seen: u64,
    hits: u64,
}

impl FaultRules {
    /// No rules yet, for the line called `line` in a run with `seed`.
    pub fn new(seed: u64, line: &str) -> Self {
        Self { seed, line: line.to_owned(), rules: Vec::new() }
    }

    /// Puts `rule` behind all others, unless there is one of that name. Was it put there? One that was
    /// removed before begins anew.
    #[must_use]
    pub fn add(&mut self, rule: FaultRule) -> bool {
        if self.names().any(|name| name == rule.name) {
            return false;
        }
        let fork = self.fork(&rule.name);
        let FaultRule { name, when, effect } = rule;
        self.rules.push(ActiveRule { name: name.into(), when, effect, fork, seen: 0, hits: 0 });
        true
    }

    /// Takes the rule called `name` away. Was there one?
    pub fn remove(&mut self, name: &str) -> bool {
        let before = self.rules.len();
        self.rules.retain(|it| *it.name != *name);
        self.rules.len() < before
    }

    /// The streams of random numbers for something else on this line.
    pub fn fork(&self, name: &str) -> Fork {
        Fork::new(self.seed, &self.line, name)
    }

    /// The names of the rules, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.rules.iter().map(|it| &*it.name)
    }

    /// How often the rule called `name` has acted, if there is one.
    pub fn hits(&self, name: &str) -> Option<u64> {
        self.rules.iter().find(|it| *it.name == *name).map(|it| it.hits)
    }

    /// What happens to a request to `unit` at `now`: the first rule that holds acts. Rules that are impossible on Modbus
    /// TCP hold for no request that comes by it.
    pub(super) fn on_request(
        &mut self,
        now: Instant,
        unit: u8,
        request: &[u8],
        is_tcp: bool,
    ) -> Option<PendingHit> {
        let mut hit = None;
        for rule in &mut self.rules {
            let is_possible = !is_tcp || rule.effect.impossible_on_tcp().is_none();
            if !(is_possible && rule.concerns(now, unit, request)) {
                continue;
            }
            rule.seen += 1;
            if hit.is_none() {
                hit = rule.act(unit, request);
            }
        }
        hit
    }
}

impl ActiveRule {
    /// Is a request to `unit` at `now` an occurrence of this rule?
    fn concerns(&self, now: Instant, unit: u8, request: &[u8]) -> bool {
        let When { functions, spans, from, until, .. } = &self.when;
        let function = request.first().copied().unwrap_or(0);
        *from <= now
            && until.is_none_or(|until| now < until)
            && self.when.unit.is_none_or(|it| it == unit)
            && (functions.is_empty() || functions.contains(&function))
            && (spans.is_empty() || touches(spans, request))
            && (unit != BROADCAST || self.effect.takes_broadcasts())
            && self.effect.has_effect(unit, function)
    }

    /// Acts, if it is its turn and its chance comes up.
    fn act(&mut self, unit: u8, request: &[u8]) -> Option<PendingHit> {
        let spent = self.when.count.is_some_and(|count| self.hits >= count);
        if spent || !self.when.is_turn(self.seen) {
            return None;
        }
        let mut rng = self.fork.stream(self.seen);
        if self.when.chance.is_some_and(|chance| !rng.happens(chance)) {
            return None;
        }
        self.hits += 1;
        let function = request.first().copied().unwrap_or(0);
        let effect = self.effect.draw(unit, function, &mut rng);
        let hit = FaultHit { rule: self.name.clone(), unit, effect, hit: self.hits };
        Some(PendingHit { hit, rng })
    }
}

impl When {
    /// Is it the turn of occurrence number `n`, counted from 1?
    fn is_turn(&self, n: u64) -> bool {
        n > self.skip && (n - self.skip).is_multiple_of(self.every)
    }
}

fn touches(spans: &[Span], request: &[u8]) -> bool {
    let request = Request::parse(request, LengthCheck::CountOnly);
    let Ok(touched) = request.map(Request::span) else { return false };
    spans.iter().any(|span| span.start() <= touched.last() && touched.start() <= span.last())
}

impl fmt::Display for FaultHit {
    /// `fault lose_reply: the reply of unit 1 was lost (hit 1)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rule, unit, effect, hit } = self;
        write!(f, "fault {rule}: {} (hit {hit})", effect.describe(*unit))
    }
}

impl Serialize for FaultHit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            rule: &'a str,
            kind: &'static str,
            unit: u8,
            hit: u64,
            #[serde(flatten)]
            effect: &'a FaultEffect,
        }
        let Self { rule, unit, effect, hit } = self;
        Fields { rule, kind: effect.name(), unit: *unit, hit: *hit, effect }.serialize(serializer)
    }
}

/// What every hit has, and the keys of each kind with the numbers that were drawn.
#[cfg(feature = "cli")]
impl schemars::JsonSchema for FaultHit {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "FaultHit".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let kinds: Vec<_> = FaultKind::ALL.iter().map(|kind| kind.name).collect();
        let number = |about: &str| serde_json::json!({ "type": "integer", "description": about });
        let mut properties = serde_json::json!({
            "rule": { "type": "string", "description": "The name of the rule." },
            "kind": { "enum": kinds, "description": "What it does." },
            "unit": number("The unit address that was asked, 0 to 255."),
            "hit": number("How often the rule has acted so far, from 1."),
        });
        for key in FaultKind::ALL.iter().flat_map(|kind| kind.keys) {
            let about = format!("Of this hit: {}.", key.about);
            properties[key.name] =
                serde_json::json!({ "type": ["number", "null"], "description": about });
        }
        for (name, about) in FaultKind::ALL.iter().flat_map(|kind| kind.reports) {
            let about = format!("Of this hit: {about}");
            properties[*name] = serde_json::json!({ "type": "boolean", "description": about });
        }
        schemars::json_schema!({
            "type": "object",
            "properties": properties,
            "required": ["rule", "kind", "unit", "hit"],
        })
    }
}
