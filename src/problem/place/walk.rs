//! From the parser's marked events to a tree of marks, with an explicit stack.
//!
//! Deliberately without recursion: the depth of a file is the author's choice, our stack is not.

use super::lines::Lines;
use super::refuse::{self, SeenKeys};
use super::{Mark, Node, NodeEntry, NodeKind, Path, Problem, YamlKey, syntax};
use crate::problem::bounds;
use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span};

/// The tree of `text`, as far as it is one, and what is wrong with it.
pub(super) fn walk(text: &str) -> (Option<Node>, Vec<Problem>) {
    if text.len() > bounds::SIZE {
        let start = Mark { line: 1, column: 1, length: 1 };
        return (None, vec![refuse::length("a file", bounds::SIZE, "bytes", start)]);
    }
    let lines = Lines::new(text);
    let mut walk = Walk { lines, root: None, stack: vec![], values: 0, problems: vec![] };
    let mut documents = 0;
    let mut parser = Parser::new_from_str(text);
    while let Some(event) = parser.next_event() {
        let going = match event {
            Ok((Event::DocumentStart(_), span)) => {
                documents += 1;
                documents == 1 || walk.end(refuse::document(walk.span_mark(span)))
            }
            Ok((event, span)) => walk.event(event, span),
            Err(error) => walk.error(&error),
        };
        if !going || walk.problems.len() >= bounds::PROBLEMS {
            break;
        }
    }
    (walk.root, walk.problems)
}

struct Walk<'t> {
    lines: Lines<'t>,
    root: Option<Node>,
    /// The collections that are open, outermost first.
    stack: Vec<WalkFrame>,
    /// Scalars, maps and lists so far.
    values: usize,
    problems: Vec<Problem>,
}

struct WalkFrame {
    path: Path,
    span: Span,
    /// The key that this collection is the value of.
    owner: Option<Mark>,
    inside: Inside,
}

enum Inside {
    Map {
        entries: Vec<NodeEntry>,
        /// A key whose value has not come yet.
        pending: Option<(YamlKey, Mark)>,
        seen: SeenKeys,
    },
    List(Vec<Node>),
}

