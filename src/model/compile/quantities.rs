//! Numbers by role: rows that show what the drive computes, what its motions and outputs go by, and whether outputs
//! and their numbers go together.

use super::names::{Names, nearest_or_all};
use super::uses::Uses;
use super::wired::Wired;
use crate::model::raw::{RawModel, RawQuantity};
use crate::model::{Applies, AxisWiring, Number, RowId, SettingRow, Shows};
use crate::problem::{At, Path, Problem};
use crate::units::{Dimension, Unit};
use crate::vocabulary::{Named, Output, Quantity, Setting, Taken, Threshold};

/// The numbers that motions and outputs go by.
pub(super) struct Numbers {
    /// Those of motions.
    pub settings: Vec<SettingRow>,
    /// Those of outputs.
    pub thresholds: Vec<(Threshold, Number)>,
    /// When settings count of which the file says nothing.
    pub taken: Taken,
}

impl Numbers {
    /// Does a row hold `setting`?
    pub fn has(&self, setting: Setting) -> bool {
        self.settings.iter().any(|it| it.setting == setting)
    }

    /// Is there a number for `threshold`?
    pub fn has_threshold(&self, threshold: Threshold) -> bool {
        self.thresholds.iter().any(|(it, _)| *it == threshold)
    }
}

/// Where `name` stands in the file.
pub(super) fn path(name: &str) -> Path {
    Path::root().key("quantities").key(name)
}

/// The numbers of the model; those that the drive computes go to `uses`.
pub(super) fn compile(raw: &RawModel, uses: &mut Uses, names: &mut Names) -> Numbers {
    let taken = raw
        .settings_taken
        .as_deref()
        .and_then(|it| names.word(it, "effect time", &Path::root().key("settings_taken")));
    let taken = taken.unwrap_or(Taken::AtOrder);
    let mut numbers = Numbers { settings: Vec::new(), thresholds: Vec::new(), taken };
    for (name, raw) in &raw.quantities {
        let (path, register) = (path(name), raw.register());
        if let Some(it) = Threshold::parse(name) {
            let number = threshold(it, register, &path, names);
            numbers.thresholds.extend(number.map(|number| (it, number)));
            no_setting(name, raw, &path, names);
            continue;
        }
        let (quantity, setting) = (Quantity::parse(name), Setting::parse(name));
        if quantity.is_none() && setting.is_none() {
            unknown(name, path, names);
            continue;
        }
        let Some(row) = names.row(register, &path) else { continue };
        if let Some(quantity) = quantity {
            dimension(row, name, &[quantity.dimension()], &path, names);
            uses.show(row, Shows::Quantity(quantity), &path, At::Value, names);
            no_setting(name, raw, &path, names);
        }
        if let Some(it) = setting {
            numbers.settings.push(setting_row(it, row, raw, taken, &path, names));
        }
    }
    numbers
}

/// The row of a setting, and when its values count; `silent` is when they do if nothing says so.
pub(super) fn setting_row(
    setting: Setting,
    row: RowId,
    raw: &RawQuantity,
    silent: Taken,
    path: &Path,
    names: &mut Names,
) -> SettingRow {
    dimension(row, setting.name(), setting.dimensions(), path, names);
    let said =
        raw.taken().and_then(|it| names.word::<Taken>(it, "effect time", &path.key("taken")));
    let printed = match names.get(row).applies {
        Some(Applies::Now) => Some(Taken::Live),
        Some(Applies::AtStop) => Some(Taken::AtStart),
        Some(Applies::PowerOn) | None => None,
    };
    let silent = if setting.is_bound() { Taken::Live } else { silent };
    // The axis numbers the slots when it has all its settings.
    SettingRow { setting, row, taken: said.or(printed).unwrap_or(silent), slot: 0 }
}

/// Something goes by `settings_taken`.
pub(super) fn check_taken(raw: &RawModel, axis: &AxisWiring, names: &mut Names) {
    let silent = |it: &SettingRow| !it.setting.is_bound() && names.get(it.row).applies.is_none();
    if raw.settings_taken.is_some() && !axis.all_settings().any(silent) {
        let what = "`settings_taken` has no effect: all settings have `applies` in their rows";
        let problem = Problem::key(Path::root().key("settings_taken"), what);
        names.report(problem.advise("remove it"));
    }
}

/// `text` is a number with its unit, or a row.
fn threshold(threshold: Threshold, text: &str, path: &Path, names: &mut Names) -> Option<Number> {
    let (name, want) = (threshold.name(), threshold.dimensions());
    let Some(number) = Unit::parse(text).filter(|_| text.contains(' ')) else {
        let row = names.row(text, path)?;
        dimension(row, name, want, path, names);
        return Some(Number::Row(row));
    };
    if !want.contains(&number.dimension) {
        let symbols: Vec<_> = want.iter().flat_map(|it| Unit::symbols_of(*it)).collect();
        let what = format!("`{name}` is in {}, and `{text}` is not", symbols.join(" or "));
        names.report(Problem::value(path.clone(), what));
    }
    Some(Number::Fixed(number))
}

/// What no motion goes by counts whenever somebody looks.
fn no_setting(name: &str, raw: &RawQuantity, path: &Path, names: &mut Names) {
    if raw.taken().is_some() {
        let what = format!("`taken` has no effect: `{name}` is not a setting of a motion");
        names.report(Problem::key(path.key("taken"), what).advise("remove it"));
    }
}

