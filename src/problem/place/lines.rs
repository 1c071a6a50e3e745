//! The lines of a text, cut where the YAML parser cuts them, and marks that stay inside them.
//!
//! Not the place for terminal columns: here a character is a character, however wide it prints.

use super::super::Mark;

/// The lines of one text, without their ends and without a byte order mark.
pub(in crate::problem) struct Lines<'t> {
    lines: Vec<TextLine<'t>>,
    /// The last line with text on it, from 1.
    last: usize,
}

struct TextLine<'t> {
    text: &'t str,
    /// Characters up to the last one that is not blank; counted once, as every mark asks for it.
    length: usize,
}

impl<'t> Lines<'t> {
    pub(in crate::problem) fn new(text: &'t str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = Vec::new();
        let mut rest = text;
        // Not `str::lines`: for YAML a lone carriage return ends a line as well.
        while let Some(end) = rest.find(['\r', '\n']) {
            lines.push(TextLine::new(&rest[..end]));
            let width = if rest[end..].starts_with("\r\n") { 2 } else { 1 };
            rest = &rest[end + width..];
        }
        lines.push(TextLine::new(rest));
        let last = lines.iter().rposition(|line| line.length > 0).map_or(1, |i| i + 1);
        Self { lines, last }
    }

    /// The text of a line, counted from 1.
    pub(in crate::problem) fn text(&self, line: usize) -> Option<&'t str> {
        Some(self.lines.get(line.checked_sub(1)?)?.text)
    }

    /// A mark of `length` characters, or up to the end of the line if that comes first.
    ///
    /// Behind all text it moves to the end of the last line that has any: there is nothing to see
    /// on the empty lines where the parser notices that a bracket was never closed.
    pub(super) fn mark(&self, line: usize, column: usize, length: usize) -> Mark {
        if line > self.last {
            return Mark { line: self.last, column: self.length(self.last) + 1, length: 1 };
        }
        let rest = (self.length(line) + 1).saturating_sub(column);
        Mark { line, column, length: length.min(rest).max(1) }
    }

    fn length(&self, line: usize) -> usize {
        line.checked_sub(1).and_then(|i| self.lines.get(i)).map_or(0, |line| line.length)
    }
}

impl<'t> TextLine<'t> {
    fn new(text: &'t str) -> Self {
        Self { text, length: text.trim_end().chars().count() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_where_yaml_cuts() {
        let lines = Lines::new("\u{feff}a\r\nb\rc\n\nd\u{2028}e");
        let all: Vec<_> = (0..8).map(|i| lines.text(i)).collect();
        let some = ["a", "b", "c", "", "d\u{2028}e"].map(Some);
        assert_eq!(all[1..6], some);
        assert_eq!((all[0], all[6]), (None, None));
    }

    #[test]
    fn marks_stay_inside() {
        let lines = Lines::new("中文字  \nab\n\n");
        let mark = |line, column, length| Mark { line, column, length };
        assert_eq!(lines.mark(1, 2, 9), mark(1, 2, 2));
        assert_eq!(lines.mark(2, 1, 1), mark(2, 1, 1));
        assert_eq!(lines.mark(2, 9, 9), mark(2, 9, 1));
        assert_eq!(lines.mark(2, 3, 1), mark(2, 3, 1));
        assert_eq!(lines.mark(4, 1, 1), mark(2, 3, 1));
        assert_eq!(lines.mark(99, 7, 7), mark(2, 3, 1));
        assert_eq!(Lines::new("").mark(1, 1, 1), mark(1, 1, 1));
    }
}
