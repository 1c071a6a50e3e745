//! Compiles rows and windows into a [`Map`], and finds what is wrong with them.

use super::expand::ExpandedRow;
use crate::model::raw::{
    RawAccess, RawApplies, RawLayer, RawLock, RawOrder, RawRange, RawRow, RawType, RawWindow,
};
use crate::model::row::span_text;
use crate::model::{Access, Applies, Layer, Map, RegisterOrder, Row, RowId, RowKind, Window};
use crate::problem::{Path, Problem, suggest};
use crate::units::Unit;
use std::collections::BTreeMap;

/// Rows by address with the path that each came from.
pub(super) struct Rows {
    pub map: Map,
    pub paths: Vec<Path>,
    /// Names of rows that were left out, each for a problem of its own; with `{n}` in those of copies.
    lost: Vec<String>,
}

impl Rows {
    /// The row called `id`, or a problem at `path` with advice.
    pub fn find(&self, id: &str, path: &Path, problems: &mut Vec<Problem>) -> Option<RowId> {
        let found = self.map.rows().find(|(_, row)| row.id == id);
        if let Some((id, _)) = found {
            return Some(id);
        }
        // What is wrong with that row was told.
        if self.lost.iter().any(|lost| is_one_of(id, lost)) {
            return None;
        }
        let ids = self.map.rows().map(|(_, row)| row.id.as_str());
        let advice = suggest::nearest(id, ids).and_then(|near| {
            let (_, row) = self.map.rows().find(|(_, row)| row.id == near)?;
            Some(format!("did you mean {} ({})?", row.id, row.name))
        });
        let what = format!("unknown register `{id}`");
        problems.push(Problem::value(path.clone(), what).advise_if(advice));
        None
    }
}

/// Is `id` the name `lost`, or that of one of its copies?
fn is_one_of(id: &str, lost: &str) -> bool {
    let Some((before, rest)) = lost.split_once("{n") else { return id == lost };
    let after = rest.split_once('}').map_or("", |(_, after)| after);
    id.starts_with(before) && id.ends_with(after)
}

pub(super) fn compile(
    entries: Vec<ExpandedRow>,
    mut lost: Vec<String>,
    windows: &BTreeMap<String, RawWindow>,
    problems: &mut Vec<Problem>,
) -> Rows {
    let mut entries = without_overlaps(entries, &mut lost, problems);
    entries.sort_by_key(|entry| entry.row.at);
    let paths = entries.iter().map(|entry| entry.path.clone()).collect();
    let rows: Vec<Row> = entries.iter().map(|entry| row(entry, problems)).collect();
    let windows = compile_windows(windows, problems);
    whole_pairs(&rows, &windows, problems);
    autosaves(&entries, &windows, problems);
    Rows { map: Map::new(rows, windows), paths, lost }
}

/// Leaves out rows whose addresses or names others have taken: one problem each.
fn without_overlaps(
    entries: Vec<ExpandedRow>,
    lost: &mut Vec<String>,
    problems: &mut Vec<Problem>,
) -> Vec<ExpandedRow> {
    let mut owner: BTreeMap<u16, String> = BTreeMap::new();
    let mut names: BTreeMap<String, u16> = BTreeMap::new();
    entries
        .into_iter()
        .filter(|ExpandedRow { id, path, row }| {
            let words = kind(row.kind).words();
            let last = row.at.checked_add(words - 1);
            let taken =
                (row.at..=last.unwrap_or(row.at)).find_map(|at| Some((at, owner.get(&at)?)));
            let clash = match (last, taken) {
                (None, _) => Some(format!("the pair at 0x{:04X} has no second address", row.at)),
                (_, Some((at, owner))) => {
                    Some(format!("address 0x{at:04X} is already used by {owner}"))
                }
                _ => None,
            };
            if let Some(what) = clash {
                problems.push(Problem::value(path.key("at"), what));
                lost.push(id.clone());
                return false;
            }
            if let Some(at) = names.insert(id.clone(), row.at) {
                let what = format!("duplicate name `{id}`, already used by the row at 0x{at:04X}");
                problems.push(Problem::key(path.clone(), what));
                return false;
            }
            owner.extend((row.at..=last.unwrap_or(row.at)).map(|at| (at, id.clone())));
            true
        })
        .collect()
}

