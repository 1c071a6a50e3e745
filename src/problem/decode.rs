//! From a tree to the raw structs of a format. What does not fit is told, and all the rest is read nevertheless.
//!
//! serde stops at the first value that does not fit, so a tree is read in passes. Each pass leaves out what the
//! ones before have told of, as if nobody had written it. Where a format can't do without it (a key that must be
//! there, an item whose place in a list counts) a blank stands in; checks may trip over that, which
//! [`settle`](super::settle) does not tell.

mod blank;
mod reader;
mod variant;

use super::tree::{MapEntry, Node};
use super::{At, Mark, Path, Problem, bounds};
use reader::{Reader, found};
use serde::de::Error;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

/// Values that are read in all passes together: who makes more mistakes gets the rest told the next time.
const WORK: usize = 2_000_000;

/// Reads `node`, which stands at `path`, as a `T`. The keys `later` of it are left to be read on their own. `None`
/// where too little is left for a `T`; what is wrong is among the problems then.
pub fn decode<'de, T: serde::Deserialize<'de>>(
    node: &'de Node,
    path: &Path,
    later: &[&str],
    problems: &mut Vec<Problem>,
) -> Option<T> {
    let mut pass = Pass {
        root: node,
        later,
        gaps: BTreeMap::new(),
        missing: BTreeSet::new(),
        unknown: Vec::new(),
        work: 0,
    };
    loop {
        pass.unknown.clear();
        let read = T::deserialize(Reader { pass: &mut pass, node, trail: Trail::Root(path) });
        let goes_on = match &read {
            Ok(_) => false,
            Err(misfit) => pass.leave_out(misfit, problems),
        };
        if !goes_on || pass.work > WORK || problems.len() > bounds::PROBLEMS {
            problems.append(&mut pass.unknown);
            return read.ok();
        }
    }
}

/// The entries of a map of things that have names, with their paths, to be read one by one.
pub fn named<'de>(
    node: Option<&'de Node>,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Vec<(String, Path, &'de Node)> {
    let Some(node) = node else { return Vec::new() };
    if !node.is_map() {
        let what = format!("expected a map, found {}", found(&node.content));
        problems.push(Problem::value(path.clone(), what).marked(node.mark).unread());
    }
    let entry = |entry: &'de MapEntry| {
        let name = entry.name().into_owned();
        (name.clone(), path.key(name), &entry.value)
    };
    node.entries().iter().map(entry).collect()
}

/// The items of a list with their paths, to be read one by one.
pub fn listed<'de>(
    node: Option<&'de Node>,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Vec<(Path, &'de Node)> {
    let Some(node) = node else { return Vec::new() };
    if !node.is_list() {
        let what = format!("expected a list, found {}", found(&node.content));
        problems.push(Problem::value(path.clone(), what).marked(node.mark).unread());
    }
    node.items().iter().enumerate().map(|(i, node)| (path.index(i), node)).collect()
}

/// What a pass knows from those before it.
struct Pass<'s> {
    root: &'s Node,
    later: &'s [&'s str],
    /// Values that do not fit.
    gaps: BTreeMap<*const Node, Gap>,
    /// Keys that must be there and are not, each with its map.
    missing: BTreeSet<(*const Node, &'static str)>,
    /// What is wrong with keys of this pass.
    unknown: Vec<Problem>,
    /// Values read so far.
    work: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Gap {
    Absent,
    Blank,
}

impl Pass<'_> {
    /// Tells of `misfit` and leaves it out from now on. `false` if that leaves nothing.
    fn leave_out(&mut self, misfit: &Misfit, problems: &mut Vec<Problem>) -> bool {
        let Misfit { node, mark, path, at, holder, cause } = misfit;
        let problem = Problem { at: *at, ..Problem::value(path.clone(), "") };
        let problem = Problem { mark: *mark, ..problem.unread() };
        match cause {
            MisfitCause::Missing { key, is_written } => {
                let (path, what) = (path.key(key), "missing key".to_owned());
                // One that is written was left out on purpose, or because of what was told.
                if !is_written {
                    problems.push(Problem { path, what, ..problem });
                }
                return self.missing.insert((*node, key));
            }
            MisfitCause::Kind { what, advice } => {
                problems.push(Problem { what: what.clone(), advice: advice.clone(), ..problem });
            }
            MisfitCause::NoBlank => {}
        }
        let gap = match holder {
            None => return false,
            Some(Holder::Map) => Gap::Absent,
            Some(Holder::List) => Gap::Blank,
        };
        self.gaps.insert(*node, gap) != Some(gap)
    }

    fn missing_keys(&self, map: *const Node) -> impl Iterator<Item = &'static str> {
        self.missing.iter().filter(move |(it, _)| *it == map).map(|(_, key)| *key)
    }
}

/// The way to a value, on the stack.
#[derive(Clone, Copy)]
enum Trail<'a> {
    Root(&'a Path),
    Key(&'a Trail<'a>, &'a str),
    Index(&'a Trail<'a>, usize),
}

impl Trail<'_> {
    fn path(&self) -> Path {
        match self {
            Self::Root(path) => (*path).clone(),
            Self::Key(above, key) => above.path().key(key),
            Self::Index(above, index) => above.path().index(*index),
        }
    }
}

/// A value that does not fit.
#[derive(Debug)]
pub struct Misfit {
    node: *const Node,
    mark: Option<Mark>,
    path: Path,
    at: At,
    /// What it is part of; `None` at the root.
    holder: Option<Holder>,
    cause: MisfitCause,
}

#[derive(Debug, Clone, Copy)]
enum Holder {
    Map,
    List,
}

