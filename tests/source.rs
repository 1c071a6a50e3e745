//! Rust source as the tests about it see it: code, comments and texts apart. A small lexer, no parser.

use crate::expect::{files, read, root};

/// One source file, cut into code, comments and texts.
pub struct Source {
    /// Where it lies, from the package's root: `src/bus/mod.rs`.
    pub path: String,
    /// As it is.
    pub text: String,
    /// With every comment, text and character blanked out; lines stay where they are.
    pub code: String,
    /// The texts of string literals, escapes as written, each with its line.
    pub texts: Vec<(usize, String)>,
    /// The comments, each with its line; doc comments too.
    pub comments: Vec<(usize, String)>,
}

impl Source {
    /// Every `.rs` file below `folder`, by path.
    pub fn all(folder: &str) -> Vec<Self> {
        let path = |file: &std::path::PathBuf| {
            file.strip_prefix(root("")).expect("below the root").display().to_string()
        };
        files(folder, "rs").iter().map(|file| Self::cut(path(file), read(file))).collect()
    }

    /// Cuts `text`.
    pub fn cut(path: String, text: String) -> Self {
        let mut lexer = Lexer { rest: &text, line: 1, code: String::new() };
        let (mut texts, mut comments) = (Vec::new(), Vec::new());
        while !lexer.rest.is_empty() {
            let line = lexer.line;
            match lexer.piece() {
                Piece::Code => {}
                Piece::Text(text) => texts.push((line, text)),
                Piece::Comment(text) => comments.push((line, text)),
            }
        }
        let code = lexer.code;
        Self { path, text, code, texts, comments }
    }

    /// The line where the file's own tests begin, or one past its last.
    pub fn tests_begin(&self) -> usize {
        let before = self.code.split("#[cfg(test)]").next().unwrap_or_default();
        before.matches('\n').count() + 1 + usize::from(before.len() == self.code.len())
    }

    /// The texts outside the file's own tests.
    pub fn texts_of_program(&self) -> impl Iterator<Item = (usize, &str)> {
        let end = self.tests_begin();
        let texts = self.texts.iter().filter(move |(line, _)| *line < end);
        texts.map(|(line, text)| (*line, text.as_str()))
    }
}

enum Piece {
    Code,
    Text(String),
    Comment(String),
}

struct Lexer<'t> {
    rest: &'t str,
    line: usize,
    code: String,
}

impl Lexer<'_> {
    fn piece(&mut self) -> Piece {
        let rest = self.rest;
        if rest.starts_with("//") {
            return Piece::Comment(self.blank(rest.find('\n').unwrap_or(rest.len())));
        }
        if let Some(hashes) = raw_string(rest).filter(|_| !self.code.ends_with(is_name)) {
            let open = rest.find('"').unwrap_or(0) + 1;
            let close = format!("\"{}", "#".repeat(hashes));
            let len = rest[open..].find(&close).unwrap_or(rest.len() - open);
            let whole = self.blank(open + len + close.len());
            return Piece::Text(whole[open..open + len].to_owned());
        }
        if rest.starts_with('"') {
            let len = end_of_string(rest);
            let whole = self.blank(len);
            return Piece::Text(whole[1..len - 1].to_owned());
        }
        let len = character(rest);
        match len {
            0 => {
                let len = rest.chars().next().map_or(0, char::len_utf8);
                self.code.push_str(&rest[..len]);
                self.step(len);
            }
            _ => {
                self.blank(len);
            }
        }
        Piece::Code
    }

    /// Takes `len` bytes that are no code.
    fn blank(&mut self, len: usize) -> String {
        let taken = self.rest[..len.min(self.rest.len())].to_owned();
        self.code.extend(taken.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        self.step(taken.len());
        taken
    }

    fn step(&mut self, len: usize) {
        self.line += self.rest[..len].matches('\n').count();
        self.rest = &self.rest[len..];
    }
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Number of `#` if a raw string begins here.
fn raw_string(rest: &str) -> Option<usize> {
    let rest = rest.strip_prefix('b').unwrap_or(rest).strip_prefix('r')?;
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    rest[hashes..].starts_with('"').then_some(hashes)
}

fn end_of_string(rest: &str) -> usize {
    let mut escaped = false;
    for (i, c) in rest.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return i + 1,
            _ => {}
        }
    }
    rest.len()
}

/// Length of a character literal that begins here; 0 for anything else, such as a lifetime.
fn character(rest: &str) -> usize {
    let Some(inside) = rest.strip_prefix('\'') else { return 0 };
    let end = match inside.strip_prefix('\\') {
        Some(escape) => escape.char_indices().skip(1).find(|(_, c)| *c == '\'').map(|(i, _)| i + 2),
        None => inside.chars().next().map(char::len_utf8),
    };
    match end {
        Some(end) if inside[end.min(inside.len())..].starts_with('\'') => end + 2,
        _ => 0,
    }
}

#[test]
fn cuts_code_texts_and_comments() {
    let text = r##"let a = "x \" // y"; // a "comment"
let b: &'static str = r#"raw "text""#; let c = '"'; let d = '\''; let e = '\u{41}';
#[cfg(test)]
mod tests { const T: &str = "of tests"; }
"##;
    let source = Source::cut("x.rs".into(), text.into());
    let want = [(1, r#"x \" // y"#), (2, r#"raw "text""#), (4, "of tests")];
    assert_eq!(source.texts, want.map(|(line, text)| (line, text.to_owned())));
    assert_eq!(source.comments, [(1, "// a \"comment\"".to_owned())]);
    assert_eq!(source.texts_of_program().count(), 2);
    assert!(source.code.contains("&'static str") && !source.code.contains('"'));
    assert_eq!(source.code.lines().count(), text.lines().count());
}
