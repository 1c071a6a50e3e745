//! A YAML file as a tree whose every key and value knows where it stands in the text.
//!
//! [`parse`](super::parse) makes it, options are laid over it, [`decode`](super::decode) reads values out of it,
//! and what is found wrong later, by [`Path`](super::Path) alone, gets its place from it.

use super::Mark;
use serde_yaml::Number;
use std::borrow::Cow;

/// A value of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// What it is.
    pub content: Content,
    /// Where it stands. A map or list that is written over several lines is marked at its key, and so is a value
    /// that was left out.
    pub mark: Mark,
}

/// What a value is.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Nothing: `null`, `~`, or left out.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number.
    Number(Number),
    /// Any other scalar, and every one in quotes.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// A map, in the order of the file. No two keys have the same name.
    Map(Vec<MapEntry>),
}

/// A key of a map with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEntry {
    /// The key: a scalar.
    pub key: Node,
    /// The key as it is written, without quotes.
    pub written: String,
    /// The value.
    pub value: Node,
}

impl MapEntry {
    /// The name that a [`Path`](super::Path) has for the key: one for all spellings of a number (`17`, `0x11`).
    pub fn name(&self) -> Cow<'_, str> {
        match &self.key.content {
            Content::Number(number) => Cow::Owned(number.to_string()),
            _ => Cow::Borrowed(&self.written),
        }
    }

    pub(super) fn is(&self, key: &str) -> bool {
        self.written == key || self.name() == key
    }
}

impl Node {
    /// The entries of a map; of anything else there are none.
    pub fn entries(&self) -> &[MapEntry] {
        match &self.content {
            Content::Map(entries) => entries,
            _ => &[],
        }
    }

    /// The items of a list; of anything else there are none.
    pub fn items(&self) -> &[Node] {
        match &self.content {
            Content::List(items) => items,
            _ => &[],
        }
    }

    /// The value of `key` in a map.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entries().iter().find(|entry| entry.is(key)).map(|entry| &entry.value)
    }

    /// Is it a map?
    pub fn is_map(&self) -> bool {
        matches!(self.content, Content::Map(_))
    }

    /// Is it a list?
    pub fn is_list(&self) -> bool {
        matches!(self.content, Content::List(_))
    }

    /// The text, if it is one.
    pub fn as_text(&self) -> Option<&str> {
        match &self.content {
            Content::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The number, if it is one of 0 or more without a fraction.
    pub fn as_u64(&self) -> Option<u64> {
        match &self.content {
            Content::Number(number) => number.as_u64(),
            _ => None,
        }
    }

    /// Lays `fragment` over this: maps are merged, `null` removes, anything else replaces. What comes from the
    /// fragment keeps its place there.
    pub fn lay_over(&mut self, fragment: &Node) {
        let (Content::Map(entries), Content::Map(over)) = (&mut self.content, &fragment.content)
        else {
            *self = fragment.clone();
            return;
        };
        for entry in over {
            let at = entries.iter().position(|it| it.name() == entry.name());
            match at {
                Some(at) if entry.value.content == Content::Null => {
                    entries.remove(at);
                }
                Some(at) => entries[at].value.lay_over(&entry.value),
                None if entry.value.content == Content::Null => {}
                None => entries.push(entry.clone()),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::problem::parse;

    #[test]
    fn maps_merge_null_removes_the_rest_replaces() {
        let tree = |text| parse(text).expect("a tree").0;
        let mut file = tree("{a: {b: 1, c: 2}, d: [1, 2], 0x11: x}");
        let over = tree("{a: {c: null, e: 3, f: null}, d: [4], 17: y}");
        file.lay_over(&over);
        assert_eq!(file.get("a").expect("a").entries().len(), 2);
        assert_eq!(file.get("a").and_then(|it| it.get("e")).and_then(|it| it.as_u64()), Some(3));
        assert_eq!(file.get("d").map(|it| it.items().len()), Some(1));
        assert_eq!(file.get("17").and_then(|it| it.as_text()), Some("y"));
        let place = file.get("d").expect("d").items()[0].mark;
        assert_eq!((place.line, place.column), (1, 35), "in the fragment");
    }

    #[test]
    fn integer_keys_compare_by_value() {
        for (written, name) in [
            ("17", "17"),
            ("0x11", "17"),
            ("0o21", "17"),
            ("0b10001", "17"),
            ("+17", "17"),
            ("-0x11", "-17"),
            ("0", "0"),
            ("021", "021"),
            ("0x", "0x"),
            ("0x+1", "0x+1"),
            ("6.10", "6.1"),
            ("99999999999999999999", "99999999999999999999"),
            ("--1", "--1"),
            ("1_000", "1_000"),
            ("C06.04", "C06.04"),
            ("中", "中"),
        ] {
            let (tree, problems) = parse(&format!("{written}: x")).unwrap();
            assert_eq!(problems, []);
            assert_eq!(tree.entries()[0].name(), name, "{written}");
            assert!(tree.get(written).is_some(), "{written}");
        }
        let (tree, _) = parse("'0x11': x\n021: y\n!!str 0o21: z").unwrap();
        assert_eq!(tree.get("17"), None);
    }
}
