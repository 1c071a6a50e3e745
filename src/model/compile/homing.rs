//! How an axis looks for its origin: words resolved, and whether everything goes together.

use super::names::Names;
use super::quantities::{self, Numbers};
use super::steps::{Sight, method};
use super::wired::{Wired, needs_alarm};
use crate::model::raw::{RawFinish, RawHoming, RawModel};
use crate::model::{Alarm, Choice, Finish, HomingRules, RowId};
use crate::problem::{Path, Problem};
use crate::vocabulary::{
    Action, AlarmCause, HomeStarter, HomingStep, Input, LimitRule, Method, Named, OriginPosition,
    OriginStop, Output, Pace, Setting, Until,
};
use std::collections::BTreeMap;

pub(super) fn path() -> Path {
    Path::root().key("homing")
}

/// The homing of the model.
pub(super) fn compile(
    raw: &RawModel,
    wired: &Wired,
    numbers: &Numbers,
    alarms: &[Alarm],
    names: &mut Names,
) -> Option<HomingRules> {
    let (raw, path) = (raw.homing.as_ref()?, path());
    let method = raw.method.as_ref().and_then(|id| names.row(id, &path.key("method")));
    let stop = raw.stop.as_ref().and_then(|it| {
        names.word::<OriginStop>(it, "stopping mode at the origin", &path.key("stop"))
    });
    let starter = raw.starter.as_ref().and_then(|it| {
        names.coded(it, &path.key("starter"), |names, name: &String, path| {
            names.word(name, "homing trigger", path)
        })
    });
    let (limit, source, index) =
        (raw.limit.as_ref(), raw.limit_source.as_ref(), raw.index.as_ref());
    let mut homing = HomingRules {
        method,
        methods: BTreeMap::new(),
        starter,
        limit: names.word_choice(limit, "reaction to a limit", &path.key("limit")),
        source: names.word_choice(source, "limit detection", &path.key("limit_source")),
        index: names.word_choice(index, "use of the index pulse", &path.key("index")),
        stop: stop.unwrap_or(OriginStop::AtOnce),
        finish: raw.finish.as_ref().and_then(|it| {
            names.choice(it, &path.key("finish"), |names, it, path| finish(it, path, names))
        }),
        time_factor: raw
            .time_factor
            .as_ref()
            .and_then(|it| names.digit(it, &path.key("time_factor"))),
    };
    let sight = Sight {
        wired,
        limit: homing.limit.as_ref(),
        source: homing.source.as_ref(),
        index: homing.index.as_ref(),
    };
    let methods = methods(raw, &sight, &path.key("methods"), names);
    check_limits(&homing, &sight, alarms, &path, names);
    match method {
        Some(row) => numbered(row, raw, &path, names),
        None if !raw.no_steps.is_empty() && raw.method.is_none() => {
            names.without_effect("no_steps", "there is no `method`", &path);
        }
        None => {}
    }
    homing.methods = methods;
    without_steps(raw, &homing, &path, names);
    check_settings(&homing, numbers, &path, names);
    Some(homing)
}

fn methods(
    raw: &RawHoming,
    sight: &Sight<'_>,
    path: &Path,
    names: &mut Names,
) -> BTreeMap<i64, Method> {
    if raw.method.is_none() && raw.methods.len() != 1 {
        let what = "without a row that selects the method there must be exactly one";
        names.report(Problem::key(path.clone(), what).advise("add `method: ROW`"));
    }
    let methods = raw.methods.iter();
    methods.map(|(number, raw)| (*number, method(raw, sight, &path.key(number), names))).collect()
}

/// Each number that the row can hold has steps, or is said to have none.
fn numbered(row: RowId, raw: &RawHoming, path: &Path, names: &mut Names) {
    let row = names.get(row);
    for number in raw.methods.keys().filter(|it| !row.admits(**it)) {
        let what = format!("{} is never {number}", row.id);
        names.report(Problem::key(path.key("methods").key(number), what));
    }
    for (i, number) in raw.no_steps.iter().enumerate() {
        let what = match () {
            () if !row.admits(*number) => format!("{} is never {number}", row.id),
            () if raw.methods.contains_key(number) => {
                format!("{number} is one of the methods")
            }
            () if raw.no_steps[..i].contains(number) => format!("{number} is listed twice"),
            () => continue,
        };
        names.report(Problem::value(path.key("no_steps").index(i), what));
    }
    let known = |it: &i64| raw.methods.contains_key(it) || raw.no_steps.contains(it);
    let mut all = row.spans.iter().flat_map(|(low, high)| *low..=*high);
    if let Some(number) = all.find(|it| !known(it)) {
        let what = format!("{} can be {number}, but there is no such method", row.id);
        let problem = Problem::key(path.key("methods"), what);
        names.report(problem.advise("add it, or list it in `no_steps`"));
    }
}

fn finish(raw: &RawFinish, path: &Path, names: &mut Names) -> Option<Finish> {
    let position = names.word(&raw.position, "position", &path.key("position"))?;
    if raw.of_origin && !raw.go {
        names.without_effect("of_origin", "the axis stays at the origin", path);
    } else if raw.of_origin && keeps(position) {
        names.without_effect("of_origin", "the position register is kept", path);
    }
    Some(Finish { go: raw.go, position, of_origin: raw.of_origin })
}

fn keeps(position: OriginPosition) -> bool {
    matches!(position, OriginPosition::Kept | OriginPosition::KeptPlus | OriginPosition::KeptMinus)
}

