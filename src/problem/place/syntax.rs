//! The parser's complaint as a problem in plain words.
//!
//! Deliberately not a diagnosis: it rewords what people run into and leaves the rest as the parser
//! said it.

use super::super::{Mark, Path, Problem};

/// The problem for what the parser says at `mark`.
pub(super) fn problem(info: &str, mark: Mark) -> Problem {
    let (what, advice) = words(info);
    Problem { mark: Some(mark), ..Problem::value(Path::root(), what).advise_if(advice) }
}

fn words(info: &str) -> (String, Option<String>) {
    if let Some(c) = info.strip_prefix("unexpected character: ") {
        let c = c.trim_matches(['`', '\'']);
        // The parser quotes the character, so a back-tick is lost by trimming.
        let c = if c.is_empty() { "`" } else { c };
        return (format!("a value can't begin with {c}"), Some("put it in quotes".into()));
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
    ("mapping values are not allowed", "a `:` where no key can end", "check the indentation, or put a value that holds `: ` in quotes"),
    ("illegal placement of ':'", "a `:` where no key can end", "a `[` or `{` above may not be closed"),
    ("mapping keys are not allowed", "a `?` where no key can begin", "put it in quotes"),
    ("sequence entries are not allowed", "a `-` where no list can begin", "check the indentation"),
    ("is only valid inside a block", "a `-` where no list can begin", "check the indentation"),
    ("block mapping, did not find expected key", "no key where one should be", "check the indentation"),
    ("did not find expected '-' indicator", "no `-` where the next item should be", "check the indentation"),
    ("flow mapping, did not find expected ',' or '}'", "a `{` that is not closed, or a `,` missing", ""),
    ("flow sequence, expected ',' or ']'", "a `[` that is not closed, or a `,` missing", ""),
    ("misplaced bracket", "a bracket that closes nothing", ""),
    ("found unexpected end of stream", "a quote that is not closed", ""),
    ("found unexpected document indicator", "a quote that is not closed", ""),
    ("after double-quoted scalar", "text behind a closing quote", ""),
    ("unknown escape character", "an escape that YAML does not know", "in single quotes a backslash is only a backslash"),
    ("simple key expect", "a key without `:`", ""),
    ("did not find expected node content", "no value where one should be", ""),
    ("found a tab", "a tab in or behind this value", "use spaces"),
    ("tabs disallowed", "a tab in the indentation", "use spaces"),
    ("tab cannot be used", "a tab in the indentation", "use spaces"),
    ("invalid indentation in flow", "a `[` or `{` above that is not closed", ""),
    ("invalid indentation", "a line that is not indented enough", ""),
    ("wrongly indented", "a line that is not indented enough", ""),
    ("separated from other tokens by whitespace", "no space before a `#`", ""),
    ("expected <document start>", "text behind the end of the document", "check the indentation"),
    ("unprintable character", "an unprintable character", ""),
    ("byte order mark", "a byte order mark inside the text", ""),
];

#[cfg(test)]
mod tests {
    use super::super::Places;

    #[test]
    fn one_problem_in_plain_words() {
        for (text, line, column, what) in [
            ("a: b: c", 1, 5, "a `:` where no key can end"),
            ("中文: b\n  字: c", 2, 4, "a `:` where no key can end"),
            ("a: 1\na: 2\nb: [1, 2\n\n", 3, 9, "a `[` that is not closed, or a `,` missing"),
            ("b: {x: 1\nc: 2", 2, 2, "a `{` that is not closed, or a `,` missing"),
            ("a: [1,\n\nb: 2\n", 3, 1, "a `[` or `{` above that is not closed"),
            ("x: 1\n\ty: 2\n", 1, 4, "a tab in or behind this value"),
            ("a:\n\t- b", 2, 2, "a tab in the indentation"),
            ("a: \"x\n", 1, 4, "a quote that is not closed"),
            ("a: @x", 1, 4, "a value can't begin with @"),
            ("a: `x`", 1, 4, "a value can't begin with `"),
            ("a: 1\nb\nc: 2", 3, 1, "a key without `:`"),
            ("  a: 1\n b: 2", 2, 2, "text behind the end of the document"),
            ("a: ]", 1, 4, "a bracket that closes nothing"),
            ("a: [1\n  b: c\n  d: e", 2, 4, "a `:` where no key can end"),
            ("%YAML 1.2 x\n", 1, 1, "not YAML: while scanning a directive"),
        ] {
            let (places, problems) = Places::parse(text);
            let [problem] = &problems[..] else { panic!("{text:?}: {problems:?}") };
            let mark = problem.mark.unwrap();
            assert!(problem.what.starts_with(what), "{text:?}: {problem:?}");
            assert_eq!((mark.line, mark.column), (line, column), "{text:?}: {problem:?}");
            assert!(places.root.is_none() && problem.path.is_root());
        }
    }
}
