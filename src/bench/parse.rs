//! From the text of a bench file to a [`Bench`], or to everything that is wrong with it.

use super::line_behaviour::{line_behaviour, strangers};
use super::ports::{ports, refuse_taken};
use super::raw::{RawBenchDrive, RawBenchLine, keys};
use super::{
    Bench, BenchLine, Device, DeviceSpec, Library, LineBuilder, MachineProblem, Mismatch,
    OverrideKey, PortSpec, Saved, SpecProblem, machine,
};
use crate::bank::Kept;
use crate::drive::{Drive, Setup};
use crate::medium;
use crate::model::{Choices, Model};
use crate::problem::{At, Path, Problem, Seg, bounds, section};
use crate::serial::Settings;
use crate::time::Instant;
use serde_yaml::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a YAML file is, judged by its keys.
pub fn kind_of(text: &str) -> &'static str {
    let file = section::tree(text).map(|(file, _)| file).unwrap_or_default();
    let of_bench = ["lines", "seed"].iter().any(|key| file.get(key).is_some());
    // Of a model this is a map; somebody forgot the s.
    let nearly = file.get("line").is_some_and(Value::is_sequence);
    if file.get("steps").is_some() {
        return "scenario";
    }
    if of_bench || nearly { "bench" } else { "model" }
}

/// Reads a bench.
///
/// # Errors
/// Every problem of the file. Of what is wrong inside a model file only the first is told; check that
/// file itself.
pub fn parse(text: &str, library: &dyn Library) -> Result<Bench, Vec<Problem>> {
    parse_saved(text, library, &mut Saved::default())
}

/// Reads a bench and gives its drives what an earlier run has `saved`.
///
/// # Errors
/// As [`parse`](fn@parse). What is wrong with `saved` itself it tells when it is finished.
pub fn parse_saved(
    text: &str,
    library: &dyn Library,
    saved: &mut Saved,
) -> Result<Bench, Vec<Problem>> {
    let (file, problems) = section::tree(text)?;
    if !problems.is_empty() {
        return Err(problems);
    }
    let mut reader = BenchReader { library, saved, models: BTreeMap::new(), problems };
    let bench = reader.bench(&file);
    match reader.problems.is_empty() {
        true => Ok(bench),
        false => Err(reader.problems),
    }
}

/// Everything of the file but its lines, which are read one by one.
#[derive(serde::Deserialize)]
struct BenchHead {
    seed: Option<u64>,
}

struct BenchReader<'a> {
    library: &'a dyn Library,
    saved: &'a mut Saved,
    /// Drives of one model with the same options share it.
    models: BTreeMap<(String, Choices), Arc<Model>>,
    problems: Vec<Problem>,
}

