//! Options: one of several readings, chosen by name, as a fragment laid over the file.

use super::raw::RawOption;
use crate::problem::{Path, Problem, bounds, suggest};
use serde_yaml::Value;
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

/// The choice in force for each option, or what is wrong with the options and the settings.
pub(super) fn choose(
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
        if !option.choices.contains_key(&option.default) {
            let what = format!("unknown choice `{}`", option.default);
            let choices = option.choices.keys().map(String::as_str);
            let advice = suggest::did_you_mean(&option.default, choices);
            problems.push(Problem::value(path.key("default"), what).advise_if(advice));
        }
        if option.choices.len() < 2 {
            let what = "an option needs at least two choices";
            problems.push(Problem::key(path.key("choices"), what));
        }
        for (choice, fragment) in &option.choices {
            if !fragment.is_mapping() {
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

/// Lays `fragment` over `file`: maps are merged, `null` removes, anything else replaces.
pub(super) fn lay_over(file: &mut Value, fragment: &Value) {
    match (file, fragment) {
        (Value::Mapping(file), Value::Mapping(fragment)) => {
            for (key, value) in fragment {
                match file.get_mut(key) {
                    _ if value.is_null() => {
                        file.remove(key);
                    }
                    Some(below) => lay_over(below, value),
                    None => {
                        file.insert(key.clone(), value.clone());
                    }
                }
            }
        }
        (file, fragment) => *file = fragment.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_merge_null_removes_the_rest_replaces() {
        let mut file: Value = serde_yaml::from_str("{a: {b: 1, c: 2}, d: [1, 2]}").expect("yaml");
        let over: Value = serde_yaml::from_str("{a: {c: null, e: 3}, d: [4]}").expect("yaml");
        lay_over(&mut file, &over);
        let want: Value = serde_yaml::from_str("{a: {b: 1, e: 3}, d: [4]}").expect("yaml");
        assert_eq!(file, want);
    }
}
