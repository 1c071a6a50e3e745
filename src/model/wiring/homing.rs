//! How an axis looks for its origin: words resolved, and whether everything goes together.

mod steps;

use super::compile::Wirer;
use super::{Choice, Finish, Homing};
use crate::model::RowId;
use crate::model::raw::{RawFinish, RawHoming, RawMethod};
use crate::problem::{Path, Problem};
use crate::words::{
    IndexRule, Input, LimitRule, LimitSource, Method, OriginPosition, OriginStop, Pace, Setting,
    Step, Steps, Until, Word,
};
use std::collections::BTreeMap;

impl Wirer<'_> {
    pub(super) fn homing(&mut self, raw: &RawHoming) {
        let path = Path::root().key("homing");
        let methods_path = path.key("methods");
        let method = |(number, raw): (&i64, &RawMethod)| {
            (*number, self.method(raw, &methods_path.key(number)))
        };
        let methods: BTreeMap<i64, Method> = raw.methods.iter().map(method).collect();
        let row = raw.method.as_ref().and_then(|id| self.row(id, &path.key("method")));
        match row {
            Some(row) => self.numbers(row, raw, &path),
            None if raw.method.is_none() && methods.len() != 1 => {
                let what = "without a row that chooses there is one method";
                self.problems.push(Problem::key(methods_path, what).advise("add `method: ROW`"));
            }
            None => {}
        }
        let stop = raw.stop.as_ref().and_then(|it| {
            self.word::<OriginStop>(it, "way to stand at the origin", &path.key("stop"))
        });
        let homing = Homing {
            method: row,
            methods,
            starter: raw.starter.as_ref().and_then(|it| {
                self.chosen(it, &path.key("starter"), |wirer, name: &String, path| {
                    wirer.word(name, "starter of a homing", path)
                })
            }),
            limit: self.words_chosen(&raw.limit, "meaning of a limit", &path.key("limit")),
            source: self.words_chosen(
                &raw.limit_source,
                "source of limits",
                &path.key("limit_source"),
            ),
            index: self.words_chosen(&raw.index, "use of the index pulse", &path.key("index")),
            stop: stop.unwrap_or(OriginStop::AtOnce),
            finish: self.choice(&raw.finish, &path.key("finish"), Self::finish),
            time_factor: raw
                .time_factor
                .as_ref()
                .and_then(|it| self.digit(it, &path.key("time_factor"))),
        };
        self.homing_settings(&homing, &path);
        self.homing_signals(&homing, &path);
        self.wiring.homing = Some(homing);
    }

    /// Each number that the row can hold has steps, or is said to have none.
    fn numbers(&mut self, row: RowId, raw: &RawHoming, path: &Path) {
        let row = self.rows.map.row(row);
        for number in raw.methods.keys().filter(|it| !row.admits(**it)) {
            let what = format!("{} never holds {number}", row.id);
            self.problems.push(Problem::key(path.key("methods").key(number), what));
        }
        for (i, number) in raw.no_steps.iter().enumerate() {
            let known = raw.methods.contains_key(number);
            let what = match row.admits(*number) {
                true if known => format!("method {number} has steps"),
                true => continue,
                false => format!("{} never holds {number}", row.id),
            };
            self.problems.push(Problem::value(path.key("no_steps").index(i), what));
        }
        let known = |it: &i64| raw.methods.contains_key(it) || raw.no_steps.contains(it);
        let mut all = row.spans.iter().flat_map(|(low, high)| *low..=*high);
        if let Some(number) = all.find(|it| !known(it)) {
            let what = format!("{} can hold {number}, and that is no method here", row.id);
            let problem = Problem::key(path.key("methods"), what);
            self.problems.push(problem.advise("give it steps, or list it in `no_steps`"));
        }
    }

    fn finish(&mut self, raw: &RawFinish, path: &Path) -> Option<Finish> {
        let position = self.word(&raw.position, "position", &path.key("position"))?;
        if raw.of_origin && !raw.go {
            let what = "`of_origin` changes nothing: the axis stays there";
            self.problems.push(Problem::key(path.key("of_origin"), what).advise("leave it out"));
        }
        Some(Finish { go: raw.go, position, of_origin: raw.of_origin })
    }

    /// A homing has the numbers that it goes by, and goes by those that it has.
    fn homing_settings(&mut self, homing: &Homing, path: &Path) {
        let methods = homing.methods.values();
        let steps = || methods.clone().flat_map(|it| [&it.steps, &it.at_limit, &it.on]);
        let any = |test: fn(Step) -> bool| steps().flat_map(Steps::iter).any(test);
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
                let what = format!("no row holds `{name}`, which a homing goes by");
                let advice = format!("add `{name}: ROW` to `quantities`");
                self.problems.push(Problem::key(path.clone(), what).advise(advice));
            }
            if wired && !used {
                let what = format!("`{name}` changes nothing: no homing goes by it");
                let path = Path::root().key("quantities").key(name);
                self.problems.push(Problem::key(path, what).advise("leave it out"));
            }
        }
        let limited = self.wiring.axis.setting(Setting::HomeTimeLimit).is_some();
        self.unused(
            homing.time_factor.is_some() && !limited,
            "time_factor",
            "there is no `home.time_limit`",
            path,
        );
        self.unused(
            homing.index.is_some() && !refined,
            "index",
            "no method says `index: true`",
            path,
        );
        if refined && homing.index.is_none() {
            let what = "`index: true` changes nothing: `homing.index` does not say what it means";
            self.problems.push(Problem::key(path.key("methods"), what));
        }
    }

    /// Something starts a homing, and what it looks for can be there.
    fn homing_signals(&mut self, homing: &Homing, path: &Path) {
        let inputs = self.inputs_wired();
        let limits = inputs.contains(&Input::LimitPos) || inputs.contains(&Input::LimitNeg);
        self.unused(homing.limit.is_some() && !limits, "limit", "no limit is wired", path);
        self.unused(homing.source.is_some() && !limits, "limit_source", "no limit is wired", path);
    }

    fn unused(&mut self, is: bool, key: &str, why: &str, path: &Path) {
        if is {
            let what = format!("`{key}` changes nothing: {why}");
            self.problems.push(Problem::key(path.key(key), what).advise("leave it out"));
        }
    }
}

/// The defaults of what a file leaves out.
impl Homing {
    /// What a limit means.
    pub const LIMIT: LimitRule = LimitRule::Turn;
    /// What tells of a limit.
    pub const SOURCE: LimitSource = LimitSource::Switch;
    /// Whether an index pulse counts.
    pub const INDEX: IndexRule = IndexRule::None;
}
