//! Problems as text for people: file, line, column, the line itself and carets under the culprit.
//!
//! Deliberately without colours and without a choice of formats: one plain text that a test
//! compares caret for caret and that editors know how to jump to.

mod strip;

use super::place::Places;
use super::place::lines::Lines;
use super::{Mark, Path, Problem, Seg, bounds};
use crate::text::is_control;
use std::fmt::Write as _;

/// Prints every problem in the order of the file, those without any place last.
///
/// `file` is the name as the reader of the output knows it, `text` what stands in the file. Each
/// problem takes three lines; each line ends with a line feed and none with a space.
pub fn render(problems: &[Problem], file: &str, text: &str) -> String {
    let (places, _) = Places::parse(text);
    let lines = Lines::new(text);
    // To look for the places of many takes more time than anybody has who reads them.
    let (told, more) = problems.split_at(problems.len().min(bounds::TOLD));
    let mut placed: Vec<_> = told.iter().map(|p| (locate(p, &places), p)).collect();
    placed.sort_by_key(|(mark, _)| (mark.is_none(), *mark));
    let mut out = String::new();
    for (mark, problem) in placed {
        match mark.and_then(|mark| Some((mark, lines.text(mark.line)?))) {
            Some((mark, line)) => with_line(&mut out, file, problem, mark, line),
            None => push_line(&mut out, &format!("{file}: {problem}")),
        }
    }
    if !more.is_empty() {
        push_line(&mut out, &format!("{file}: and {} more problems", more.len()));
    }
    out
}

/// Where a problem stands: at its own mark, at its path or at the nearest thing above that exists.
///
/// A path into an option's choice (`options.NAME.choices.CHOICE.line.unit`) may mean something that
/// the fragment does not touch itself; then it stands where the file without the option has it.
pub fn locate(problem: &Problem, places: &Places) -> Option<Mark> {
    let Problem { path, at, mark, .. } = problem;
    (*mark)
        .or_else(|| places.find(path, *at))
        .or_else(|| places.find(&behind_choice(path)?, *at))
        .or_else(|| places.find_nearest(path, *at))
}

/// The path inside the fragment, if this is one.
fn behind_choice(path: &Path) -> Option<Path> {
    let [Seg::Key(options), Seg::Key(_), Seg::Key(choices), Seg::Key(_), tail @ ..] = path.segs()
    else {
        return None;
    };
    if options != "options" || choices != "choices" || tail.is_empty() {
        return None;
    }
    Some(tail.iter().fold(Path::root(), |path, seg| match seg {
        Seg::Key(key) => path.key(key),
        Seg::Index(index) => path.index(*index),
    }))
}

fn with_line(out: &mut String, file: &str, problem: &Problem, mark: Mark, line: &str) {
    let Mark { line: number, column, .. } = mark;
    // The advice goes behind the carets, not into the head.
    let head = Problem { advice: None, ..problem.clone() };
    push_line(out, &format!("{file}:{number}:{column}: {head}"));
    let strip = strip::strip(line, mark);
    push_line(out, &format!("   | {}", strip.text));
    let mut carets = format!(
        "   | {:indent$}{:^<length$}",
        "",
        "",
        indent = strip.indent,
        length = strip.length
    );
    if let Some(advice) = &problem.advice {
        let _ = write!(carets, " {advice}");
    }
    push_line(out, &carets);
}

