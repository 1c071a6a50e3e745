//! Motions by number: which rows each segment goes by, and whether what selects and starts them is wired.

use super::chain::{ChainRules, Link};
use super::compile::Wirer;
use crate::model::expand::number;
use crate::model::line::{Coded, coded};
use crate::model::raw::{
    RawKind, RawLasts, RawPositionSegments, RawSegments, RawTarget, RawTrigger, RawVelocitySegments,
};
use crate::problem::{Path, Problem, suggest};
use crate::words::{Input, Output, Quantity, RowId, Setting, Word};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Motions by number.
#[derive(Debug, Default)]
pub struct Segments {
    /// Moves.
    pub position: Option<PositionSegments>,
    /// Runs.
    pub velocity: Option<VelocitySegments>,
}

/// Moves by number.
#[derive(Debug)]
pub struct PositionSegments {
    /// Number of the first.
    pub first: u16,
    /// All of them.
    pub list: Vec<PositionSegment>,
    /// What those that follow each other have in common.
    pub chain: Option<ChainRules>,
}

/// A move.
#[derive(Debug)]
pub struct PositionSegment {
    /// The rows that it goes by.
    pub settings: Vec<(Setting, RowId)>,
    /// What its target is.
    pub kind: PerRow<RawTarget>,
    /// How it gives way to the next.
    pub link: Option<Link>,
}

/// Runs by number.
#[derive(Debug)]
pub struct VelocitySegments {
    /// Number of the first.
    pub first: u16,
    /// The rows that each goes by.
    pub list: Vec<Vec<(Setting, RowId)>>,
    /// How long one lasts.
    pub trigger: PerRow<RawLasts>,
}

/// Something that is always the same, or as a row says.
#[derive(Debug)]
pub enum PerRow<T> {
    /// Always the same.
    Fixed(T),
    /// As a row says.
    Row(Coded<T>),
}

impl<T: Copy> PerRow<T> {
    /// What it is, given the values of rows; nothing where a row holds a value that stands for nothing.
    pub fn get(&self, value: impl FnOnce(RowId) -> i64) -> Option<T> {
        match self {
            Self::Fixed(it) => Some(*it),
            Self::Row(coded) => coded.decode(value(coded.row)),
        }
    }

    fn row(&self) -> Option<RowId> {
        match self {
            Self::Fixed(_) => None,
            Self::Row(coded) => Some(coded.row),
        }
    }
}

impl PositionSegments {
    /// The segment with that number.
    pub fn get(&self, number: u16) -> Option<&PositionSegment> {
        self.list.get(usize::from(number.checked_sub(self.first)?))
    }
}

impl VelocitySegments {
    /// The rows of the segment with that number.
    pub fn get(&self, number: u16) -> Option<&[(Setting, RowId)]> {
        self.list.get(usize::from(number.checked_sub(self.first)?)).map(Vec::as_slice)
    }
}

impl Segments {
    /// Every row that a segment goes by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> {
        let moves = self.position.iter().flat_map(|it| &it.list).flat_map(|segment| {
            let links = segment.link.iter().flat_map(Link::rows);
            rows_of(&segment.settings).chain(segment.kind.row()).chain(links)
        });
        let runs = self.velocity.iter().flat_map(|it| {
            it.list.iter().flat_map(|settings| rows_of(settings)).chain(it.trigger.row())
        });
        moves.chain(runs)
    }
}

fn rows_of(settings: &[(Setting, RowId)]) -> impl Iterator<Item = RowId> {
    settings.iter().map(|(_, row)| *row)
}

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

const SELECTS: [Input; 4] = [Input::Select0, Input::Select1, Input::Select2, Input::Select3];