/// What is said about steps, where no method has any.
fn without_steps(raw: &RawHoming, homing: &HomingRules, path: &Path, names: &mut Names) {
    if homing.methods.values().any(|it| it.all_steps().next().is_some()) {
        return;
    }
    let of_steps = [
        ("stop", raw.stop.is_some()),
        ("limit", raw.limit.is_some()),
        ("limit_source", raw.limit_source.is_some()),
    ];
    for (key, _) in of_steps.into_iter().filter(|(_, given)| *given) {
        names.without_effect(key, "no method has steps", path);
    }
}

/// A homing has the numbers that it goes by, and goes by those that it has.
fn check_settings(homing: &HomingRules, numbers: &Numbers, path: &Path, names: &mut Names) {
    let methods = homing.methods.values();
    let any = |test: fn(HomingStep) -> bool| methods.clone().flat_map(Method::all_steps).any(test);
    let finishes: Vec<Finish> = homing.finish.iter().flat_map(Choice::all).collect();
    let refined = methods.clone().any(|it| it.index);
    let goes = finishes.iter().any(|it| it.go);
    let sets = |it: &Finish| !matches!(it.position, OriginPosition::Zero | OriginPosition::Kept);
    let moves = goes || any(|_| true);
    let uses = [
        (Setting::HomeFast, goes || any(|it| it.pace == Pace::Fast), true),
        (Setting::HomeSlow, refined || any(|it| it.pace == Pace::Slow), true),
        (Setting::HomeAccel, moves, false),
        (Setting::HomeOffset, goes, true),
        (Setting::HomeCoordinate, finishes.iter().any(sets), true),
        (Setting::HomeCollision, any(|it| it.until == Until::Collision), true),
        (Setting::HomeTimeLimit, moves, false),
    ];
    for (setting, used, needed) in uses {
        let (name, wired) = (setting.name(), numbers.has(setting));
        if used && needed && !wired {
            let what = format!("the homing uses `{name}`, but no row holds it");
            let advice = format!("add `{name}: ROW` to `quantities`");
            names.report(Problem::key(path.clone(), what).advise(advice));
        }
        if wired && !used {
            let what = format!("`{name}` has no effect: no homing uses it");
            names.report(Problem::key(quantities::path(name), what).advise("remove it"));
        }
    }
    if homing.time_factor.is_some() && !numbers.has(Setting::HomeTimeLimit) {
        names.without_effect("time_factor", "no row holds `home.time_limit`", path);
    }
    if homing.index.is_some() && !refined {
        names.without_effect("index", "no method says `index: true`", path);
    }
}

/// What is said about limits comes to something, and ends in alarms that there are.
fn check_limits(
    homing: &HomingRules,
    sight: &Sight<'_>,
    alarms: &[Alarm],
    path: &Path,
    names: &mut Names,
) {
    let ends = [
        (Input::LimitPos, AlarmCause::HomingLimitPos),
        (Input::LimitNeg, AlarmCause::HomingLimitNeg),
    ];
    let seen = ends.map(|(limit, _)| sight.sees(limit));
    let given = [("limit", homing.limit.is_some()), ("limit_source", homing.source.is_some())];
    let alarmed = homing.limit.as_ref().is_some_and(|it| it.all().contains(&LimitRule::Alarm));
    if seen == [false, false] {
        for (key, _) in given.into_iter().filter(|(_, given)| *given) {
            names.without_effect(key, "no limit is wired", path);
        }
    }
    for ((_, cause), _) in ends.into_iter().zip(seen).filter(|(_, seen)| alarmed && *seen) {
        needs_alarm(LimitRule::Alarm.name(), cause, path.key("limit"), alarms, names);
    }
}

/// A homing has a starter, a starter has a homing, and what shows or needs one has one.
pub(super) fn check_starters(homing: Option<&HomingRules>, wired: &Wired, names: &mut Names) {
    let starters = [
        (HomeStarter::Input, wired.has(Input::HomeStart)),
        (HomeStarter::Command, wired.does(Action::HomeStart)),
    ];
    let any = starters.iter().any(|(_, wired)| *wired) || at_first_enable(homing);
    let Some(homing) = homing else {
        if any {
            let what = "`home_start` is wired, but there is no `homing`";
            names.report(Problem::key(Path::root().key("signals"), what).advise("add `homing`"));
        }
        return wired.never_on(Output::HomeDone, "there is no `homing`", names);
    };
    let looks =
        |step: HomingStep| step.until.edge().is_some_and(|it| it.signal == Input::HomeSwitch);
    let looked_for = homing.methods.values().flat_map(Method::all_steps).any(looks);
    if wired.has(Input::HomeSwitch) && !looked_for {
        let what = "`home_switch` has no effect: no homing step waits for it";
        names.report(Problem::key(super::inputs::path(), what).advise("remove it"));
    }
    if !any {
        let what = "`homing` has no effect: nothing starts it";
        names.report(Problem::key(path(), what).advise("wire `home_start`, or remove it"));
        return;
    }
    let Some(codes) = homing.starter.as_ref().map(|it| &it.codes) else { return };
    let allowed = |starter| codes.values().any(|it| *it == starter);
    for (starter, wired) in starters.into_iter().filter(|(it, is)| allowed(*it) != *is) {
        let name = starter.name();
        let what = match wired {
            true => format!("no code is `{name}`, but `home_start` is wired"),
            false => format!("`{name}` starts nothing: no such `home_start` is wired"),
        };
        let advice = match starter {
            HomeStarter::Input => "an input signal needs its code, and a code its signal",
            _ => "an action needs its code, and a code its action",
        };
        names.report(Problem::key(path().key("starter"), what).advise(advice));
    }
}

/// Can a homing start that nobody asks for?
pub(super) fn at_first_enable(homing: Option<&HomingRules>) -> bool {
    let starter = homing.and_then(|it| it.starter.as_ref());
    starter.is_some_and(|it| it.codes.values().any(|it| *it == HomeStarter::FirstEnable))
}
