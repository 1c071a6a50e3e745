//! How an axis looks for its origin: words resolved, and whether everything goes together.

mod starts;
mod steps;

use super::compile::Wirer;
use super::{Choice, Digit};
use crate::model::RowId;
use crate::model::line::Coded;
use crate::model::raw::{RawFinish, RawHoming, RawMethod};
use crate::problem::{Path, Problem};
use crate::vocabulary::{
    AlarmCause, HomeStarter, HomingStep, IndexRule, Input, LimitRule, LimitSource, Method, Named,
    OriginPosition, OriginStop, Pace, Setting, Until,
};
use std::collections::BTreeMap;

/// How the axis looks for its origin.
#[derive(Debug)]
pub struct HomingRules {
    /// The row with the number of the method; `None` where there is one.
    pub method: Option<RowId>,
    /// Methods by number.
    pub methods: BTreeMap<i64, Method>,
    /// What starts it; `None` is everything that is wired.
    pub starter: Option<Coded<HomeStarter>>,
    /// What a limit on the way means.
    pub limit: Option<Choice<LimitRule>>,
    /// What tells that there is one.
    pub source: Option<Choice<LimitSource>>,
    /// Whether an index pulse refines the origin.
    pub index: Option<Choice<IndexRule>>,
    /// How the axis stands at the origin.
    pub stop: OriginStop,
    /// What happens there.
    pub finish: Option<Choice<Finish>>,
    /// Factor of the time limit; 0 is none.
    pub time_factor: Option<Digit>,
}

impl HomingRules {
    /// The rows that it goes by, when it starts.
    pub fn rows(&self) -> impl Iterator<Item = RowId> + '_ {
        let choices = [
            self.limit.as_ref().and_then(Choice::row),
            self.source.as_ref().and_then(Choice::row),
            self.index.as_ref().and_then(Choice::row),
            self.finish.as_ref().and_then(Choice::row),
            self.starter.as_ref().map(|it| it.row),
            self.time_factor.map(|it| it.row),
            self.method,
        ];
        choices.into_iter().flatten()
    }
}

/// What happens when the origin is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Finish {
    /// Go on by `home.way`?
    pub go: bool,
    /// What the position register says then.
    pub position: OriginPosition,
    /// Does it say that of the origin, and not of where the axis stands in the end?
    pub of_origin: bool,
}

