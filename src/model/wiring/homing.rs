//! How an axis looks for its origin and what its limits do: words resolved, and whether everything goes together.

use super::Digit;
use super::compile::Wirer;
use super::{Choice, Finish, Homing, Limits};
use crate::model::line::{Coded, coded};
use crate::model::raw::{
    RawChoice, RawChosen, RawDigit, RawFinish, RawHoming, RawLimits, RawMethod, RawStep, RawWay,
};
use crate::problem::{At, Path, Problem};
use crate::words::{
    Edge, IndexRule, Input, LimitRule, LimitSource, MOST_STEPS, Method, OriginPosition, OriginStop,
    Setting, Step, Steps, Until, Word,
};
use std::collections::BTreeMap;

/// Signals that a step can wait for.
const SWITCHES: [Input; 3] = [Input::HomeSwitch, Input::LimitPos, Input::LimitNeg];

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
            Some(row) => self.numbered(row, raw, &path),
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

    pub(super) fn limits(&mut self, raw: &RawLimits) {
        let path = Path::root().key("limits");
        let stop = self.words_chosen(&raw.stop, "way to stop", &path.key("stop"));
        let soft = self.words_chosen(&raw.soft, "rule for soft limits", &path.key("soft"));
        let has = |wirer: &Self, setting| wirer.wiring.axis.setting(setting).is_some();
        let softs = [Setting::SoftLimitPos, Setting::SoftLimitNeg];
        let wired = softs.map(|setting| has(self, setting));
        match wired {
            [true, true] => {}
            [false, false] => {
                if soft.is_some() {
                    let what = "`soft` changes nothing: no row holds a soft limit";
                    let advice = "wire `limit.soft_pos` and `limit.soft_neg`, or leave it out";
                    self.problems.push(Problem::key(path.key("soft"), what).advise(advice));
                }
            }
            _ => {
                let name = softs[usize::from(wired[0])].name();
                let what = format!("no row holds `{name}`, and soft limits are two");
                self.problems.push(Problem::key(Path::root().key("quantities"), what));
            }
        }
        let inputs = self.inputs_wired();
        let any = [Input::LimitPos, Input::LimitNeg].iter().any(|it| inputs.contains(it));
        if stop.is_some() && !any && wired == [false, false] {
            let what = "`stop` changes nothing: there is no limit";
            self.problems.push(Problem::key(path.key("stop"), what).advise("leave it out"));
        }
        self.wiring.limits = Limits { stop, soft };
    }

    /// Each number that the row can hold has steps, or is said to have none.
    fn numbered(&mut self, row: crate::model::RowId, raw: &RawHoming, path: &Path) {
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

    fn method(&mut self, raw: &RawMethod, path: &Path) -> Method {
        let by = raw.by.as_ref().and_then(|name| self.switch(name, &path.key("by")));
        for (key, steps) in [("on", &raw.on), ("at_limit", &raw.at_limit)] {
            let why = match key {
                "on" if by.is_none() => "there is no `by`",
                "at_limit" if raw.steps.is_empty() => "there is no first step",
                _ => continue,
            };
            if !steps.is_empty() {
                let what = format!("`{key}` changes nothing: {why}");
                self.problems.push(Problem::key(path.key(key), what).advise("leave it out"));
            }
        }
        if by.is_some() && raw.on.is_empty() {
            let what = "`by` changes nothing without `on`";
            self.problems.push(Problem::key(path.key("by"), what).advise("leave it out"));
        }
        Method {
            by,
            steps: self.steps(&raw.steps, &path.key("steps")),
            at_limit: self.steps(&raw.at_limit, &path.key("at_limit")),
            on: self.steps(&raw.on, &path.key("on")),
            index: raw.index,
        }
    }

    fn steps(&mut self, raw: &[RawStep], path: &Path) -> Steps {
        if raw.len() > MOST_STEPS {
            let what = format!("{} steps, and there is room for {MOST_STEPS}", raw.len());
            self.problems.push(Problem::value(path.clone(), what));
        }
        let step = |(i, it): (usize, &RawStep)| self.step(it, &path.index(i));
        let steps: Vec<_> = raw.iter().enumerate().filter_map(step).collect();
        let origin = |step: &Step| step.then == crate::words::Then::Origin;
        let last = steps.len().saturating_sub(1);
        if steps.len() == raw.len() {
            for (i, step) in steps.iter().enumerate().filter(|(i, it)| origin(it) != (*i == last)) {
                let what = match origin(step) {
                    true => "the origin ends a homing, and a step follows",
                    false => "the last step finds no origin",
                };
                self.problems.push(Problem::value(path.index(i).key("then"), what));
            }
        }
        Steps::new(&steps)
    }

    fn step(&mut self, raw: &RawStep, path: &Path) -> Option<Step> {
        let pace = self.word(&raw.at, "pace", &path.key("at"));
        let until = self.until(&raw.to, &path.key("to"));
        let then = self.word(&raw.then, "end of a step", &path.key("then"));
        Some(Step { forward: raw.go == RawWay::Pos, pace: pace?, until: until?, then: then? })
    }

    fn until(&mut self, text: &str, path: &Path) -> Option<Until> {
        match text {
            "collision" => return Some(Until::Collision),
            "index" => return Some(Until::Index(None)),
            _ => {}
        }
        let (index, edge) = match text.strip_prefix("index after ") {
            Some(edge) => (true, edge),
            None => (false, text),
        };
        let (name, on) = match edge.split_once(' ') {
            Some((name, "on")) => (name, true),
            Some((name, "off")) => (name, false),
            _ => {
                let what = format!("`{text}` is nothing to wait for");
                let advice =
                    "a switch with `on` or `off`, `index`, `index after SWITCH on`, or `collision`";
                self.problems.push(Problem::value(path.clone(), what).advise(advice));
                return None;
            }
        };
        let edge = Edge { signal: self.switch(name, path)?, on };
        Some(if index { Until::Index(Some(edge)) } else { Until::Edge(edge) })
    }

    /// One of the switches, and wired.
    fn switch(&mut self, name: &str, path: &Path) -> Option<Input> {
        let signal = self.word::<Input>(name, "switch", path)?;
        let names = || SWITCHES.map(Word::name).join(", ");
        let what = if !SWITCHES.contains(&signal) {
            format!("`{name}` is no switch; there are {}", names())
        } else if !self.inputs_wired().contains(&signal) {
            format!("`{name}` is wired to nothing")
        } else {
            return Some(signal);
        };
        self.problems.push(Problem::value(path.clone(), what));
        None
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
            (Setting::HomeFast, goes || any(|it| it.pace == crate::words::Pace::Fast), true),
            (Setting::HomeSlow, refined || any(|it| it.pace == crate::words::Pace::Slow), true),
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

/// Choices by row.
impl Wirer<'_> {
    fn words_chosen<W: Word>(
        &mut self,
        raw: &Option<RawChoice<String>>,
        kind: &str,
        path: &Path,
    ) -> Option<Choice<W>> {
        self.choice(raw, path, |wirer, name: &String, path| wirer.word(name, kind, path))
    }

    fn choice<R, T: Copy>(
        &mut self,
        raw: &Option<RawChoice<R>>,
        path: &Path,
        read: impl Fn(&mut Self, &R, &Path) -> Option<T>,
    ) -> Option<Choice<T>> {
        Some(match raw.as_ref()? {
            RawChoice::Fixed(it) => Choice::Fixed(read(self, it, path)?),
            RawChoice::Row(it) => Choice::Row(self.chosen(it, path, read)?),
        })
    }

    fn chosen<R, T: Copy>(
        &mut self,
        raw: &RawChosen<R>,
        path: &Path,
        read: impl Fn(&mut Self, &R, &Path) -> Option<T>,
    ) -> Option<Coded<T>> {
        let row = self.row(&raw.register, &path.key("register"));
        coded(row, raw.digit, &raw.codes, self.rows, path, self.problems);
        let mut codes = BTreeMap::new();
        for (code, it) in &raw.codes {
            let meaning = read(self, it, &path.key("codes").key(code));
            codes.extend(meaning.map(|meaning| (*code, meaning)));
        }
        Some(Coded { row: row?, digit: raw.digit, codes })
    }

    fn digit(&mut self, raw: &RawDigit, path: &Path) -> Option<Digit> {
        let row = self.row(&raw.register, &path.key("register"))?;
        if raw.digit.is_some_and(|digit| digit > 3) {
            let what = "a word has hex digits 0 to 3, counted from the right";
            self.problems
                .push(Problem { at: At::Value, ..Problem::value(path.key("digit"), what) });
        }
        Some(Digit { row, digit: raw.digit })
    }
}

impl<T: Copy> Choice<T> {
    /// Everything that it can come to.
    fn all(&self) -> Vec<T> {
        match self {
            Self::Fixed(it) => vec![*it],
            Self::Row(coded) => coded.codes.values().copied().collect(),
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
