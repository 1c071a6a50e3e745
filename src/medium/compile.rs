//! From a rule as it is written to a [`FaultRule`], or to everything that is wrong with it.
//!
//! A rule that could do nothing is refused: an inert rule makes a test pass that tests nothing.

use super::keys::{self, FaultKeys, KeyRefusal};
use super::raw::{COMMON_KEYS, RawAct, RawFault, RawFaultRegister, RawFunctions};
use super::{FaultEffect, FaultKind, FaultRule, LineBehaviour, When, spec};
use crate::problem::decode::decode;
use crate::problem::tree::Node;
use crate::problem::{Path, Problem, is_unread, placed, suggest};
use crate::rng::Chance;
use crate::time::{Duration, Instant};
use crate::units::parse_integer;
use crate::wire::{BROADCAST, Span};
use std::ops::RangeInclusive;

/// What a rule has to know of its line when it is read.
pub trait FaultContext {
    /// Is it Modbus TCP, without checksums and wires?
    fn is_tcp(&self) -> bool;

    /// What it always does already.
    fn line_behaviour(&self) -> &LineBehaviour;

    /// Where the row called `name` can be reached.
    ///
    /// # Errors
    /// Why it can't be told.
    fn spans(&self, name: &str) -> Result<Vec<Span>, NoRow>;
}

/// Why a row's name gives no addresses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoRow {
    /// Why.
    pub what: String,
    /// What to do.
    pub advice: Option<String>,
}

/// What one rule as it is written makes of a line.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FaultSet {
    /// The rule, or those of a preset.
    pub rules: Vec<FaultRule>,
    /// The line behaviour of a preset.
    pub line_behaviour: LineBehaviour,
}

/// Reads the compact form of one rule or preset for `site`, where rules called `taken` stand already.
///
/// # Errors
/// Everything that is wrong with it, each with its place in `spec`.
pub fn parse(
    spec: &str,
    site: &dyn FaultContext,
    taken: &[&str],
) -> Result<FaultSet, Vec<Problem>> {
    let mut problems = Vec::new();
    let tree = spec::cut(spec, &mut problems);
    let path = Path::root();
    let raw: Option<RawFault> = decode(&tree, &path, &[], &mut problems);
    let rules = raw.map(|raw| compile(&raw, &tree, &path, site, taken, &mut problems));
    if problems.is_empty() {
        return Ok(rules.unwrap_or_default());
    }
    Err(placed(problems, &tree))
}

/// Compiles the rule at `path` for `site`, where rules called `taken` stand already. A preset gives several
/// rules. What is wrong goes to `problems`; then what comes back is not to be used.
pub fn compile(
    raw: &RawFault,
    node: &Node,
    path: &Path,
    site: &dyn FaultContext,
    taken: &[&str],
    problems: &mut Vec<Problem>,
) -> FaultSet {
    let is_known = !is_unread(problems, &path.key("do"));
    let mut reader = FaultReader { raw, node, path, site, problems };
    match is_known {
        true => reader.refuse_idle_keys(),
        false => reader.refuse_keys_of_no_kind(),
    }
    let name = reader.name(taken);
    let when = reader.when();
    if !is_known {
        return FaultSet::default();
    }
    let preset = match raw.act {
        RawAct::Preset(preset) => preset,
        RawAct::Kind(kind) => {
            let effect = reader.effect(kind);
            let rules = effect.map(|effect| FaultRule { name, when, effect }).into_iter().collect();
            return FaultSet { rules, line_behaviour: LineBehaviour::default() };
        }
    };
    let mut rules: Vec<FaultRule> = Vec::new();
    for spec in preset.rules {
        let names: Vec<_> = rules.iter().map(|it| it.name.as_str()).collect();
        for rule in parse(spec, site, &names).unwrap_or_default().rules {
            let when = When { chance: rule.when.chance, ..when.clone() };
            rules.push(FaultRule { when, ..rule });
        }
    }
    rules.iter_mut().for_each(|rule| rule.name = format!("{name}.{}", rule.name));
    FaultSet { rules, line_behaviour: preset.line_behaviour() }
}

struct FaultReader<'a> {
    raw: &'a RawFault,
    /// The rule in the tree, for the keys that its kind has of its own.
    node: &'a Node,
    path: &'a Path,
    site: &'a dyn FaultContext,
    problems: &'a mut Vec<Problem>,
}

