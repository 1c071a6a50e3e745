//! The rows of segments, found and checked.

use super::compile::Wirer;
use super::segment_signals::SELECTS;
use super::segments::{Lasts, PerRow, PositionSegment, PositionSegments, Target, VelocitySegments};
use crate::model::expand::number;
use crate::model::line::{Coded, coded};
use crate::model::raw::{
    RawKind, RawKindCode, RawLasts, RawPositionSegments, RawSegments, RawTarget, RawTrigger,
    RawVelocitySegments,
};
use crate::problem::{Path, Problem, suggest};
use crate::words::{Input, RowId, Setting, Word};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

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

/// More than any drive has: a slip of the pen is told at once, not row by row.
const SEGMENTS_MAX: usize = 256;

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
            Some(PositionSegment { settings, kind: kind?, link })
        });
        let list = list.into_iter().flatten().collect();
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
        let trigger = self.trigger(&raw.trigger, &path.key("trigger"))?;
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
        if count > SEGMENTS_MAX {
            let what = format!("{count} segments, and {SEGMENTS_MAX} are the most");
            self.problems.push(Problem::value(path.key("n"), what));
            return None;
        }
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

    fn kind(&mut self, raw: &RawKind, n: u16, path: &Path) -> Option<PerRow<Target>> {
        match raw {
            RawKind::Fixed(RawTarget::Relative) => Some(PerRow::Fixed(Target::Relative)),
            RawKind::Fixed(RawTarget::Absolute) => Some(PerRow::Fixed(Target::Absolute)),
            RawKind::Register { register, codes } => {
                self.coded_row(&number(register, n), codes, path, |code| match code {
                    RawKindCode::Relative => Some(Target::Relative),
                    RawKindCode::Absolute => Some(Target::Absolute),
                    RawKindCode::None => None,
                })
            }
        }
    }

    fn trigger(&mut self, raw: &RawTrigger, path: &Path) -> Option<PerRow<Lasts>> {
        let lasts = |raw: RawLasts| match raw {
            RawLasts::Level => Lasts::Level,
            RawLasts::Edge => Lasts::Edge,
        };
        match raw {
            RawTrigger::Fixed(raw) => Some(PerRow::Fixed(lasts(*raw))),
            RawTrigger::Register { register, codes } => {
                self.coded_row(register, codes, path, |raw| Some(lasts(raw)))
            }
        }
    }

    /// What the values of a row stand for, without those that stand for nothing.
    fn coded_row<R: Copy, T>(
        &mut self,
        register: &str,
        raw: &BTreeMap<i64, R>,
        path: &Path,
        meaning: impl Fn(R) -> Option<T>,
    ) -> Option<PerRow<T>> {
        let row = self.row(register, &path.key("register"))?;
        coded(Some(row), None, raw, self.rows, path, self.problems);
        let codes = raw.iter().filter_map(|(code, raw)| Some((*code, meaning(*raw)?))).collect();
        Some(PerRow::Row(Coded { row, digit: None, codes }))
    }
}
