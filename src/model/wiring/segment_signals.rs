//! Whether what selects, starts and shows segments goes together with the segments.

use super::Shows;
use super::chain::ChainRules;
use super::compile::Wirer;
use crate::model::raw::RawSegments;
use crate::problem::{Path, Problem};
use crate::vocabulary::{Input, Named, Output, Quantity};

/// The bits of the selection, lowest first.
pub(super) const SELECTS: [Input; 4] =
    [Input::Select0, Input::Select1, Input::Select2, Input::Select3];

impl Wirer<'_> {
    /// What starts, selects, turns round or shows segments, and the segments themselves: one without the
    /// other changes nothing.
    pub(super) fn segment_signals(&mut self, raw: &RawSegments, path: &Path, inputs: &[Input]) {
        let (moves, runs) = (raw.position.is_some(), raw.velocity.is_some());
        let steps = self
            .wiring
            .axis
            .segments
            .position
            .as_ref()
            .is_some_and(|it| it.chain.as_ref().is_some_and(ChainRules::waits_for_a_step));
        let mut goes_with = vec![
            (Input::SegmentStart, moves, "axis.segments.position"),
            (Input::SegmentRun, runs, "axis.segments.velocity"),
            (Input::SegmentReverse, runs, "axis.segments.velocity"),
            (Input::SegmentStep, steps, "condition `step` of a chain"),
        ];
        goes_with.extend(SELECTS.map(|it| (it, moves || runs, "axis.segments")));
        for (input, there, what) in goes_with {
            if !there && inputs.contains(&input) {
                let what = format!("`{}` has no effect without {what}", input.name());
                let path = Path::root().key("signals");
                self.problems.push(Problem::key(path, what).advise("remove it"));
            }
        }
        let needs = [
            (moves, path.key("position"), Input::SegmentStart),
            (runs, path.key("velocity"), Input::SegmentRun),
            (steps, path.key("position").key("chain").key("codes"), Input::SegmentStep),
        ];
        for (there, path, input) in needs {
            if there && !inputs.contains(&input) {
                let what = format!("has no effect: no input is `{}`", input.name());
                let advice = "wire it, or remove this";
                self.problems.push(Problem::key(path, what).advise(advice));
            }
        }
        if !moves {
            self.numbers_without_segments();
        }
    }

    fn numbers_without_segments(&mut self) {
        let path = Path::root();
        let bits = [
            Output::Segment0,
            Output::Segment1,
            Output::Segment2,
            Output::Segment3,
            Output::Segment4,
        ];
        let bits = bits.into_iter().filter(|it| self.is_shown(*it));
        let bits = bits.map(|it| (path.key("signals"), it.name()));
        let numbers = [Quantity::SegmentRunning, Quantity::SegmentNext].into_iter();
        let shows = |it: &Quantity| {
            self.wiring.shows.iter().flatten().any(|row| *row == Shows::Quantity(*it))
        };
        let numbers =
            numbers.filter(shows).map(|it| (path.key("quantities").key(it.name()), it.name()));
        let names: Vec<_> = bits.chain(numbers).collect();
        for (path, name) in names {
            let what = format!("`{name}` is always 0 without axis.segments.position");
            self.problems.push(Problem::key(path, what).advise("remove it"));
        }
    }
}
