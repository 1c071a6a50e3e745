//! Problems as text for people: what is wrong, file, line and column, and the line itself with the culprit marked.
//!
//! Deliberately without colours: one plain text that a test compares caret for caret and that editors know how to
//! jump to.

use super::place::Lines;
use super::{Mark, Problem, bounds};
use crate::text::{is_control, one_line};
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use std::fmt::Write as _;

/// Columns of a line; what is longer is cut around the mark.
const WIDTH: usize = 110;

/// Characters of a line that the renderer sees, about.
const LONG: usize = 1000;

/// Prints every problem in the order of the file, those without any place last, with an empty line between two.
///
/// `file` is the name as the reader of the output knows it, `text` what stands in the file. No line ends with a
/// space.
pub fn render(problems: &[Problem], file: &str, text: &str) -> String {
    let lines = Lines::new(text);
    let mut sorted: Vec<&Problem> = problems.iter().collect();
    sorted.sort_by_key(|it| (it.mark.is_none(), it.mark));
    // Nobody reads thousands.
    let (told, more) = sorted.split_at(sorted.len().min(bounds::TOLD));
    let file = one_line(file);
    let mut out = told.iter().map(|it| one(it, &file, &lines)).collect::<Vec<_>>().join("\n");
    if !more.is_empty() {
        let _ = writeln!(out, "\n{file}: and {} more problems", more.len());
    }
    out
}

fn one(problem: &Problem, file: &str, lines: &Lines<'_>) -> String {
    let place = problem.mark.and_then(|mark| Some((mark, lines.text(mark.line)?)));
    let mut head = Problem { advice: None, ..problem.clone() };
    if place.is_none() {
        head.advice.clone_from(&problem.advice);
    }
    let head = head.to_string();
    let title = Level::ERROR.primary_title(one_line(&head));
    let report = match place {
        None => Group::with_title(title).element(Origin::path(file)),
        Some((mark, line)) => {
            let label = problem.advice.as_deref().map(one_line);
            let (line, span) = shown(line, mark);
            let marked = AnnotationKind::Primary.span(span).label(label);
            let snippet = Snippet::source(line).line_start(mark.line).annotation(marked);
            // Of a line without its beginning the renderer does not know the column.
            match mark.column > LONG {
                true => {
                    let place = Origin::path(file).line(mark.line).char_column(mark.column);
                    Group::with_title(title).element(place).element(snippet)
                }
                false => Group::with_title(title).element(snippet.path(file)),
            }
        }
    };
    let told = Renderer::plain().term_width(WIDTH).render(&[report]);
    told.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// What of a line is shown, and the bytes of it that are marked. Each character that would move the cursor or turn
/// the direction is replaced. Behind the end of a line is a place too: something is missing there.
fn shown(line: &str, mark: Mark) -> (String, std::ops::Range<usize>) {
    let start = mark.column.saturating_sub(1);
    // The renderer cuts lines to size, but takes its time with one as long as a file.
    let from = if mark.column > LONG { start - LONG / 2 } else { 0 };
    let mut text = String::from(if from > 0 { "..." } else { "" });
    let mut marked = None;
    let mut chars = line.trim_end().chars().skip(from);
    for column in from..start.saturating_add(LONG) {
        if column == start {
            marked = Some(text.len());
        }
        let Some(c) = chars.next() else { break };
        text.push(if is_control(c) && c != '\t' { '\u{FFFD}' } else { c });
    }
    let first = marked.unwrap_or(text.len());
    let length: usize = text[first..].chars().take(mark.length).map(char::len_utf8).sum();
    if chars.next().is_some() {
        text.push_str("...");
    }
    (text, first..first + length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{At, Path};
    use proptest::prelude::*;

    fn marked(line: usize, column: usize, length: usize, what: &str) -> Problem {
        Problem::value(Path::root().key("a"), what).marked(Mark { line, column, length })
    }

    #[test]
    fn prints_in_file_order() {
        let text = "model: {vendor: Acme}\nzh: {名: 点动速度}\n";
        let problems = [
            Problem::value(Path::root().key("nothing"), "no place").advise("none at all"),
            marked(2, 9, 4, "not\nASCII").advise("write Latin letters"),
            marked(1, 9, 6, "unknown"),
            marked(9, 1, 1, "beyond the end"),
        ];
        assert_eq!(
            render(&problems, "m.yaml", text),
            "\
error: a: unknown
 --> m.yaml:1:9
  |
1 | model: {vendor: Acme}
  |         ^^^^^^

error: a: not\\nASCII
 --> m.yaml:2:9
  |
2 | zh: {名: 点动速度}
  |          ^^^^^^^^ write Latin letters

error: a: beyond the end
--> m.yaml

error: nothing: no place (none at all)
--> m.yaml
"
        );
    }

    /// Each character of a line, and the place behind the last, as it is shown below the line.
    #[test]
    fn what_moves_the_cursor_is_replaced() {
        let told = render(&[marked(1, 4, 3, "x")], "f", "a: \u{1b}[2\u{202e}J");
        assert!(told.contains("1 | a: \u{FFFD}[2\u{FFFD}J\n  |    ^^^\n"), "{told}");
        let told = render(&[marked(1, 3, 1, "x")], "f", "[a");
        assert!(told.contains("1 | [a\n  |   ^\n"), "{told}");
        assert!(render(&[marked(1, 1, 1, "x")], "a\u{1b}b", "c").contains("a\\u{1b}b:1:1"));
    }

    #[test]
    fn long_lines_keep_what_is_marked() {
        let line = "word ".repeat(100) + "culprit " + &"more ".repeat(100);
        let told = render(&[marked(1, 501, 7, "x").advise("advice")], "f", &line);
        let [shown, carets] = [3, 4].map(|i| told.lines().nth(i).expect("a line"));
        let [from, to] = [carets.find('^'), carets.rfind('^')].map(|it| it.expect("a caret"));
        assert_eq!(&shown[from..=to], "culprit");
        assert!(shown.len() <= WIDTH + 20, "{shown}");
    }

    proptest! {
        #[test]
        fn any_mark_on_any_text_prints(
            text in prop_oneof![any::<String>(), "[a中\u{301}\t ,:\r\n]{0,300}"],
            line in 0..9usize, column in 0..400usize, length in 0..400usize,
            what in any::<String>(),
        ) {
            let problems = [
                marked(line, column, length, &what).advise(what.clone()),
                Problem { mark: None, at: At::Key, ..Problem::key(Path::root().key("b"), "x") },
            ];
            let out = render(&problems, "f", &text);
            prop_assert!(out.lines().all(|line| line.trim_end() == line), "{out:?}");
        }
    }
}
