//! The compact form of a rule: `KIND`, or `KIND:KEY=VALUE,KEY=VALUE`.
//!
//! A value is written as in YAML, so a list takes brackets: `lose_reply:function=[0x06,0x10]`. What is said
//! here becomes the same tree as a map in a bench file and is checked by the same code.

use super::raw::{self, RawFault};
use super::{FaultContext, FaultSet, compile};
use crate::problem::{At, Mark, Path, Problem, Seg, section};
use serde_yaml::{Mapping, Value};
use std::collections::BTreeMap;
use std::ops::Range;

/// Reads the compact form of one rule or preset for `site`, where rules called `taken` stand already.
///
/// # Errors
/// Everything that is wrong with it, each with its place in `spec`.
pub fn parse(
    spec: &str,
    site: &dyn FaultContext,
    taken: &[&str],
) -> Result<FaultSet, Vec<Problem>> {
    let mut problems = Vec::new();
    let cut = Cut::new(spec, &mut problems);
    let path = Path::root();
    let raw: Option<RawFault> =
        section::read(&Value::Mapping(cut.tree), &path, &raw::keys(), &mut problems);
    let rules = raw.map(|raw| compile(&raw, &path, site, taken, &mut problems));
    match problems.is_empty() {
        true => Ok(rules.unwrap_or_default()),
        false => {
            let placed = problems.into_iter().map(|it| place(it, spec, &cut.places));
            Err(placed.collect())
        }
    }
}

/// A spec cut at its colons and commas.
struct Cut {
    tree: Mapping,
    /// Where each key and its value stand, in bytes.
    places: BTreeMap<String, [Range<usize>; 2]>,
}

impl Cut {
    fn new(spec: &str, problems: &mut Vec<Problem>) -> Self {
        let (kind, rest) = spec.split_once(':').unwrap_or((spec, ""));
        let mut cut = Self { tree: Mapping::new(), places: BTreeMap::new() };
        cut.put("do", kind, spec, Value::String(kind.trim().into()));
        for item in items(rest) {
            let Some((key, value)) = item.split_once('=') else {
                let mark = Some(mark(spec, &place_of(spec, item)));
                let what = format!("`{}` has no value", item.trim());
                let problem = Problem::value(Path::root(), what).advise("write KEY=VALUE");
                problems.push(Problem { mark, ..problem });
                continue;
            };
            let key = key.trim();
            if cut.places.contains_key(key) {
                let mark = Some(mark(spec, &place_of(spec, key)));
                let problem = Problem::key(Path::root().key(key), "duplicate key");
                problems.push(Problem { mark, ..problem });
                continue;
            }
            let as_yaml = serde_yaml::from_str(value).ok().filter(|it: &Value| !it.is_null());
            let read = as_yaml.unwrap_or_else(|| Value::String(value.trim().into()));
            cut.put(key, value, spec, read);
        }
        cut
    }

    fn put(&mut self, key: &str, value: &str, spec: &str, read: Value) {
        // The kind stands without its key.
        let of_key = if key == "do" { value } else { key };
        let places = [of_key, value.trim()].map(|part| place_of(spec, part));
        self.places.insert(key.to_owned(), places);
        self.tree.insert(Value::String(key.to_owned()), read);
    }
}

/// What stands between commas; those in brackets are part of a list.
fn items(rest: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    let items = rest.split(move |c| {
        depth += i32::from(c == '[') - i32::from(c == ']');
        c == ',' && depth <= 0
    });
    items.filter(move |_| !rest.is_empty())
}

/// Where `part`, a slice of `spec`, stands in it.
fn place_of(spec: &str, part: &str) -> Range<usize> {
    let start = (part.as_ptr() as usize).saturating_sub(spec.as_ptr() as usize).min(spec.len());
    start..(start + part.len()).min(spec.len())
}

fn place(problem: Problem, spec: &str, places: &BTreeMap<String, [Range<usize>; 2]>) -> Problem {
    if problem.mark.is_some() {
        return problem;
    }
    let key = problem.path.segs().iter().find_map(|seg| match seg {
        Seg::Key(key) => Some(key.as_str()),
        Seg::Index(_) => None,
    });
    // A key that is missing: the kind asks for it.
    let found = key.and_then(|key| places.get(key)).or_else(|| places.get("do"));
    let place = found.map(|[key, value]| if problem.at == At::Key { key } else { value });
    let mark = place.map(|place| mark(spec, place));
    Problem { mark, ..problem }
}

fn mark(spec: &str, place: &Range<usize>) -> Mark {
    let count = |part: &str| part.chars().count();
    let length = count(&spec[place.clone()]).max(1);
    Mark { line: 1, column: count(&spec[..place.start]) + 1, length }
}