/// Keeps it one line: a key or a message of the reader may hold line feeds.
fn push_line(out: &mut String, line: &str) {
    let line: String = line.chars().map(|c| if is_control(c) { ' ' } else { c }).collect();
    out.push_str(line.trim_end());
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::At;
    use proptest::prelude::*;

    const FILE: &str = "\
model: {vendor: Acme}
line:
  functions: [0x03, 0x06]
options:
  crc_error:
    default: silent
    choices:
      exception: {line: {crc_error: 0x01}}
axes:
  A:
    quantities: {jog.speed: C06.40, jog.ramp: C06.05, home.speed_fast: C05.31, home.speed_slow: C05.32}
    zh: {名: 点动速度, x: 中文}
";

    fn quantities() -> Path {
        Path::root().key("axes").key("A").key("quantities")
    }

    #[test]
    fn prints_in_file_order() {
        let zh = Path::root().key("axes").key("A").key("zh");
        let duplicate = Mark { line: 3, column: 15, length: 4 };
        let problems = [
            Problem::value(Path::root().key("nothing"), "no place for this").advise("none at all"),
            Problem::value(zh.key("x"), "no text"),
            Problem::value(zh.key("名"), "not\nASCII").advise("write Latin letters "),
            Problem::value(quantities().key("jog.speed"), "no register `C06.40`")
                .advise("did you mean C06.04 (Jog speed)?"),
            Problem::key(Path::root().key("axes").key("A").key("speed"), "unknown"),
            Problem { mark: Some(duplicate), ..Problem::value(Path::root(), "twice") },
        ];
        // The first has no place only in an empty file; here it falls back to the root.
        assert_eq!(
            render(&problems, "m.yaml", FILE),
            "\
m.yaml:1:1: nothing: no place for this
   | model: {vendor: Acme}
   | ^^^^^ none at all
m.yaml:3:15: twice
   |   functions: [0x03, 0x06]
   |               ^^^^
m.yaml:10:3: axes.A.speed: unknown
   |   A:
   |   ^
m.yaml:11:29: axes.A.quantities[jog.speed]: no register `C06.40`
   |     quantities: {jog.speed: C06.40, jog.ramp: C06.05, home.speed_fast: C05.31, home.speed_slow: ...
   |                             ^^^^^^ did you mean C06.04 (Jog speed)?
m.yaml:12:13: axes.A.zh[名]: not ASCII
   |     zh: {名: 点动速度, x: 中文}
   |              ^^^^^^^^ write Latin letters
m.yaml:12:22: axes.A.zh.x: no text
   |     zh: {名: 点动速度, x: 中文}
   |                           ^^^^
"
        );
    }

    #[test]
    fn without_a_place() {
        let path = Path::root().key("line").key("unit");
        let problem = Problem::value(path, "missing");
        let lost = Mark { line: 9, column: 1, length: 1 };
        let problems = [
            Problem { mark: Some(lost), ..problem.clone() },
            problem.clone().advise("add it"),
            Problem::value(Path::root(), "empty"),
        ];
        assert_eq!(
            render(&problems, "x", ""),
            "x: line.unit: missing\nx: line.unit: missing (add it)\nx: empty\n"
        );
        let end = Mark { line: 1, column: 3, length: 1 };
        assert_eq!(
            render(&[Problem { mark: Some(end), ..problem }], "x", "[a"),
            "x:1:3: line.unit: missing\n   | [a\n   |   ^\n"
        );
    }

    #[test]
    fn a_choice_is_searched_first() {
        let (places, problems) = Places::parse(FILE);
        assert_eq!(problems, []);
        let choice = Path::root().key("options").key("crc_error").key("choices").key("exception");
        for (path, line, column) in [
            (choice.clone(), 8, 18),
            (choice.key("line").key("crc_error"), 8, 37),
            (choice.key("line").key("functions").index(1), 3, 21),
            (choice.key("line").key("nowhere"), 8, 19),
            (Path::root().key("options").key("crc_error").key("line"), 5, 3),
        ] {
            let mark = locate(&Problem::value(path.clone(), ""), &places).unwrap();
            assert_eq!((mark.line, mark.column), (line, column), "{path}");
        }
    }

    proptest! {
        #[test]
        fn any_mark_on_any_text_prints(
            text in prop_oneof![any::<String>(), "[a中\u{301}\t ,:\r\n]{0,300}"],
            line in 0..9usize, column in 0..400usize, length in 0..400usize,
            what in any::<String>(),
        ) {
            let mark = Some(Mark { line, column, length });
            let problems = [
                Problem { mark, ..Problem::value(Path::root(), what.clone()).advise(what) },
                Problem { mark: None, at: At::Key, ..Problem::key(quantities(), "x") },
            ];
            let out = render(&problems, "f", &text);
            prop_assert!(out.lines().all(|line| line.trim_end() == line), "{out:?}");
        }
    }
}
