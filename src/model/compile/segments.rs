//! Motions by number and the move that interrupts others: their rows, found and checked, and whether what
//! selects, starts and shows them goes together with them.

use super::expand::number;
use super::names::{Names, nearest_or_all};
use super::quantities::{self, Numbers, setting_row};
use super::uses::one_word;
use super::wired::Wired;
use crate::model::raw::{
    RawAxis, RawChain, RawChoice, RawChosen, RawPositionSegments, RawQuantity, RawSegments,
    RawVelocitySegments,
};
use crate::model::{
    ChainLink, ChainRules, Choice, InterruptWiring, PositionSegment, PositionSegments, Segments,
    SettingRow, VelocitySegments,
};
use crate::problem::{Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{
    Condition, Input, InterruptRule, Lasts, Named, Output, Quantity, Setting, Target,
};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The bits of the selection, lowest first.
const SELECTS: [Input; 4] = [Input::Select0, Input::Select1, Input::Select2, Input::Select3];

/// More than any drive has: a slip of the pen is told at once, not row by row.
const SEGMENTS_MAX: usize = 256;

/// What a segment needs and what else it may go by.
struct Takes {
    needs: &'static [Setting],
    takes: &'static [Setting],
}

const MOVE: Takes = Takes {
    needs: &[Setting::MoveTarget, Setting::MoveSpeed],
    takes: &[Setting::MoveStartSpeed, Setting::MoveAccel, Setting::MoveDecel],
};

const RUN: Takes = Takes {
    needs: &[Setting::RunSpeed],
    takes: &[Setting::RunStartSpeed, Setting::RunAccel, Setting::RunDecel],
};

/// The segments of the axis.
pub(super) fn compile(
    raw: Option<&RawAxis>,
    wired: &Wired,
    numbers: &Numbers,
    names: &mut Names,
) -> Segments {
    let (none, path) = (RawSegments::default(), Path::root().key("axis").key("segments"));
    let raw = raw.map_or(&none, |raw| &raw.segments);
    let position = raw.position.as_ref();
    let position = position.and_then(|it| moves(it, wired, numbers, &path.key("position"), names));
    let velocity = raw.velocity.as_ref();
    let velocity = velocity.and_then(|it| runs(it, wired, numbers, &path.key("velocity"), names));
    let segments = Segments { position, velocity };
    check_signals(raw, &segments, wired, &path, names);
    segments
}

fn moves(
    raw: &RawPositionSegments,
    wired: &Wired,
    numbers: &Numbers,
    path: &Path,
    names: &mut Names,
) -> Option<PositionSegments> {
    let all = reachable(raw.n, raw.chain.is_some(), wired, path, names)?;
    let chain = raw.chain.as_ref().map(|raw| chain_rules(raw, &path.key("chain"), names));
    let list = each(all, names, |n, names| {
        let settings = settings(&raw.quantities, n, &MOVE, numbers, path, names);
        let kind = target(raw.kind.as_ref(), n, &path.key("kind"), names);
        let link = match (&raw.chain, &chain) {
            (Some(raw), Some(rules)) => link(raw, rules, n, &path.key("chain"), names),
            _ => None,
        };
        let kind = kind.unwrap_or(Choice::Fixed(Target::Relative));
        PositionSegment { settings, kind, link }
    });
    Some(PositionSegments { first: raw.n[0], list, chain })
}

fn runs(
    raw: &RawVelocitySegments,
    wired: &Wired,
    numbers: &Numbers,
    path: &Path,
    names: &mut Names,
) -> Option<VelocitySegments> {
    let all = reachable(raw.n, false, wired, path, names)?;
    let list =
        each(all, names, |n, names| settings(&raw.quantities, n, &RUN, numbers, path, names));
    let path = path.key("trigger");
    let trigger = match &raw.trigger {
        None => Choice::Fixed(Lasts::Level),
        trigger => names.word_choice(trigger.as_ref(), "trigger of a velocity segment", &path)?,
    };
    Some(VelocitySegments { first: raw.n[0], list, trigger })
}

/// What all segments of a chain have in common.
fn chain_rules(raw: &RawChain, path: &Path, names: &mut Names) -> ChainRules {
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
fn link(
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

/// Interrupt positioning, and whether its signals go with it.
pub(super) fn interrupt(
    raw: Option<&RawAxis>,
    wired: &Wired,
    numbers: &Numbers,
    names: &mut Names,
) -> Option<InterruptWiring> {
    let path = Path::root().key("axis").key("interrupt");
    let Some(raw) = raw.and_then(|raw| raw.interrupt.as_ref()) else {
        without_interrupt(wired, names);
        return None;
    };
    let settings = settings(&raw.quantities, 0, &MOVE, numbers, &path, names);
    let rule = match &raw.rule {
        None => Some(Choice::Fixed(InterruptRule::Free)),
        rule => {
            let kind = "rule for interrupt positioning";
            names.word_choice(rule.as_ref(), kind, &path.key("rule"))
        }
    };
    if !wired.has(Input::InterruptStart) {
        let what = "has no effect: no input is `interrupt_start`";
        names.report(Problem::key(path, what).advise("wire it, or remove this"));
    }
    rule.map(|rule| InterruptWiring { settings, rule })
}

fn without_interrupt(wired: &Wired, names: &mut Names) {
    let inputs = [Input::InterruptStart, Input::InterruptUnlock, Input::InterruptInhibit];
    let inputs = inputs.into_iter().filter(|it| wired.has(*it)).map(Named::name);
    let outputs = [Output::InterruptActive, Output::InterruptDone];
    let outputs = outputs.into_iter().filter(|it| wired.shows(*it)).map(Named::name);
    for name in inputs.chain(outputs) {
        let what = format!("`{name}` has no effect without axis.interrupt");
        names.report(Problem::key(Path::root().key("signals"), what).advise("remove it"));
    }
}

/// Compiles the segments one by one. A mistake shared by several of them is reported for the first.
fn each<T>(
    numbers: RangeInclusive<u16>,
    names: &mut Names,
    mut segment: impl FnMut(u16, &mut Names) -> T,
) -> Vec<T> {
    let mut told = false;
    let each = |n| {
        let before = names.problems.len();
        let segment = segment(n, names);
        if told {
            names.problems.truncate(before);
        }
        told |= names.problems.len() > before;
        segment
    };
    numbers.map(each).collect()
}

/// The numbers of segments, if there are any; those that nothing can reach are a problem.
fn reachable(
    n: [u16; 2],
    chained: bool,
    wired: &Wired,
    path: &Path,
    names: &mut Names,
) -> Option<RangeInclusive<u16>> {
    let ([first, last], path) = (n, path.key("n"));
    if first > last {
        let what = format!("the range {first} to {last} is empty");
        names.report(Problem::value(path, what).advise("give the lower number first"));
        return None;
    }
    let count = usize::from(last - first) + 1;
    if count > SEGMENTS_MAX {
        let what = format!("{count} segments, but at most {SEGMENTS_MAX} are allowed");
        names.report(Problem::value(path, what));
        return None;
    }
    let reach = 1 << SELECTS.iter().take_while(|it| wired.has(**it)).count();
    if count > reach && !chained {
        let what = format!("{count} segments, but the inputs can select only {reach}");
        let problem = Problem::value(path, what);
        names.report(problem.advise("wire `select_0` to `select_3`, or use fewer segments"));
    }
    Some(first..=last)
}

/// The rows that segment `n`, or interrupt positioning, goes by.
fn settings(
    raw: &BTreeMap<String, RawQuantity>,
    n: u16,
    takes: &Takes,
    numbers: &Numbers,
    path: &Path,
    names: &mut Names,
) -> Vec<SettingRow> {
    let path = path.key("quantities");
    let all = || takes.needs.iter().chain(takes.takes).map(|it| it.name());
    let mut settings = Vec::new();
    for (name, raw) in raw {
        let path = path.key(name);
        let Some(setting) = Setting::parse(name).filter(|_| all().any(|it| it == name)) else {
            let what = format!("`{name}` is not used here");
            names.report(Problem::key(path, what).advise(nearest_or_all(name, all)));
            continue;
        };
        let Some(row) = names.row(&number(raw.register(), n), &path) else { continue };
        settings.push(setting_row(setting, row, raw, numbers.taken, &path, names));
    }
    for need in takes.needs.iter().filter(|it| !raw.contains_key(it.name())) {
        let what = format!("no row holds `{}`", need.name());
        names.report(Problem::value(path.clone(), what));
    }
    settings
}

/// What the target of segment `n` is.
fn target(
    raw: Option<&RawChoice<String>>,
    n: u16,
    path: &Path,
    names: &mut Names,
) -> Option<Choice<Target>> {
    let of_segment = match raw {
        None => return Some(Choice::Fixed(Target::Relative)),
        Some(RawChoice::Row(of_all)) => {
            let register = number(&of_all.register, n);
            RawChoice::Row(RawChosen { register, ..of_all.clone() })
        }
        Some(fixed) => fixed.clone(),
    };
    names.word_choice(Some(&of_segment), "target kind", path)
}

/// What starts, selects, turns round or shows segments, and the segments themselves: one without the
/// other has no effect.
fn check_signals(
    raw: &RawSegments,
    segments: &Segments,
    wired: &Wired,
    path: &Path,
    names: &mut Names,
) {
    let (moves, runs) = (raw.position.is_some(), raw.velocity.is_some());
    let chain = segments.position.as_ref().and_then(|it| it.chain.as_ref());
    let steps = chain.is_some_and(ChainRules::waits_for_a_step);
    let mut goes_with = vec![
        (Input::SegmentStart, moves, "axis.segments.position"),
        (Input::SegmentRun, runs, "axis.segments.velocity"),
        (Input::SegmentReverse, runs, "axis.segments.velocity"),
        (Input::SegmentStep, steps, "condition `step` of a chain"),
    ];
    goes_with.extend(SELECTS.map(|it| (it, moves || runs, "axis.segments")));
    for (input, there, what) in goes_with {
        if !there && wired.has(input) {
            let what = format!("`{}` has no effect without {what}", input.name());
            names.report(Problem::key(Path::root().key("signals"), what).advise("remove it"));
        }
    }
    let needs = [
        (moves, path.key("position"), Input::SegmentStart),
        (runs, path.key("velocity"), Input::SegmentRun),
        (steps, path.key("position").key("chain").key("codes"), Input::SegmentStep),
    ];
    for (there, path, input) in needs {
        if there && !wired.has(input) {
            let what = format!("has no effect: no input is `{}`", input.name());
            let advice = "wire it, or remove this";
            names.report(Problem::key(path, what).advise(advice));
        }
    }
    if !moves {
        without_moves(wired, names);
    }
}

/// What shows the number of a segment, where no move has any.
fn without_moves(wired: &Wired, names: &mut Names) {
    let bits =
        [Output::Segment0, Output::Segment1, Output::Segment2, Output::Segment3, Output::Segment4];
    let bits = bits.into_iter().filter(|it| wired.shows(*it));
    let bits = bits.map(|it| (Path::root().key("signals"), it.name()));
    let shown = [Quantity::SegmentRunning, Quantity::SegmentNext].into_iter();
    let shown = shown.filter(|it| wired.shows_quantity(*it));
    let shown = shown.map(|it| (quantities::path(it.name()), it.name()));
    for (path, name) in bits.chain(shown) {
        let what = format!("`{name}` is always 0 without axis.segments.position");
        names.report(Problem::key(path, what).advise("remove it"));
    }
}
