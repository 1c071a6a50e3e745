//! Numbers that outputs go by, each with an output, each output with its numbers.

use super::names::Names;
use super::quantities::{Numbers, path};
use super::wired::Wired;
use crate::problem::{Path, Problem};
use crate::vocabulary::{Named, Output, Quantity, Threshold};

/// An output with the number that it goes by, and whether it can do without.
const USES: [(Output, Threshold, bool); 20] = [
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
pub(super) fn check(numbers: &Numbers, wired: &Wired, names: &mut Names) {
    for (output, threshold, optional) in USES {
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
        let mut uses = USES.iter().filter(|(_, it, _)| *it == threshold);
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
