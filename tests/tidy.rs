//! The house rules that no compiler knows: who may import whom, how long a file may be, what must not stand in it.

use crate::source::Source;
use drivemu::model::Choices;
use drivemu::model::builtin::Builtin;
use std::collections::{BTreeMap, BTreeSet};

/// The floors, lowest first. A module may import from floors below its own, and from itself.
const FLOORS: [&[&str]; 15] = [
    &["text"],
    &["time", "units", "wire", "problem", "rng"],
    &["vocabulary", "serial"],
    &["event"],
    &["line", "motion"],
    &["model"],
    &["bank", "behaviour", "fault"],
    &["drive"],
    &["bus"],
    &["bench", "log"],
    &["scenario"],
    &["server"],
    &["testkit"],
    &["lib"],
    &["cli", "main"],
];

/// Narrower than the floors: what these modules must not know, although it lies below them.
const FORBIDDEN: [(&str, &[&str]); 7] = [
    ("motion", &["vocabulary", "event", "wire", "serial", "problem"]),
    ("line", &["vocabulary", "event", "units", "serial"]),
    ("bank", &["event", "line"]),
    ("behaviour", &["wire", "line", "model", "units", "problem"]),
    ("log", &["problem", "line"]),
    ("drive", &["problem"]),
    ("fault", &["model", "line", "motion", "serial"]),
];

/// The one file of the testkit that may use the shell: all others work without it.
const LIVE: &str = "src/testkit/live.rs";

