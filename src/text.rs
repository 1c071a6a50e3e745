//! Which characters a line of text may hold: text from files goes into logs and onto terminals.
//!
//! Deliberately no layout and no colours.

use std::borrow::Cow;

/// Does `c` do something to a terminal, or to the text around it, instead of showing? Control characters, line and
/// paragraph separators, and marks that reverse the direction of writing.
pub fn is_control(c: char) -> bool {
    let turns =
        matches!(c, '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}');
    c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') || turns
}

/// `text` with each such character as Rust writes it in a literal: `\n`, `\u{1b}`.
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_control)
}

/// The same for text of several lines: their ends and tabs stay.
pub fn lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_control(c) && !matches!(c, '\n' | '\t'))
}

fn escaped(text: &str, is_bad: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&is_bad) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_bad(c) { out.extend(c.escape_default()) } else { out.push(c) }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_show_is_written_out() {
        for (text, one, several) in [
            ("speed 伺服 `\\`", "speed 伺服 `\\`", "speed 伺服 `\\`"),
            ("a\nb\tc", "a\\nb\\tc", "a\nb\tc"),
            (
                "\u{1b}[2J\r\u{7f}\u{9b}",
                "\\u{1b}[2J\\r\\u{7f}\\u{9b}",
                "\\u{1b}[2J\\r\\u{7f}\\u{9b}",
            ),
            ("a\u{2028}b\u{202e}c", "a\\u{2028}b\\u{202e}c", "a\\u{2028}b\\u{202e}c"),
        ] {
            assert_eq!(one_line(text), one);
            assert_eq!(lines(text), several);
        }
        assert!(matches!(one_line("plain"), Cow::Borrowed(_)));
    }
}