impl FaultReader<'_> {
    fn refuse(&mut self, key: &str, what: impl Into<String>, advice: Option<&str>) {
        let problem = Problem::value(self.path.key(key), what);
        self.problems.push(problem.advise_if(advice.map(str::to_owned)));
    }

    /// A key that changes nothing for its kind, and a kind that changes nothing on its line.
    fn refuse_idle_keys(&mut self) {
        let raw = self.raw;
        let kind = raw.act;
        for key in raw.own.0.keys().filter(|key| !kind.has_key(key)) {
            let has = |kind: &&FaultKind| kind.key(key).is_some();
            let with: Vec<_> = FaultKind::ALL.iter().filter(has).map(|kind| kind.name).collect();
            let path = self.path.key(key);
            let problem = match with.is_empty() {
                true => unknown_key(key, path),
                false => {
                    let what = format!("`{key}` does not apply to `{}`", kind.name());
                    Problem::key(path, what).advise(format!("it applies to {}", with.join(", ")))
                }
            };
            self.problems.push(problem);
        }
        let is_preset = matches!(kind, RawAct::Preset(_));
        let turns = [
            ("skip", raw.skip.is_some()),
            ("every", raw.every.is_some()),
            ("probability", raw.probability.is_some()),
            ("count", raw.count.is_some()),
        ];
        for (key, _) in turns.iter().filter(|(_, given)| *given && is_preset) {
            let what = format!("a preset does not take `{key}`");
            let problem = Problem::key(self.path.key(key), what);
            self.problems.push(problem.advise("list the rules of the preset instead"));
        }
        self.refuse_incomplete_line_behaviour();
        if let Some(why) = kind.impossible_on_tcp().filter(|_| self.site.is_tcp()) {
            self.refuse("do", why, None);
        }
        if raw.unit == Some(BROADCAST) && !kind.takes_broadcasts() {
            let what = format!("a broadcast has no reply, so `{}` has no effect", kind.name());
            self.refuse("unit", what, None);
        }
    }

    /// Keys that no kind has, or that none could read, where the kind is not known.
    fn refuse_keys_of_no_kind(&mut self) {
        for key in self.raw.own.0.keys() {
            let (path, Some(node)) = (self.path.key(key), self.node.get(key)) else { continue };
            let mut refused = vec![vec![unknown_key(key, path.clone())]];
            let kinds = FaultKind::ALL.iter().filter_map(|kind| kind.key(key));
            refused.extend(kinds.map(|key| {
                let mut problems = Vec::new();
                FaultKeys::of(None).put(key, node, &path, &mut problems);
                problems
            }));
            if refused[1..].iter().all(|problems| !problems.is_empty()) {
                self.problems.extend(refused.pop().unwrap_or_default());
            }
        }
    }

    /// A setting of line behaviour is the whole line's, always, and a line has one of each.
    fn refuse_incomplete_line_behaviour(&mut self) {
        let (raw, line_behaviour) = (self.raw, self.raw.act.line_behaviour());
        if line_behaviour.is_empty() {
            return;
        }
        let conditions = [
            ("unit", raw.unit.is_some()),
            ("function", raw.function.is_some()),
            ("register", raw.register.is_some()),
            ("from", raw.from.is_some()),
            ("until", raw.until.is_some()),
        ];
        let preset = raw.act.name();
        for (key, _) in conditions.iter().filter(|(_, given)| *given) {
            let what = format!("`{preset}` applies to the whole line and takes no `{key}`");
            self.problems.push(Problem::key(self.path.key(key), what));
        }
        if let Some(key) = line_behaviour.shared(self.site.line_behaviour()) {
            let what = format!("`{preset}` sets `{key}`, which this line already has");
            self.refuse("do", what, None);
        }
    }

    fn name(&mut self, taken: &[&str]) -> String {
        let free = |name: &str| {
            let below = format!("{name}.");
            !taken.iter().any(|it| *it == name || it.starts_with(&below))
        };
        let Some(name) = &self.raw.name else {
            let kind = self.raw.act.name();
            let mut numbered = (2..).map(|n| format!("{kind}-{n}"));
            return match free(kind) {
                true => kind.to_owned(),
                false => numbered.find(|name| free(name)).unwrap_or_default(),
            };
        };
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
        if name.is_empty() || !name.chars().all(plain) {
            self.refuse("name", "a name may contain letters, digits, `_`, `-` and `.`", None);
        } else if !free(name) {
            let what = format!("duplicate rule name `{name}` on this line");
            self.refuse("name", what, Some("give each rule its own `name`"));
        }
        name.clone()
    }

    fn when(&mut self) -> When {
        let raw = self.raw;
        let unlimited = 1..=u64::MAX;
        if let Some(probability) = raw.probability.filter(|it| !(*it > 0.0 && *it <= 1.0)) {
            let what = format!("`probability` must be above 0 and at most 1, not {probability}");
            self.refuse("probability", what, None);
        }
        When {
            unit: raw.unit,
            functions: self.functions(),
            spans: self.spans(),
            from: self.instant("from", raw.from).unwrap_or(Instant::ZERO),
            until: self.until(),
            skip: raw.skip.unwrap_or(0),
            every: self.within("every", raw.every, unlimited.clone()).unwrap_or(1).max(1),
            chance: raw.probability.map(Chance::new),
            count: self.within("count", raw.count, unlimited),
        }
    }

    fn functions(&mut self) -> Vec<u8> {
        let functions = match &self.raw.function {
            None => return Vec::new(),
            Some(RawFunctions::One(function)) => vec![*function],
            Some(RawFunctions::Many(functions)) => functions.clone(),
        };
        if functions.is_empty() {
            self.refuse("function", "an empty list matches no request", Some("remove it"));
        }
        for function in &functions {
            self.within("function", Some(*function), 1..=0x7F);
        }
        functions
    }

    fn spans(&mut self) -> Vec<Span> {
        let name = match &self.raw.register {
            None => return Vec::new(),
            Some(RawFaultRegister::Address(address)) => return vec![Span::one(*address)],
            Some(RawFaultRegister::Name(name)) => name,
        };
        let unknown = match self.site.spans(name) {
            Ok(spans) => return spans,
            Err(unknown) => unknown,
        };
        let address = |text: &str| u16::try_from(parse_integer(text.trim())?).ok();
        if let Some(address) = address(name) {
            return vec![Span::one(address)];
        }
        let ends = name.split_once('-').and_then(|(a, b)| Some((address(a)?, address(b)?)));
        match ends {
            Some((first, last)) if first <= last => {
                Span::new(first, (last - first).saturating_add(1)).into_iter().collect()
            }
            Some(_) => {
                self.refuse("register", "a range must begin with its lower address", None);
                Vec::new()
            }
            None => {
                self.refuse("register", unknown.what, unknown.advice.as_deref());
                Vec::new()
            }
        }
    }

    fn instant(&mut self, key: &str, seconds: Option<f64>) -> Option<Instant> {
        let seconds = seconds?;
        match Duration::try_from_secs_f64(seconds) {
            Ok(after) => Some(Instant::ZERO + after),
            Err(_) => {
                let what = if seconds < 0.0 { "not be negative" } else { "be finite" };
                self.refuse(key, format!("`{key}` must {what}"), None);
                None
            }
        }
    }

    fn until(&mut self) -> Option<Instant> {
        let (from, until) = (self.raw.from.unwrap_or(0.0), self.raw.until?);
        let end = self.instant("until", Some(until))?;
        if until <= from {
            let what = format!("`until` must be later than `from`, {from} s");
            self.refuse("until", what, None);
        }
        Some(end)
    }

    /// What a rule of `kind` does, from the keys that the kind has of its own.
    fn effect(&mut self, kind: &FaultKind) -> Option<FaultEffect> {
        let mut keys = FaultKeys::of(self.raw.unit);
        for key in kind.keys {
            match self.node.get(key.name) {
                Some(node) => keys.put(key, node, &self.path.key(key.name), self.problems),
                None if key.is_required => {
                    let what = format!("`{}` needs `{}`", kind.name, key.name);
                    self.refuse("do", what, None);
                }
                None => {}
            }
        }
        match (kind.read)(&keys) {
            Ok(effect) => Some(effect),
            Err(KeyRefusal { key, what }) => {
                self.refuse(key, what, None);
                None
            }
        }
    }

    /// The value of `key`, if it is given and one of `range`.
    fn within<T: Copy + PartialOrd + std::fmt::Display>(
        &mut self,
        key: &str,
        value: Option<T>,
        range: RangeInclusive<T>,
    ) -> Option<T> {
        keys::within(key, value?, range, &self.path.key(key), self.problems)
    }
}

fn unknown_key(key: &str, path: Path) -> Problem {
    let own = FaultKind::ALL.iter().flat_map(|kind| kind.keys).map(|key| key.name);
    let advice = suggest::did_you_mean(key, COMMON_KEYS.iter().copied().chain(own));
    Problem::key(path, "unknown key").advise_if(advice)
}
