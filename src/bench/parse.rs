//! From the text of a bench file to a [`Bench`], or to everything that is wrong with it.

use super::line_keys::{line_behaviour, ports, refuse_taken, strangers};
use super::raw::{RawBench, RawBenchDrive, RawBenchLine};
use super::{
    Bench, BenchLine, Device, DeviceSpec, Library, LineBuilder, MachineProblem, Mismatch,
    OverrideKey, PortSpec, Saved, SpecProblem, machine,
};
use crate::bank::Kept;
use crate::drive::{Drive, Setup};
use crate::medium::{self, FaultContext, LineBehaviour, NoRow, raw::RawFault};
use crate::model::{Choices, Model};
use crate::problem::decode::{decode, listed};
use crate::problem::tree::Node;
use crate::problem::{
    At, Path, Problem, Seg, bounds, has_unread, is_unread, parse as parse_yaml, placed,
};
use crate::serial::Settings;
use crate::time::Instant;
use crate::wire::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a YAML file is, judged by its keys.
pub fn kind_of(text: &str) -> &'static str {
    let Ok((file, _)) = parse_yaml(text) else { return "model" };
    let of_bench = ["lines", "seed"].iter().any(|key| file.get(key).is_some());
    // Of a model this is a map; somebody forgot the s.
    let nearly = file.get("line").is_some_and(Node::is_list);
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
    let (file, problems) = parse_yaml(text)?;
    let mut reader = BenchReader { library, saved, models: BTreeMap::new(), problems };
    let bench = reader.bench(&file);
    let problems = reader.problems;
    if problems.is_empty() {
        return Ok(bench);
    }
    Err(placed(problems, &file))
}

struct BenchReader<'a> {
    library: &'a dyn Library,
    saved: &'a mut Saved,
    /// Drives of one model with the same options share it.
    models: BTreeMap<(String, Choices), Arc<Model>>,
    problems: Vec<Problem>,
}

