//! How one segment follows another: the rule of a segment taken to pieces, and the rows that go with it.

use super::expand::number;
use super::names::Names;
use super::uses::one_word;
use crate::model::raw::RawChain;
use crate::model::{ChainLink, ChainRules};
use crate::problem::{Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Condition, Named};

/// What all segments of a chain have in common.
pub(super) fn chain_rules(raw: &RawChain, path: &Path, names: &mut Names) -> ChainRules {
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
        names.report(Problem::value(path, what));
    }
    let mut codes = Vec::new();
    for (code, name) in &raw.codes {
        let path = path.key("codes").key(code);
        if *code > 0xF {
            let what = format!("a hex digit is never {code}");
            names.report(Problem::key(path.clone(), what));
        }
        codes.extend(names.word::<Condition>(name, "condition", &path).map(|it| (*code, it)));
    }
    for (name, bit) in [("all", raw.all), ("through", raw.through)] {
        if bit.is_some_and(|bit| bit > 15 || digits.contains(&(bit / 4))) {
            let what = "must be a bit from 0 to 15 that no condition uses";
            names.report(Problem::value(path.key(name), what));
        }
    }
    let units = units(raw, &codes, &path.key("units"), names);
    ChainRules { digits, codes, units, all: raw.all, through: raw.through }
}

/// The units of the values that conditions have.
fn units(
    raw: &RawChain,
    codes: &[(u8, Condition)],
    path: &Path,
    names: &mut Names,
) -> Vec<(Condition, Unit)> {
    let mut units = Vec::new();
    let measured =
        [(Condition::Delay, Dimension::Time), (Condition::Position, Dimension::Position)];
    for (condition, dimension) in measured {
        let name = condition.name();
        let text = raw.units.get(name).map(String::as_str);
        let coded = codes.iter().any(|(_, it)| *it == condition);
        let unit = text.and_then(Unit::parse).filter(|it| it.dimension == dimension);
        if coded != text.is_some() || text.is_some() && unit.is_none() {
            let symbols: Vec<_> = Unit::symbols_of(dimension).collect();
            let what = format!(
                "`{name}` needs a unit if and only if it has a code: {}",
                symbols.join(" or ")
            );
            names.report(Problem::value(path.clone(), what));
        }
        units.extend(unit.map(|it| (condition, it)));
    }
    let plain = |name: &&String| !measured.iter().any(|(it, _)| it.name() == name.as_str());
    for name in raw.units.keys().filter(plain) {
        let what = format!("condition `{name}` has no value");
        names.report(Problem::key(path.key(name), what));
    }
    units
}

/// How segment `n` gives way to the next.
pub(super) fn link(
    raw: &RawChain,
    rules: &ChainRules,
    n: u16,
    path: &Path,
    names: &mut Names,
) -> Option<ChainLink> {
    let next = names.row(&number(&raw.next, n), &path.key("next"));
    let rule = names.row(&number(&raw.rule, n), &path.key("rule"));
    rule.into_iter().for_each(|rule| one_word(rule, &path.key("rule"), names));
    let mut values = Vec::new();
    for (i, condition) in raw.conditions.iter().enumerate().take(rules.digits.len()) {
        let path = path.key("conditions").index(i).key("value");
        values.push(names.row(&number(&condition.value, n), &path)?);
    }
    Some(ChainLink { next: next?, rule: rule?, values })
}