#[derive(Debug)]
enum MisfitCause {
    Kind {
        what: String,
        advice: Option<String>,
    },
    Missing {
        key: &'static str,
        is_written: bool,
    },
    /// No blank can stand in for something below.
    NoBlank,
}

impl Misfit {
    fn new(cause: MisfitCause) -> Self {
        let (path, at) = (Path::root(), At::Value);
        Self { node: std::ptr::null(), mark: None, path, at, holder: None, cause }
    }

    /// The same where a visitor has found it out, who knows no places.
    fn located(mut self, node: &Node, trail: &Trail<'_>) -> Self {
        if self.mark.is_none() {
            (self.node, self.mark, self.path) = (node, Some(node.mark), trail.path());
            if let MisfitCause::Missing { key, is_written } = &mut self.cause {
                *is_written = node.get(key).is_some();
            }
        }
        self
    }

    fn held_by(mut self, holder: Holder) -> Self {
        self.holder.get_or_insert(holder);
        self
    }
}

impl Display for Misfit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.cause)
    }
}

impl std::error::Error for Misfit {}

impl Error for Misfit {
    fn custom<T: Display>(what: T) -> Self {
        Self::new(MisfitCause::Kind { what: what.to_string(), advice: None })
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(MisfitCause::Missing { key, is_written: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::parse;
    use serde::Deserialize;

    #[derive(Debug, Default, PartialEq, Deserialize)]
    #[serde(default)]
    struct SampleMap {
        number: u8,
        text: Option<String>,
        pair: Option<[i32; 2]>,
        items: Vec<SampleItem>,
        by_number: BTreeMap<u8, bool>,
        shape: Option<SampleShape>,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    struct SampleItem {
        must: i64,
        word: SampleWord,
        #[serde(default)]
        may: f64,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum SampleWord {
        First,
        Second,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    enum SampleShape {
        #[serde(rename = "a number")]
        Number(u8),
        #[serde(rename = "a list of numbers")]
        List(Vec<u8>),
        #[serde(rename = "a map with a or b")]
        Map { a: u8 },
        #[serde(rename = "a map")]
        Other(BTreeMap<String, SampleWord>),
    }

    /// What is read of a text, and what is said about the rest.
    fn read(text: &str) -> (Option<SampleMap>, Vec<String>) {
        let (tree, mut problems) = parse(text).expect("a tree");
        let read = decode(&tree, &Path::root(), &[], &mut problems);
        (read, problems.iter().map(Problem::to_string).collect())
    }

    #[test]
    fn what_does_not_fit_is_left_out() {
        let (outer, told) = read(
            "{number: 256, text: x, pair: [1, y], by_number: {1: yes, 2: true, z: true}, more: 1,
              items: [{must: 1, word: first}, {must: [], word: thrid, may: 2}, 5, {mast: 3}]}",
        );
        let outer = outer.expect("enough to go on with");
        assert_eq!((outer.number, outer.text.as_deref(), outer.pair), (0, Some("x"), None));
        assert_eq!(outer.by_number, BTreeMap::from([(2, true)]));
        let item = |must, may| SampleItem { must, word: SampleWord::First, may };
        assert_eq!(outer.items, [item(1, 0.0), item(0, 2.0), item(0, 0.0), item(0, 0.0)]);
        let mut want = [
            "number: expected an integer from 0 to 255, found 256",
            "pair[1]: expected an integer from -2147483648 to 2147483647, found \"y\"",
            "by_number[1]: expected true or false, found \"yes\"",
            "by_number.z: expected an integer from 0 to 255, found \"z\"",
            "more: unknown key",
            "items[1].must: expected an integer, found a list",
            "items[1].word: expected `first` or `second`, found \"thrid\"",
            "items[2]: expected a map, found 5",
            "items[3].must: missing key",
            "items[3].word: missing key",
            "items[3].mast: unknown key (did you mean `must`?)",
        ];
        want.sort_unstable();
        let mut told = told;
        told.sort_unstable();
        assert_eq!(told, want);
    }

    #[test]
    fn a_shape_is_told_by_what_stands_there() {
        for (text, want) in [
            ("5", Ok(SampleShape::Number(5))),
            ("[1, 2]", Ok(SampleShape::List(vec![1, 2]))),
            ("{a: 1}", Ok(SampleShape::Map { a: 1 })),
            ("{c: second}", Ok(SampleShape::Other([("c".to_owned(), SampleWord::Second)].into()))),
            ("[1, 300]", Err("shape[1]: expected an integer from 0 to 255, found 300")),
            ("{b: 1}", Err("shape.a: missing key")),
            (
                "x",
                Err(
                    "shape: expected a number or a list of numbers or a map with a or b or a map, \
                     found \"x\"",
                ),
            ),
        ] {
            let (outer, told) = read(&format!("shape: {text}"));
            match want {
                Ok(want) => assert_eq!(outer.and_then(|it| it.shape), Some(want), "{told:?}"),
                Err(want) => assert!(told.iter().any(|it| it == want), "{told:?}"),
            }
        }
    }

    #[test]
    fn nothing_at_all() {
        assert_eq!(read("[]"), (None, vec!["expected a map, found a list".to_owned()]));
        let (tree, mut problems) = parse("later: [x]").expect("a tree");
        #[derive(Deserialize)]
        struct SampleHead {
            later: Vec<u8>,
        }
        let head: SampleHead =
            decode(&tree, &Path::root(), &["later"], &mut problems).expect("a head");
        assert!(head.later.is_empty() && problems.is_empty(), "left to be read on its own");
    }
}
