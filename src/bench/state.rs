//! The state file: what the drives of a run keep over power-off, as text that people read and compare.
//!
//! [`StateFile`] writes it, [`Saved`] reads it. Rows go by their ids, so that a file outlives a change of the
//! register map, and only those are in it that somebody has stored or set. Deliberately no file system; where
//! the text lies, and when it is safe there, is the server's. The format: docs/state.md.

use super::Device;
use crate::bank::{Kept, KeptRow};
use crate::bus::Bus;
use crate::drive::Drive;
use crate::event::DriveId;
use crate::model::{Model, Shows, Station};
use crate::problem::decode::{decode, named};
use crate::problem::tree::Node;
use crate::problem::{Path, Problem, parse, placed, suggest};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_yaml::Value;
use std::collections::BTreeMap;

/// The format that is written and read here.
const FORMAT: u32 = 1;

/// What a drive is called in the file: its line, which device of the line it is, counted from 1, and which
/// station of a device that has several.
fn name(line: &str, device: usize, station: &Station) -> String {
    match station.name.as_str() {
        "" => format!("{line}/{}", device + 1),
        station => format!("{line}/{}/{station}", device + 1),
    }
}

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

/// The state file of a run. A drive that has stored something gets its section anew; the others keep theirs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StateFile {
    sections: BTreeMap<String, String>,
}

impl StateFile {
    /// Takes what all drives of `line` keep.
    pub fn keep_all(&mut self, line: &str, bus: &Bus) {
        bus.drives().for_each(|(id, _)| self.keep(line, bus, id));
    }

    /// Takes what one drive of `line` keeps.
    pub fn keep(&mut self, line: &str, bus: &Bus, id: DriveId) {
        let drive = bus.drive(id);
        let station = &drive.model().stations[drive.station()];
        let name = name(line, usize::from(bus.device(id)), station);
        let section = section(&name, drive);
        self.sections.insert(name, section);
    }

    /// The whole file.
    pub fn text(&self) -> String {
        let mut text =
            String::from("# Non-volatile memory of the drives. Do not edit during a run.\n");
        text += &entry(0, "format", &FORMAT.to_string());
        text += &entry(0, "drives", "");
        self.sections.values().for_each(|section| text += section);
        text
    }
}

fn section(name: &str, drive: &Drive) -> String {
    let (model, kept) = (drive.model(), drive.kept());
    let mut text = entry(1, &quoted(name), "");
    text += &entry(2, "model", &quoted(&model.name));
    text += &entry(2, "saves", &kept.saves.to_string());
    text += &entry(2, "rows", if kept.rows.is_empty() { "{}" } else { "" });
    for it in &kept.rows {
        let row = model.map.row(it.row);
        let (value, writes) = (row.kind.value(it.raw).to_string(), it.writes.to_string());
        let about = row.name.split_whitespace().collect::<Vec<_>>().join(" ");
        let value = ["{value: ", &value, ", writes: ", &writes, "}  # ", &about].concat();
        text += &entry(3, &quoted(&row.id), &value);
    }
    text
}

/// A line of the file: nothing behind the key where more lines follow.
fn entry(depth: usize, key: &str, value: &str) -> String {
    let gap = if value.is_empty() { "" } else { " " };
    ["  ".repeat(depth).as_str(), key, ":", gap, value, "\n"].concat()
}

/// A text as YAML reads it back: bare where it can be.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    let bare = text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain);
    // `null` and `true` are words of YAML's own.
    if bare && serde_yaml::from_str(text).is_ok_and(|it: Value| it.is_string()) {
        return text.to_owned();
    }
    let character = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        _ if c.is_alphanumeric() || c == ' ' || c.is_ascii_graphic() => c.to_string(),
        _ => format!("\\U{:08X}", u32::from(c)),
    };
    format!("\"{}\"", text.chars().map(character).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_is_read_back() {
        for (text, want) in [
            ("acme-s1", "acme-s1"),
            ("line/1", "line/1"),
            ("true", "\"true\""),
            ("1/2", "\"1/2\""),
            ("", "\"\""),
            ("Halle 2: \"links\"\\", "\"Halle 2: \\\"links\\\"\\\\\""),
            ("伺服", "\"伺服\""),
            ("a\nb\u{7f}\u{2028}", "\"a\\U0000000Ab\\U0000007F\\U00002028\""),
        ] {
            assert_eq!(quoted(text), want);
            assert_eq!(serde_yaml::from_str::<Value>(&quoted(text)).unwrap(), text);
        }
    }
}
