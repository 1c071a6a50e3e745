//! Options: one of several readings, chosen by name, as a fragment laid over the file.

use super::raw::RawOption;
use crate::problem::tree::Node;
use crate::problem::{Path, Problem, bounds, has_unread, suggest};
use std::collections::BTreeMap;

/// An option of a model, and what was chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OptionInfo {
    /// Name as in `--set NAME=CHOICE`.
    pub name: String,
    /// What it is about.
    pub about: String,
    /// Why the default is what it is.
    pub why: String,
    /// The choice in force unless told otherwise.
    pub default: String,
    /// The choice in force.
    pub chosen: String,
    /// Names of the choices, the default included.
    pub choices: Vec<String>,
}

impl OptionInfo {
    pub(super) fn new(name: &str, raw: &RawOption, chosen: &str) -> Self {
        Self {
            name: name.into(),
            about: raw.about.clone(),
            why: raw.why.clone(),
            default: raw.default.clone(),
            chosen: chosen.into(),
            choices: raw.choices.keys().cloned().collect(),
        }
    }
}

/// The fragment of `file` that a choice lays over it.
pub(super) fn fragment<'a>(file: &'a Node, option: &str, choice: &str) -> Option<&'a Node> {
    file.get("options")?.get(option)?.get("choices")?.get(choice)
}

/// The choice in force for each option of `file`, or what is wrong with the options and the settings.
pub(super) fn choose(
    file: &Node,
    options: &BTreeMap<String, RawOption>,
    override_keys: &BTreeMap<String, String>,
    problems: &mut Vec<Problem>,
) -> BTreeMap<String, String> {
    let choices = options.values().map(|option| option.choices.len()).sum();
    let path = Path::root().key("options");
    problems.extend(bounds::count("choices", choices, bounds::CHOICES, &path));
    let mut chosen = BTreeMap::new();
    for (name, option) in options {
        let path = Path::root().key("options").key(name);
        let is_whole = !has_unread(problems, &path.key("choices"));
        if !option.choices.contains_key(&option.default) && is_whole {
            let what = format!("unknown choice `{}`", option.default);
            let choices = option.choices.keys().map(String::as_str);
            let advice = suggest::did_you_mean(&option.default, choices);
            problems.push(Problem::value(path.key("default"), what).advise_if(advice));
        }
        if option.choices.len() < 2 && is_whole {
            let what = "an option needs at least two choices";
            problems.push(Problem::key(path.key("choices"), what));
        }
        for choice in option.choices.keys() {
            if fragment(file, name, choice).is_some_and(|it| !it.is_map()) {
                let what = "a choice must be a map; `{}` leaves the file as it is";
                problems.push(Problem::value(path.key("choices").key(choice), what));
            }
        }
        chosen.insert(name.clone(), option.default.clone());
    }
    for (name, choice) in override_keys {
        let path = Path::root().key("options").key(name);
        let Some(option) = options.get(name) else {
            let what = format!("unknown option `{name}`");
            let advice = suggest::did_you_mean(name, options.keys().map(String::as_str));
            problems.push(Problem::key(path, what).advise_if(advice));
            continue;
        };
        if !option.choices.contains_key(choice) {
            let all: Vec<_> = option.choices.keys().map(String::as_str).collect();
            let what = format!("unknown choice `{choice}`; choices: {}", all.join(", "));
            let advice = suggest::did_you_mean(choice, all);
            problems.push(Problem::value(path, what).advise_if(advice));
            continue;
        }
        chosen.insert(name.clone(), choice.clone());
    }
    chosen
}
