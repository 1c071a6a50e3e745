//! From the text of a state file to the memories of drives, or to everything that is wrong with it.

use super::{FORMAT, name};
use crate::bank::{Kept, KeptRow};
use crate::bench::Device;
use crate::model::{Model, Shows};
use crate::problem::decode::{decode, named};
use crate::problem::tree::Node;
use crate::problem::{Path, Places, Problem, parse, settle, suggest};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

/// What an earlier run has left: each memory is given to the drive that it belongs to.
///
/// The default is that of a first run, which finds nothing.
#[derive(Debug, Default)]
pub struct Saved {
    /// The file; `None` at a first run.
    file: Option<Node>,
    /// The sections that nobody has taken yet.
    left: Vec<Section>,
    /// The drives that have asked, each with its model.
    asked: Vec<String>,
    problems: Vec<Problem>,
}

#[derive(Debug)]
struct Section {
    name: String,
    path: Path,
    node: Node,
}

#[derive(Deserialize)]
struct RawStateFile {
    format: u32,
    #[serde(rename = "drives")]
    _drives: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
struct RawSavedDrive {
    model: String,
    #[serde(default)]
    saves: u32,
    rows: BTreeMap<String, RawSavedRow>,
}

#[derive(Deserialize)]
struct RawSavedRow {
    value: i64,
    #[serde(default)]
    writes: u32,
}

impl Saved {
    /// Reads `text` as far as that goes without knowing the drives.
    ///
    /// # Errors
    /// Everything that is wrong so far.
    pub fn read(text: &str) -> Result<Self, Vec<Problem>> {
        let (file, mut problems) = parse(text)?;
        if let Some(problem) = of_the_future(&file) {
            return Err(vec![problem]);
        }
        let root = Path::root();
        let raw: Option<RawStateFile> = decode(&file, &root, &["drives"], &mut problems);
        let left = named(file.get("drives"), &root.key("drives"), &mut problems).into_iter();
        let left = left.map(|(name, path, node)| Section { name, path, node: node.clone() });
        let left = left.collect();
        if raw.is_some_and(|raw| raw.format != FORMAT) {
            problems.push(other_format(&file));
        }
        match problems.is_empty() {
            true => Ok(Self { file: Some(file), left, ..Self::default() }),
            false => Err(placed(problems, &file)),
        }
    }

    /// Gives the stations of `device`, the `index`-th of `line` from 0, what they have kept. What is wrong with it
    /// is told by [`finish`](Self::finish).
    pub fn give(&mut self, line: &str, index: usize, device: &mut Device) {
        for setup in &mut device.setups {
            let name = name(line, index, &device.model.stations[setup.station]);
            if let Some(i) = self.left.iter().position(|section| section.name == name) {
                let section = self.left.remove(i);
                setup.kept = self.kept(&section, &device.model).unwrap_or_default();
            }
            self.asked.push(format!("{name} ({})", device.model.name));
        }
    }

    /// Makes sure that every memory has found its drive.
    ///
    /// # Errors
    /// Everything that is wrong; then no drive may be switched on with what it was given.
    pub fn finish(mut self) -> Result<(), Vec<Problem>> {
        for section in &self.left {
            let model = section.node.get("model").and_then(Node::as_text).unwrap_or("no model");
            let what = format!("this run has no drive {} ({model})", section.name);
            let advice = format!("it has {}", self.asked.join(", "));
            self.problems.push(Problem::key(section.path.clone(), what).advise(advice));
        }
        match self.problems.is_empty() {
            true => Ok(()),
            false => Err(match &self.file {
                Some(file) => placed(self.problems, file),
                None => self.problems,
            }),
        }
    }

    fn kept(&mut self, section: &Section, model: &Model) -> Option<Kept> {
        let Section { name, path, node } = section;
        let raw: RawSavedDrive = decode(node, path, &[], &mut self.problems)?;
        if raw.model != model.name {
            let (got, want) = (&raw.model, &model.name);
            let what = format!("{name} is {got} in this file and {want} in this run");
            let problem = Problem::value(path.key("model"), what);
            self.problems.push(problem.advise("use another file for this run"));
            return None;
        }
        let path = path.key("rows");
        let rows = raw.rows.iter().filter_map(|(id, raw)| self.row(id, raw, model, &path.key(id)));
        let mut rows: Vec<_> = rows.collect();
        rows.sort_by_key(|it| it.row);
        Some(Kept { rows, saves: raw.saves })
    }

    fn row(&mut self, id: &str, raw: &RawSavedRow, model: &Model, path: &Path) -> Option<KeptRow> {
        let Some((row, of_map)) = model.map.rows().find(|(_, row)| row.id == id) else {
            let ids = model.map.rows().map(|(_, row)| row.id.as_str());
            let advice = suggest::did_you_mean(id, ids);
            let what = format!("{} has no register `{id}`", model.name);
            self.problems.push(Problem::key(path.clone(), what).advise_if(advice));
            return None;
        };
        let RawSavedRow { value, writes } = *raw;
        let computed = model.wiring.shows(row).is_some_and(|it| !matches!(it, Shows::PastAlarm(_)));
        if of_map.volatile || computed {
            let what = format!("{} is not non-volatile", of_map.label());
            self.problems.push(Problem::key(path.clone(), what).advise("remove it"));
            return None;
        }
        if !of_map.admits(value) {
            let (label, range) = (of_map.label(), of_map.range_text());
            let what = format!("{label} accepts {range}, not {value}");
            self.problems.push(Problem::value(path.key("value"), what));
            return None;
        }
        Some(KeptRow { row, raw: of_map.kind.raw(value), writes })
    }
}

fn placed(mut problems: Vec<Problem>, file: &Node) -> Vec<Problem> {
    let mut places = Places::new(file);
    settle(&mut problems, |it| Some(places.find_nearest(&it.path, it.at)));
    problems
}

/// A file of a later format: all else that is odd about it is news, not mistakes.
fn of_the_future(file: &Node) -> Option<Problem> {
    let format = file.get("format")?;
    let problem = other_format(file).advise("a later version wrote this file: use that version");
    (format.as_u64()? > FORMAT.into()).then(|| problem.marked(format.mark))
}

fn other_format(file: &Node) -> Problem {
    let format = file.get("format").and_then(Node::as_u64).unwrap_or_default();
    let what = format!("unsupported format {format}; this version reads format {FORMAT}");
    Problem::value(Path::root().key("format"), what)
}
