//! Where things stand: paths through a tree, marks in a text, and how a path finds its mark.
//!
//! A character is a character here, however wide it prints.

use super::tree::Node;
use super::{At, Mark};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

/// One step of a [`Path`].
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Seg {
    /// Into a map, by key. Integer keys stand here in decimal, whatever base the file uses.
    Key(String),
    /// Into a list, by position from 0.
    Index(usize),
}

/// A path from the root of a file to one of its nodes.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Path(Vec<Seg>);

impl Path {
    /// The root.
    pub fn root() -> Self {
        Self::default()
    }

    /// Is this the root?
    pub fn is_root(&self) -> bool {
        self.0.is_empty()
    }

    /// The steps, outermost first.
    pub fn segs(&self) -> &[Seg] {
        &self.0
    }

    /// The path of the entry `key` below this one.
    #[must_use]
    pub fn key(&self, key: impl fmt::Display) -> Self {
        let mut segs = self.0.clone();
        segs.push(Seg::Key(key.to_string()));
        Self(segs)
    }

    /// The path of item `index` below this one.
    #[must_use]
    pub fn index(&self, index: usize) -> Self {
        let mut segs = self.0.clone();
        segs.push(Seg::Index(index));
        Self(segs)
    }

    /// This path with `tail` behind it.
    #[must_use]
    pub fn join(&self, tail: &Path) -> Self {
        Self(self.0.iter().chain(&tail.0).cloned().collect())
    }

    /// Is this `above`, or somewhere below it?
    pub fn starts_with(&self, above: &Path) -> bool {
        self.0.starts_with(&above.0)
    }

    /// The path of the node above, or `None` at the root.
    pub fn parent(&self) -> Option<Self> {
        let (_, above) = self.0.split_last()?;
        Some(Self(above.to_vec()))
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, seg) in self.0.iter().enumerate() {
            match seg {
                Seg::Key(key) if is_plain(key) && i == 0 => write!(f, "{key}")?,
                Seg::Key(key) if is_plain(key) => write!(f, ".{key}")?,
                Seg::Key(key) => write!(f, "[{key}]")?,
                Seg::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

fn is_plain(key: &str) -> bool {
    key.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'))
}

/// The lines of one text, without their ends and without a byte order mark.
pub(super) struct Lines<'t> {
    lines: Vec<TextLine<'t>>,
    /// The last line with text on it, from 1.
    last: usize,
}

struct TextLine<'t> {
    text: &'t str,
    /// Characters up to the last one that is not blank; counted once, as every mark asks for it.
    length: usize,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = Vec::new();
        let mut rest = text;
        // Not `str::lines`: for YAML a lone carriage return ends a line as well.
        while let Some(end) = rest.find(['\r', '\n']) {
            lines.push(TextLine::new(&rest[..end]));
            let width = if rest[end..].starts_with("\r\n") { 2 } else { 1 };
            rest = &rest[end + width..];
        }
        lines.push(TextLine::new(rest));
        let last = lines.iter().rposition(|line| line.length > 0).map_or(1, |i| i + 1);
        Self { lines, last }
    }

    /// The text of a line, counted from 1.
    pub(super) fn text(&self, line: usize) -> Option<&'t str> {
        Some(self.lines.get(line.checked_sub(1)?)?.text)
    }

    /// A mark of `length` characters, or up to the end of the line if that comes first.
    ///
    /// Behind all text it moves to the end of the last line that has any: there is nothing to see
    /// on the empty lines where the parser notices that a bracket was never closed.
    pub(super) fn mark(&self, line: usize, column: usize, length: usize) -> Mark {
        if line > self.last {
            return Mark { line: self.last, column: self.length(self.last) + 1, length: 1 };
        }
        let rest = (self.length(line) + 1).saturating_sub(column);
        Mark { line, column, length: length.min(rest).max(1) }
    }

    fn length(&self, line: usize) -> usize {
        line.checked_sub(1).and_then(|i| self.lines.get(i)).map_or(0, |line| line.length)
    }
}

impl<'t> TextLine<'t> {
    fn new(text: &'t str) -> Self {
        Self { text, length: text.trim_end().chars().count() }
    }
}

/// Looks places up, many of them in one tree.
pub struct Places<'a> {
    root: &'a Node,
    /// The positions of the keys of large maps, by name; of each the address stands for it.
    large: BTreeMap<*const Node, BTreeMap<Cow<'a, str>, usize>>,
}

