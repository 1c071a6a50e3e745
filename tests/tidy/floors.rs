//! The floors: who may import whom. The table is the drawing in docs/ARCHITECTURE.md.

use crate::expect::{read, root};
use crate::source::Source;
use std::collections::BTreeSet;

/// Narrower than the floors: what these modules must not know, although it lies below them.
const FORBIDDEN: [(&str, &[&str]); 7] = [
    ("motion", &["vocabulary", "event", "wire", "serial", "problem"]),
    ("line", &["vocabulary", "event", "units", "serial"]),
    ("bank", &["event", "line"]),
    ("behaviour", &["wire", "line", "model", "units", "problem"]),
    ("log", &["problem", "line"]),
    ("drive", &["problem"]),
    ("medium", &["model", "motion", "vocabulary"]),
];

/// The one file of the testkit that may use the shell: all others work without it.
const LIVE: &str = "src/testkit/live.rs";

/// The modules of each floor, lowest first: the lines between the fences of the one drawing. A line that begins with a
/// number is a floor, its modules stand in front of the two spaces that begin the description.
fn floors() -> Vec<Vec<String>> {
    let page = read(&root("docs/ARCHITECTURE.md"));
    let drawing = page.split("```text").find(|block| block.contains("  main  "));
    let drawing = drawing.and_then(|block| block.split("```").next()).expect("the drawing");
    let mut floors: Vec<(u32, Vec<String>)> = Vec::new();
    for line in drawing.lines() {
        let (number, rest) = line.trim().split_once(' ').unwrap_or_default();
        let Ok(number) = number.parse() else { continue };
        let names = rest.trim().split("  ").next().unwrap_or_default();
        let names = names.split(" · ").map(|name| name.trim().to_owned()).collect();
        floors.push((number, names));
    }
    assert!(floors.is_sorted_by(|above, below| above.0 > below.0), "highest floor first");
    floors.into_iter().rev().map(|(_, names)| names).collect()
}

#[test]
fn imports_point_down() {
    let floors = floors();
    let floor =
        |module: &str| floors.iter().position(|floor| floor.iter().any(|name| name == module));
    let mut bad = Vec::new();
    for source in Source::all("src").into_iter().filter(|source| source.path != "src/lib.rs") {
        let own = module(&source.path);
        let Some(height) = floor(own) else {
            bad.push(format!("{} stands on no floor of docs/ARCHITECTURE.md", source.path));
            continue;
        };
        for used in imports(&source).into_iter().filter(|used| used != own) {
            let below = floor(&used).is_some_and(|other| other < height);
            let server = used == "server" && own == "testkit" && source.path != LIVE;
            if !below || server || is_forbidden(own, &used) {
                bad.push(format!("{} imports {used}", source.path));
            }
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

/// Every module of the library stands in the drawing, and nothing else does.
#[test]
fn the_drawing_is_complete() {
    let lib = read(&root("src/lib.rs"));
    let modules =
        lib.lines().filter_map(|line| line.trim().trim_end_matches(';').split_once("mod "));
    let modules: BTreeSet<String> = modules
        .filter(|(before, name)| !before.contains("//") && !name.starts_with('$'))
        .map(|(_, name)| name.to_owned())
        .chain(["main".to_owned()])
        .collect();
    let drawn: BTreeSet<String> = floors().into_iter().flatten().collect();
    assert_eq!(drawn, modules);
}

/// `bus` of `src/bus/answer.rs`, `time` of `src/time.rs`.
fn module(path: &str) -> &str {
    let path = path.strip_prefix("src/").unwrap_or(path);
    path.split('/').next().unwrap_or(path).trim_end_matches(".rs")
}

fn is_forbidden(own: &str, used: &str) -> bool {
    FORBIDDEN.iter().any(|(module, forbidden)| *module == own && forbidden.contains(&used))
}

/// The top-level modules that a file names: behind `crate::`, or behind enough `super::`.
fn imports(source: &Source) -> BTreeSet<String> {
    let code = source.code.as_str();
    let to_root = "super::".repeat(depth(&source.path));
    let tests = code.find("#[cfg(test)]").unwrap_or(code.len());
    let (program, tests) = code.split_at(tests);
    let out_of_tests = format!("super::{to_root}");
    let mut found = BTreeSet::new();
    for (code, root) in [(code, "crate::"), (program, &to_root), (tests, &out_of_tests)] {
        let places = code.match_indices(root).filter(|(at, _)| !code[..*at].ends_with("super::"));
        found.extend(places.flat_map(|(at, _)| heads(&code[at + root.len()..])));
    }
    found
}

/// The names right behind a path: one, or those in braces.
fn heads(rest: &str) -> Vec<String> {
    let name = |text: &str| -> Option<String> {
        let name: String =
            text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        (name.starts_with(char::is_lowercase) && name != "super").then_some(name)
    };
    match rest.strip_prefix('{') {
        None => name(rest).into_iter().collect(),
        Some(list) => {
            let (mut level, mut names, mut start) = (0, Vec::new(), 0);
            for (i, c) in list.char_indices() {
                match c {
                    '{' => level += 1,
                    '}' if level == 0 => {
                        names.extend(name(&list[start..i]));
                        break;
                    }
                    '}' => level -= 1,
                    ',' if level == 0 => {
                        names.extend(name(&list[start..i]));
                        start = i + 1;
                    }
                    _ => {}
                }
            }
            names
        }
    }
}

/// How many `super::` lead from a file to the root of its crate: 1 for `src/time.rs`.
fn depth(path: &str) -> usize {
    let parts = path.strip_prefix("src/").unwrap_or(path).split('/').count();
    if path.ends_with("/mod.rs") { parts - 1 } else { parts }
}

#[test]
fn imports_are_found() {
    let text = "use crate::{bus::{Bus, Link}, time, Row};\nfn f() -> crate::wire::Frame;\n\
                use super::drive::Drive; use super::super::model;\n\
                #[cfg(test)]\nmod tests { use super::*; use super::super::line; }\n";
    let found = |path: &str| -> Vec<String> {
        imports(&Source::cut(path.into(), text.into())).into_iter().collect()
    };
    assert_eq!(found("src/event.rs"), ["bus", "drive", "line", "time", "wire"]);
    assert_eq!(found("src/bench/mod.rs"), ["bus", "drive", "line", "time", "wire"]);
    assert_eq!(found("src/bench/parse.rs"), ["bus", "model", "time", "wire"]);
}
