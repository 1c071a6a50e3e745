//! From the text of a scenario to a [`Scenario`], or to everything that is wrong with it.
//!
//! Without a bench only what needs no drives is looked at. A key that could change nothing is a mistake.

use super::order::{NoOrder, Order, ScenarioLine};
use super::raw::{
    RawCondition, RawCount, RawLevel, RawRegister, RawScenario, RawScenarioStep, RawStepRepeat,
};
use super::step::{Condition, ScenarioStep, Subject, Test, Trigger};
use super::{Part, Scenario};
use crate::bench::BenchLine;
use crate::bus::Command;
use crate::event::DriveId;
use crate::problem::decode::{decode, listed};
use crate::problem::tree::Node;
use crate::problem::{Path, Problem, bounds, has_unread, parse as parse_yaml, placed, suggest};
use crate::time::{Duration, Instant, parse_duration};
use crate::vocabulary::{Named, Output, Quantity};

/// The least time from one repetition of a step to the next. At the usual rate a machine that does more often a thing
/// that takes it some time would do nothing else.
const REPEAT_EVERY: Duration = Duration::from_millis(1);

/// Reads a scenario for the lines of a bench.
///
/// # Errors
/// Every problem of the text.
pub fn parse(text: &str, lines: &[BenchLine]) -> Result<Scenario, Vec<Problem>> {
    read(text, Some(lines))
}

/// Everything that is wrong with a scenario whatever bench it is for.
pub fn check(text: &str) -> Vec<Problem> {
    read(text, None).err().unwrap_or_default()
}

fn read(text: &str, lines: Option<&[BenchLine]>) -> Result<Scenario, Vec<Problem>> {
    let (file, problems) = parse_yaml(text)?;
    let sites = lines.map(|lines| lines.iter().map(ScenarioLine::new).collect());
    let mut reader = ScenarioReader { sites, problems };
    let scenario = reader.scenario(&file);
    let problems = reader.problems;
    if problems.is_empty() {
        return Ok(scenario);
    }
    Err(placed(problems, &file))
}

struct ScenarioReader<'a> {
    /// The lines with their drives, if they are known.
    sites: Option<Vec<ScenarioLine<'a>>>,
    problems: Vec<Problem>,
}

