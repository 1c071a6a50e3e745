//! From a text to its tree, by one walk over the parser's marked events with an explicit stack.
//!
//! Deliberately without recursion: the depth of a file is the author's choice, our stack is not. What is YAML and yet
//! can't be used (equal keys, anchors, tags, a second document, too much of anything) is refused here.

use super::bounds::{self, DEPTH};
use super::place::Lines;
use super::tree::{Content, MapEntry, Node};
use super::{Mark, Path, Problem, syntax};
use crate::text::is_control;
use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span, Tag};
use serde_yaml::Number;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Keys whose texts may have several lines; names have one.
const PROSE: [&str; 4] = ["about", "assumed", "note", "why"];

/// The tree of `text`, and what in it can't be used.
///
/// # Errors
/// Everything that is wrong with the text, where it gives no tree: it is no YAML, empty, or beyond a bound.
pub fn parse(text: &str) -> Result<(Node, Vec<Problem>), Vec<Problem>> {
    if text.len() > bounds::SIZE {
        let start = Mark { line: 1, column: 1, length: 1 };
        return Err(vec![too_long("a file", bounds::SIZE, "bytes", start)]);
    }
    let lines = Lines::new(text);
    let mut walk = Walk { lines, root: None, stack: vec![], values: 0, problems: vec![] };
    match walk.run(text) {
        Ok(()) => {}
        Err(last) => {
            walk.problems.push(last);
            return Err(walk.problems);
        }
    }
    match walk.root {
        Some(root) if walk.problems.len() < bounds::PROBLEMS => Ok((root, walk.problems)),
        _ if walk.problems.is_empty() => {
            Err(vec![Problem::value(Path::root(), "the file is empty")])
        }
        _ => Err(walk.problems),
    }
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
        entries: Vec<MapEntry>,
        /// A key whose value has not come yet; one that is no scalar has no name.
        pending: Option<(Option<MapEntry>, Mark)>,
        /// The position of each key, by name.
        seen: BTreeMap<String, usize>,
    },
    List(Vec<Node>),
}