impl Wirer<'_> {
    pub(super) fn homing(&mut self, raw: &RawHoming) {
        let path = Path::root().key("homing");
        let row = raw.method.as_ref().and_then(|id| self.row(id, &path.key("method")));
        let stop = raw.stop.as_ref().and_then(|it| {
            self.word::<OriginStop>(it, "stopping mode at the origin", &path.key("stop"))
        });
        let starter = raw.starter.as_ref().and_then(|it| {
            self.chosen(it, &path.key("starter"), |wirer, name: &String, path| {
                wirer.word(name, "homing trigger", path)
            })
        });
        let source = &raw.limit_source;
        self.wiring.homing = Some(HomingRules {
            method: row,
            methods: BTreeMap::new(),
            starter,
            limit: self.words_chosen(&raw.limit, "reaction to a limit", &path.key("limit")),
            source: self.words_chosen(source, "limit detection", &path.key("limit_source")),
            index: self.words_chosen(&raw.index, "use of the index pulse", &path.key("index")),
            stop: stop.unwrap_or(OriginStop::AtOnce),
            finish: self.choice(&raw.finish, &path.key("finish"), Self::finish),
            time_factor: raw
                .time_factor
                .as_ref()
                .and_then(|it| self.digit(it, &path.key("time_factor"))),
        });
        let methods = self.methods(raw, &path.key("methods"));
        if let Some(row) = row {
            self.numbered(row, raw, &path);
        } else if !raw.no_steps.is_empty() && raw.method.is_none() {
            self.unused("no_steps", "there is no `method`", &path);
        }
        let Some(mut homing) = self.wiring.homing.take() else { return };
        let stays = methods.values().all(|it| it.all_steps().next().is_none());
        let of_steps = [
            ("stop", raw.stop.is_some()),
            ("limit", raw.limit.is_some()),
            ("limit_source", raw.limit_source.is_some()),
        ];
        for (key, _) in of_steps.into_iter().filter(|(_, given)| stays && *given) {
            self.unused(key, "no method has steps", &path);
        }
        homing.methods = methods;
        self.homing_settings(&homing, &path);
        self.wiring.homing = Some(homing);
        self.homing_limits(&path);
    }

    fn methods(&mut self, raw: &RawHoming, path: &Path) -> BTreeMap<i64, Method> {
        if raw.method.is_none() && raw.methods.len() != 1 {
            let what = "without a row that selects the method there must be exactly one";
            self.problems.push(Problem::key(path.clone(), what).advise("add `method: ROW`"));
        }
        let method =
            |(number, raw): (&i64, &RawMethod)| (*number, self.method(raw, &path.key(number)));
        raw.methods.iter().map(method).collect()
    }

    /// Each number that the row can hold has steps, or is said to have none.
    fn numbered(&mut self, row: RowId, raw: &RawHoming, path: &Path) {
        let row = self.rows.map.row(row);
        for number in raw.methods.keys().filter(|it| !row.admits(**it)) {
            let what = format!("{} is never {number}", row.id);
            self.problems.push(Problem::key(path.key("methods").key(number), what));
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
            self.problems.push(Problem::value(path.key("no_steps").index(i), what));
        }
        let known = |it: &i64| raw.methods.contains_key(it) || raw.no_steps.contains(it);
        let mut all = row.spans.iter().flat_map(|(low, high)| *low..=*high);
        if let Some(number) = all.find(|it| !known(it)) {
            let what = format!("{} can be {number}, but there is no such method", row.id);
            let problem = Problem::key(path.key("methods"), what);
            self.problems.push(problem.advise("add it, or list it in `no_steps`"));
        }
    }

    fn finish(&mut self, raw: &RawFinish, path: &Path) -> Option<Finish> {
        let position = self.word(&raw.position, "position", &path.key("position"))?;
        if raw.of_origin && !raw.go {
            self.unused("of_origin", "the axis stays at the origin", path);
        } else if raw.of_origin && keeps(position) {
            self.unused("of_origin", "the position register is kept", path);
        }
        Some(Finish { go: raw.go, position, of_origin: raw.of_origin })
    }

    /// A homing has the numbers that it goes by, and goes by those that it has.
    fn homing_settings(&mut self, homing: &HomingRules, path: &Path) {
        let methods = homing.methods.values();
        let any =
            |test: fn(HomingStep) -> bool| methods.clone().flat_map(Method::all_steps).any(test);
        let finishes: Vec<Finish> = homing.finish.iter().flat_map(Choice::all).collect();
        let refined = methods.clone().any(|it| it.index);
        let goes = finishes.iter().any(|it| it.go);
        let sets =
            |it: &Finish| !matches!(it.position, OriginPosition::Zero | OriginPosition::Kept);
        let moves = goes || any(|_| true);
        let uses = [
            (Setting::HomeFast, goes || any(|it| it.pace == Pace::Fast), true),
            (Setting::HomeSlow, refined || any(|it| it.pace == Pace::Slow), true),
            (Setting::HomeAccel, moves, false),
            (Setting::HomeWay, goes, true),
            (Setting::HomeCoordinate, finishes.iter().any(sets), true),
            (Setting::HomeCollision, any(|it| it.until == Until::Collision), true),
            (Setting::HomeTimeLimit, moves, false),
        ];
        for (setting, used, needed) in uses {
            let name = setting.name();
            let wired = self.wiring.axis.setting(setting).is_some();
            if used && needed && !wired {
                let what = format!("the homing uses `{name}`, but no row holds it");
                let advice = format!("add `{name}: ROW` to `quantities`");
                self.problems.push(Problem::key(path.clone(), what).advise(advice));
            }
            if wired && !used {
                let what = format!("`{name}` has no effect: no homing uses it");
                let path = Path::root().key("quantities").key(name);
                self.problems.push(Problem::key(path, what).advise("remove it"));
            }
        }
        let limited = self.wiring.axis.setting(Setting::HomeTimeLimit).is_some();
        if homing.time_factor.is_some() && !limited {
            self.unused("time_factor", "no row holds `home.time_limit`", path);
        }
        if homing.index.is_some() && !refined {
            self.unused("index", "no method says `index: true`", path);
        }
    }

    /// What is said about limits comes to something, and ends in alarms that there are.
    fn homing_limits(&mut self, path: &Path) {
        let ends = [
            (Input::LimitPos, AlarmCause::HomingLimitPos),
            (Input::LimitNeg, AlarmCause::HomingLimitNeg),
        ];
        let seen = ends.map(|(limit, _)| self.is_seen(limit));
        let Some(homing) = &self.wiring.homing else { return };
        let given = [("limit", homing.limit.is_some()), ("limit_source", homing.source.is_some())];
        let alarms = homing.limit.as_ref().is_some_and(|it| it.all().contains(&LimitRule::Alarm));
        if seen == [false, false] {
            for (key, _) in given.into_iter().filter(|(_, given)| *given) {
                self.unused(key, "no limit is wired", path);
            }
        }
        for ((_, cause), _) in ends.into_iter().zip(seen).filter(|(_, seen)| alarms && *seen) {
            self.needs_alarm(LimitRule::Alarm.name(), cause, path.key("limit"));
        }
    }
}

fn keeps(position: OriginPosition) -> bool {
    matches!(position, OriginPosition::Kept | OriginPosition::KeptPlus | OriginPosition::KeptMinus)
}

/// The defaults of what a file leaves out.
impl HomingRules {
    /// What a limit means.
    pub const LIMIT: LimitRule = LimitRule::Turn;
    /// What tells of a limit.
    pub const SOURCE: LimitSource = LimitSource::Switch;
    /// Whether an index pulse counts.
    pub const INDEX: IndexRule = IndexRule::None;
}
