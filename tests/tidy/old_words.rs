//! One vocabulary: words that were given up stay out of the source, the documents and the models.

use crate::expect::{files, read, root};
use std::path::{Path, PathBuf};

/// Words that are gone. In names they count too: `set_habits` and `FaultStrike` hold two.
const WORDS: &[&str] = &[
    "agenda",
    "foresee",
    "foreseen",
    "habit",
    "habits",
    "haste",
    "hush",
    "kin",
    "lump",
    "lumps",
    "manieth",
    "mishap",
    "mishaps",
    "outlet",
    "outlets",
    "storm",
    "storms",
    "strike",
    "strikes",
    "struck",
    "suffer",
    "suffers",
    "trouble",
    "troubles",
    "unheard",
    "weather",
    "weathered",
    "wish",
    "wishes",
];

/// Type names that are gone.
const NAMES: &[&str] = &["Given", "Heard", "HomeWay", "Served", "Site"];

/// Phrases that are gone.
const PHRASES: &[&str] = &[
    "a map should stand here",
    "act on every so",
    "goes whole only",
    "hears nobody",
    "is no name of",
    "is no time",
    "is told of",
    "is told on",
    "nobody knows how",
    "runs out the servo",
    "should stand here",
    "so many bytes",
    "so manieth",
    "stands here twice",
    "suffers from",
    "wears out its memory",
    "whole only",
    "whose answer nobody",
];

/// Where a file lies, from the package's root.
fn name(path: &Path) -> String {
    path.strip_prefix(root("")).expect("below the root").display().to_string()
}

/// Everything that is held: source, documents without the history, models, and the names of tests.
fn held() -> Vec<(String, String)> {
    let history = |path: &PathBuf| path.components().any(|part| part.as_os_str() == "decisions");
    let own = root("tests/tidy");
    let mut held: Vec<PathBuf> = files("src", "rs");
    held.extend(files("docs", "md").into_iter().filter(|path| !history(path)));
    held.extend(files("models", "yaml"));
    held.push(root("README.md"));
    let mut texts: Vec<_> = held.iter().map(|path| (name(path), read(path))).collect();
    for path in files("tests", "rs").into_iter().filter(|path| !path.starts_with(&own)) {
        let text = read(&path);
        let names = text.lines().filter(|line| line.trim_start().starts_with("fn "));
        let name = name(&path);
        texts.push((name.clone(), format!("{name}\n{}", names.collect::<Vec<_>>().join("\n"))));
    }
    texts
}

#[test]
fn old_words_stay_out() {
    let held = held();
    assert!(held.len() > 200, "{}", held.len());
    let mut bad = Vec::new();
    for word in WORDS.iter().chain(NAMES).chain(PHRASES) {
        let count = |text: &str| match word {
            word if NAMES.contains(word) => identifiers(text).filter(|it| it == word).count(),
            word if word.contains(' ') => prose(text).matches(&format!(" {word} ")).count(),
            word => parts(text).iter().filter(|it| it == word).count(),
        };
        let places: Vec<_> = held
            .iter()
            .filter(|(_, text)| count(text) > 0)
            .map(|(path, _)| path.as_str())
            .collect();
        if !places.is_empty() {
            bad.push(format!("`{word}` in {}", places.join(", ")));
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

fn identifiers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

/// The words of a text in small letters; `set_habits` and `FaultStrike` are two each.
fn parts(text: &str) -> Vec<String> {
    let (mut parts, mut part) = (Vec::new(), String::new());
    let mut before = ' ';
    for c in text.chars() {
        if !c.is_alphabetic() || c.is_uppercase() && !before.is_uppercase() {
            parts.extend((!part.is_empty()).then(|| std::mem::take(&mut part)));
        }
        if c.is_alphabetic() {
            part.extend(c.to_lowercase());
        }
        before = c;
    }
    parts.extend((!part.is_empty()).then_some(part));
    parts
}

/// The words of a text in small letters with one blank around each, so that a phrase is found across lines.
fn prose(text: &str) -> String {
    let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.fold(" ".to_owned(), |prose, word| prose + &word.to_lowercase() + " ")
}

#[test]
fn old_words_are_found() {
    assert_eq!(parts("set_habits(FaultStrike, RTU)"), ["set", "habits", "fault", "strike", "rtu"]);
    assert_eq!(prose("    /// It Hears\n    /// nobody."), " it hears nobody ");
}