impl Walk<'_> {
    /// Takes one event; `false` ends the walk.
    fn event(&mut self, event: Event<'_>, span: Span) -> bool {
        match event {
            Event::Scalar(text, style, anchor, tag) => {
                let mark = self.scalar_mark(&text, style, span);
                if let Some((what, most)) = self.too_long(&text) {
                    return self.end(refuse::length(what, most, "characters", mark));
                }
                if self.is_one_too_many() {
                    return self.end(refuse::length("a file", bounds::VALUES, "values", mark));
                }
                self.refuse_anchor(anchor, mark);
                self.problems.extend(refuse::text(&text, &self.here(), mark));
                let plain = style == ScalarStyle::Plain && tag.is_none();
                self.add(
                    Node { mark, kind: NodeKind::Leaf },
                    YamlKey::new(text.into_owned(), plain),
                );
            }
            Event::Alias(anchor) => {
                let mark = self.span_mark(span);
                self.refuse_anchor(anchor, mark);
                self.add(Node { mark, kind: NodeKind::Leaf }, YamlKey::Collection);
            }
            Event::MappingStart(anchor, _) => {
                let (entries, pending, seen) = (vec![], None, SeenKeys::new());
                return self.open(anchor, span, Inside::Map { entries, pending, seen });
            }
            Event::SequenceStart(anchor, _) => {
                return self.open(anchor, span, Inside::List(vec![]));
            }
            Event::MappingEnd | Event::SequenceEnd => self.close(span),
            _ => {}
        }
        true
    }

    /// What the scalar `text` is if it is too long for that, and how long that may be.
    fn too_long(&self, text: &str) -> Option<(&'static str, usize)> {
        let is_key = matches!(
            self.stack.last().map(|frame| &frame.inside),
            Some(Inside::Map { pending: None, .. })
        );
        let (what, most) = if is_key { ("a key", bounds::KEY) } else { ("a string", bounds::TEXT) };
        // Bytes are counted in no time, and are no fewer than characters.
        (text.len() > most && text.chars().count() > most).then_some((what, most))
    }

    fn is_one_too_many(&mut self) -> bool {
        self.values += 1;
        self.values > bounds::VALUES
    }

    fn open(&mut self, anchor: usize, span: Span, inside: Inside) -> bool {
        let mark = self.lines.mark(span.start.line(), span.start.col() + 1, 1);
        self.refuse_anchor(anchor, mark);
        if self.is_one_too_many() {
            return self.end(refuse::length("a file", bounds::VALUES, "values", mark));
        }
        if self.stack.len() == bounds::DEPTH {
            return self.end(refuse::depth(self.here(), mark));
        }
        self.stack.push(WalkFrame { path: self.here(), span, owner: self.owner(), inside });
        true
    }

    fn close(&mut self, end: Span) {
        let Some(frame) = self.stack.pop() else { return };
        // Only brackets have a width; block collections begin and end between two characters.
        let flow = !frame.span.is_empty() && !end.is_empty();
        let (start, line) = (frame.span.start.col() + 1, frame.span.start.line());
        let mark = match (frame.owner, &frame.inside) {
            // Not the end of `end`: that takes in the blanks and the comment behind the bracket.
            _ if flow && end.start.line() == line => {
                self.lines.mark(line, start, (end.start.col() + 2).saturating_sub(start))
            }
            _ if flow => self.lines.mark(line, start, usize::MAX),
            (Some(owner), _) => owner,
            (None, Inside::Map { entries, .. }) if !entries.is_empty() => entries[0].mark,
            _ => self.lines.mark(line, start, 1),
        };
        let kind = match frame.inside {
            Inside::Map { entries, .. } => NodeKind::Map(entries),
            Inside::List(items) => NodeKind::List(items),
        };
        self.add(Node { mark, kind }, YamlKey::Collection);
    }

    /// Puts a finished node where it belongs; `key` is what it would be as a map key.
    fn add(&mut self, node: Node, key: YamlKey) {
        let Some(WalkFrame { path, inside, .. }) = self.stack.last_mut() else {
            self.root = Some(node);
            return;
        };
        match inside {
            Inside::List(items) => items.push(node),
            Inside::Map { entries, pending, seen } => match pending.take() {
                Some((key, mark)) => entries.push(NodeEntry { key, mark, value: node }),
                None => {
                    self.problems.extend(refuse::key(&key, path, node.mark, seen));
                    *pending = Some((key, node.mark));
                }
            },
        }
    }

    /// The path of the node that comes next.
    fn here(&self) -> Path {
        match self.stack.last() {
            None => Path::root(),
            Some(WalkFrame { path, inside: Inside::List(items), .. }) => path.index(items.len()),
            Some(WalkFrame { path, inside: Inside::Map { pending, .. }, .. }) => match pending {
                Some((YamlKey::Scalar { name, .. }, _)) => path.key(name),
                _ => path.clone(),
            },
        }
    }

    /// The key whose value comes next.
    fn owner(&self) -> Option<Mark> {
        match &self.stack.last()?.inside {
            Inside::Map { pending, .. } => pending.as_ref().map(|(_, mark)| *mark),
            Inside::List(_) => None,
        }
    }

    fn scalar_mark(&self, text: &str, style: ScalarStyle, span: Span) -> Mark {
        let quoted = matches!(style, ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted);
        match self.owner() {
            // Nothing was written there to put a caret under.
            Some(owner) if text.is_empty() && !quoted => owner,
            _ => self.span_mark(span),
        }
    }

    fn span_mark(&self, Span { start, end }: Span) -> Mark {
        let length = match start.line() == end.line() {
            true => end.col().saturating_sub(start.col()),
            false => usize::MAX,
        };
        self.lines.mark(start.line(), start.col() + 1, length)
    }

    fn refuse_anchor(&mut self, anchor: usize, mark: Mark) {
        if anchor != 0 {
            self.problems.push(refuse::anchor(self.here(), mark));
        }
    }

    fn end(&mut self, last: Problem) -> bool {
        self.problems.push(last);
        false
    }

    fn error(&mut self, error: &ScanError) -> bool {
        let mark = self.lines.mark(error.marker().line(), error.marker().col() + 1, 1);
        match error.info() {
            // The parser looks ahead, so its own limit on brackets may come before ours.
            "recursion limit exceeded" => self.end(refuse::depth(self.here(), mark)),
            info if info.contains("unknown anchor") => self.end(refuse::anchor(self.here(), mark)),
            info => {
                // The text is not what it seems; what was found in its first half may not hold.
                self.problems.clear();
                self.root = None;
                self.end(syntax::problem(info, mark))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Places;
    use super::*;
    use proptest::prelude::*;

    /// Every mark that any path can lead to.
    fn marks(node: &Node, into: &mut Vec<Mark>) {
        into.push(node.mark);
        match &node.kind {
            NodeKind::Leaf => {}
            NodeKind::List(items) => items.iter().for_each(|node| marks(node, into)),
            NodeKind::Map(entries) => entries.iter().for_each(|entry| {
                into.push(entry.mark);
                marks(&entry.value, into);
            }),
        }
    }

    proptest! {
        #[test]
        fn any_text_is_survived_and_marks_lie_inside(
            text in prop_oneof![
                any::<String>(),
                proptest::collection::vec(prop::sample::select(vec![
                    "a", "b: ", "17: ", "0x11: ", ":", " ", "\n", "\n  ", "- ", "[", "]", "{", "}",
                    ",", ", ", "'", "\"", "|\n", ">\n", "# c", "&x ", "*x", "!t ", "---\n", "...\n",
                    "? ", "\t", "\r", "\r\n", "\u{feff}", "中", "\u{301}", "\\", "%YAML 1.2\n",
                ]), 0..24).prop_map(|parts| parts.concat()),
            ]
        ) {
            let (places, problems) = Places::parse(&text);
            let mut all: Vec<Mark> = problems.iter().map(|p| p.mark.unwrap()).collect();
            places.root.iter().for_each(|root| marks(root, &mut all));
            let lines = Lines::new(&text);
            for Mark { line, column, length } in all {
                let end = lines.text(line).map(|text| text.chars().count());
                prop_assert!(column >= 1 && length >= 1, "{line}:{column}+{length}");
                prop_assert!(end.is_some_and(|end| column <= end + 1), "{line}:{column}");
            }
        }
    }
}