impl BenchReader<'_> {
    fn bench(&mut self, file: &Value) -> Bench {
        let mut head = file.clone();
        let lines = head.as_mapping_mut().and_then(|head| head.remove("lines"));
        let head: Option<BenchHead> =
            section::read(&head, &Path::root(), &keys(), &mut self.problems);
        let seed = head.and_then(|head| head.seed);
        let path = Path::root().key("lines");
        let items = match &lines {
            Some(Value::Sequence(items)) => items.as_slice(),
            Some(_) => {
                self.problems.push(Problem::value(path.clone(), "expected a list of lines"));
                &[]
            }
            None => &[],
        };
        let most = bounds::count("lines", items.len(), bounds::LINES, &path);
        let items = if most.is_none() { items } else { &[] };
        self.problems.extend(most);
        let mut lines: Vec<BenchLine> = Vec::new();
        for (i, value) in items.iter().enumerate() {
            let path = path.index(i);
            if self.has_too_many(value, &path) {
                continue;
            }
            let raw: Option<RawBenchLine> =
                section::read(value, &path, &keys(), &mut self.problems);
            let Some(line) = raw.and_then(|raw| self.line(i, &raw, &path, &lines)) else {
                continue;
            };
            if lines.iter().any(|it| it.name == line.name) {
                let what = format!("duplicate line name `{}`", line.name);
                let advice = "give each line its own `name`";
                self.problems.push(Problem::value(path.key("name"), what).advise(advice));
            }
            lines.push(line);
        }
        if items.is_empty() && self.problems.is_empty() {
            self.problems.push(Problem::key(path, "a bench needs at least one line"));
        }
        Bench { seed, lines }
    }

    /// Has a line more drives or rules than may be?
    fn has_too_many(&mut self, line: &Value, path: &Path) -> bool {
        let before = self.problems.len();
        for (key, most) in [("drives", bounds::DRIVES), ("faults", bounds::FAULTS)] {
            let len = line.get(key).and_then(Value::as_sequence).map_or(0, Vec::len);
            self.problems.extend(bounds::count(key, len, most, &path.key(key)));
        }
        self.problems.len() > before
    }

    fn line(
        &mut self,
        index: usize,
        raw: &RawBenchLine,
        path: &Path,
        above: &[BenchLine],
    ) -> Option<BenchLine> {
        let name = raw.name.clone().unwrap_or_else(|| format!("line-{}", index + 1));
        let ports = ports(raw, path, &mut self.problems);
        let mut devices = Vec::new();
        for (i, drive) in raw.drives.iter().enumerate() {
            devices.push(self.device(drive, &path.key("drives").index(i)));
        }
        if devices.is_empty() {
            self.problems.push(Problem::key(path.key("drives"), "a line needs at least one drive"));
        }
        let mut devices: Vec<Device> = devices.into_iter().collect::<Option<_>>()?;
        for (i, device) in devices.iter_mut().enumerate() {
            self.saved.give(&name, i, device);
        }
        if ports.is_empty() {
            return None;
        }
        refuse_taken(&ports, above, &mut self.problems);
        let ports = ports.into_iter().map(|(port, _)| port).collect();
        let line = self.wired(name, ports, raw, devices, path)?;
        self.addresses(&line, path);
        Some(line)
    }

    fn device(&mut self, raw: &RawBenchDrive, path: &Path) -> Option<Device> {
        let model = self.model(raw, path)?;
        let machine = machine(&raw.machine, &model.wiring).map_err(|problems| {
            let path = path.key("machine");
            let problem = |it: MachineProblem| Problem::value(path.key(it.key), it.what);
            self.problems.extend(problems.into_iter().map(problem));
        });
        let spec = DeviceSpec {
            unit: raw.unit,
            set: raw.set.clone(),
            switches: raw.switches,
            terminals: raw.terminals.clone(),
            machine: machine.ok()?,
            start: raw.machine.start.into(),
            position: raw.machine.position.into(),
        };
        match Device::new(model, &spec) {
            Ok(device) => Some(device),
            Err(problems) => {
                self.problems
                    .extend(problems.into_iter().map(|problem| at_override_key(problem, path)));
                None
            }
        }
    }

    fn model(&mut self, raw: &RawBenchDrive, path: &Path) -> Option<Arc<Model>> {
        let key = (raw.model.clone(), raw.options.clone());
        if let Some(model) = self.models.get(&key) {
            return Some(model.clone());
        }
        let path_of_model = path.key("model");
        let (file, text) = match self.library.fetch(&raw.model) {
            Ok(found) => found,
            Err(what) => {
                self.problems.push(Problem::value(path_of_model, what));
                return None;
            }
        };
        match crate::model::load(&text, &raw.options) {
            Ok(model) => {
                let model = Arc::new(model);
                self.models.insert(key, model.clone());
                Some(model)
            }
            Err(problems) if crate::model::load(&text, &Choices::new()).is_ok() => {
                let of_options = problems.into_iter().map(|it| of_options(it, &file, path));
                self.problems.extend(of_options);
                None
            }
            Err(problems) => {
                let more = match problems.len() {
                    0 | 1 => String::new(),
                    len => format!(", and {} more", len - 1),
                };
                let first = problems.first().map(Problem::to_string).unwrap_or_default();
                let what = format!("{file} is invalid: {first}{more}");
                let problem = Problem::value(path_of_model, what);
                self.problems.push(problem.advise(format!("see `drivemu check {file}`")));
                None
            }
        }
    }

    /// Settles speed, format and framing of the line, and sets every drive on it to them.
    fn wired(
        &mut self,
        name: String,
        ports: Vec<PortSpec>,
        raw: &RawBenchLine,
        devices: Vec<Device>,
        path: &Path,
    ) -> Option<BenchLine> {
        let settings = match raw.settings.as_deref().map(str::parse::<Settings>).transpose() {
            Ok(settings) => settings,
            Err(what) => {
                self.problems.push(Problem::value(path.key("settings"), what));
                return None;
            }
        };
        let line_behaviour = line_behaviour(raw, path, &mut self.problems);
        strangers(&line_behaviour, &devices, path, &mut self.problems);
        let builder = LineBuilder::new(name, devices)
            .ports(ports)
            .settings(settings)
            .ascii(raw.ascii)
            .strict(raw.strict)
            .match_baud(raw.match_baud)
            .behaviour(line_behaviour);
        let (mut line, mismatches) = builder.build();
        for Mismatch { device, what } in mismatches {
            let path = path.key("drives").index(device).key("model");
            let advice = "choose `settings` that all drives on the line support";
            self.problems.push(Problem::value(path, what).advise(advice));
        }
        self.faults(raw, &mut line, path);
        Some(line)
    }

    fn faults(&mut self, raw: &RawBenchLine, line: &mut BenchLine, path: &Path) {
        for (i, raw) in raw.faults.iter().enumerate() {
            let path = path.key("faults").index(i);
            let taken = line.rule_names();
            let fault_set = medium::compile(raw, &path, line, &taken, &mut self.problems);
            line.put(fault_set);
        }
    }

    /// No two stations of a line may answer to one address. What masters have saved since may clash: real
    /// drives do.
    fn addresses(&mut self, line: &BenchLine, path: &Path) {
        let mut taken: BTreeMap<u8, usize> = BTreeMap::new();
        for (i, device) in line.devices.iter().enumerate() {
            for setup in &device.setups {
                let new = Setup { kept: Kept::default(), ..setup.clone() };
                let unit = Drive::new(device.model.clone(), &new, Instant::ZERO).unit();
                let Some(other) = taken.insert(unit, i).filter(|_| unit != crate::wire::BROADCAST)
                else {
                    continue;
                };
                let what =
                    format!("unit {unit} is already used by drive {} on this line", other + 1);
                let path = path.key("drives").index(i).key("unit");
                self.problems
                    .push(Problem::value(path, what).advise("give each drive its own `unit`"));
            }
        }
    }
}

/// What the options of the drive at `path` make of its model, which is fine without them.
fn of_options(problem: Problem, file: &str, path: &Path) -> Problem {
    if problem.path.segs().first() == Some(&Seg::Key("options".into())) {
        return Problem { path: path.join(&problem.path), ..problem };
    }
    let what = format!("with these options {file} is invalid: {problem}");
    Problem::key(path.key("options"), what).advise(format!("see `drivemu check {file}`"))
}

fn at_override_key(problem: SpecProblem, path: &Path) -> Problem {
    let (path, at) = match &problem.override_key {
        OverrideKey::Unit => (path.key("unit"), At::Value),
        OverrideKey::Set(name) => (path.key("set").key(name), At::Value),
        OverrideKey::SetName(name) => (path.key("set").key(name), At::Key),
        OverrideKey::Switches => (path.key("switches"), At::Value),
        OverrideKey::Terminal(i) => (path.key("terminals").index(*i), At::Value),
    };
    Problem { path, at, what: problem.what, advice: problem.advice, mark: None }
}