impl Walk<'_> {
    /// Walks to the end, or to the problem that ends it.
    fn run(&mut self, text: &str) -> Result<(), Problem> {
        let mut documents = 0;
        let mut parser = Parser::new_from_str(text);
        while let Some(event) = parser.next_event() {
            match event {
                Ok((Event::DocumentStart(_), span)) => {
                    documents += 1;
                    if documents > 1 {
                        let what = "only one document is allowed, and a second begins here";
                        return Err(Problem::value(Path::root(), what).marked(self.span_mark(span)));
                    }
                }
                Ok((event, span)) => self.event(event, span)?,
                Err(error) => return Err(self.error(&error)),
            }
            if self.problems.len() >= bounds::PROBLEMS {
                break;
            }
        }
        Ok(())
    }

    fn event(&mut self, event: Event<'_>, span: Span) -> Result<(), Problem> {
        match event {
            Event::Scalar(text, style, anchor, tag) => {
                let mark = self.scalar_mark(&text, style, span);
                if let Some((what, most)) = self.excess(&text) {
                    return Err(too_long(what, most, "characters", mark));
                }
                self.count(mark)?;
                self.refuse_anchor(anchor, mark);
                self.refuse_control(&text, mark);
                let plain = style == ScalarStyle::Plain;
                let content = match self.is_text(plain, tag.as_deref(), mark) {
                    true => Content::Text(text.to_string()),
                    false => self.resolve(&text, mark),
                };
                self.add(Node { content, mark }, Some(text.into_owned()));
            }
            Event::Alias(anchor) => {
                let mark = self.span_mark(span);
                self.refuse_anchor(anchor, mark);
                self.add(Node { content: Content::Null, mark }, None);
            }
            Event::MappingStart(anchor, tag) => {
                let (entries, pending, seen) = (vec![], None, BTreeMap::new());
                self.open(anchor, tag.as_deref(), span, Inside::Map { entries, pending, seen })?;
            }
            Event::SequenceStart(anchor, tag) => {
                self.open(anchor, tag.as_deref(), span, Inside::List(vec![]))?;
            }
            Event::MappingEnd | Event::SequenceEnd => self.close(span),
            _ => {}
        }
        Ok(())
    }

    /// What the scalar `text` is if it is too long for that, and how long that may be.
    fn excess(&self, text: &str) -> Option<(&'static str, usize)> {
        let (what, most) = match self.next_is_key() {
            true => ("a key", bounds::KEY),
            false => ("a string", bounds::TEXT),
        };
        // Bytes are counted in no time, and are no fewer than characters.
        (text.len() > most && text.chars().count() > most).then_some((what, most))
    }

    fn next_is_key(&self) -> bool {
        let inside = self.stack.last().map(|frame| &frame.inside);
        matches!(inside, Some(Inside::Map { pending: None, .. }))
    }

    fn count(&mut self, mark: Mark) -> Result<(), Problem> {
        self.values += 1;
        match self.values > bounds::VALUES {
            true => Err(too_long("a file", bounds::VALUES, "values", mark)),
            false => Ok(()),
        }
    }

    /// Is a scalar a text, whatever it looks like?
    fn is_text(&mut self, plain: bool, tag: Option<&Tag>, mark: Mark) -> bool {
        match tag {
            None => !plain,
            Some(tag) if tag.is_yaml_core_schema() => tag.suffix == "str",
            // `! 17` says nothing but that.
            Some(tag) if tag.suffix == "!" || tag.suffix.is_empty() => true,
            Some(_) => {
                self.refuse_tag(mark);
                !plain
            }
        }
    }

    /// What a scalar without quotes is.
    fn resolve(&mut self, text: &str, mark: Mark) -> Content {
        match text {
            "" | "~" | "null" | "Null" | "NULL" => Content::Null,
            "true" | "True" | "TRUE" => Content::Bool(true),
            "false" | "False" | "FALSE" => Content::Bool(false),
            _ => match text.parse::<Number>() {
                Ok(number) => Content::Number(number),
                Err(_)
                    if !self.next_is_key()
                        && text.parse::<f64>().is_ok_and(f64::is_finite)
                        && text.len() > 18 =>
                {
                    let what = "the number has too many digits";
                    let problem = Problem::value(self.here(), what).marked(mark);
                    self.problems.push(problem.unread());
                    Content::Null
                }
                Err(_) => Content::Text(text.to_owned()),
            },
        }
    }

    fn open(
        &mut self,
        anchor: usize,
        tag: Option<&Tag>,
        span: Span,
        inside: Inside,
    ) -> Result<(), Problem> {
        let mark = self.lines.mark(span.start.line(), span.start.col() + 1, 1);
        self.refuse_anchor(anchor, mark);
        if tag.is_some_and(|tag| !tag.is_yaml_core_schema()) {
            self.refuse_tag(mark);
        }
        self.count(mark)?;
        if self.stack.len() == DEPTH {
            return Err(too_deep(self.here(), mark));
        }
        self.stack.push(WalkFrame { path: self.here(), span, owner: self.owner(), inside });
        Ok(())
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
            (None, Inside::Map { entries, .. }) if !entries.is_empty() => entries[0].key.mark,
            _ => self.lines.mark(line, start, 1),
        };
        let content = match frame.inside {
            Inside::Map { entries, .. } => Content::Map(entries),
            Inside::List(items) => Content::List(items),
        };
        self.add(Node { content, mark }, None);
    }

    /// Puts a finished node where it belongs; `written` is how a scalar is spelt.
    fn add(&mut self, node: Node, written: Option<String>) {
        let Some(WalkFrame { path, inside, .. }) = self.stack.last_mut() else {
            self.root = Some(node);
            return;
        };
        let (entries, pending, seen) = match inside {
            Inside::List(items) => return items.push(node),
            Inside::Map { entries, pending, seen } => (entries, pending, seen),
        };
        match pending.take() {
            Some((Some(entry), _)) => {
                let name = entry.name().into_owned();
                // Of equal keys the first counts.
                if let Entry::Vacant(free) = seen.entry(name) {
                    free.insert(entries.len());
                    entries.push(MapEntry { value: node, ..entry });
                }
            }
            Some((None, _)) => {}
            None => {
                let mark = node.mark;
                let value = Node { content: Content::Null, mark };
                let entry = written.map(|written| MapEntry { key: node, written, value });
                self.problems.extend(match &entry {
                    None => {
                        let what = "a key must be a string or a number";
                        Some(Problem::value(path.clone(), what).marked(mark))
                    }
                    Some(entry) => {
                        let first = seen.get(&*entry.name()).map(|i| &entries[*i]);
                        first.map(|first| twice(entry, first, path))
                    }
                });
                *pending = Some((entry, mark));
            }
        }
    }

    /// The path of the node that comes next.
    fn here(&self) -> Path {
        let Some(WalkFrame { path, inside, .. }) = self.stack.last() else { return Path::root() };
        match inside {
            Inside::List(items) => path.index(items.len()),
            Inside::Map { pending: Some((Some(entry), _)), .. } => path.key(entry.name()),
            Inside::Map { .. } => path.clone(),
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

    /// Followed, it could fill any memory, and paths could not tell its two places apart.
    fn refuse_anchor(&mut self, anchor: usize, mark: Mark) {
        if anchor != 0 {
            let problem = anchored(self.here(), mark);
            self.problems.push(problem);
        }
    }

    fn refuse_tag(&mut self, mark: Mark) {
        let problem = Problem::value(self.here(), "tags are not supported").marked(mark);
        self.problems.push(problem.advise("remove it; a string that begins with `!` needs quotes"));
    }

    /// A text that would disturb a log or a terminal.
    fn refuse_control(&mut self, text: &str, mark: Mark) {
        if !text.chars().any(is_control) {
            return;
        }
        let path = self.here();
        let last = path.segs().last();
        let is_prose = matches!(last, Some(super::Seg::Key(key)) if PROSE.contains(&key.as_str()));
        let is_bad = |c: &char| is_control(*c) && !(is_prose && matches!(c, '\n' | '\t'));
        let Some(bad) = text.chars().find(is_bad) else { return };
        let what = match bad {
            '\n' => "line breaks are not allowed here".to_owned(),
            c => format!("the character U+{:04X} is not allowed here", u32::from(c)),
        };
        let problem = Problem::value(path, what).advise("remove it").marked(mark);
        self.problems.push(if self.next_is_key() { problem } else { problem.unread() });
    }

    fn error(&mut self, error: &ScanError) -> Problem {
        let mark = self.lines.mark(error.marker().line(), error.marker().col() + 1, 1);
        match error.info() {
            // The parser looks ahead, so its own limit on brackets may come before ours.
            "recursion limit exceeded" => too_deep(self.here(), mark),
            info if info.contains("unknown anchor") => anchored(self.here(), mark),
            info => {
                // The text is not what it seems; what was found in its first half may not hold.
                self.problems.clear();
                syntax::problem(info, mark)
            }
        }
    }
}

fn anchored(path: Path, mark: Mark) -> Problem {
    let advice = "write out the value; a string that begins with `&` or `*` needs quotes";
    let problem = Problem::value(path, "anchors and aliases are not supported").advise(advice);
    problem.marked(mark).unread()
}

fn too_deep(path: Path, mark: Mark) -> Problem {
    Problem::value(path, format!("nested deeper than {DEPTH} levels")).marked(mark)
}

/// A file, or something in it, beyond a bound.
fn too_long(what: &str, most: usize, unit: &str, mark: Mark) -> Problem {
    Problem::value(Path::root(), bounds::length(what, most, unit)).marked(mark)
}

/// A key that is there already.
fn twice(entry: &MapEntry, first: &MapEntry, path: &Path) -> Problem {
    let spelling = match first.written == entry.written {
        true => String::new(),
        false => format!(" as `{}`", first.written),
    };
    let advice = format!("first used in line {}{spelling}", first.key.mark.line);
    let what = format!("duplicate key `{}`", entry.written);
    Problem::key(path.key(entry.name()), what).advise(advice).marked(entry.key.mark)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn told(text: &str) -> Vec<Problem> {
        parse(text).map_or_else(|problems| problems, |(_, problems)| problems)
    }

    /// `line:column+length problem`, one a line.
    fn problems(text: &str) -> String {
        let show = |p: &Problem| {
            let Mark { line, column, length } = p.mark.unwrap();
            format!("{line}:{column}+{length} {p}\n")
        };
        told(text).iter().map(show).collect()
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
        ] {
            assert_eq!(problems(text), want, "{text:?}");
        }
    }

    #[test]
    fn depth_has_a_bottom() {
        let fits = "[".repeat(DEPTH) + &"]".repeat(DEPTH);
        assert_eq!(problems(&fits), "");
        let stairs: String = (0..999).map(|i| " ".repeat(i) + "a:\n").collect();
        for text in ["[".repeat(65), "[".repeat(100_000), "- ".repeat(100_000), stairs] {
            let problems = parse(&text).expect_err("too deep");
            assert_eq!(problems.len(), 1);
            assert_eq!(problems[0].what, "nested deeper than 64 levels");
        }
    }

    /// Every mark that any path can lead to.
    fn marks(node: &Node, into: &mut Vec<Mark>) {
        into.push(node.mark);
        node.items().iter().for_each(|node| marks(node, into));
        for entry in node.entries() {
            into.push(entry.key.mark);
            marks(&entry.value, into);
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
            let mut all: Vec<Mark> = told(&text).iter().filter_map(|it| it.mark).collect();
            parse(&text).iter().for_each(|(root, _)| marks(root, &mut all));
            let lines = Lines::new(&text);
            for Mark { line, column, length } in all {
                let end = lines.text(line).map(|text| text.chars().count());
                prop_assert!(column >= 1 && length >= 1, "{line}:{column}+{length}");
                prop_assert!(end.is_some_and(|end| column <= end + 1), "{line}:{column}");
            }
        }
    }
}
