//! The house rules that no compiler knows: how long a file may be, what must not stand in it.

mod floors;

mod circles;
mod old_words;
mod types;

use crate::source::Source;
use drivemu::model::Choices;
use drivemu::model::builtin::Builtin;
use std::collections::{BTreeMap, BTreeSet};

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
