//! Numbers that outputs go by: out of rows or fixed, each with an output, each output with its numbers.

use super::compile::Wirer;
use super::{Number, Shows};
use crate::problem::{Path, Problem};
use crate::units::Unit;
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

impl Wirer<'_> {
    /// `text` is a number with its unit, or a row.
    pub(super) fn threshold(&mut self, threshold: Threshold, text: &str, path: &Path) {
        let (name, want) = (threshold.name(), threshold.dimensions());
        let number = match Unit::parse(text).filter(|_| text.contains(' ')) {
            Some(number) => {
                if !want.contains(&number.dimension) {
                    let symbols: Vec<_> =
                        want.iter().flat_map(|it| Unit::symbols_of(*it)).collect();
                    let what =
                        format!("`{name}` is in {}, and `{text}` is not", symbols.join(" or "));
                    self.problems.push(Problem::value(path.clone(), what));
                }
                Number::Fixed(number)
            }
            None => {
                let Some(row) = self.row(text, path) else { return };
                self.dimension(row, name, want, path);
                Number::Row(row)
            }
        };
        self.wiring.thresholds.push((threshold, number));
    }

    /// What shows a deviation, or goes by it, where there is none. To be called when the axis is wired.
    pub(super) fn deviation_fits(&mut self) {
        if self.wiring.axis.position_gain.is_some() {
            return;
        }
        let signals = Path::root().key("signals");
        let outputs = [Output::Coincides, Output::Near].into_iter();
        let mut names: Vec<_> = outputs
            .filter(|it| self.is_shown(*it))
            .map(|it| (it.name(), signals.clone()))
            .collect();
        let quantities = Path::root().key("quantities");
        let following = Quantity::ErrorFollowing.name();
        if self
            .wiring
            .shows
            .iter()
            .flatten()
            .any(|it| *it == Shows::Quantity(Quantity::ErrorFollowing))
        {
            names.push((following, quantities.key(following)));
        }
        let window = Threshold::PositionWindow;
        if self.wiring.threshold(window).is_some() {
            names.push((window.name(), quantities.key(window.name())));
        }
        for (name, path) in names {
            let what = format!("`{name}` has no effect: the axis never lags behind its command");
            let problem = Problem::key(path, what);
            self.problems.push(problem.advise("give `axis` a `position_gain`, or remove it"));
        }
    }

    /// To be called when all that shows outputs is wired.
    pub(super) fn thresholds_fit(&mut self) {
        for (output, threshold, optional) in USES {
            let there = self.wiring.threshold(threshold).is_some();
            if self.is_shown(output) && !there && !optional {
                let (output, name) = (output.name(), threshold.name());
                let what = format!("`{output}` is shown, but `{name}` is missing");
                let problem = Problem::key(Path::root().key("signals").key("outputs"), what);
                let advice =
                    format!("add `{name}: ROW`, or a number with its unit, to `quantities`");
                self.problems.push(problem.advise(advice));
            }
        }
        let of_outputs = |it: &(Threshold, Number)| it.0 != Threshold::Deviation;
        for (threshold, _) in self.wiring.thresholds.clone().into_iter().filter(of_outputs) {
            let of = |it: &&(Output, Threshold, bool)| it.1 == threshold;
            if !USES.iter().filter(of).any(|(output, ..)| self.is_shown(*output)) {
                let name = threshold.name();
                let what = format!("`{name}` has no effect: no output that uses it is shown");
                let path = Path::root().key("quantities").key(name);
                self.problems.push(Problem::key(path, what).advise("show one, or remove it"));
            }
        }
    }
}
