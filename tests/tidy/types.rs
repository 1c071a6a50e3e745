//! A type has one name, one declaration, and its methods in one place.

use crate::source::Source;
use std::collections::{BTreeMap, BTreeSet};

/// Most files that the inherent impls of one type may stand in.
const MOST_FILES: usize = 2;

/// Declared once for each platform, side by side.
const TWINS: [&str; 1] = ["Presence"];

#[test]
fn a_type_name_is_declared_once() {
    let mut declared: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for source in Source::all("src") {
        for name in source.code.lines().filter_map(declared_type) {
            declared.entry(name).or_default().push(source.path.clone());
        }
    }
    assert!(declared.len() > 200, "{}", declared.len());
    declared.retain(|name, files| files.len() > 1 && !TWINS.contains(&name.as_str()));
    assert!(declared.is_empty(), "{declared:#?}");
}

#[test]
fn impls_of_a_type_stand_together() {
    let mut files: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for source in Source::all("src") {
        for name in inherent_impls(&source.code) {
            files.entry(name).or_default().insert(source.path.clone());
        }
    }
    assert!(files.len() > 100, "{}", files.len());
    files.retain(|_, files| files.len() > MOST_FILES);
    assert!(files.is_empty(), "{files:#?}");
}

/// The name that a line declares: a struct, an enum, a union, a trait, or a type alias outside of impls.
fn declared_type(line: &str) -> Option<String> {
    let plain = match line.strip_prefix("pub") {
        Some(rest) => rest.split_once(") ").map_or(rest, |(_, rest)| rest).trim_start(),
        None => line,
    };
    let (kind, rest) = plain.trim_start().split_once(' ')?;
    let is_type = match kind {
        "struct" | "enum" | "union" | "trait" => true,
        "type" => !line.starts_with(' '),
        _ => false,
    };
    let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    (is_type && !name.is_empty()).then_some(name)
}

/// The types with an impl of their own in `code`; one of a trait does not count.
fn inherent_impls(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in
        code.match_indices("impl").filter(|(at, _)| *at == 0 || code[..*at].ends_with('\n'))
    {
        let head = code[at + 4..].split('{').next().unwrap_or_default();
        let head = without_generics(head);
        let head = head.split(" where").next().unwrap_or_default();
        if !head.contains(" for ") {
            found.extend(head.trim().rsplit("::").next().map(str::to_owned));
        }
    }
    found
}

/// Without everything between `<` and `>`.
fn without_generics(head: &str) -> String {
    let (mut level, mut out, mut last) = (0, String::new(), ' ');
    for c in head.chars() {
        match c {
            '<' => level += 1,
            '>' if last != '-' => level -= 1,
            '\n' if level == 0 => out.push(' '),
            c if level == 0 => out.push(c),
            _ => {}
        }
        last = c;
    }
    out
}

#[test]
fn types_are_found() {
    let code = "pub struct A;\npub(crate) enum B {}\ntype C = u8;\nimpl<T: Fn() -> u8> A<T> {\n    type D = u8;\n}\n\
                impl Copy for A {}\nimpl crate::b::B\nwhere\n    A: Copy,\n{\n}\n";
    let declared: Vec<_> = code.lines().filter_map(declared_type).collect();
    assert_eq!(declared, ["A", "B", "C"]);
    assert_eq!(inherent_impls(code), ["A", "B"]);
}