fn unknown(name: &str, path: Path, names: &mut Names) {
    let all = || {
        let quantities = Quantity::ALL.iter().map(|it| it.name());
        let settings = Setting::ALL.iter().map(|it| it.name());
        quantities.chain(settings).chain(Threshold::ALL.iter().map(|it| it.name()))
    };
    let what = format!("unknown quantity `{name}`");
    names.report(Problem::key(path, what).advise(nearest_or_all(name, all)));
}

/// The unit of `row` has one of the dimensions that `name` wants.
fn dimension(row: RowId, name: &str, want: &[Dimension], path: &Path, names: &mut Names) {
    let row = names.get(row);
    if want.contains(&row.unit.dimension) {
        return;
    }
    let symbols: Vec<_> = want.iter().flat_map(|it| Unit::symbols_of(*it)).collect();
    let (what, advice) = match symbols.as_slice() {
        [] => ("has no unit".to_owned(), "remove the unit".to_owned()),
        [first, ..] => {
            let what = format!("is in {}", symbols.join(" or "));
            (what, format!("give the row `unit: {first}`"))
        }
    };
    let have = match row.unit_text.as_str() {
        "" => "has no unit".to_owned(),
        unit => format!("is in {unit}"),
    };
    let what = format!("`{name}` {what}, but {} {have}", row.id);
    let advice = format!("{advice}, or wire another row");
    names.report(Problem::value(path.clone(), what).advise(advice));
}

/// An output with the number that it goes by, and whether it can do without.
const OUTPUT_NUMBERS: [(Output, Threshold, bool); 20] = [
    (Output::ZeroSpeed, Threshold::ZeroSpeed, true),
    (Output::Turning, Threshold::TurningSpeed, false),
    (Output::SpeedReached, Threshold::ReachedSpeed, false),
    (Output::SpeedReached, Threshold::ReachedWindow, false),
    (Output::SpeedAgrees, Threshold::AgreesWindow, false),
    (Output::Arrived, Threshold::AgreesWindow, false),
    (Output::Arrived, Threshold::PositionWindow, true),
    (Output::Arrived, Threshold::PositionSettle, true),
    (Output::Settled, Threshold::PositionWindow, true),
    (Output::Settled, Threshold::PositionSettle, true),
    (Output::InPosition, Threshold::PositionWindow, true),
    (Output::InPosition, Threshold::PositionSettle, true),
    (Output::CommandPresent, Threshold::CommandSpeed, true),
    (Output::InterruptActive, Threshold::PositionWindow, true),
    (Output::InterruptActive, Threshold::PositionSettle, true),
    (Output::InterruptDone, Threshold::PositionWindow, true),
    (Output::InterruptDone, Threshold::PositionSettle, true),
    (Output::InterruptDone, Threshold::InterruptDoneTime, false),
    (Output::Coincides, Threshold::CoincidesWindow, false),
    (Output::Near, Threshold::NearWindow, false),
];

/// Outputs have their numbers, and numbers their outputs.
pub(super) fn check_thresholds(numbers: &Numbers, wired: &Wired, names: &mut Names) {
    for (output, threshold, optional) in OUTPUT_NUMBERS {
        if wired.shows(output) && !numbers.has_threshold(threshold) && !optional {
            let (output, name) = (output.name(), threshold.name());
            let what = format!("`{output}` is shown, but `{name}` is missing");
            let problem = Problem::key(Path::root().key("signals").key("outputs"), what);
            let advice = format!("add `{name}: ROW`, or a number with its unit, to `quantities`");
            names.report(problem.advise(advice));
        }
    }
    let of_outputs = numbers.thresholds.iter().map(|(it, _)| *it);
    for threshold in of_outputs.filter(|it| *it != Threshold::Deviation) {
        let mut uses = OUTPUT_NUMBERS.iter().filter(|(_, it, _)| *it == threshold);
        if !uses.any(|(output, ..)| wired.shows(*output)) {
            let name = threshold.name();
            let what = format!("`{name}` has no effect: no output that uses it is shown");
            let problem = Problem::key(path(name), what);
            names.report(problem.advise("show one, or remove it"));
        }
    }
}

/// What shows a deviation, or goes by it, where the axis is never behind its command.
pub(super) fn without_deviation(numbers: &Numbers, wired: &Wired, names: &mut Names) {
    let signals = Path::root().key("signals");
    let outputs = [Output::Coincides, Output::Near].into_iter();
    let outputs = outputs.filter(|it| wired.shows(*it)).map(|it| (it.name(), signals.clone()));
    let quantity = |it: Quantity| (wired.shows_quantity(it), it.name());
    let threshold = |it: Threshold| (numbers.has_threshold(it), it.name());
    let shown = [quantity(Quantity::ErrorFollowing), threshold(Threshold::PositionWindow)];
    let shown = shown.into_iter().filter(|it| it.0).map(|(_, name)| (name, path(name)));
    for (name, path) in outputs.chain(shown) {
        let what = format!("`{name}` has no effect: the axis never lags behind its command");
        let problem = Problem::key(path, what);
        names.report(problem.advise("give `axis` a `position_gain`, or remove it"));
    }
}
