//! serde's complaints in the words of somebody who writes YAML and no Rust.
//!
//! Deliberately no diagnosis: it rewords what people run into and leaves the rest as serde said it.

use super::super::{Path, Problem, suggest};

/// The problem at `path` for what serde says.
pub(super) fn problem(path: Path, message: &str) -> Problem {
    // The path tells the place already.
    let message = message.split(" at line ").next().unwrap_or(message).trim_end_matches('.');
    if let Some(key) = message.strip_prefix("missing field ") {
        return Problem::value(path, format!("missing key {key}"));
    }
    if let Some((name, known)) = one_of(message, "unknown field `") {
        let advice = suggest::did_you_mean(name, known);
        return Problem::value(path, format!("unknown key `{name}`")).advise_if(advice);
    }
    if let Some((name, known)) = one_of(message, "unknown variant `") {
        let what = format!("expected one of {}, found `{name}`", known.join(", "));
        let advice = suggest::did_you_mean(name, known);
        return Problem::value(path, what).advise_if(advice);
    }
    if message.contains("expected any YAML value") {
        return Problem::value(path, "the number has too many digits");
    }
    let Some((got, want)) = type_or_value(message) else {
        return Problem::value(path, message);
    };
    let bare = ["integer ", "floating point ", "boolean "].iter().any(|it| got.starts_with(it));
    let advice = (want == "a string" && bare).then(|| "put it in quotes".to_owned());
    let what = format!("expected {}, found {}", wanted(want), found(got));
    Problem::value(path, what).advise_if(advice)
}

/// Of ``unknown variant `x`, expected one of `a`, `b` ``, which begins so: `x` and `a`, `b`.
fn one_of<'a>(message: &'a str, begins: &str) -> Option<(&'a str, Vec<&'a str>)> {
    let (name, known) = message.strip_prefix(begins)?.split_once("`, expected ")?;
    Some((name, known.split('`').skip(1).step_by(2).collect()))
}

/// Of `invalid type: A, expected B` (or `value`, or `length`): A and B.
fn type_or_value(message: &str) -> Option<(&str, &str)> {
    let kinds = ["invalid type: ", "invalid value: ", "invalid length "];
    kinds.iter().find_map(|kind| message.strip_prefix(kind))?.rsplit_once(", expected ")
}

fn wanted(want: &str) -> &str {
    match want {
        "a string" => "a string",
        "u8" => "a number from 0 to 255",
        "u16" => "a number from 0 to 65535",
        "u32" | "u64" => "a non-negative integer",
        "i32" => "a number from -2147483648 to 2147483647",
        "i64" => "an integer",
        "f64" => "a number",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "an array of length 2" => "a list of two values",
        _ if want.starts_with("struct ") => "a map",
        _ => want,
    }
}

fn found(got: &str) -> String {
    let (kind, value) = got.split_once(' ').unwrap_or((got, ""));
    match kind {
        "sequence" => "a list".into(),
        "map" => "a map".into(),
        "unit" => "nothing".into(),
        "boolean" => value.into(),
        "integer" => value.trim_matches('`').into(),
        "floating" => value.trim_start_matches("point ").trim_matches('`').into(),
        "string" => format!("the string {value}"),
        _ if kind.parse::<usize>().is_ok() => format!("one of {kind}"),
        _ => got.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_plain_words() {
        for (message, want) in [
            ("missing field `at` at line 3 column 4", "missing key `at`"),
            (
                "unknown variant `u61`, expected one of `u16`, `i16`",
                "expected one of u16, i16, found `u61` (did you mean `u16`?)",
            ),
            (
                "unknown field `digt`, expected one of `register`, `digit`",
                "unknown key `digt` (did you mean `digit`?)",
            ),
            ("unknown variant `x`, expected `none`", "expected one of none, found `x`"),
            (
                "invalid type: floating point `80.0`, expected a string",
                "expected a string, found 80.0 (put it in quotes)",
            ),
            (
                "invalid type: boolean `true`, expected a string",
                "expected a string, found `true` (put it in quotes)",
            ),
            ("invalid type: sequence, expected a string", "expected a string, found a list"),
            (
                "invalid value: integer `257`, expected u8",
                "expected a number from 0 to 255, found 257",
            ),
            (
                "invalid type: string \"a, expected b\", expected u16",
                "expected a number from 0 to 65535, found the string \"a, expected b\"",
            ),
            ("invalid type: unit value, expected struct Row", "expected a map, found nothing"),
            (
                "invalid length 1, expected an array of length 2",
                "expected a list of two values, found one of 1",
            ),
            ("a range is [low, high].", "a range is [low, high]"),
        ] {
            assert_eq!(problem(Path::root(), message).to_string(), want, "{message}");
        }
    }
}
