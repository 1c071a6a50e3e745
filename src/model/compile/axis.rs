//! The axis: its counts, its gear, its units, and whether rows and axis go together.

use super::names::Names;
use super::quantities::{self, Numbers};
use super::segments;
use super::wired::Wired;
use crate::model::raw::{RawAxis, RawCounts, RawGear};
use crate::model::{AxisWiring, Choice, Counts, Gear, Number};
use crate::problem::{Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{InhibitRule, Input, Named, Quantity};

/// The axis of the model; without one in the file, one that nothing moves.
pub(super) fn compile(
    raw: Option<&RawAxis>,
    wired: &Wired,
    numbers: &Numbers,
    names: &mut Names,
) -> AxisWiring {
    let path = Path::root().key("axis");
    let mut axis = AxisWiring { settings: numbers.settings.clone(), ..AxisWiring::default() };
    axis.segments = segments::compile(raw, wired, numbers, names);
    axis.interrupt = segments::interrupt(raw, wired, numbers, names);
    if let Some(raw) = raw {
        axis.inhibit = inhibit(raw, wired, &path.key("inhibit"), names);
        physics(raw, &mut axis, wired, numbers, &path, names);
    }
    axis.number_slots();
    axis
}

/// What the axis is made of.
fn physics(
    raw: &RawAxis,
    axis: &mut AxisWiring,
    wired: &Wired,
    numbers: &Numbers,
    path: &Path,
    names: &mut Names,
) {
    let per_rev = path.key("counts_per_rev");
    if let Some(it) = counts(&raw.counts_per_rev, &per_rev, names) {
        not_zero(it, &per_rev, names);
        axis.counts_per_rev = it;
    }
    let encoder = raw.encoder.as_ref();
    axis.encoder = encoder.and_then(|it| counts(it, &path.key("encoder"), names));
    check_increments(encoder.is_some(), numbers, path, names);
    if let Some(coast) = names.duration(raw.coast.as_deref(), &path.key("coast")) {
        axis.coast = coast;
    }
    if raw.position_gain.is_some_and(|gain| !(0.1..=10_000.0).contains(&gain)) {
        let what = "`position_gain` must be between 0.1 and 10000 1/s";
        names.report(Problem::value(path.key("position_gain"), what));
    }
    axis.position_gain = raw.position_gain;
    axis.pole_pairs = pole_pairs(raw.pole_pairs, wired, path, names).unwrap_or(axis.pole_pairs);
    let reversed = raw.reversed.as_ref();
    axis.reversed = reversed.and_then(|it| names.row(it, &path.key("reversed")));
    axis.gear = raw.gear.as_ref().and_then(|it| gear(it, &path.key("gear"), names));
    let unit = raw.speed_unit.as_ref();
    axis.speed_unit = unit.and_then(|it| {
        names.coded(it, &path.key("speed_unit"), |names, text, path| speed_unit(text, path, names))
    });
}

/// What becomes of a deviation when commands are inhibited, where something inhibits them.
fn inhibit(
    raw: &RawAxis,
    wired: &Wired,
    path: &Path,
    names: &mut Names,
) -> Option<Choice<InhibitRule>> {
    if raw.inhibit.is_some() && !wired.has(Input::CommandInhibit) {
        let what = "has no effect: no input is `command_inhibit`";
        names.report(Problem::key(path.clone(), what).advise("wire it, or remove this"));
    }
    names.word_choice(raw.inhibit.as_ref(), "rule for inhibited commands", path)
}

fn pole_pairs(raw: Option<u16>, wired: &Wired, path: &Path, names: &mut Names) -> Option<u16> {
    let angle = Quantity::ElectricalAngle;
    let (shown, name) = (wired.shows_quantity(angle), angle.name());
    match raw {
        Some(0) => {
            let what = "`pole_pairs` must be at least 1";
            names.report(Problem::value(path.key("pole_pairs"), what));
        }
        Some(_) if !shown => {
            names.without_effect("pole_pairs", &format!("no row shows `{name}`"), path);
        }
        None if shown => {
            let what = format!("`{name}` is shown, but the number of pole pairs is missing");
            let problem = Problem::key(quantities::path(name), what);
            names.report(problem.advise("add `pole_pairs: N` to `axis`"));
        }
        _ => {}
    }
    raw
}

fn speed_unit(text: &str, path: &Path, names: &mut Names) -> Option<f64> {
    let unit = Unit::parse(text).filter(|it| it.dimension == Dimension::Speed);
    if unit.is_none() {
        let problem = Problem::value(path.clone(), format!("`{text}` is not a unit of speed"));
        names.report(problem.advise("write `rpm`, or a factor and `rpm`: `0.1 rpm`"));
    }
    unit.map(|it| it.scale)
}

fn gear(raw: &RawGear, path: &Path, names: &mut Names) -> Option<Gear> {
    let mut whole = |register: &str, key: &str| {
        let path = path.key(key);
        let id = names.row(register, &path)?;
        let row = names.get(id);
        if row.spans.iter().any(|(low, _)| *low <= 0) {
            let what = format!(
                "{} can be 0 or less, but a gear ratio needs numbers of at least 1",
                row.id
            );
            let problem = Problem::value(path, what);
            names.report(problem.advise("give the row a `range` that begins at 1"));
        }
        Some(id)
    };
    let numerator = whole(&raw.numerator, "numerator");
    let denominator = whole(&raw.denominator, "denominator");
    Some(Gear { numerator: numerator?, denominator: denominator? })
}

fn counts(raw: &RawCounts, path: &Path, names: &mut Names) -> Option<Counts> {
    let id = match raw {
        RawCounts::Number(0) => {
            let what = "a revolution has at least 1 count";
            names.report(Problem::value(path.clone(), what));
            return None;
        }
        RawCounts::Number(number) => return Some(Counts::Fixed(*number)),
        RawCounts::Row(register) => names.row(register, path)?,
    };
    let row = names.get(id);
    if row.unit.dimension != Dimension::Resolution {
        let what = format!("{} must be in counts per revolution", row.id);
        let problem = Problem::value(path.clone(), what);
        names.report(problem.advise("give the row `unit: counts/rev`"));
    }
    Some(Counts::Row(id))
}

fn not_zero(counts: Counts, path: &Path, names: &mut Names) {
    let Counts::Row(row) = counts else { return };
    let row = names.get(row);
    if row.spans.iter().any(|(low, _)| *low <= 0) {
        let what = format!("{} can be 0, but a revolution has at least 1 count", row.id);
        let problem = Problem::value(path.clone(), what);
        names.report(problem.advise("give the row a `range` that begins at 1"));
    }
}

/// Rows in increments and what says how many of them make a revolution go together.
fn check_increments(known: bool, numbers: &Numbers, path: &Path, names: &mut Names) {
    let settings = numbers.settings.iter().map(|it| names.get(it.row).unit);
    let thresholds = numbers.thresholds.iter().map(|(_, number)| match number {
        Number::Fixed(unit) => *unit,
        Number::Row(row) => names.get(*row).unit,
    });
    let used = settings.chain(thresholds).any(|it| it.dimension == Dimension::Increments);
    if used && !known {
        let what = "a row is in `inc`, but the number of increments per revolution is missing";
        let problem = Problem::key(path.clone(), what);
        names.report(problem.advise("add `encoder: N`, or a row for N"));
    }
    if known && !used {
        names.without_effect("encoder", "no row that is wired is in `inc`", path);
    }
}
