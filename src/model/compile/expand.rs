//! Folded rows unfolded: repeats and fills become one list of rows, each with its path in the file.

use crate::model::raw::{RawFill, RawRow, RawRowRepeat, RawSim, RawType};
use crate::problem::decode::{decode, named};
use crate::problem::tree::Node;
use crate::problem::{Path, Problem, bounds, is_unread};
use std::collections::BTreeMap;

/// A row as it is written, with the key it got and the place it came from.
pub(super) struct ExpandedRow {
    pub id: String,
    pub path: Path,
    pub row: RawRow,
}

/// Most rows that a model may have: the map's index is 16 bits wide.
const ROWS_MAX: usize = 60_000;

/// All rows of `file`, in the order of their keys, and the keys of those that can't be read: they are
/// problems and left out.
pub(super) fn expand(file: &Node, problems: &mut Vec<Problem>) -> (Vec<ExpandedRow>, Vec<String>) {
    let (mut entries, mut lost) = (Vec::new(), Vec::new());
    let path = Path::root().key("registers");
    for (id, path, row) in rows(file.get("registers"), &path, &mut lost, problems) {
        entries.push(ExpandedRow { id, path, row });
    }
    let path = Path::root().key("repeats");
    for (_, path, node) in named(file.get("repeats"), &path, problems) {
        let before = problems.len();
        let repeat: Option<RawRowRepeat> = decode(node, &path, &["registers"], problems);
        let is_known = problems.len() == before;
        let below = path.key("registers");
        let rows = rows(node.get("registers"), &below, &mut lost, problems);
        match repeat.filter(|_| is_known) {
            Some(repeat) => unroll(&repeat, &rows, &path, &mut entries, problems),
            None => lost.extend(rows.into_iter().map(|(id, ..)| id)),
        }
    }
    let path = Path::root().key("fill");
    for (_, path, node) in named(file.get("fill"), &path, problems) {
        let before = problems.len();
        let area: Option<RawFill> = decode(node, &path, &[], problems);
        match area {
            Some(area) if problems.len() == before => fill(&area, &path, &mut entries, problems),
            Some(area) => lost.push(area.id),
            None => {}
        }
    }
    (entries, lost)
}

/// The rows of a map. One whose address or type can't be read is lost.
fn rows(
    node: Option<&Node>,
    path: &Path,
    lost: &mut Vec<String>,
    problems: &mut Vec<Problem>,
) -> Vec<(String, Path, RawRow)> {
    let mut rows = Vec::new();
    for (id, path, node) in named(node, path, problems) {
        let before = problems.len();
        let row: Option<RawRow> = decode(node, &path, &[], problems);
        let is_lost =
            ["at", "type"].iter().any(|key| is_unread(&problems[before..], &path.key(key)));
        match row.filter(|_| !is_lost) {
            Some(row) => rows.push((id, path, row)),
            None => lost.push(id),
        }
    }
    rows
}

fn unroll(
    repeat: &RawRowRepeat,
    rows: &[(String, Path, RawRow)],
    path: &Path,
    entries: &mut Vec<ExpandedRow>,
    problems: &mut Vec<Problem>,
) {
    let [first, last] = repeat.n;
    if first > last {
        let what = format!("the range {first} to {last} is empty");
        return problems
            .push(Problem::value(path.key("n"), what).advise("give the lower number first"));
    }
    if repeat.stride == 0 && first != last {
        let what = "with a stride of 0 all copies have the same address";
        return problems.push(Problem::value(path.key("stride"), what));
    }
    let copies = usize::from(last - first) + 1;
    let size = rows.iter().map(|(.., row)| text_size(row)).sum::<usize>() * copies;
    if copies * rows.len() + entries.len() > ROWS_MAX {
        return problems.push(Problem::value(path.key("n"), "more rows than a model can have"));
    }
    if size > bounds::EXPANDED {
        let what = bounds::expanded();
        return problems.push(Problem::value(path.key("n"), what));
    }
    for (key, path, row) in rows {
        if first != last && !key.contains("{n") {
            let what = "all copies would have the same name";
            problems.push(Problem::key(path.clone(), what).advise("add {n} to the key"));
            continue;
        }
        for n in first..=last {
            let at = u32::from(row.at) + u32::from(n - first) * u32::from(repeat.stride);
            let Ok(at) = u16::try_from(at) else {
                let what = format!("copy {n} would be at 0x{at:X}, above 0xFFFF");
                problems.push(Problem::value(path.key("at"), what));
                break;
            };
            let mut row = RawRow { at, ..row.clone() };
            row.name = number(&row.name, n);
            row.zh = row.zh.map(|zh| number(&zh, n));
            row.note = row.note.map(|note| number(&note, n));
            entries.push(ExpandedRow { id: number(key, n), path: path.clone(), row });
        }
    }
}

