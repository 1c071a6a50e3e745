//! The piece of a line that is shown, and where the carets go below it, in terminal columns.
//!
//! Deliberately not a full answer to how wide a text prints: no grapheme clusters, only what keeps
//! a caret in place under Latin letters, CJK and combining marks.

use super::super::Mark;

/// One line cut to size.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Strip {
    /// What is shown.
    pub(super) text: String,
    /// Terminal columns before the first caret.
    pub(super) indent: usize,
    /// Number of carets, at least 1.
    pub(super) length: usize,
}

/// The widest line, dots included.
const WIDTH: usize = 100;
/// What stays visible before the caret when the beginning of a line is cut off.
const BEFORE: usize = 40;
/// How much more is given up to cut between words.
const WORD: usize = 20;
const DOTS: &str = "...";

/// Cuts `line` so that the region round `mark` stays.
pub(super) fn strip(line: &str, mark: Mark) -> Strip {
    let line: String = line.chars().map(shown).collect();
    let cells: Vec<char> = line.trim_end().chars().collect();
    // Behind the end of the line is a place, too: something is missing there.
    let start = mark.column.saturating_sub(1).min(cells.len());
    let end = start.saturating_add(mark.length).min(cells.len());

    let from = first_shown(&cells, start, end);
    let lead = if from > 0 { DOTS } else { "" };
    let to = last_shown(&cells, from, end, WIDTH - lead.len());
    let tail = if to < cells.len() { DOTS } else { "" };

    let text: String = cells[from..to].iter().collect();
    Strip {
        text: format!("{lead}{text}{tail}"),
        indent: lead.len() + width(&cells[from..start]),
        length: width(&cells[start..end.min(to).max(start)]).max(1),
    }
}

/// The first character shown: 0 if the marked region is near enough to the beginning.
fn first_shown(cells: &[char], start: usize, end: usize) -> usize {
    let fits = width(cells) <= WIDTH || width(&cells[..end]) + DOTS.len() <= WIDTH;
    if fits || width(&cells[..start]) <= BEFORE {
        return 0;
    }
    let mut from = start;
    let mut room = BEFORE;
    while from > 0 && cell_width(cells[from - 1]) <= room {
        from -= 1;
        room -= cell_width(cells[from]);
    }
    let word = (from..start).take(WORD).find(|&i| i > 0 && cells[i - 1] == ' ');
    word.unwrap_or(from)
}

/// One past the last character shown.
fn last_shown(cells: &[char], from: usize, end: usize, room: usize) -> usize {
    if width(&cells[from..]) <= room {
        return cells.len();
    }
    let mut room = room - DOTS.len();
    let mut to = from;
    while to < cells.len() && cell_width(cells[to]) <= room {
        room -= cell_width(cells[to]);
        to += 1;
    }
    let word = (end.max(from + 1)..=to).rev().take(WORD).find(|&i| cells[i - 1] == ' ');
    word.unwrap_or(to)
}

fn width(cells: &[char]) -> usize {
    cells.iter().map(|&c| cell_width(c)).sum()
}

/// The character as printed: what would move the cursor or turn the direction becomes a space.
fn shown(c: char) -> char {
    let bidi =
        matches!(c, '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}');
    let separator = matches!(c, '\u{2028}' | '\u{2029}');
    if c.is_control() || bidi || separator { ' ' } else { c }
}

