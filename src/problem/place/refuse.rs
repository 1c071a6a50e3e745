//! What is refused although it is YAML, in words.
//!
//! Not here: a text that is no YAML at all (see [`syntax`](super::syntax)).

use super::key::YamlKey;
use super::{Mark, Path, Problem, Seg};
use crate::problem::bounds::{self, DEPTH};
use crate::text::is_control;
use std::collections::BTreeMap;

/// Keys whose texts may have several lines; names have one.
const PROSE: [&str; 4] = ["about", "assumed", "note", "why"];

/// TextLine and spelling of the keys of one map so far, by name.
pub(super) type SeenKeys = BTreeMap<String, (usize, String)>;

/// An anchor or an alias: the reader would follow it, and paths could not tell its two places
/// apart.
pub(super) fn anchor(path: Path, mark: Mark) -> Problem {
    let advice = "write out the value; a string that begins with `&` or `*` needs quotes";
    let problem = Problem::value(path, "anchors and aliases are not supported").advise(advice);
    Problem { mark: Some(mark), ..problem }
}

/// The second of several documents.
pub(super) fn document(mark: Mark) -> Problem {
    let what = "only one document is allowed, and a second begins here";
    Problem { mark: Some(mark), ..Problem::value(Path::root(), what) }
}

/// A map or list one level too deep.
pub(super) fn depth(path: Path, mark: Mark) -> Problem {
    let what = format!("nested deeper than {DEPTH} levels");
    Problem { mark: Some(mark), ..Problem::value(path, what) }
}

/// A text at `path` that would disturb a log or a terminal.
pub(super) fn text(text: &str, path: &Path, mark: Mark) -> Option<Problem> {
    let is_prose =
        matches!(path.segs().last(), Some(Seg::Key(key)) if PROSE.contains(&key.as_str()));
    let is_bad = |c: &char| is_control(*c) && !(is_prose && matches!(c, '\n' | '\t'));
    let what = match text.chars().find(is_bad)? {
        '\n' => "line breaks are not allowed here".to_owned(),
        c => format!("the character U+{:04X} is not allowed here", u32::from(c)),
    };
    let problem = Problem::value(path.clone(), what).advise("remove it");
    Some(Problem { mark: Some(mark), ..problem })
}

/// A file, or something in it, beyond a bound.
pub(super) fn length(what: &str, most: usize, unit: &str, mark: Mark) -> Problem {
    let problem = Problem::value(Path::root(), bounds::length(what, most, unit));
    Problem { mark: Some(mark), ..problem }
}

/// A key of the map at `path` that is there already or that can't be one; `None` for a good one.
pub(super) fn key(key: &YamlKey, path: &Path, mark: Mark, seen: &mut SeenKeys) -> Option<Problem> {
    let problem = match key {
        YamlKey::Collection => Problem::value(path.clone(), "a key must be a string or a number"),
        YamlKey::Scalar { name, written } => {
            let Some((line, first)) = seen.get(name) else {
                seen.insert(name.clone(), (mark.line, written.clone()));
                return None;
            };
            let spelling = match first == written {
                true => String::new(),
                false => format!(" as `{first}`"),
            };
            Problem::key(path.key(name), format!("duplicate key `{written}`"))
                .advise(format!("first used in line {line}{spelling}"))
        }
    };
    Some(Problem { mark: Some(mark), ..problem })
}

#[cfg(test)]
mod tests {
    use super::super::{At, Places};
    use super::*;

    /// `line:column+length problem`, one a line.
    fn problems(text: &str) -> String {
        let show = |p: &Problem| {
            let Mark { line, column, length } = p.mark.unwrap();
            format!("{line}:{column}+{length} {p}\n")
        };
        Places::parse(text).1.iter().map(show).collect()
    }

    #[test]
    fn equal_keys() {
        #[rustfmt::skip]
        let table = [
            ("a: {b: 1, 'b': 2}\nc: 1\na: 3\n",
             "1:11+3 a.b: duplicate key `b` (first used in line 1)\n\
              3:1+1 a: duplicate key `a` (first used in line 1)\n"),
            ("- {17: x, 中: y, 0x11: z}",
             "1:17+4 [0][17]: duplicate key `0x11` (first used in line 1 as `17`)\n"),
            ("- a: 1\n- a: 1\n", ""),
            ("{a: a, b: a}", ""),
            ("021: x\n17: y\n21: z\n", ""),
            ("P1: {6.10: x, 6.1: y}",
             "1:15+3 P1[6.1]: duplicate key `6.1` (first used in line 1 as `6.10`)\n"),
            ("? [a, b]\n: c\n", "1:3+6 a key must be a string or a number\n"),
        ];
        for (text, want) in table {
            assert_eq!(problems(text), want, "{text:?}");
        }
    }

    #[test]
    fn what_is_refused() {
        const ANCHORS: &str = "anchors and aliases are not supported (write out the value; \
                               a string that begins with `&` or `*` needs quotes)\n";
        for (text, want) in [
            ("a: &x 1\nb: *x\n", format!("1:4+4 a: {ANCHORS}2:4+2 b: {ANCHORS}")),
            ("a: &x\n  b: c\n", format!("1:4+1 a: {ANCHORS}")),
            ("a: [b, *nowhere]", format!("1:8+1 a[1]: {ANCHORS}")),
            (
                "a: b\n---\nc: d\n",
                "2:1+3 only one document is allowed, and a second begins here\n".into(),
            ),
            (
                "a: b\n...\nc: d\n",
                "3:1+1 only one document is allowed, and a second begins here\n".into(),
            ),
            (
                "a: b\n---\n*x",
                "2:1+3 only one document is allowed, and a second begins here\n".into(),
            ),
            ("", String::new()),
        ] {
            assert_eq!(problems(text), want, "{text:?}");
        }
        let (places, _) = Places::parse("a: b\n---\nc: d\n");
        assert!(places.find(&Path::root().key("a"), At::Key).is_some());
    }

    #[test]
    fn depth_has_a_bottom() {
        let fits = "[".repeat(DEPTH) + &"]".repeat(DEPTH);
        assert_eq!(problems(&fits), "");
        let stairs: String = (0..999).map(|i| " ".repeat(i) + "a:\n").collect();
        for text in ["[".repeat(65), "[".repeat(100_000), "- ".repeat(100_000), stairs] {
            let (places, problems) = Places::parse(&text);
            assert!(places.root.is_none());
            assert_eq!(problems.len(), 1);
            assert_eq!(problems[0].what, "nested deeper than 64 levels");
        }
    }
}
