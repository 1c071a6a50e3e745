//! The parser's complaint as a problem in plain words.
//!
//! Deliberately not a diagnosis: it rewords what people run into and leaves the rest as the parser
//! said it.

use super::{Mark, Path, Problem};

/// The problem for what the parser says at `mark`.
pub(super) fn problem(info: &str, mark: Mark) -> Problem {
    let (what, advice) = words(info);
    Problem::value(Path::root(), what).advise_if(advice).marked(mark)
}

fn words(info: &str) -> (String, Option<String>) {
    if let Some(c) = info.strip_prefix("unexpected character: ") {
        let c = c.trim_matches(['`', '\'']);
        // The parser quotes the character, so a back-tick is lost by trimming.
        let c = if c.is_empty() { "`" } else { c };
        return (format!("a value cannot begin with {c}"), Some("put it in quotes".into()));
    }
    for (part, what, advice) in WORDS {
        if info.contains(part) {
            return ((*what).into(), (!advice.is_empty()).then(|| (*advice).into()));
        }
    }
    (format!("not YAML: {info}"), None)
}

/// A part of the parser's message, what we say, and the advice (empty: none). The first that fits.
#[rustfmt::skip]
const WORDS: &[(&str, &str, &str)] = &[
    ("mapping values are not allowed", "unexpected `:`", "check the indentation, or put a value that holds `: ` in quotes"),
    ("illegal placement of ':'", "unexpected `:`", "an earlier `[` or `{` may not be closed"),
    ("mapping keys are not allowed", "unexpected `?`", "put it in quotes"),
    ("sequence entries are not allowed", "unexpected `-`", "check the indentation"),
    ("is only valid inside a block", "unexpected `-`", "check the indentation"),
    ("block mapping, did not find expected key", "expected a key", "check the indentation"),
    ("did not find expected '-' indicator", "expected `-` of the next item", "check the indentation"),
    ("flow mapping, did not find expected ',' or '}'", "unclosed `{`, or a missing `,`", ""),
    ("flow sequence, expected ',' or ']'", "unclosed `[`, or a missing `,`", ""),
    ("misplaced bracket", "unmatched closing bracket", ""),
    ("found unexpected end of stream", "unclosed quote", ""),
    ("found unexpected document indicator", "unclosed quote", ""),
    ("after double-quoted scalar", "text after a closing quote", ""),
    ("unknown escape character", "unknown escape sequence", "in single quotes a backslash is not an escape"),
    ("simple key expect", "expected `:` after the key", ""),
    ("did not find expected node content", "expected a value", ""),
    ("found a tab", "a tab in or after this value", "use spaces"),
    ("tabs disallowed", "a tab in the indentation", "use spaces"),
    ("tab cannot be used", "a tab in the indentation", "use spaces"),
    ("invalid indentation in flow", "an earlier `[` or `{` is not closed", ""),
    ("invalid indentation", "this line is not indented enough", ""),
    ("wrongly indented", "this line is not indented enough", ""),
    ("separated from other tokens by whitespace", "missing space before `#`", ""),
    ("expected <document start>", "text after the end of the document", "check the indentation"),
    ("unprintable character", "an unprintable character", ""),
    ("byte order mark", "a byte order mark inside the text", ""),
];

#[cfg(test)]
mod tests {
    use crate::problem::parse;

    #[test]
    fn one_problem_in_plain_words() {
        for (text, line, column, what) in [
            ("a: b: c", 1, 5, "unexpected `:`"),
            ("中文: b\n  字: c", 2, 4, "unexpected `:`"),
            ("a: 1\na: 2\nb: [1, 2\n\n", 3, 9, "unclosed `[`, or a missing `,`"),
            ("b: {x: 1\nc: 2", 2, 2, "unclosed `{`, or a missing `,`"),
            ("a: [1,\n\nb: 2\n", 3, 1, "an earlier `[` or `{` is not closed"),
            ("x: 1\n\ty: 2\n", 1, 4, "a tab in or after this value"),
            ("a:\n\t- b", 2, 2, "a tab in the indentation"),
            ("a: \"x\n", 1, 4, "unclosed quote"),
            ("a: @x", 1, 4, "a value cannot begin with @"),
            ("a: `x`", 1, 4, "a value cannot begin with `"),
            ("a: 1\nb\nc: 2", 3, 1, "expected `:` after the key"),
            ("  a: 1\n b: 2", 2, 2, "text after the end of the document"),
            ("a: ]", 1, 4, "unmatched closing bracket"),
            ("a: [1\n  b: c\n  d: e", 2, 4, "unexpected `:`"),
            ("%YAML 1.2 x\n", 1, 1, "not YAML: while scanning a directive"),
        ] {
            let problems = parse(text).expect_err("no tree");
            let [problem] = &problems[..] else { panic!("{text:?}: {problems:?}") };
            let mark = problem.mark.unwrap();
            assert!(problem.what.starts_with(what), "{text:?}: {problem:?}");
            assert_eq!((mark.line, mark.column), (line, column), "{text:?}: {problem:?}");
            assert!(problem.path.is_root());
        }
    }
}