impl BenchReader<'_> {
    fn bench(&mut self, file: &Node) -> Bench {
        let root = Path::root();
        let head: Option<RawBench> = decode(file, &root, &["lines"], &mut self.problems);
        let path = root.key("lines");
        let mut nodes = listed(file.get("lines"), &path, &mut self.problems);
        if nodes.is_empty() {
            self.problems.push(Problem::key(path.clone(), "a bench needs at least one line"));
        }
        if let Some(most) = bounds::count("lines", nodes.len(), bounds::LINES, &path) {
            self.problems.push(most);
            nodes.clear();
        }
        let mut lines: Vec<BenchLine> = Vec::new();
        for (i, (path, node)) in nodes.into_iter().enumerate() {
            let Some(line) = self.line(i, node, &path, &lines) else { continue };
            if lines.iter().any(|it| it.name == line.name) {
                let what = format!("duplicate line name `{}`", line.name);
                let advice = "give each line its own `name`";
                self.problems.push(Problem::value(path.key("name"), what).advise(advice));
            }
            lines.push(line);
        }
        Bench { seed: head.and_then(|head| head.seed), lines }
    }

    /// The items of a list of a line, unless there are more than may be.
    fn items<'a>(
        &mut self,
        line: &'a Node,
        key: &str,
        most: usize,
        path: &Path,
    ) -> Option<Vec<(Path, &'a Node)>> {
        let path = path.key(key);
        let items = listed(line.get(key), &path, &mut self.problems);
        let many = bounds::count(key, items.len(), most, &path);
        let few = many.is_none();
        self.problems.extend(many);
        few.then_some(items)
    }

    /// Reads a line. What is wrong with one part of it keeps no other from being looked at.
    fn line(
        &mut self,
        index: usize,
        node: &Node,
        path: &Path,
        above: &[BenchLine],
    ) -> Option<BenchLine> {
        let later = ["drives", "faults"];
        let raw: RawBenchLine = decode(node, path, &later, &mut self.problems)?;
        let drives = self.items(node, "drives", bounds::DRIVES, path)?;
        let faults = self.items(node, "faults", bounds::FAULTS, path)?;
        if drives.is_empty() {
            let what = "a line needs at least one drive";
            self.problems.push(Problem::key(path.key("drives"), what));
        }
        let name = raw.name.clone().unwrap_or_else(|| format!("line-{}", index + 1));
        let ports = ports(&raw, path, &mut self.problems);
        refuse_taken(&ports, above, &mut self.problems);
        let ports: Vec<PortSpec> = ports.into_iter().map(|(port, _)| port).collect();
        let mut devices: Vec<Option<Device>> = Vec::new();
        for (path, node) in &drives {
            let drive: Option<RawBenchDrive> = decode(node, path, &[], &mut self.problems);
            devices.push(drive.and_then(|drive| self.device(&drive, path)));
        }
        let first_is_known = devices.first().is_some_and(Option::is_some);
        let is_whole = !ports.is_empty() && devices.iter().all(Option::is_some);
        let known =
            |(i, device): (usize, Option<Device>)| Some((path.key("drives").index(i), device?));
        let known = devices.into_iter().enumerate().filter_map(known);
        let (paths, mut devices): (Vec<Path>, Vec<Device>) = known.unzip();
        if is_whole {
            for (i, device) in devices.iter_mut().enumerate() {
                self.saved.give(&name, i, device);
            }
        }
        let settings = self.settings(&raw, path);
        let line_behaviour = line_behaviour(&raw, path, &mut self.problems);
        strangers(&line_behaviour, &devices, path, &mut self.problems);
        let builder = LineBuilder::new(name, devices)
            // A line without a port is looked at like one on a pseudo-terminal.
            .ports(if ports.is_empty() { vec![PortSpec::Pty(None)] } else { ports })
            .settings(settings.unwrap_or_default())
            .ascii(raw.ascii)
            .strict(raw.strict)
            .match_baud(raw.match_baud)
            .behaviour(line_behaviour);
        let (mut line, mismatches) = builder.build();
        // How the line is set is known by what it says, or by its first drive.
        if settings.is_ok_and(|it| it.is_some() || first_is_known) {
            for Mismatch { device, what } in mismatches {
                let advice = "choose `settings` that all drives on the line support";
                let problem = Problem::value(paths[device].key("model"), what);
                self.problems.push(problem.advise(advice));
            }
        }
        for (path, node) in &faults {
            let taken = line.rule_names();
            let raw: Option<RawFault> = decode(node, path, &[], &mut self.problems);
            let Some(raw) = raw else { continue };
            let known = KnownPart { line: &line, is_whole };
            let fault_set = medium::compile(&raw, node, path, &known, &taken, &mut self.problems);
            line.put(fault_set);
        }
        self.addresses(&line, &paths);
        Some(line)
    }

    /// The speed and the format that the line is told, if any.
    fn settings(&mut self, raw: &RawBenchLine, path: &Path) -> Result<Option<Settings>, ()> {
        let path = path.key("settings");
        let read = raw.settings.as_deref().map(str::parse::<Settings>).transpose();
        let read = read.map_err(|what| self.problems.push(Problem::value(path.clone(), what)));
        read.and_then(|it| if is_unread(&self.problems, &path) { Err(()) } else { Ok(it) })
    }

    fn device(&mut self, raw: &RawBenchDrive, path: &Path) -> Option<Device> {
        let model = self.model(raw, path)?;
        let machine = machine(&raw.machine, &model.wiring).map_err(|problems| {
            let path = path.key("machine");
            let problem = |it: MachineProblem| Problem::value(path.key(it.key), it.what);
            let told: Vec<_> = problems.into_iter().map(problem).collect();
            let told = told.into_iter().filter(|it| !has_unread(&self.problems, &it.path));
            let mut told: Vec<_> = told.collect();
            self.problems.append(&mut told);
        });
        let spec = DeviceSpec {
            unit: raw.unit,
            set: raw.set.clone(),
            switches: raw.switches,
            terminals: raw.terminals.clone(),
            machine: machine.unwrap_or_default(),
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

    /// No two stations of a line may answer to one address. What masters have saved since may clash: real
    /// drives do.
    fn addresses(&mut self, line: &BenchLine, paths: &[Path]) {
        let mut taken: BTreeMap<u8, usize> = BTreeMap::new();
        for (i, (device, path)) in line.devices.iter().zip(paths).enumerate() {
            let path = path.key("unit");
            if is_unread(&self.problems, &path) {
                continue;
            }
            for setup in &device.setups {
                let new = Setup { kept: Kept::default(), ..setup.clone() };
                let unit = Drive::new(device.model.clone(), &new, Instant::ZERO).unit();
                let Some(other) = taken.insert(unit, i).filter(|_| unit != crate::wire::BROADCAST)
                else {
                    continue;
                };
                let what =
                    format!("unit {unit} is already used by drive {} on this line", other + 1);
                let problem = Problem::value(path.clone(), what);
                self.problems.push(problem.advise("give each drive its own `unit`"));
            }
        }
    }
}

/// A line as far as it could be read.
struct KnownPart<'a> {
    line: &'a BenchLine,
    is_whole: bool,
}

impl FaultContext for KnownPart<'_> {
    fn is_tcp(&self) -> bool {
        self.line.is_tcp()
    }

    fn line_behaviour(&self) -> &LineBehaviour {
        self.line.line_behaviour()
    }

    fn spans(&self, name: &str) -> Result<Vec<Span>, NoRow> {
        match self.line.spans(name) {
            // It may be a register of a drive that is not known.
            Err(_) if !self.is_whole => Ok(Vec::new()),
            found => found,
        }
    }
}

/// What the options of the drive at `path` make of its model, which is fine without them.
fn of_options(problem: Problem, file: &str, path: &Path) -> Problem {
    if problem.path.segs().first() == Some(&Seg::Key("options".into())) {
        // Its place is one in the model file.
        return Problem { path: path.join(&problem.path), mark: None, ..problem };
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
    Problem { at, ..Problem::value(path, problem.what).advise_if(problem.advice) }
}