impl ScenarioReader<'_> {
    fn scenario(&mut self, file: &Node) -> Scenario {
        let root = Path::root();
        let head: Option<RawScenario> = decode(file, &root, &["steps"], &mut self.problems);
        let limit = head.and_then(|head| self.limit(head.limit.as_ref(), &root.key("limit")));
        let path = root.key("steps");
        let mut steps = listed(file.get("steps"), &path, &mut self.problems);
        if steps.is_empty() {
            self.problems.push(Problem::key(path.clone(), "a scenario needs at least one step"));
        }
        if let Some(most) = bounds::count("steps", steps.len(), bounds::STEPS, &path) {
            self.problems.push(most);
            steps.clear();
        }
        let count = self.sites.as_ref().map_or(1, Vec::len);
        let limit = limit.map(|limit| Instant::ZERO + limit);
        let mut parts = vec![Part { steps: Vec::new(), limit }; count];
        for (path, node) in steps {
            let raw: Option<RawScenarioStep> = decode(node, &path, &[], &mut self.problems);
            let Some(raw) = raw else { continue };
            let line = self.line(&raw, &path);
            let step = self.step(&raw, line, &path);
            parts[line.unwrap_or(0)].steps.extend(step);
        }
        Scenario { parts }
    }

    /// By when all is to be done.
    fn limit(&mut self, text: Option<&String>, path: &Path) -> Option<Duration> {
        let limit = self.time(text, path)?;
        if limit.is_zero() {
            self.refuse(path, "`limit` must be above 0", None);
        }
        Some(limit)
    }

    /// Which line the step is about.
    fn line(&mut self, raw: &RawScenarioStep, path: &Path) -> Option<usize> {
        let (Some(sites), Some(name)) = (&self.sites, &raw.line) else {
            return self.sites.as_ref().map(|_| 0);
        };
        let names: Vec<_> = sites.iter().map(|line| line.line.name.as_str()).collect();
        let at = names.iter().position(|it| it == name);
        if at.is_none() {
            let advice = suggest::did_you_mean(name, names.iter().copied());
            let problem = Problem::value(path.key("line"), format!("unknown line `{name}`"));
            self.problems.push(problem.advise_if(advice));
        }
        at
    }

    fn step(
        &mut self,
        raw: &RawScenarioStep,
        line: Option<usize>,
        path: &Path,
    ) -> Option<ScenarioStep> {
        let drive = self.drive(line, raw.unit, DriveId(0), &path.key("unit"));
        let lengths =
            [("do", "orders", raw.orders.len()), ("expect", "conditions", raw.expect.len())];
        for (key, what, len) in lengths {
            if let Some(problem) = bounds::count(what, len, bounds::OF_A_STEP, &path.key(key)) {
                self.problems.push(problem);
                return None;
            }
        }
        if raw.orders.is_empty() && raw.expect.is_empty() && raw.repeat.is_none() {
            self.refuse(
                path,
                "this step has neither `do` nor `expect`",
                Some("add `do` or `expect`"),
            );
        }
        if raw.within.is_some() && raw.expect.is_empty() {
            let problem =
                Problem::key(path.key("within"), "`within` has no effect without `expect`");
            self.problems.push(problem);
        }
        let trigger = self.trigger(raw, line, drive, path);
        let commands = self.commands(raw, line, drive, path);
        let repeat = raw.repeat.as_ref().and_then(|it| self.repeat(it, raw, path));
        let mut expect = Vec::new();
        for (i, condition) in raw.expect.iter().enumerate() {
            expect.extend(self.condition(condition, line, drive, &path.key("expect").index(i)));
        }
        let within = self.time_above_zero(raw.within.as_ref(), &path.key("within"));
        let within = within.unwrap_or_default();
        let name = raw.name.clone();
        Some(ScenarioStep { name, trigger: trigger?, commands, repeat, expect, within })
    }

    fn trigger(
        &mut self,
        raw: &RawScenarioStep,
        line: Option<usize>,
        drive: DriveId,
        path: &Path,
    ) -> Option<Trigger> {
        let given = [
            ("at", raw.at.is_some()),
            ("wait", raw.wait.is_some()),
            ("after", raw.after.is_some()),
            ("when", raw.when.is_some()),
        ];
        let mut given = given.iter().filter(|(_, given)| *given).map(|(key, _)| *key);
        given.next();
        if let Some(second) = given.next() {
            let what = "a step has only one trigger, and this is a second";
            self.problems.push(Problem::key(path.key(second), what).advise("use two steps"));
        }
        if raw.at.is_some() {
            let at = self.time(raw.at.as_ref(), &path.key("at"))?;
            return Some(Trigger::At(Instant::ZERO + at));
        }
        if let Some(after) = &raw.after {
            return self.after(after, line, &path.key("after"));
        }
        if let Some(condition) = &raw.when {
            let condition = self.condition(condition, line, drive, &path.key("when"));
            return condition.map(Trigger::When);
        }
        let wait = self.time_above_zero(raw.wait.as_ref(), &path.key("wait"));
        Some(Trigger::Wait(wait.unwrap_or_default()))
    }

    fn after(&mut self, raw: &RawCount, line: Option<usize>, path: &Path) -> Option<Trigger> {
        if raw.n == 0 {
            self.refuse(&path.key("n"), "`n` must be at least 1", None);
        }
        let path = path.key("unit");
        let drive = raw.unit.map(|unit| self.drive(line, Some(unit), DriveId(0), &path));
        Some(Trigger::After { n: raw.n, kind: raw.kind, drive })
    }

    fn repeat(
        &mut self,
        repeat: &RawStepRepeat,
        raw: &RawScenarioStep,
        path: &Path,
    ) -> Option<(u32, Duration)> {
        let own = path.key("repeat");
        let every = self.time(Some(&repeat.every), &own.key("every"))?;
        if every < REPEAT_EVERY {
            let what = format!("`every` must be at least {REPEAT_EVERY:?}");
            self.refuse(&own.key("every"), what, None);
        }
        if repeat.times < 2 {
            self.refuse(&own.key("times"), "`times` must be at least 2", None);
        }
        let orders: Vec<_> = raw.orders.iter().map(|it| it.trim_start()).collect();
        if orders.is_empty() {
            let problem = Problem::key(own, "`repeat` has no effect without `do`");
            self.problems.push(problem);
        } else if orders.iter().any(|it| it.starts_with("fault ") || it.starts_with("no_fault ")) {
            let problem = Problem::key(own, "fault rules cannot be repeated");
            self.problems.push(problem.advise("use the keys `every` and `count` of the rule"));
        }
        Some((repeat.times, every))
    }

    fn commands(
        &mut self,
        raw: &RawScenarioStep,
        line: Option<usize>,
        drive: DriveId,
        path: &Path,
    ) -> Vec<Command> {
        let mut commands = Vec::new();
        for (i, text) in raw.orders.iter().enumerate() {
            let path = path.key("do").index(i);
            let line = line.and_then(|line| self.sites.as_mut()?.get_mut(line));
            let read = match line {
                Some(line) => line.commands(text, drive),
                None => Order::check(text).map(|()| Vec::new()),
            };
            match read {
                Ok(more) => commands.extend(more),
                Err(NoOrder { what, advice }) => {
                    self.problems.push(Problem::value(path, what).advise_if(advice));
                }
            }
        }
        commands
    }

    fn condition(
        &mut self,
        raw: &RawCondition,
        line: Option<usize>,
        drive: DriveId,
        path: &Path,
    ) -> Option<Condition> {
        let drive = self.drive(line, raw.unit, drive, &path.key("unit"));
        if has_unread(&self.problems, path) {
            return None;
        }
        let subject = self.subject(raw, line, drive, path);
        let test = self.test(raw, path);
        let condition = Condition { drive, subject: subject?, test: test? };
        self.refuse_never(&condition, line, path);
        Some(condition)
    }

    /// No register shows a number that its type does not have.
    fn refuse_never(&mut self, condition: &Condition, line: Option<usize>, path: &Path) {
        let line = line.and_then(|line| self.sites.as_ref()?.get(line));
        let (Some(line), Subject::Row(row)) = (line, condition.subject) else { return };
        let row = line.model(condition.drive).map.row(row);
        let ((low, high), label) = (row.kind.limits(), row.label());
        let (key, number) = match condition.test {
            Test::Is(number) if !(low..=high).contains(&number) => ("is", number),
            Test::Within(Some(above), _) if above >= high => ("above", above),
            Test::Within(_, Some(below)) if below <= low => ("below", below),
            Test::Is(_) | Test::Within(..) => return,
        };
        let what = format!("can never be true: {label} is within {low}..{high}, not {number}");
        self.refuse(&path.key(key), what, None);
    }

    fn subject(
        &mut self,
        raw: &RawCondition,
        line: Option<usize>,
        drive: DriveId,
        path: &Path,
    ) -> Option<Subject> {
        match (&raw.signal, &raw.quantity, &raw.register) {
            (Some(name), None, None) => {
                let signal = Output::parse(name).map(Subject::Signal);
                self.known(signal, "signal", name, Output::ALL.iter().map(|it| it.name()), path)
            }
            (None, Some(name), None) => {
                let quantity = Quantity::parse(name).map(Subject::Quantity);
                self.known(
                    quantity,
                    "quantity",
                    name,
                    Quantity::ALL.iter().map(|it| it.name()),
                    path,
                )
            }
            (None, None, Some(register)) => {
                let line = self.sites.as_ref()?.get(line?)?;
                let map = &line.model(drive).map;
                let name = match register {
                    RawRegister::Address(address) => address.to_string(),
                    RawRegister::Name(name) => name.clone(),
                };
                let row = map.find(&name).map(Subject::Row);
                let ids: Vec<String> = map.rows().map(|(_, row)| row.id.clone()).collect();
                self.known(row, "register", &name, ids.iter().map(String::as_str), path)
            }
            _ => {
                let what = "a condition needs exactly one of signal, quantity, register";
                self.refuse(path, what, None);
                None
            }
        }
    }

    /// The thing called `name`, or a problem with it.
    fn known<'n, T>(
        &mut self,
        found: Option<T>,
        key: &str,
        name: &str,
        names: impl Iterator<Item = &'n str>,
        path: &Path,
    ) -> Option<T> {
        if found.is_none() {
            let advice = suggest::did_you_mean(name, names);
            let problem = Problem::value(path.key(key), format!("unknown {key} `{name}`"));
            self.problems.push(problem.advise_if(advice));
        }
        found
    }

    fn test(&mut self, raw: &RawCondition, path: &Path) -> Option<Test> {
        let window = raw.above.is_some() || raw.below.is_some();
        let test = match (&raw.is, raw.signal.is_some()) {
            (Some(RawLevel::Word(word)), true) if !window => match word.as_str() {
                "on" => Some(Test::Is(1)),
                "off" => Some(Test::Is(0)),
                _ => None,
            },
            (Some(RawLevel::Number(number)), false) if !window => Some(Test::Is(*number)),
            (None, false) if window => Some(Test::Within(raw.above, raw.below)),
            _ => None,
        };
        if test.is_none() {
            let what = match raw.signal.is_some() {
                true => "for a signal, give `is: on` or `is: off`",
                false => "for a number, give `is`, `above`, `below`, or both of the last two",
            };
            self.refuse(path, what, None);
        }
        if let (Some(above), Some(below)) = (raw.above, raw.below)
            && below.saturating_sub(above) < 2
        {
            self.refuse(
                &path.key("below"),
                format!("there is no integer between {above} and {below}"),
                None,
            );
        }
        test
    }

    /// The drive that answers to `unit` at power-on, or `default`.
    fn drive(
        &mut self,
        line: Option<usize>,
        unit: Option<u8>,
        default: DriveId,
        path: &Path,
    ) -> DriveId {
        let line = line.and_then(|line| self.sites.as_ref()?.get(line));
        let (Some(unit), Some(line)) = (unit, line) else { return default };
        match line.find(unit) {
            Some(drive) => drive,
            None => {
                self.refuse(path, format!("no drive on this line has unit {unit}"), None);
                default
            }
        }
    }

    fn time(&mut self, text: Option<&String>, path: &Path) -> Option<Duration> {
        let text = text?;
        let time = parse_duration(text);
        if time.is_none() {
            let what = format!("`{text}` is not a duration");
            self.refuse(path, what, Some("write a number with us, ms, s or min: 200ms"));
        }
        time
    }

    /// A time that is more than none at all.
    fn time_above_zero(&mut self, text: Option<&String>, path: &Path) -> Option<Duration> {
        let time = self.time(text, path)?;
        if time.is_zero() {
            self.refuse(path, "a time of 0 has no effect", Some("remove it"));
        }
        Some(time)
    }

    fn refuse(&mut self, path: &Path, what: impl Into<String>, advice: Option<&str>) {
        let problem = Problem::value(path.clone(), what);
        self.problems.push(problem.advise_if(advice.map(str::to_owned)));
    }
}
