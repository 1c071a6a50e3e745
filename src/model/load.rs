//! From the text of a model file to a [`Model`], or to everything that is wrong with it.

use super::expand::{expand, without_rows};
use super::options::{OptionInfo, choose, lay_over};
use super::raw::{KEYS, RawModel};
use super::{Model, RowId, Station, line, rows, wiring};
use crate::problem::{Path, Problem, section};
use serde_yaml::Value;
use std::collections::BTreeMap;

/// Options chosen by name.
pub type Choices = BTreeMap<String, String>;

/// Compiles `text` with `choices`.
///
/// # Errors
/// Every problem of the file with the chosen options laid over it, and settings for options that it does not have.
pub fn load(text: &str, choices: &Choices) -> Result<Model, Vec<Problem>> {
    let (file, mut problems) = section::tree(text)?;
    let options = read_options(&file, &mut problems);
    let chosen = choose(&options, choices, &mut problems);
    let layered = |chosen: &Choices| {
        let mut layered = file.clone();
        for (name, choice) in chosen {
            let fragment = options.get(name).and_then(|it| it.choices.get(choice));
            // Anything but a map was told of and would wipe out the file.
            if let Some(fragment) = fragment.filter(|it| it.is_mapping()) {
                lay_over(&mut layered, fragment);
            }
        }
        layered
    };
    let infos = || {
        options.iter().map(|(name, option)| OptionInfo::new(name, option, &chosen[name])).collect()
    };
    let model = compile(&layered(&chosen), &mut problems, infos);
    match (model, problems.is_empty()) {
        (Some(model), true) => Ok(model),
        _ => Err(problems),
    }
}

/// Checks `text` whole: as it stands, and with every choice of every option laid over it.
pub fn check(text: &str) -> Vec<Problem> {
    let model = match load(text, &Choices::new()) {
        Ok(model) => model,
        Err(problems) => return problems,
    };
    let mut problems = Vec::new();
    for option in &model.options {
        for choice in option.choices.iter().filter(|choice| **choice != option.default) {
            let override_key = Choices::from([(option.name.clone(), choice.clone())]);
            let fragment = Path::root().key("options").key(&option.name).key("choices").key(choice);
            for mut problem in load(text, &override_key).err().unwrap_or_default() {
                problem.path = fragment.join(&problem.path);
                problems.push(problem);
            }
        }
    }
    problems
}

fn read_options(
    file: &Value,
    problems: &mut Vec<Problem>,
) -> BTreeMap<String, super::raw::RawOption> {
    let path = Path::root().key("options");
    let entries = section::entries(file.get("options"), &path, problems);
    let read = |(name, path, value): (String, Path, &Value)| {
        section::read(value, &path, KEYS, problems).map(|option| (name, option))
    };
    entries.into_iter().filter_map(read).collect()
}

fn compile(
    file: &Value,
    problems: &mut Vec<Problem>,
    options: impl FnOnce() -> Vec<OptionInfo>,
) -> Option<Model> {
    let mut head = without_rows(file);
    if let Value::Mapping(map) = &mut head {
        map.remove("options");
    }
    let (entries, lost) = expand(file, problems);
    let raw: RawModel = section::read(&head, &Path::root(), KEYS, problems)?;
    check_identity(&raw, problems);
    let rows = rows::compile(entries, lost, &raw.windows, problems);
    let line = line::compile(&raw.line, &rows, problems);
    let wiring = wiring::compile(&raw, &rows, problems);
    let line = line?;
    wiring::check_inert(&rows, &line, &wiring, problems);
    let stations = stations(&raw, &rows, problems);
    Some(Model {
        vendor: raw.model.vendor,
        name: raw.model.name,
        about: raw.model.about,
        products: raw.model.products,
        manual: format!("{}, {}", raw.manual.title, raw.manual.rev),
        options: options(),
        line,
        map: rows.map,
        stations,
        wiring,
    })
}

fn check_identity(raw: &RawModel, problems: &mut Vec<Problem>) {
    if raw.format != 1 {
        let what = format!("unsupported format {}; this version reads format 1", raw.format);
        problems.push(Problem::value(Path::root().key("format"), what));
    }
    let name = &raw.model.name;
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if name.is_empty() || !name.chars().all(plain) {
        let what = format!("invalid model name `{name}`");
        let path = Path::root().key("model").key("name");
        problems.push(Problem::value(path, what).advise("use lower-case letters, digits and `-`"));
    }
}

fn stations(raw: &RawModel, rows: &rows::Compiled, problems: &mut Vec<Problem>) -> Vec<Station> {
    if raw.stations.is_empty() {
        return vec![Station { name: String::new(), init: Vec::new() }];
    }
    let mut stations: Vec<Station> = Vec::new();
    for (i, station) in raw.stations.iter().enumerate() {
        let path = Path::root().key("stations").index(i);
        if stations.iter().any(|it| it.name == station.name) {
            let what = format!("duplicate station name `{}`", station.name);
            problems.push(Problem::value(path.key("name"), what));
        }
        let path = path.key("init");
        let mut init: Vec<(RowId, u32)> = Vec::new();
        for (id, value) in &station.init {
            let path = path.key(id);
            let Some(row) = rows.find(id, &path, problems) else { continue };
            if !rows.map.row(row).admits(*value) {
                let what =
                    format!("{value} is outside the range {}", rows.map.row(row).range_text());
                problems.push(Problem::value(path, what));
            }
            init.push((row, rows.map.row(row).kind.raw(*value)));
        }
        stations.push(Station { name: station.name.clone(), init });
    }
    stations
}
