//! The compact form of a rule: `KIND`, or `KIND:KEY=VALUE,KEY=VALUE`.
//!
//! A value is written as in YAML, so a list takes brackets: `lose_reply:function=[0x06,0x10]`. What is said
//! here becomes the same tree as a map in a bench file and is checked by the same code.

use crate::problem::tree::{Content, MapEntry, Node};
use crate::problem::{Mark, Path, Problem, parse as parse_yaml};

/// The map that a spec stands for, cut at its colons and commas. What has no place of its own is marked at the kind.
pub(super) fn cut(spec: &str, problems: &mut Vec<Problem>) -> Node {
    let (kind, rest) = spec.split_once(':').unwrap_or((spec, ""));
    let mark = mark_of(spec, kind.trim());
    let text = |text: &str, mark| Node { content: Content::Text(text.to_owned()), mark };
    let entry = |key: &str, of_key, value| MapEntry {
        key: text(key, of_key),
        written: key.to_owned(),
        value,
    };
    let mut entries = vec![entry("do", mark, text(kind.trim(), mark))];
    for item in items(rest) {
        let Some((key, value)) = item.split_once('=') else {
            let what = format!("`{}` has no value", item.trim());
            let problem = Problem::value(Path::root(), what).advise("write KEY=VALUE");
            problems.push(problem.marked(mark_of(spec, item)));
            continue;
        };
        let (key, value) = (key.trim(), value.trim());
        let of_key = mark_of(spec, key);
        if entries.iter().any(|it| it.written == key) {
            let problem = Problem::key(Path::root().key(key), "duplicate key");
            problems.push(problem.marked(of_key));
            continue;
        }
        let of_value = mark_of(spec, value);
        let read = parse_yaml(value).ok().filter(|(node, _)| node.content != Content::Null);
        let read = read.map(|(node, more)| {
            problems.extend(more.into_iter().map(|it| of_key_in(it, key).marked(of_value)));
            shifted(node, of_value.column - 1)
        });
        entries.push(entry(key, of_key, read.unwrap_or_else(|| text(value, of_value))));
    }
    Node { content: Content::Map(entries), mark }
}

/// What is wrong with a value, told of its key.
fn of_key_in(problem: Problem, key: &str) -> Problem {
    Problem { path: Path::root().key(key).join(&problem.path), ..problem }
}

/// The same value, so many columns to the right.
fn shifted(mut node: Node, columns: usize) -> Node {
    node.mark = Mark { column: node.mark.column + columns, ..node.mark };
    node.content = match node.content {
        Content::List(items) => {
            Content::List(items.into_iter().map(|it| shifted(it, columns)).collect())
        }
        Content::Map(entries) => {
            let entry = |it: MapEntry| MapEntry {
                key: shifted(it.key, columns),
                value: shifted(it.value, columns),
                ..it
            };
            Content::Map(entries.into_iter().map(entry).collect())
        }
        other => other,
    };
    node
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
fn mark_of(spec: &str, part: &str) -> Mark {
    let start = (part.as_ptr() as usize).saturating_sub(spec.as_ptr() as usize).min(spec.len());
    let column = spec.get(..start).map_or(0, |before| before.chars().count()) + 1;
    Mark { line: 1, column, length: part.chars().count().max(1) }
}
