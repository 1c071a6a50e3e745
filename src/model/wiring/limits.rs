//! What the limits of an axis do: words resolved, and whether there is a limit at all.

use super::Choice;
use super::compile::Wirer;
use crate::model::RowId;
use crate::model::raw::RawLimits;
use crate::problem::{Path, Problem};
use crate::vocabulary::{
    AlarmCause, Input, LimitStop, Named, Output, Setting, SoftLimitRule, Threshold,
};

/// What limits do.
#[derive(Debug, Default)]
pub struct Limits {
    /// How the axis stops.
    pub stop: Option<Choice<LimitStop>>,
    /// When soft limits are in force; `None` is always.
    pub soft: Option<Choice<SoftLimitRule>>,
}

impl Limits {
    /// The rows that they go by.
    pub fn rows(&self) -> impl Iterator<Item = RowId> + '_ {
        let stop = self.stop.as_ref().and_then(Choice::row);
        stop.into_iter().chain(self.soft.as_ref().and_then(Choice::row))
    }
}

impl Wirer<'_> {
    pub(super) fn limits(&mut self, raw: Option<&RawLimits>) {
        let path = Path::root().key("limits");
        let stop =
            raw.and_then(|it| self.words_chosen(&it.stop, "stopping mode", &path.key("stop")));
        let soft = raw
            .and_then(|it| self.words_chosen(&it.soft, "rule for soft limits", &path.key("soft")));
        let has_soft = self.soft_limits(soft.as_ref(), &path);
        let inputs = self.inputs_wired();
        let switches = inputs.contains(&Input::LimitPos) || inputs.contains(&Input::LimitNeg);
        if raw.is_some() && !switches && !has_soft {
            let what = "`limits` has no effect: there is no limit";
            let advice = "wire `limit_pos` and `limit_neg`, or remove it";
            self.problems.push(Problem::key(path, what).advise(advice));
        } else if soft.is_some() && !has_soft {
            self.unused("soft", "no rows hold soft limits", &path);
        }
        self.limits_shown(&inputs, has_soft);
        if self.wiring.threshold(Threshold::Deviation).is_some() {
            let name = Threshold::Deviation.name();
            let path = Path::root().key("quantities").key(name);
            self.needs_alarm(name, AlarmCause::PositionDeviation, path);
        }
        self.wiring.limits = Limits { stop, soft };
    }

    /// Are there soft limits? They are two or none, and some day in force.
    fn soft_limits(&mut self, rule: Option<&Choice<SoftLimitRule>>, path: &Path) -> bool {
        let softs = [Setting::SoftLimitPos, Setting::SoftLimitNeg];
        let wired = softs.map(|it| self.wiring.axis.setting(it).is_some());
        if wired[0] != wired[1] {
            let [here, missing] = if wired[0] { softs } else { [softs[1], softs[0]] };
            let (here, missing) = (here.name(), missing.name());
            let what = format!("`{here}` has no effect: no row holds `{missing}`");
            let path = Path::root().key("quantities").key(here);
            let advice = format!("add `{missing}: ROW`, or remove it");
            self.problems.push(Problem::key(path, what).advise(advice));
        }
        if wired == [false, false] {
            return false;
        }
        let rules = rule.map(Choice::all).unwrap_or_default();
        let path = path.key("soft");
        if !rules.is_empty() && rules.iter().all(|it| *it == SoftLimitRule::Off) {
            let what = "soft limits are never in force";
            let advice = "remove their rows from `quantities`, and this";
            self.problems.push(Problem::key(path, what).advise(advice));
        } else if rules.contains(&SoftLimitRule::AfterHoming) && self.wiring.homing.is_none() {
            let what = "`after_homing` has no effect: there is no `homing`";
            self.problems.push(Problem::key(path, what));
        }
        true
    }

    fn limits_shown(&mut self, inputs: &[Input], has_soft: bool) {
        let switches =
            [(Output::AtLimitPos, Input::LimitPos), (Output::AtLimitNeg, Input::LimitNeg)];
        for (output, input) in switches {
            if !inputs.contains(&input) {
                self.never_on(output, "no input signal of that name is wired");
            }
        }
        for output in [Output::BeyondPos, Output::BeyondNeg].into_iter().filter(|_| !has_soft) {
            self.never_on(output, "no rows hold soft limits");
        }
    }
}
