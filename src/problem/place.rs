//! Where every key and value of one YAML text stands: path in, line and column out.
//!
//! Deliberately not a reader: it keeps no values and knows no types; `serde` reads the same text on
//! its own. It does refuse what the reader lets pass or would follow blindly (equal keys, anchors,
//! a second document, bottomless nesting), because only here these things still have a place.

mod key;
pub(super) mod lines;
mod refuse;
mod syntax;
mod walk;

use super::{At, Mark, Path, Problem, Seg};
use key::YamlKey;

/// The marks of all keys and values of one document.
#[derive(Debug, Default)]
pub struct Places {
    root: Option<Node>,
}

impl Places {
    /// Walks `text`. A text that is not YAML gives exactly one problem and no places.
    ///
    /// The other problems are equal keys of one map, anchors and aliases, nesting deeper than
    /// 64 levels and a second document. Each carries its own mark.
    pub fn parse(text: &str) -> (Self, Vec<Problem>) {
        let (root, problems) = walk::walk(text);
        (Self { root }, problems)
    }

    /// The mark of the key that ends `path`, or of the value there.
    ///
    /// An item of a list has no key, so both are the item. A block map or list that belongs to a
    /// key is marked at that key, since its text is many lines; so is a value that was left out.
    /// Equal keys: the first.
    pub fn find(&self, path: &Path, at: At) -> Option<Mark> {
        let (spot, arrived) = self.descend(path)?;
        arrived.then(|| spot.mark(at))
    }

    /// Like [`find`](Self::find); if the path leads nowhere, the key of its deepest ancestor that
    /// exists. `None` only for a text without any node.
    pub fn find_nearest(&self, path: &Path, at: At) -> Option<Mark> {
        let (spot, arrived) = self.descend(path)?;
        Some(spot.mark(if arrived { at } else { At::Key }))
    }

    /// As far along `path` as the text goes, and whether that is all of it.
    fn descend(&self, path: &Path) -> Option<(Spot<'_>, bool)> {
        let root = self.root.as_ref()?;
        let mut spot = Spot { key: root.mark, node: root };
        for seg in path.segs() {
            match spot.node.child(seg) {
                Some(child) => spot = child,
                None => return Some((spot, false)),
            }
        }
        Some((spot, true))
    }
}

struct Spot<'a> {
    key: Mark,
    node: &'a Node,
}

impl Spot<'_> {
    fn mark(&self, at: At) -> Mark {
        match at {
            At::Key => self.key,
            At::Value => self.node.mark,
        }
    }
}

#[derive(Debug)]
struct Node {
    mark: Mark,
    kind: NodeKind,
}

#[derive(Debug)]
enum NodeKind {
    Leaf,
    Map(Vec<NodeEntry>),
    List(Vec<Node>),
}

#[derive(Debug)]
struct NodeEntry {
    key: YamlKey,
    mark: Mark,
    value: Node,
}

impl Node {
    fn child(&self, seg: &Seg) -> Option<Spot<'_>> {
        match (&self.kind, seg) {
            (NodeKind::Map(entries), Seg::Key(key)) => {
                let entry = entries.iter().find(|entry| entry.key.is(key))?;
                Some(Spot { key: entry.mark, node: &entry.value })
            }
            (NodeKind::List(items), Seg::Index(index)) => {
                let node = items.get(*index)?;
                Some(Spot { key: node.mark, node })
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let (places, problems) = Places::parse(TEXT);
        assert_eq!(problems, []);
        for (at, key, value) in table {
            assert_eq!(under(TEXT, places.find(&path(at), At::Key)), key, "key of {at:?}");
            assert_eq!(under(TEXT, places.find(&path(at), At::Value)), value, "value of {at:?}");
        }
    }

    #[test]
    fn falls_back_to_the_deepest_ancestor() {
        let (places, _) = Places::parse(TEXT);
        for (at, want) in [
            ("axes.A.jog", "5:C06.04"),
            ("axes.A.nowhere.x", "4:A"),
            ("axes.A.jog.deeper", "5:jog"),
            ("model.series.#9", "2:series"),
            ("nowhere", "2:model"),
        ] {
            assert_eq!(under(TEXT, places.find_nearest(&path(at), At::Value)), want, "{at:?}");
        }
        assert_eq!(Places::parse("").0.find_nearest(&Path::root(), At::Value), None);
        assert_eq!(Places::parse("# only\n").0.find(&Path::root(), At::Value), None);
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
            assert_eq!(Places::parse(text).0.find(&path(at), At::Value), want, "{text:?}");
        }
    }
}