#[test]
fn imports_point_down() {
    let mut bad = Vec::new();
    for source in Source::all("src") {
        let own = module(&source.path);
        let floor = floor(own).unwrap_or_else(|| panic!("{} stands on no floor", source.path));
        for used in imports(&source) {
            let below =
                self::floor(&used).is_some_and(|it| it < floor) && !is_forbidden(own, &used);
            if !(below || used == own)
                || used == "server" && own == "testkit" && source.path != LIVE
            {
                bad.push(format!("{} imports {used}", source.path));
            }
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

/// Every module of the library has a floor, and every floor is drawn in the head of lib.rs in that order.
#[test]
fn the_map_in_lib_is_the_table() {
    let sources = Source::all("src");
    let lib = sources.iter().find(|it| it.path == "src/lib.rs").expect("a library");
    let declared = lib.code.lines().filter_map(|it| it.trim().strip_prefix("pub mod "));
    let mut declared: BTreeSet<&str> = declared.map(|it| it.trim_end_matches(';')).collect();
    for module in &declared {
        assert!(floor(module).is_some(), "{module} stands on no floor");
    }
    declared.extend(["cli", "main"]);
    let head = lib.text.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim);
    let map = head.skip_while(|line| *line != "```text").skip(1).take_while(|line| *line != "```");
    let names = |line: &str| -> BTreeSet<String> {
        let names = line.split("  ").take_while(|part| !part.contains(", ")).map(str::trim);
        names
            .flat_map(|it| it.split(" · "))
            .map(str::to_owned)
            .filter(|it| floor(it).is_some())
            .collect()
    };
    let drawn: Vec<_> = map.map(names).collect();
    let there = |floor: &&[&str]| -> BTreeSet<String> {
        floor.iter().filter(|it| declared.contains(*it)).map(|it| (*it).to_owned()).collect()
    };
    let table = FLOORS.iter().rev().map(there).filter(|floor| !floor.is_empty());
    assert_eq!(drawn, table.collect::<Vec<_>>());
}

#[test]
fn files_are_short() {
    for folder in ["src", "tests"] {
        let mut lengths = BTreeMap::new();
        for source in Source::all(folder) {
            lengths.insert(source.path.clone(), source.text.lines().count());
        }
        let long: Vec<_> = lengths.iter().filter(|(_, lines)| **lines > 500).collect();
        assert!(long.is_empty(), "look for the second noun in {long:?}");
        let mut lengths: Vec<_> = lengths.into_values().collect();
        lengths.sort_unstable();
        assert!(lengths[lengths.len() / 2] < 200, "the median file of {folder} is too long");
    }
}

#[test]
fn each_file_says_what_it_is() {
    let sources = Source::all("src").into_iter().chain(Source::all("tests"));
    let silent: Vec<_> =
        sources.filter(|it| !it.text.starts_with("//! ")).map(|source| source.path).collect();
    assert!(silent.is_empty(), "no `//!` head: {silent:?}");
}

#[test]
fn nothing_is_left_over() {
    for source in Source::all("src").into_iter().chain(Source::all("tests")) {
        let code = words_of(&source.code)
            .filter(|it| ["todo", "unimplemented", "dbg", "HashMap", "HashSet"].contains(it));
        let comments = source.comments.iter().flat_map(|(_, text)| words_of(text));
        let marks = ["TODO", "FIXME", "XXX", "HACK", "todo", "fixme"];
        let found: Vec<_> = code.chain(comments.filter(|it| marks.contains(it))).collect();
        assert!(found.is_empty(), "{}: {found:?}", source.path);
    }
}

/// Numbers of four hex digits that are masks and limits, or nobody's example.
const NEUTRAL: [&str; 5] = ["0xFFFF", "0x1_0000", "0x0000_FFFF", "0xFFFF_0000", "0x1234"];

/// What vendors printed stands in `models/`, and nowhere in the program: not even in an example.
#[test]
fn no_vendor_is_named() {
    let vendors = vendor_words();
    let codes = row_codes();
    let mut bad = Vec::new();
    for source in Source::all("src") {
        for (i, line) in source.text.lines().enumerate() {
            let place = format!("{}:{}", source.path, i + 1);
            let lower = line.to_lowercase();
            bad.extend(
                vendors.iter().filter(|it| lower.contains(*it)).map(|it| format!("{place}: {it}")),
            );
            let tokens = line.split(|c: char| !c.is_alphanumeric() && c != '.' && c != '_');
            let code = |it: &&str| codes.contains(it.trim_matches('.')) || is_code(it);
            bad.extend(tokens.filter(code).map(|it| format!("{place}: {it}")));
            if i + 1 < source.tests_begin() && !source.path.ends_with("tests.rs") {
                let address = |it: &&str| is_address(it) && !NEUTRAL.contains(it);
                let tokens = line.split(|c: char| !c.is_alphanumeric() && c != '_');
                bad.extend(tokens.filter(address).map(|it| format!("{place}: {it}")));
            }
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

/// Names that vendors go by, and their products; in small letters.
fn vendor_words() -> BTreeSet<String> {
    let mut words = BTreeSet::from(["estun".to_owned()]);
    for builtin in Builtin::all() {
        let model = builtin.load(&Choices::new()).expect("a good model");
        words.insert(model.name.to_lowercase());
        words.extend(model.products.iter().map(|it| it.to_lowercase()));
        let names = model.vendor.split(|c: char| !c.is_alphanumeric());
        let names = names.filter(|it| it.len() > 3 && it.starts_with(char::is_uppercase));
        words.extend(names.map(str::to_lowercase));
    }
    assert!(words.len() > 10, "the models name their vendors: {words:?}");
    words
}

/// Codes of rows as manuals print them; our own words for rows are in small letters.
fn row_codes() -> BTreeSet<String> {
    let mut codes = BTreeSet::new();
    for builtin in Builtin::all() {
        let model = builtin.load(&Choices::new()).expect("a good model");
        let ids = model.map.rows().map(|(_, row)| row.id.clone());
        codes.extend(ids.filter(|id| id.starts_with(char::is_uppercase)));
    }
    codes
}

/// `P12.34`: how several vendors number their parameters.
fn is_code(token: &str) -> bool {
    let Some((group, number)) = token.split_once('.') else { return false };
    let Some(group) = group.strip_prefix('P') else { return false };
    let digits = |it: &str| it.len() == 2 && it.bytes().all(|b| b.is_ascii_digit());
    digits(group) && digits(number)
}

fn is_address(token: &str) -> bool {
    let Some(digits) = token.strip_prefix("0x") else { return false };
    digits.len() >= 4 && digits.bytes().all(|b| b.is_ascii_hexdigit() || b == b'_')
}

fn words_of(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

/// `bus` of `src/bus/answer.rs`, `time` of `src/time.rs`.
fn module(path: &str) -> &str {
    let path = path.strip_prefix("src/").unwrap_or(path);
    path.split('/').next().unwrap_or(path).trim_end_matches(".rs")
}

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&module))
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
