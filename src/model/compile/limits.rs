//! What the limits of an axis do: words resolved, and whether there is a limit at all.

use super::names::Names;
use super::quantities::{self, Numbers};
use super::wired::{Wired, needs_alarm};
use crate::model::raw::RawModel;
use crate::model::{Alarm, Choice, HomingRules, Limits};
use crate::problem::{Path, Problem};
use crate::vocabulary::{AlarmCause, Input, Named, Output, Setting, SoftLimitRule, Threshold};

/// The limits of the model.
pub(super) fn compile(
    raw: &RawModel,
    wired: &Wired,
    numbers: &Numbers,
    homing: Option<&HomingRules>,
    alarms: &[Alarm],
    names: &mut Names,
) -> Limits {
    let (raw, path) = (raw.limits.as_ref(), Path::root().key("limits"));
    let stop = raw.and_then(|it| it.stop.as_ref());
    let stop = names.word_choice(stop, "stopping mode", &path.key("stop"));
    let soft = raw.and_then(|it| it.soft.as_ref());
    let soft = names.word_choice(soft, "rule for soft limits", &path.key("soft"));
    let has_soft = soft_limits(soft.as_ref(), numbers, homing, &path, names);
    let switches = [Input::LimitPos, Input::LimitNeg].into_iter().any(|it| wired.has(it));
    if raw.is_some() && !switches && !has_soft {
        let what = "`limits` has no effect: there is no limit";
        let advice = "wire `limit_pos` and `limit_neg`, or remove it";
        names.report(Problem::key(path, what).advise(advice));
    } else if soft.is_some() && !has_soft {
        names.without_effect("soft", "no rows hold soft limits", &path);
    }
    shown(wired, has_soft, names);
    if numbers.has_threshold(Threshold::Deviation) {
        let name = Threshold::Deviation.name();
        let cause = AlarmCause::PositionDeviation;
        needs_alarm(name, cause, quantities::path(name), alarms, names);
    }
    Limits { stop, soft }
}

/// Are there soft limits? They are two or none, and some day in force.
fn soft_limits(
    rule: Option<&Choice<SoftLimitRule>>,
    numbers: &Numbers,
    homing: Option<&HomingRules>,
    path: &Path,
    names: &mut Names,
) -> bool {
    let softs = [Setting::SoftLimitPos, Setting::SoftLimitNeg];
    let wired = softs.map(|it| numbers.has(it));
    if wired[0] != wired[1] {
        let [here, missing] = if wired[0] { softs } else { [softs[1], softs[0]] };
        let (here, missing) = (here.name(), missing.name());
        let what = format!("`{here}` has no effect: no row holds `{missing}`");
        let advice = format!("add `{missing}: ROW`, or remove it");
        names.report(Problem::key(quantities::path(here), what).advise(advice));
    }
    if wired == [false, false] {
        return false;
    }
    let rules = rule.map(Choice::all).unwrap_or_default();
    let path = path.key("soft");
    if !rules.is_empty() && rules.iter().all(|it| *it == SoftLimitRule::Off) {
        let what = "soft limits are never in force";
        let advice = "remove their rows from `quantities`, and this";
        names.report(Problem::key(path, what).advise(advice));
    } else if rules.contains(&SoftLimitRule::AfterHoming) && homing.is_none() {
        let what = "`after_homing` has no effect: there is no `homing`";
        names.report(Problem::key(path, what));
    }
    true
}

/// Outputs that show limits have limits.
fn shown(wired: &Wired, has_soft: bool, names: &mut Names) {
    let switches = [(Output::AtLimitPos, Input::LimitPos), (Output::AtLimitNeg, Input::LimitNeg)];
    for (output, _) in switches.into_iter().filter(|(_, input)| !wired.has(*input)) {
        wired.never_on(output, "no input signal of that name is wired", names);
    }
    for output in [Output::BeyondPos, Output::BeyondNeg].into_iter().filter(|_| !has_soft) {
        wired.never_on(output, "no rows hold soft limits", names);
    }
}
