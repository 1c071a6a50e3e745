//! The rows of segments, found and checked.

use super::SettingRow;
use super::choice::Choice;
use super::compile::Wirer;
use super::segment_signals::SELECTS;
use super::segments::{PositionSegment, PositionSegments, VelocitySegments};
use crate::model::expand::number;
use crate::model::raw::{
    RawChoice, RawChosen, RawPositionSegments, RawQuantity, RawSegments, RawVelocitySegments,
};
use crate::problem::{Path, Problem, suggest};
use crate::vocabulary::{Input, Lasts, Named, Setting, Target};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// What a segment needs and what else it may go by.
pub(super) struct Takes {
    needs: &'static [Setting],
    takes: &'static [Setting],
}

pub(super) const MOVE: Takes = Takes {
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
            let kind = wirer.kind(raw.kind.as_ref(), n, &path.key("kind"));
            let link = match (&raw.chain, &chain) {
                (Some(raw), Some(rules)) => wirer.link(raw, rules, n, &path.key("chain")),
                _ => None,
            };
            let kind = kind.unwrap_or(Choice::Fixed(Target::Relative));
            Some(PositionSegment { settings, kind, link })
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
        let path = path.key("trigger");
        let trigger = match &raw.trigger {
            None => Choice::Fixed(Lasts::Level),
            raw => self.words_chosen(raw, "trigger of a velocity segment", &path)?,
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
            let what = format!("the range {first} to {last} is empty");
            let problem = Problem::value(path.key("n"), what);
            self.problems.push(problem.advise("give the lower number first"));
            return None;
        }
        let reach = 1 << SELECTS.iter().take_while(|it| inputs.contains(it)).count();
        let count = usize::from(last - first) + 1;
        if count > SEGMENTS_MAX {
            let what = format!("{count} segments, but at most {SEGMENTS_MAX} are allowed");
            self.problems.push(Problem::value(path.key("n"), what));
            return None;
        }
        if count > reach && !chained {
            let what = format!("{count} segments, but the inputs can select only {reach}");
            let problem = Problem::value(path.key("n"), what);
            self.problems
                .push(problem.advise("wire `select_0` to `select_3`, or use fewer segments"));
        }
        Some(n)
    }

    /// The rows that a segment, or interrupt positioning, goes by.
    pub(super) fn segment_settings(
        &mut self,
        raw: &BTreeMap<String, RawQuantity>,
        n: u16,
        takes: &Takes,
        path: &Path,
    ) -> Vec<SettingRow> {
        let path = path.key("quantities");
        let all = || takes.needs.iter().chain(takes.takes).map(|it| it.name());
        let mut settings = Vec::new();
        for (name, raw) in raw {
            let path = path.key(name);
            let Some(setting) = Setting::parse(name).filter(|_| all().any(|it| it == name)) else {
                let advice = suggest::did_you_mean(name, all())
                    .unwrap_or_else(|| format!("known: {}", all().collect::<Vec<_>>().join(", ")));
                let what = format!("`{name}` is not used here");
                self.problems.push(Problem::key(path, what).advise(advice));
                continue;
            };
            let Some(row) = self.row(&number(raw.register(), n), &path) else { continue };
            settings.push(self.setting(setting, row, raw, &path));
        }
        for need in takes.needs.iter().filter(|it| !raw.contains_key(it.name())) {
            let what = format!("no row holds `{}`", need.name());
            self.problems.push(Problem::value(path.clone(), what));
        }
        settings
    }

    fn kind(
        &mut self,
        raw: Option<&RawChoice<String>>,
        n: u16,
        path: &Path,
    ) -> Option<Choice<Target>> {
        let of_segment = match raw {
            None => return Some(Choice::Fixed(Target::Relative)),
            Some(RawChoice::Row(of_all)) => {
                let register = number(&of_all.register, n);
                RawChoice::Row(RawChosen { register, ..of_all.clone() })
            }
            Some(fixed) => fixed.clone(),
        };
        self.words_chosen(&Some(of_segment), "target kind", path)
    }
}