impl Wirer<'_> {
    pub(super) fn segments(&mut self, raw: &RawSegments, path: &Path, inputs: &[Input]) {
        if let Some(raw) = &raw.position {
            self.wiring.axis.segments.position =
                self.position_segments(raw, &path.key("position"), inputs);
        }
        if let Some(raw) = &raw.velocity {
            self.wiring.axis.segments.velocity =
                self.velocity_segments(raw, &path.key("velocity"), inputs);
        }
        self.segment_signals(raw, path, inputs);
    }

    fn position_segments(
        &mut self,
        raw: &RawPositionSegments,
        path: &Path,
        inputs: &[Input],
    ) -> Option<PositionSegments> {
        let [first, last] = self.numbers(raw.n, raw.chain.is_some(), path, inputs)?;
        let chain = raw.chain.as_ref().map(|raw| self.chain_rules(raw, &path.key("chain")));
        let list = self.each(first..=last, |wirer, n| {
            let settings = wirer.segment_settings(&raw.quantities, n, &MOVE, path);
            let kind = wirer.kind(&raw.kind, n, &path.key("kind"));
            let link = match (&raw.chain, &chain) {
                (Some(raw), Some(rules)) => wirer.link(raw, rules, n, &path.key("chain")),
                _ => None,
            };
            PositionSegment { settings, kind, link }
        });
        Some(PositionSegments { first, list, chain })
    }

    fn velocity_segments(
        &mut self,
        raw: &RawVelocitySegments,
        path: &Path,
        inputs: &[Input],
    ) -> Option<VelocitySegments> {
        let [first, last] = self.numbers(raw.n, false, path, inputs)?;
        let list = self
            .each(first..=last, |wirer, n| wirer.segment_settings(&raw.quantities, n, &RUN, path));
        let path = path.key("trigger");
        let trigger = match &raw.trigger {
            RawTrigger::Fixed(lasts) => PerRow::Fixed(*lasts),
            RawTrigger::Register { register, codes } => self.coded_row(register, codes, &path)?,
        };
        Some(VelocitySegments { first, list, trigger })
    }

    /// Wires the segments one by one. What is wrong with several of them is told of the first.
    fn each<T>(
        &mut self,
        numbers: RangeInclusive<u16>,
        mut wire: impl FnMut(&mut Self, u16) -> T,
    ) -> Vec<T> {
        let mut told = false;
        let mut segment = |n| {
            let before = self.problems.len();
            let segment = wire(self, n);
            if told {
                self.problems.truncate(before);
            }
            told |= self.problems.len() > before;
            segment
        };
        numbers.map(&mut segment).collect()
    }

    /// The numbers of segments, if there are any; those that nothing can reach are a problem.
    fn numbers(
        &mut self,
        n: [u16; 2],
        chained: bool,
        path: &Path,
        inputs: &[Input],
    ) -> Option<[u16; 2]> {
        let [first, last] = n;
        if first > last {
            let what = format!("segments {first} to {last} are none");
            let problem = Problem::value(path.key("n"), what);
            self.problems.push(problem.advise("first, then last"));
            return None;
        }
        let reach = 1 << SELECTS.iter().take_while(|it| inputs.contains(it)).count();
        let count = usize::from(last - first) + 1;
        if count > reach && !chained {
            let what = format!("{count} segments, and the inputs select {reach}");
            let problem = Problem::value(path.key("n"), what);
            self.problems.push(problem.advise("wire `select_0` to `select_3`, or take less"));
        }
        Some(n)
    }

    fn segment_settings(
        &mut self,
        raw: &BTreeMap<String, String>,
        n: u16,
        takes: &Takes,
        path: &Path,
    ) -> Vec<(Setting, RowId)> {
        let path = path.key("quantities");
        let all = || takes.needs.iter().chain(takes.takes).map(|it| it.name());
        let mut settings = Vec::new();
        for (name, register) in raw {
            let path = path.key(name);
            let Some(setting) = Setting::parse(name).filter(|_| all().any(|it| it == name)) else {
                let advice = suggest::did_you_mean(name, all())
                    .unwrap_or_else(|| format!("known: {}", all().collect::<Vec<_>>().join(", ")));
                let what = format!("no segment goes by `{name}`");
                self.problems.push(Problem::key(path, what).advise(advice));
                continue;
            };
            let Some(row) = self.row(&number(register, n), &path) else { continue };
            self.dimension(row, name, setting.dimensions(), &path);
            settings.push((setting, row));
        }
        for need in takes.needs.iter().filter(|it| !raw.contains_key(it.name())) {
            let what = format!("no row holds `{}` of the segments", need.name());
            self.problems.push(Problem::value(path.clone(), what));
        }
        settings
    }

    fn kind(&mut self, raw: &RawKind, n: u16, path: &Path) -> PerRow<RawTarget> {
        let coded = match raw {
            RawKind::Fixed(target) => return PerRow::Fixed(*target),
            RawKind::Register { register, codes } => {
                self.coded_row(&number(register, n), codes, path)
            }
        };
        coded.unwrap_or(PerRow::Fixed(RawTarget::None))
    }

    fn coded_row<T: Copy>(
        &mut self,
        register: &str,
        codes: &BTreeMap<i64, T>,
        path: &Path,
    ) -> Option<PerRow<T>> {
        let row = self.row(register, &path.key("register"))?;
        coded(Some(row), None, codes, self.rows, path, self.problems);
        Some(PerRow::Row(Coded { row, digit: None, codes: codes.clone() }))
    }

    /// What starts, selects, turns round or shows segments, and the segments themselves: one without the
    /// other changes nothing.
    fn segment_signals(&mut self, raw: &RawSegments, path: &Path, inputs: &[Input]) {
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
                let what = format!("`{}` changes nothing without {what}", input.name());
                let path = Path::root().key("signals");
                self.problems.push(Problem::key(path, what).advise("leave it out"));
            }
        }
        let needs = [
            (moves, path.key("position"), Input::SegmentStart),
            (runs, path.key("velocity"), Input::SegmentRun),
            (steps, path.key("position").key("chain").key("codes"), Input::SegmentStep),
        ];
        for (there, path, input) in needs {
            if there && !inputs.contains(&input) {
                let what = format!("changes nothing: no input is `{}`", input.name());
                let advice = "wire it, or leave this out";
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
            self.wiring.shows.iter().flatten().any(|row| *row == super::Shows::Quantity(*it))
        };
        let numbers =
            numbers.filter(shows).map(|it| (path.key("quantities").key(it.name()), it.name()));
        let names: Vec<_> = bits.chain(numbers).collect();
        for (path, name) in names {
            let what = format!("`{name}` is always 0 without axis.segments.position");
            self.problems.push(Problem::key(path, what).advise("leave it out"));
        }
    }
}