/// From so many entries on, looking through them one by one takes longer than an index.
const LARGE: usize = 32;

impl<'a> Places<'a> {
    /// The places of a tree.
    pub fn new(root: &'a Node) -> Self {
        Self { root, large: BTreeMap::new() }
    }

    /// The mark of the key that ends `path`, or of the value there. An item of a list has no key, so both are the
    /// item.
    pub fn find(&mut self, path: &Path, at: At) -> Option<Mark> {
        let (mark, arrived) = self.descend(path, at);
        arrived.then_some(mark)
    }

    /// The same; if the path leads nowhere, the key of its deepest ancestor that exists.
    pub fn find_nearest(&mut self, path: &Path, at: At) -> Mark {
        self.descend(path, at).0
    }

    /// As far along `path` as the tree goes, and whether that is all of it.
    fn descend(&mut self, path: &Path, at: At) -> (Mark, bool) {
        let (mut key, mut node) = (self.root.mark, self.root);
        for seg in path.segs() {
            match self.child(node, seg) {
                Some((mark, child)) => (key, node) = (mark, child),
                None => return (key, false),
            }
        }
        (if at == At::Key { key } else { node.mark }, true)
    }

    fn child(&mut self, node: &'a Node, seg: &Seg) -> Option<(Mark, &'a Node)> {
        let key = match seg {
            Seg::Key(key) => key,
            Seg::Index(index) => {
                return node.items().get(*index).map(|item| (item.mark, item));
            }
        };
        let entries = node.entries();
        let entry = if entries.len() < LARGE {
            entries.iter().find(|entry| entry.is(key))
        } else {
            let index = self.large.entry(node).or_insert_with(|| {
                // A name counts before another key's spelling.
                let spellings =
                    entries.iter().enumerate().map(|(i, it)| (it.written.as_str().into(), i));
                let names = entries.iter().enumerate().map(|(i, it)| (it.name(), i));
                spellings.chain(names).collect()
            });
            index.get(key.as_str()).map(|i| &entries[*i])
        };
        entry.map(|entry| (entry.key.mark, &entry.value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::parse;

    #[test]
    fn cuts_where_yaml_cuts() {
        let lines = Lines::new("\u{feff}a\r\nb\rc\n\nd\u{2028}e");
        let all: Vec<_> = (0..8).map(|i| lines.text(i)).collect();
        let some = ["a", "b", "c", "", "d\u{2028}e"].map(Some);
        assert_eq!(all[1..6], some);
        assert_eq!((all[0], all[6]), (None, None));
    }

    #[test]
    fn marks_stay_inside() {
        let lines = Lines::new("中文字  \nab\n\n");
        let mark = |line, column, length| Mark { line, column, length };
        assert_eq!(lines.mark(1, 2, 9), mark(1, 2, 2));
        assert_eq!(lines.mark(2, 1, 1), mark(2, 1, 1));
        assert_eq!(lines.mark(2, 9, 9), mark(2, 9, 1));
        assert_eq!(lines.mark(2, 3, 1), mark(2, 3, 1));
        assert_eq!(lines.mark(4, 1, 1), mark(2, 3, 1));
        assert_eq!(lines.mark(99, 7, 7), mark(2, 3, 1));
        assert_eq!(Lines::new("").mark(1, 1, 1), mark(1, 1, 1));
    }

    /// `list.#2.key`, as no key of these tests holds a dot.
    fn path(text: &str) -> Path {
        text.split('.').filter(|seg| !seg.is_empty()).fold(Path::root(), |path, seg| {
            match seg.strip_prefix('#') {
                Some(index) => path.index(index.parse().unwrap()),
                None => path.key(seg),
            }
        })
    }

    /// The text under the mark, so that a table reads without counting columns.
    fn under(text: &str, mark: Option<Mark>) -> String {
        let Some(mark) = mark else { return "nothing".into() };
        let line = text.lines().nth(mark.line - 1).unwrap();
        let word: String = line.chars().skip(mark.column - 1).take(mark.length).collect();
        format!("{}:{}", mark.line, word)
    }

    const TEXT: &str = "\
# a comment
model: {vendor: Acme, name: S1, zh: 伺服, series: [一, two, 3]}   # behind
axes:
  A:
    jog: C06.04
    空: \"quo ted\"
    left_out:
    next:
    - one
    - k: v
      w: >-
        text
        more
  0x11: [1,
    2]
list:
  - - deep
  -
    far: off
  - [a: b]
  -
long: plain words
  go on
tagged: !!str 17
";

    #[test]
    fn finds_keys_and_values() {
        #[rustfmt::skip]
        let table = [
            ("", "2:model", "2:model"),
            ("model", "2:model", "2:{vendor: Acme, name: S1, zh: 伺服, series: [一, two, 3]}"),
            ("model.vendor", "2:vendor", "2:Acme"),
            ("model.zh", "2:zh", "2:伺服"),
            ("model.series", "2:series", "2:[一, two, 3]"),
            ("model.series.#1", "2:two", "2:two"),
            ("axes", "3:axes", "3:axes"),
            ("axes.A", "4:A", "4:A"),
            ("axes.A.jog", "5:jog", "5:C06.04"),
            ("axes.A.空", "6:空", "6:\"quo ted\""),
            ("axes.A.left_out", "7:left_out", "7:left_out"),
            ("axes.A.next", "8:next", "8:next"),
            ("axes.A.next.#0", "9:one", "9:one"),
            ("axes.A.next.#1", "10:k", "10:k"),
            ("axes.A.next.#1.k", "10:k", "10:v"),
            ("axes.A.next.#1.w", "11:w", "12:text"),
            ("axes.17", "14:0x11", "14:[1,"),
            ("axes.0x11", "14:0x11", "14:[1,"),
            ("axes.17.#1", "15:2", "15:2"),
            ("list.#0", "17:-", "17:-"),
            ("list.#0.#0", "17:deep", "17:deep"),
            ("list.#1", "19:far", "19:far"),
            ("list.#2", "20:[a: b]", "20:[a: b]"),
            ("list.#2.#0", "20:a", "20:a"),
            ("list.#2.#0.a", "20:a", "20:b"),
            ("list.#3", "21:", "21:"),
            ("long", "22:long", "22:plain words"),
            ("tagged", "24:tagged", "24:!!str 17"),
            ("axes.B", "nothing", "nothing"),
            ("model.#0", "nothing", "nothing"),
            ("list.0", "nothing", "nothing"),
            ("axes.A.jog.deeper", "nothing", "nothing"),
        ];
        let (tree, problems) = parse(TEXT).unwrap();
        assert_eq!(problems, []);
        let mut places = Places::new(&tree);
        for (at, key, value) in table {
            assert_eq!(under(TEXT, places.find(&path(at), At::Key)), key, "key of {at:?}");
            assert_eq!(under(TEXT, places.find(&path(at), At::Value)), value, "value of {at:?}");
        }
    }

    #[test]
    fn falls_back_to_the_deepest_ancestor() {
        let (tree, _) = parse(TEXT).unwrap();
        let mut places = Places::new(&tree);
        for (at, want) in [
            ("axes.A.jog", "5:C06.04"),
            ("axes.A.nowhere.x", "4:A"),
            ("axes.A.jog.deeper", "5:jog"),
            ("model.series.#9", "2:series"),
            ("nowhere", "2:model"),
        ] {
            assert_eq!(
                under(TEXT, Some(places.find_nearest(&path(at), At::Value))),
                want,
                "{at:?}"
            );
        }
    }

    #[test]
    fn columns_count_characters_from_one() {
        let mark = |line, column, length| Some(Mark { line, column, length });
        for (text, at, want) in [
            ("a: b", "a", mark(1, 4, 1)),
            ("中文: {字: 值, x: two}", "中文.x", mark(1, 15, 3)),
            ("{'一二': \"三\", x: 🙂}", "x", mark(1, 16, 1)),
            ("# 注释\r\na: b\r\nc: dd\r\n", "c", mark(3, 4, 2)),
            ("\u{feff}a: b", "a", mark(1, 4, 1)),
            ("---\na: b\n...\n", "a", mark(2, 4, 1)),
        ] {
            let (tree, _) = parse(text).unwrap();
            assert_eq!(Places::new(&tree).find(&path(at), At::Value), want, "{text:?}");
        }
    }

    #[test]
    fn reads_like_the_file() {
        let path = Path::root().key("axis").key("quantities").key("jog.speed");
        assert_eq!(path.to_string(), "axis.quantities[jog.speed]");
        assert_eq!(Path::root().key("line").key("refuse").index(2).to_string(), "line.refuse[2]");
    }
}