/// Terminal columns of a character (Unicode Standard Annex 11: Wide and Fullwidth take two).
fn cell_width(c: char) -> usize {
    match c {
        '\u{0300}'..='\u{036F}' | '\u{200B}'..='\u{200D}' | '\u{20D0}'..='\u{20FF}' => 0,
        '\u{FE00}'..='\u{FE0F}' | '\u{FE20}'..='\u{FE2F}' | '\u{FEFF}' => 0,
        '\u{1100}'..='\u{115F}' | '\u{2E80}'..='\u{303E}' | '\u{3041}'..='\u{4DBF}' => 2,
        '\u{4E00}'..='\u{A4CF}' | '\u{A960}'..='\u{A97F}' | '\u{AC00}'..='\u{D7A3}' => 2,
        '\u{F900}'..='\u{FAFF}' | '\u{FE10}'..='\u{FE19}' | '\u{FE30}'..='\u{FE6F}' => 2,
        '\u{FF00}'..='\u{FF60}' | '\u{FFE0}'..='\u{FFE6}' | '\u{1F300}'..='\u{1F64F}' => 2,
        '\u{1F680}'..='\u{1F6FF}' | '\u{1F900}'..='\u{1F9FF}' | '\u{20000}'..='\u{3FFFD}' => 2,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The strip with its carets below, for reading.
    fn show(line: &str, column: usize, length: usize) -> String {
        let strip = strip(line, Mark { line: 1, column, length });
        format!("{}\n{}{}", strip.text, " ".repeat(strip.indent), "^".repeat(strip.length))
    }

    #[test]
    fn short_lines_stay() {
        for (line, column, length, want) in [
            ("a: b", 4, 1, "a: b\n   ^"),
            ("a: b  ", 5, 1, "a: b\n    ^"),
            ("a: b", 99, 9, "a: b\n    ^"),
            ("", 1, 1, "\n^"),
            ("\ta:\tb\u{1b}", 5, 1, " a: b\n    ^"),
            ("点动: 速度", 5, 2, "点动: 速度\n      ^^^^"),
            ("（全），x", 5, 1, "（全），x\n        ^"),
            ("e\u{301}: x", 5, 1, "e\u{301}: x\n   ^"),
            ("a: 🙂 b", 6, 1, "a: 🙂 b\n      ^"),
            ("한: x", 4, 1, "한: x\n    ^"),
        ] {
            assert_eq!(show(line, column, length), want, "{line:?}");
        }
    }

    #[test]
    fn long_lines_keep_the_region_round_the_caret() {
        let words = "word ".repeat(60);
        let letters = "x".repeat(300);
        let five = |n| "word ".repeat(n);
        for (line, column, length, want) in [
            (&words, 6, 4, format!("{}...\n     ^^^^", five(19))),
            (&words, 91, 4, format!("{}...\n{}^^^^", five(19), " ".repeat(90))),
            (&words, 151, 4, format!("...{}...\n{}^^^^", five(18), " ".repeat(43))),
            (&words, 296, 4, format!("...{}word\n{}^^^^", five(8), " ".repeat(43))),
            (&letters, 1, 300, format!("{}...\n{}", &letters[..97], "^".repeat(97))),
            (&letters, 201, 2, format!("...{}...\n{}^^", &letters[..94], " ".repeat(43))),
        ] {
            assert_eq!(show(line, column, length), want, "{column}");
        }
        let wide = "速".repeat(200);
        assert_eq!(show(&wide, 3, 1), format!("{}...\n    ^^", "速".repeat(48)));
    }

    #[test]
    fn never_wider_than_allowed() {
        let lines =
            ["word ".repeat(60), "x".repeat(300), "速x, ".repeat(80), " ".repeat(200) + "y"];
        for line in &lines {
            for column in 1..line.chars().count() {
                for length in [1, 7, 90, 400] {
                    let strip = strip(line, Mark { line: 1, column, length });
                    let cells: Vec<char> = strip.text.chars().collect();
                    assert!(width(&cells) <= WIDTH, "{line:?} {column}");
                    assert!(strip.indent + strip.length <= WIDTH, "{line:?} {column} {length}");
                    let under = cells.iter().scan(0, |sum, &c| {
                        let at = *sum;
                        *sum += cell_width(c);
                        Some((at, c))
                    });
                    let want = line.chars().nth(column - 1).unwrap();
                    let found = under.clone().find(|(at, _)| *at == strip.indent).map(|(_, c)| c);
                    assert!(found == Some(want) || want == ' ', "{line:?} {column} {found:?}");
                }
            }
        }
    }
}