fn row(ExpandedRow { id, path, row: raw }: &ExpandedRow, problems: &mut Vec<Problem>) -> Row {
    let kind = kind(raw.kind);
    let listed = raw.range.is_none() && !raw.values.is_empty() && raw.access != RawAccess::R;
    let spans = match listed {
        true => one_by_one(raw.values.keys().copied()),
        false => spans(&raw.range, kind, path, problems),
    };
    let in_range = spans.iter().any(|(low, high)| (*low..=*high).contains(&raw.init));
    let (low, high) = kind.limits();
    if !(low..=high).contains(&raw.init) {
        let what = format!("{} does not fit the type, {low}..{high}", raw.init);
        problems.push(Problem::value(path.key("init"), what));
    } else if !in_range {
        let kind = if listed { "values" } else { "range" };
        let what = format!("init {} is outside the {kind} {}", raw.init, span_text(&spans));
        let advice = match raw.init {
            0 if listed => "give an init that is listed; the default is 0",
            _ if listed => "give an init that is listed, or a `range`",
            0 => "give an init within the range; the default is 0",
            _ => "give an init within the range, or widen it",
        };
        problems.push(Problem::value(path.key("init"), what).advise(advice));
    }
    let unit = raw.unit.as_deref().map_or(Some(Unit::NONE), Unit::parse);
    if unit.is_none() {
        let text = raw.unit.as_deref().unwrap_or_default();
        let symbols: Vec<_> = Unit::symbols().collect();
        let symbol = text.rsplit(' ').next().unwrap_or(text);
        let advice = match Unit::parse(symbol) {
            Some(_) => "a factor must be a number above 0 followed by a space: `0.1 rpm`".into(),
            None => suggest::did_you_mean(symbol, Unit::symbols()).unwrap_or_else(|| {
                format!("known: {}; each may have a factor in front", symbols.join(", "))
            }),
        };
        let what = format!("unknown unit `{text}`");
        problems.push(Problem::value(path.key("unit"), what).advise(advice));
    }
    reject_keys_without_effect(raw, kind, path, problems);
    reject_values_never_held(raw, kind, &spans, path, problems);
    for bit in raw.bits.keys().filter(|bit| u16::from(**bit) >= 16 * kind.words()) {
        let what = format!("the row has no bit {bit}");
        problems.push(Problem::key(path.key("bits").key(bit), what));
    }
    for digit in raw.not_simulated.keys().filter(|digit| u16::from(**digit) >= 4 * kind.words()) {
        let what = format!("the row has no hex digit {digit}");
        problems.push(Problem::key(path.key("not_simulated").key(digit), what));
    }
    Row {
        id: id.clone(),
        at: raw.at,
        kind,
        spans,
        listed,
        init: kind.raw(raw.init),
        unit: unit.unwrap_or(Unit::NONE),
        unit_text: raw.unit.clone().unwrap_or_default(),
        access: match raw.access {
            RawAccess::R => Access::Read,
            RawAccess::W => Access::Write,
            RawAccess::Rw => Access::Both,
        },
        applies: raw.applies.map(|it| match it {
            RawApplies::Now => Applies::Now,
            RawApplies::AtStop => Applies::AtStop,
            RawApplies::PowerOn => Applies::PowerOn,
        }),
        locked_while_enabled: raw.lock == Some(RawLock::Enabled),
        // What is 0 again once it has acted has nothing to keep.
        volatile: raw.volatile || raw.clears,
        autosave: raw.autosave,
        clears: raw.clears,
        order: raw.word_order.map(order),
        name: raw.name.clone(),
        zh: raw.zh.clone().unwrap_or_default(),
        see: raw.see.clone(),
        values: raw.values.clone(),
        bits: raw.bits.clone(),
        not_simulated: raw.not_simulated.clone(),
        note: raw.note.clone().unwrap_or_default(),
        assumed: raw.assumed.clone().unwrap_or_default(),
        inert: raw.sim.is_some(),
    }
}

/// A key that could change nothing on this row is a mistake, not a decoration.
fn reject_keys_without_effect(
    raw: &RawRow,
    kind: RowKind,
    path: &Path,
    problems: &mut Vec<Problem>,
) {
    let mut reject = |key: &str, why: &str| {
        let what = format!("`{key}` has no effect on {why}");
        problems.push(Problem::key(path.key(key), what).advise("remove it"));
    };
    if raw.access == RawAccess::R {
        let of_writes = [
            ("lock", raw.lock.is_some()),
            ("clears", raw.clears),
            ("volatile", raw.volatile),
            ("autosave", raw.autosave),
            ("not_simulated", !raw.not_simulated.is_empty()),
        ];
        for (key, _) in of_writes.into_iter().filter(|(_, set)| *set) {
            reject(key, "a read-only row");
        }
    }
    if raw.access != RawAccess::R && raw.clears && raw.volatile {
        reject("volatile", "a row that `clears`");
    }
    if (raw.volatile || raw.clears) && raw.autosave {
        reject("autosave", "a volatile row");
    }
    if raw.word_order.is_some() && kind.words() == 1 {
        reject("word_order", "a 16-bit row");
    }
}

/// A value with a meaning that no write may carry is a slip of the list or of the range.
fn reject_values_never_held(
    raw: &RawRow,
    kind: RowKind,
    spans: &[(i64, i64)],
    path: &Path,
    problems: &mut Vec<Problem>,
) {
    let (low, high) = kind.limits();
    for value in raw.values.keys() {
        let what = if !(low..=high).contains(value) {
            format!("{value} does not fit the type, {low}..{high}")
        } else if !spans.iter().any(|(low, high)| (low..=high).contains(&value)) {
            format!("{value} is outside the range {}", span_text(spans))
        } else {
            continue;
        };
        let problem = Problem::key(path.key("values").key(value), what);
        problems.push(problem.advise("widen the range, or remove the value"));
    }
}

