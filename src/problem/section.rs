//! From a YAML tree to raw structs, section by section, so that one bad section hides no other.

mod words;

use super::place::Places;
use super::{At, Mark, Path, Problem, Seg, suggest};
use serde::de::DeserializeOwned;
use serde_yaml::Value;

/// Reads `text` as a tree, and finds everything that makes it a tree to be careful with.
///
/// # Errors
/// Everything that is wrong with the text as such, if there is no going on with it.
pub fn tree(text: &str) -> Result<(Value, Vec<Problem>), Vec<Problem>> {
    let (places, problems) = Places::parse(text);
    let readable = places.find(&Path::root(), At::Value).is_some();
    if !readable && problems.is_empty() {
        return Err(vec![Problem::value(Path::root(), "the file is empty")]);
    }
    if !readable || problems.iter().any(|problem| problem.path.is_root()) {
        return Err(problems);
    }
    match serde_yaml::from_str(text) {
        Ok(tree) => Ok((tree, problems)),
        // A second key of the same name stops the reader too; the places have told of it.
        Err(_) if !problems.is_empty() => Err(problems),
        Err(error) => {
            let mark = error.location();
            let mark = mark.map(|it| Mark { line: it.line(), column: it.column(), length: 1 });
            Err(vec![Problem { mark, ..words::problem(Path::root(), &error.to_string()) }])
        }
    }
}

/// Reads the value at `path` as a `T`. Unknown keys are problems, all of them, with advice out of the
/// keys of the format, `known`; of wrong types and missing keys serde tells the first.
pub fn read<T: DeserializeOwned>(
    value: &Value,
    path: &Path,
    known: &[&str],
    problems: &mut Vec<Problem>,
) -> Option<T> {
    let mut track = serde_path_to_error::Track::new();
    let tracked = serde_path_to_error::Deserializer::new(value, &mut track);
    let mut unknown = Vec::new();
    let result = serde_ignored::deserialize(tracked, |ignored| unknown.push(of_ignored(&ignored)));
    for tail in unknown {
        let advice = match tail.segs().last() {
            // Known, but not here: that can't be what was meant.
            Some(Seg::Key(key)) => {
                suggest::did_you_mean(key, known.iter().copied().filter(|known| known != key))
            }
            _ => None,
        };
        problems.push(Problem::key(path.join(&tail), "unknown key").advise_if(advice));
    }
    match result {
        Ok(read) => Some(read),
        Err(error) => {
            let path = path.join(&of_tracked(&track.path()));
            problems.push(words::problem(path, &error.to_string()));
            None
        }
    }
}

/// The entries of a map with their paths, to be read one by one.
pub fn entries<'a>(
    value: Option<&'a Value>,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Vec<(String, Path, &'a Value)> {
    let Some(value) = value else { return Vec::new() };
    let Value::Mapping(map) = value else {
        problems.push(Problem::value(path.clone(), "expected a map of names"));
        return Vec::new();
    };
    let entry = |(key, value): (&'a Value, &'a Value)| {
        let key = scalar_text(key)?;
        Some((key.clone(), path.key(&key), value))
    };
    map.iter().filter_map(entry).collect()
}

/// A scalar as a path spells it: integers in decimal.
fn scalar_text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        Value::Bool(truth) => Some(truth.to_string()),
        _ => None,
    }
}

fn of_ignored(path: &serde_ignored::Path<'_>) -> Path {
    use serde_ignored::Path as Ignored;
    match path {
        Ignored::Root => Path::root(),
        Ignored::Seq { parent, index } => of_ignored(parent).index(*index),
        Ignored::Map { parent, key } => of_ignored(parent).key(key),
        Ignored::Some { parent }
        | Ignored::NewtypeStruct { parent }
        | Ignored::NewtypeVariant { parent } => of_ignored(parent),
    }
}

fn of_tracked(path: &serde_path_to_error::Path) -> Path {
    use serde_path_to_error::Segment;
    path.iter().fold(Path::root(), |path, segment| match segment {
        Segment::Seq { index } => path.index(*index),
        Segment::Map { key } => path.key(key),
        Segment::Enum { .. } | Segment::Unknown => path,
    })
}
