//! How one segment follows another: the rule of a segment taken to pieces, and the rows that go with it.

use super::compile::Wirer;
use crate::model::expand::number;
use crate::model::raw::RawChain;
use crate::problem::{Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Condition, Named, RowId};

/// What all segments of a chain have in common.
#[derive(Debug)]
pub struct ChainRules {
    /// Which hex digit of the rule has the code of each condition, from the right.
    pub digits: Vec<u8>,
    /// Condition by code.
    pub codes: Vec<(u8, Condition)>,
    /// Unit of a condition's value.
    pub units: Vec<(Condition, Unit)>,
    /// Bit of the rule: wait for all conditions.
    pub all: Option<u8>,
    /// Bit of the rule: go on in motion.
    pub through: Option<u8>,
}

/// How one segment gives way.
#[derive(Debug)]
pub struct ChainLink {
    /// The row with the number of the next.
    pub next: RowId,
    /// The row with the rule.
    pub rule: RowId,
    /// The rows with the conditions' values.
    pub values: Vec<RowId>,
}

impl ChainLink {
    /// Every row of it.
    pub(super) fn rows(&self) -> impl Iterator<Item = RowId> {
        [self.next, self.rule].into_iter().chain(self.values.iter().copied())
    }
}

impl ChainRules {
    /// The conditions of `rule`, each with the index of its value.
    pub fn conditions(&self, rule: u32) -> impl Iterator<Item = (usize, Condition)> {
        self.digits.iter().enumerate().filter_map(move |(i, digit)| {
            let code = (rule >> (4 * digit) & 0xF) as u8;
            self.codes.iter().find(|(it, _)| *it == code).map(|(_, condition)| (i, *condition))
        })
    }

    /// `value` of a condition in the base unit of its dimension.
    pub fn value(&self, condition: Condition, value: i64) -> f64 {
        let unit = self.units.iter().find(|(it, _)| *it == condition);
        value as f64 * unit.map_or(1.0, |(_, unit)| unit.scale)
    }

    pub(super) fn waits_for_a_step(&self) -> bool {
        self.codes.iter().any(|(_, it)| *it == Condition::HomingStep)
    }
}

impl Wirer<'_> {
    pub(super) fn chain_rules(&mut self, raw: &RawChain, path: &Path) -> ChainRules {
        let mut digits = Vec::new();
        for (i, condition) in raw.conditions.iter().enumerate() {
            let path = path.key("conditions").index(i).key("digit");
            let what = match condition.digit {
                digit if digit > 3 => format!("a rule has hex digits 0 to 3, not {digit}"),
                digit if digits.contains(&digit) => {
                    format!("digit {digit} is already used by another condition")
                }
                digit => {
                    digits.push(digit);
                    continue;
                }
            };
            self.problems.push(Problem::value(path, what));
        }
        let mut codes = Vec::new();
        for (code, name) in &raw.codes {
            let path = path.key("codes").key(code);
            if *code > 0xF {
                let what = format!("a hex digit is never {code}");
                self.problems.push(Problem::key(path.clone(), what));
            }
            codes.extend(self.word::<Condition>(name, "condition", &path).map(|it| (*code, it)));
        }
        for (name, bit) in [("all", raw.all), ("through", raw.through)] {
            if bit.is_some_and(|bit| bit > 15 || digits.contains(&(bit / 4))) {
                let what = "must be a bit from 0 to 15 that no condition uses";
                self.problems.push(Problem::value(path.key(name), what));
            }
        }
        let units = self.condition_units(raw, &codes, path);
        ChainRules { digits, codes, units, all: raw.all, through: raw.through }
    }

    fn condition_units(
        &mut self,
        raw: &RawChain,
        codes: &[(u8, Condition)],
        path: &Path,
    ) -> Vec<(Condition, Unit)> {
        let mut units = Vec::new();
        let measured =
            [(Condition::Delay, Dimension::Time), (Condition::Position, Dimension::Position)];
        for (condition, dimension) in measured {
            let text = raw.units.get(condition.name()).map(String::as_str);
            let coded = codes.iter().any(|(_, it)| *it == condition);
            let unit = text.and_then(Unit::parse).filter(|it| it.dimension == dimension);
            if coded != text.is_some() || text.is_some() && unit.is_none() {
                let symbols: Vec<_> = Unit::symbols_of(dimension).collect();
                let what = format!(
                    "`{}` needs a unit if and only if it has a code: {}",
                    condition.name(),
                    symbols.join(" or ")
                );
                self.problems.push(Problem::value(path.key("units"), what));
            }
            units.extend(unit.map(|it| (condition, it)));
        }
        let plain = |name: &&String| !measured.iter().any(|(it, _)| it.name() == name.as_str());
        for name in raw.units.keys().filter(plain) {
            let what = format!("condition `{name}` has no value");
            self.problems.push(Problem::key(path.key("units").key(name), what));
        }
        units
    }

    pub(super) fn link(
        &mut self,
        raw: &RawChain,
        rules: &ChainRules,
        n: u16,
        path: &Path,
    ) -> Option<ChainLink> {
        let next = self.row(&number(&raw.next, n), &path.key("next"));
        let rule = self.row(&number(&raw.rule, n), &path.key("rule"));
        rule.into_iter().for_each(|rule| self.one_word(rule, &path.key("rule")));
        let mut values = Vec::new();
        for (i, condition) in raw.conditions.iter().enumerate().take(rules.digits.len()) {
            let path = path.key("conditions").index(i).key("value");
            values.push(self.row(&number(&condition.value, n), &path)?);
        }
        Some(ChainLink { next: next?, rule: rule?, values })
    }
}