/// Bytes of text that each copy of a row has.
fn text_size(row: &RawRow) -> usize {
    let texts = [&row.zh, &row.note, &row.assumed, &row.unit].into_iter().flatten();
    let meanings = row.values.values().chain(row.bits.values());
    let texts = texts.chain(meanings).chain([&row.name, &row.see]);
    texts.map(String::len).sum()
}

fn fill(area: &RawFill, path: &Path, entries: &mut Vec<ExpandedRow>, problems: &mut Vec<Problem>) {
    let [first, last] = area.span;
    if first > last {
        let what = format!("the range 0x{first:04X} to 0x{last:04X} is empty");
        return problems
            .push(Problem::value(path.key("span"), what).advise("give the lower number first"));
    }
    if usize::from(last - first) + entries.len() > ROWS_MAX {
        return problems.push(Problem::value(path.key("span"), "more rows than a model can have"));
    }
    let texts = [Some(&area.name), area.zh.as_ref(), Some(&area.see), area.assumed.as_ref()];
    let size = texts.into_iter().flatten().map(String::len).sum::<usize>();
    if size * (usize::from(last - first) + 1) > bounds::EXPANDED {
        let what = bounds::expanded();
        return problems.push(Problem::value(path.key("span"), what));
    }
    if !area.id.contains("{n") {
        let what = "all rows would have the same name";
        return problems.push(Problem::value(path.key("id"), what).advise("add {n} to it"));
    }
    let mut taken = vec![false; 0x1_0000];
    for ExpandedRow { row, .. } in entries.iter() {
        taken[usize::from(row.at)] = true;
        if matches!(row.kind, RawType::U32 | RawType::I32) {
            taken[usize::from(row.at.saturating_add(1))] = true;
        }
    }
    for at in (first..=last).filter(|at| !taken[usize::from(*at)]) {
        let row = RawRow {
            at,
            kind: RawType::U16,
            range: None,
            init: 0,
            unit: None,
            access: area.access,
            applies: None,
            lock: None,
            volatile: false,
            autosave: false,
            clears: false,
            word_order: None,
            name: number(&area.name, at),
            zh: area.zh.as_ref().map(|zh| number(zh, at)),
            see: area.see.clone(),
            values: BTreeMap::new(),
            bits: BTreeMap::new(),
            not_simulated: BTreeMap::new(),
            note: None,
            assumed: area.assumed.clone(),
            sim: Some(RawSim::None),
        };
        entries.push(ExpandedRow { id: number(&area.id, at), path: path.clone(), row });
    }
}

/// `text` with its placeholders replaced by `n`: `{n}`, `{n:02}`, `{n:04X}`.
pub(super) fn number(text: &str, n: u16) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, tail)) = rest.split_once("{n") {
        out.push_str(before);
        let Some((format, after)) = tail.split_once('}') else {
            out.push_str("{n");
            rest = tail;
            continue;
        };
        let digits = format.trim_start_matches(':');
        let (width, hex) = match digits.strip_suffix('X') {
            Some(width) => (width, true),
            None => (digits, false),
        };
        let width = width.parse().unwrap_or(0).min(8);
        match hex {
            true => out.push_str(&format!("{n:0width$X}")),
            false => out.push_str(&format!("{n:0width$}")),
        }
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placeholders() {
        assert_eq!(number("C04.{n:02} of {n}", 3), "C04.03 of 3");
        assert_eq!(number("x{n:04X}", 0x42A), "x042A");
        assert_eq!(number("no {number", 1), "no {number");
        assert_eq!(number("{n:x} {n:99}", 7), "7 00000007");
    }
}
