//! From the text of a model file to a [`Model`], or to everything that is wrong with it. An option is one of several
//! readings, chosen by name, as a fragment that is laid over the file.

use super::OptionInfo;
use super::raw::RawOption;
use super::{Model, compile};
use crate::problem::decode::{decode, named};
use crate::problem::tree::Node;
use crate::problem::{Path, Places, Problem, bounds, has_unread, parse, settle, suggest};
use std::collections::BTreeMap;

/// Options chosen by name.
pub type Choices = BTreeMap<String, String>;

/// Compiles `text` with `choices`.
///
/// # Errors
/// Every problem of the file with the chosen options laid over it, and settings for options that it does not have.
pub fn load(text: &str, choices: &Choices) -> Result<Model, Vec<Problem>> {
    ModelFile::parse(text)?.compile(choices, None)
}

/// Checks `text` whole: as it stands, and with every choice of every option laid over it.
pub fn check(text: &str) -> Vec<Problem> {
    let file = match ModelFile::parse(text) {
        Ok(file) => file,
        Err(problems) => return problems,
    };
    let mut problems = file.compile(&Choices::new(), None).err().unwrap_or_default();
    let is_valid = problems.is_empty();
    if file.options.values().map(|it| it.choices.len()).sum::<usize>() > bounds::CHOICES {
        return problems;
    }
    let mut places = Places::new(&file.tree);
    for (name, option) in &file.options {
        for choice in option.choices.keys().filter(|choice| **choice != option.default) {
            let only = Choices::from([(name.clone(), choice.clone())]);
            let fragment = Path::root().key("options").key(name).key("choices").key(choice);
            let mut more = file.compile(&only, Some(&fragment)).err().unwrap_or_default();
            // What is wrong without the choice was told.
            more.retain(|it| is_valid || places.find(&it.path, it.at).is_some());
            problems.append(&mut more);
        }
    }
    settle(&mut problems, |_| None);
    problems
}

/// A model file, parsed once and compiled with as many choices as are asked for.
struct ModelFile {
    tree: Node,
    options: BTreeMap<String, RawOption>,
    problems: Vec<Problem>,
}

impl ModelFile {
    fn parse(text: &str) -> Result<Self, Vec<Problem>> {
        let (tree, mut problems) = parse(text)?;
        let path = Path::root().key("options");
        let entries = named(tree.get("options"), &path, &mut problems);
        let read = |(name, path, node): (String, Path, &Node)| {
            decode(node, &path, &[], &mut problems).map(|option| (name, option))
        };
        let options = entries.into_iter().filter_map(read).collect();
        Ok(Self { tree, options, problems })
    }

    /// The model with `choices`. What is wrong with it is looked for in `fragment` of the file first, if that is
    /// what is tried.
    fn compile(&self, choices: &Choices, fragment: Option<&Path>) -> Result<Model, Vec<Problem>> {
        let mut problems = self.problems.clone();
        let chosen = choose(&self.tree, &self.options, choices, &mut problems);
        let mut tree = self.tree.clone();
        for (name, choice) in &chosen {
            // Anything but a map was told of and would wipe out the file.
            if let Some(over) = fragment_of(&self.tree, name, choice).filter(|it| it.is_map()) {
                tree.lay_over(over);
            }
        }
        let info =
            |(name, option): (&String, &RawOption)| OptionInfo::new(name, option, &chosen[name]);
        let infos = self.options.iter().map(info).collect();
        let model = compile::compile(&tree, infos, &mut problems);
        if let (Some(model), true) = (model, problems.is_empty()) {
            return Ok(model);
        }
        let (mut layered, mut file) = (Places::new(&tree), Places::new(&self.tree));
        // A key that a choice lacks is lacking there.
        for it in problems.iter_mut().filter(|it| fragment.is_some() && !it.path.is_root()) {
            it.mark = it.mark.filter(|_| layered.find(&it.path, it.at).is_some());
        }
        settle(&mut problems, |Problem { path, at, .. }| {
            let inside = fragment.map(|it| file.find_nearest(&it.join(path), *at));
            layered.find(path, *at).or(inside).or_else(|| Some(layered.find_nearest(path, *at)))
        });
        if let Some(fragment) = fragment {
            problems.iter_mut().for_each(|it| it.path = fragment.join(&it.path));
        }
        Err(problems)
    }
}

/// The fragment of `file` that a choice lays over it.
fn fragment_of<'a>(file: &'a Node, option: &str, choice: &str) -> Option<&'a Node> {
    file.get("options")?.get(option)?.get("choices")?.get(choice)
}

/// The choice in force for each option of `file`, or what is wrong with the options and the settings.
fn choose(
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
            if fragment_of(file, name, choice).is_some_and(|it| !it.is_map()) {
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
