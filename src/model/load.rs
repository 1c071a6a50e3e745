//! From the text of a model file to a [`Model`], or to everything that is wrong with it.

use super::options::{OptionInfo, choose, lay_over};
use super::raw::{KEYS, RawOption};
use super::{Model, compile};
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
    let info = |(name, option): (&String, &RawOption)| OptionInfo::new(name, option, &chosen[name]);
    let infos = options.iter().map(info).collect();
    let model = compile::compile(&layered(&chosen), infos, &mut problems);
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

fn read_options(file: &Value, problems: &mut Vec<Problem>) -> BTreeMap<String, RawOption> {
    let path = Path::root().key("options");
    let entries = section::entries(file.get("options"), &path, problems);
    let read = |(name, path, value): (String, Path, &Value)| {
        section::read(value, &path, KEYS, problems).map(|option| (name, option))
    };
    entries.into_iter().filter_map(read).collect()
}
