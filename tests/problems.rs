//! Bad files and what people are told about them, caret for caret: one small file a rule.
//!
//! `UPDATE_EXPECT=1 cargo test` writes the expectations anew; read them as somebody who made the mistake.

use crate::expect::{files, read, root, same};
use crate::kit::{Files, line_of, text_of};
use crate::source::Source;
use drivemu::bench::{self, BuiltinLibrary, DeviceSpec, Library, Saved, kind_of};
use drivemu::model;
use drivemu::problem::Problem;
use drivemu::problem::render::render;
use drivemu::scenario;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The embedded models, and the bad ones of this test by file name.
struct BadModels;

impl Library for BadModels {
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        let file = root("tests/problems/model").join(name);
        if name.ends_with(".yaml") && file.exists() {
            Ok((name.to_owned(), read(&file)))
        } else {
            BuiltinLibrary.fetch(name)
        }
    }
}

/// Each bad file with what is told about it; a `.spec` is a fault rule in compact form.
static TOLD: LazyLock<Vec<(PathBuf, String)>> = LazyLock::new(|| {
    let specs = files("tests/problems/fault", "spec");
    let files = files("tests/problems", "yaml").into_iter().chain(specs);
    files.map(|file| (file.clone(), told(&file))).collect()
});

fn told(file: &Path) -> String {
    let text = read(file);
    if is_spec(file) {
        let line = line_of(text_of("hcfa-x"), &[], &DeviceSpec::default());
        let spec = text.trim_end_matches('\n');
        return render(&line.fault(spec, &[]).err().unwrap_or_default(), "--fault", spec);
    }
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let problems = match file.parent().and_then(Path::file_name) {
        Some(kind) if kind == "bench" => bench::parse(&text, &BadModels).err().unwrap_or_default(),
        Some(kind) if kind == "scenario" => of_scenario(&text).err().unwrap_or_default(),
        Some(kind) if kind == "state" => of_state(&text).err().unwrap_or_default(),
        _ => model::check(&text),
    };
    render(&problems, &name, &text)
}

/// What is wrong with a state file for two drives on one line, the second with two stations.
fn of_state(text: &str) -> Result<(), Vec<Problem>> {
    const BENCH: &str = "lines: [{name: cell, tcp: '127.0.0.1:0', drives: [{model: acme-s1.yaml}, {model: k-series}]}]";
    let mut saved = Saved::read(text)?;
    bench::parse_saved(BENCH, &Files, &mut saved)?;
    saved.finish()
}

/// What is wrong with a scenario for one drive.
fn of_scenario(text: &str) -> Result<(), Vec<Problem>> {
    const BENCH: &str = "lines: [{name: cell-1, pty: auto, drives: [{model: yako-closed-loop}]}]";
    scenario::parse(text, &bench::parse(BENCH, &BuiltinLibrary)?.lines).map(|_| ())
}

fn is_spec(file: &Path) -> bool {
    file.extension().is_some_and(|it| it == "spec")
}

#[test]
fn each_bad_file_is_told_as_expected() {
    let check = |(file, told): &(PathBuf, String)| {
        same(&file.with_extension("txt"), told, "UPDATE_EXPECT").err()
    };
    let bad: Vec<_> = TOLD.iter().filter_map(check).collect();
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

/// Nobody says which kind of file it is: it is told by its keys, or what is told is the same either way.
#[test]
fn the_kind_of_a_file_shows() {
    let is_state = |file: &Path| file.parent().is_some_and(|it| it.ends_with("state"));
    for (file, told) in TOLD.iter().filter(|(file, _)| !is_state(file) && !is_spec(file)) {
        let text = read(file);
        let by_kind = match kind_of(&text) {
            "bench" => bench::parse(&text, &BadModels).err().unwrap_or_default(),
            "scenario" => of_scenario(&text).err().unwrap_or_default(),
            _ => model::check(&text),
        };
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        assert_eq!(render(&by_kind, &name, &text), *told, "{}", file.display());
    }
}

#[test]
fn good_models_have_no_problem() {
    for file in ["models", "tests/models"].iter().flat_map(|folder| files(folder, "yaml")) {
        assert_eq!(told(&file), "");
    }
}

#[test]
fn each_expectation_has_its_bad_file() {
    let mut orphans = files("tests/problems", "txt");
    let exists = |file: &PathBuf, ending| file.with_extension(ending).exists();
    orphans.retain(|file| !exists(file, "yaml") && !exists(file, "spec"));
    assert!(orphans.is_empty(), "{orphans:?}");
}

/// Where sentences for people who write files come from.
const SPEAKERS: [&str; 13] = [
    "src/model/",
    "src/bench/",
    "src/scenario/compile.rs",
    "src/scenario/order.rs",
    "src/scenario/raw.rs",
    "src/scenario/site.rs",
    "src/medium/compile.rs",
    "src/medium/raw.rs",
    "src/medium/spec.rs",
    "src/serial.rs",
    "src/problem/parse.rs",
    "src/problem/decode.rs",
    "src/problem/decode/reader.rs",
];

/// Every rule has a bad file: each sentence in the source stands in some expectation.
#[test]
fn each_sentence_has_a_file() {
    let mut missing = Vec::new();
    for source in Source::all("src") {
        if !SPEAKERS.iter().any(|speaker| source.path.starts_with(speaker)) {
            continue;
        }
        for (line, text) in source.texts_of_program().filter(|(_, text)| is_sentence(text)) {
            let pieces = pieces(text);
            if !TOLD.iter().flat_map(|(_, told)| told.lines()).any(|line| says(line, &pieces)) {
                missing.push(format!("{}:{line}: {text}", source.path));
            }
        }
    }
    assert!(missing.is_empty(), "no file in tests/problems brings up\n{}", missing.join("\n"));
}

/// What no small file brings up (tests/bounds.rs does, with large ones), and what is said to nobody.
const UNHEARD: [&str; 5] =
    ["a file", "a map with ", "anything else", "recursion limit exceeded", "unknown anchor"];

fn is_sentence(text: &str) -> bool {
    if UNHEARD.iter().any(|it| text.starts_with(it)) {
        return false;
    }
    let words = text.split(' ').filter(|word| word.chars().any(char::is_lowercase));
    // A comment is for those who read what the program has written.
    words.count() >= 2 && !text.contains("BTreeMap<") && !text.starts_with("# ")
}

/// What a format string says around its values.
fn pieces(text: &str) -> Vec<String> {
    let text = text.replace("{{", "\u{1}").replace("}}", "\u{2}");
    let mut pieces = vec![String::new()];
    let mut inside = false;
    for c in text.chars() {
        match c {
            '{' => {
                inside = true;
                pieces.push(String::new());
            }
            '}' => inside = false,
            _ if inside => {}
            '\u{1}' => pieces.last_mut().expect("one").push('{'),
            '\u{2}' => pieces.last_mut().expect("one").push('}'),
            _ => pieces.last_mut().expect("one").push(c),
        }
    }
    pieces
}

fn says(line: &str, pieces: &[String]) -> bool {
    let mut rest = line;
    pieces.iter().all(|piece| match rest.split_once(piece.as_str()) {
        Some((_, after)) => {
            rest = after;
            true
        }
        None => false,
    })
}