/// Spans that hold the listed values and nothing between them; `values` ascend.
fn one_by_one(values: impl Iterator<Item = i64>) -> Vec<(i64, i64)> {
    let mut spans: Vec<(i64, i64)> = Vec::new();
    for value in values {
        match spans.last_mut().filter(|(_, high)| high.checked_add(1) == Some(value)) {
            Some((_, high)) => *high = value,
            None => spans.push((value, value)),
        }
    }
    spans
}

fn spans(
    range: &Option<RawRange>,
    kind: RowKind,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Vec<(i64, i64)> {
    let limits = kind.limits();
    let path = path.key("range");
    let pairs: Vec<(Path, [i64; 2])> = match range {
        None => return vec![limits],
        Some(RawRange::One(pair)) => vec![(path, *pair)],
        Some(RawRange::Many(pairs)) => {
            pairs.iter().enumerate().map(|(i, pair)| (path.index(i), *pair)).collect()
        }
    };
    let mut spans = Vec::new();
    for (path, [low, high]) in pairs {
        if low > high {
            let what = format!("the range {low} to {high} is empty");
            problems.push(Problem::value(path, what).advise("give the lower value first"));
            continue;
        }
        if low < limits.0 || high > limits.1 {
            let what = format!("{low}..{high} does not fit the type, {}..{}", limits.0, limits.1);
            problems.push(Problem::value(path, what));
        }
        spans.push((low, high));
    }
    if spans.is_empty() { vec![limits] } else { spans }
}

/// A window shows a pair whole or not at all.
fn whole_pairs(rows: &[Row], windows: &[Window], problems: &mut Vec<Problem>) {
    for window in windows {
        let shows = |at| (window.span.0..=window.span.1).contains(&at);
        if let Some(row) = rows.iter().find(|row| shows(row.at) != shows(row.last())) {
            let path = Path::root().key("windows").key(&window.name).key("span");
            let what = format!("the span splits the pair {}", row.id);
            problems.push(Problem::value(path, what).advise("move its end by one"));
        }
    }
}

/// Where every window saves what it writes, no row needs to.
fn autosaves(entries: &[ExpandedRow], windows: &[Window], problems: &mut Vec<Problem>) {
    let mut told: Vec<&Path> = Vec::new();
    for ExpandedRow { path, row, .. } in entries.iter().filter(|entry| entry.row.autosave) {
        let saves = |window: &Window| {
            window.layer == Layer::RamAndStore || !(window.span.0..=window.span.1).contains(&row.at)
        };
        if windows.iter().all(saves) && !told.contains(&path) {
            told.push(path);
            let what = "`autosave` has no effect where every write is stored";
            problems.push(Problem::key(path.key("autosave"), what).advise("remove it"));
        }
    }
}

fn compile_windows(
    windows: &BTreeMap<String, RawWindow>,
    problems: &mut Vec<Problem>,
) -> Vec<Window> {
    if windows.is_empty() {
        let name = "ram".into();
        return vec![Window { name, base: 0, span: (0, 0xFFFF), layer: Layer::Ram }];
    }
    let mut compiled: Vec<Window> = Vec::new();
    for (name, raw) in windows {
        let path = Path::root().key("windows").key(name);
        let [first, last] = raw.span.unwrap_or([0, 0xFFFF - raw.base]);
        if first > last || last > 0xFFFF - raw.base {
            let what = format!("with base 0x{:04X} the span extends beyond 0xFFFF", raw.base);
            let what = if first > last { "the span is empty".into() } else { what };
            problems.push(Problem::value(path.key("span"), what));
            continue;
        }
        let layer = match raw.writes.as_slice() {
            [RawLayer::Ram] => Layer::Ram,
            [RawLayer::Ram, RawLayer::Store] | [RawLayer::Store, RawLayer::Ram] => {
                Layer::RamAndStore
            }
            _ => {
                let what = "`writes` must be [ram] or [ram, store]";
                problems.push(Problem::value(path.key("writes"), what));
                continue;
            }
        };
        let window = Window { name: name.clone(), base: raw.base, span: (first, last), layer };
        let reach = |w: &Window| (w.base + w.span.0)..=(w.base + w.span.1);
        let clash = compiled.iter().find(|other| {
            let (mine, theirs) = (reach(&window), reach(other));
            mine.start() <= theirs.end() && theirs.start() <= mine.end()
        });
        if let Some(other) = clash {
            let what = format!("overlaps window `{}`", other.name);
            let advice = "narrow the span of one of them";
            problems.push(Problem::key(path, what).advise(advice));
            continue;
        }
        compiled.push(window);
    }
    compiled
}

fn kind(raw: RawType) -> RowKind {
    match raw {
        RawType::U16 => RowKind::U16,
        RawType::I16 => RowKind::I16,
        RawType::U32 => RowKind::U32,
        RawType::I32 => RowKind::I32,
    }
}

pub(super) fn order(raw: RawOrder) -> RegisterOrder {
    match raw {
        RawOrder::HighWordFirst => RegisterOrder::HighFirst,
        RawOrder::LowWordFirst => RegisterOrder::LowFirst,
    }
}
