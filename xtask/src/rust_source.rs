//! A Rust file parted into code, comments and literals, so that a rule about code reads only code.

/// A Rust file parted into code and comments.
///
/// Each part has the lines and columns of the file; what belongs elsewhere is blank in it.
pub(crate) struct RustSource {
    /// The code, without comments and the text of literals.
    pub(crate) code: String,
    /// The comments, with their marks.
    pub(crate) comments: String,
    /// The text of string and character literals, with their quotes.
    pub(crate) literals: String,
}

#[derive(Clone, Copy, PartialEq)]
enum Part {
    Code,
    Comment,
    Literal,
}

impl RustSource {
    /// Parts `text`, which need not compile.
    pub(crate) fn new(text: &str) -> Self {
        let mut scanner = Scanner { rest: text, ..Scanner::default() };
        scanner.scan();
        let Scanner { code, comments, literals, .. } = scanner;
        Self { code, comments, literals }
    }

    /// Comments and literals together.
    pub(crate) fn prose(&self) -> String {
        let parts = self.comments.chars().zip(self.literals.chars());
        parts.map(|(comment, literal)| if comment == ' ' { literal } else { comment }).collect()
    }

    /// Lines of documentation, each with its number from 1 and without its `///` or `//!`.
    pub(crate) fn doc_lines(&self) -> Vec<(usize, &str)> {
        let lines = self.comments.lines().zip(self.code.lines()).enumerate();
        let docs = lines.filter(|(_, (_, code))| code.trim().is_empty());
        docs.filter_map(|(i, (comment, _))| Some((i + 1, doc_text(comment)?))).collect()
    }

    /// The words of the code (identifiers, keywords, numbers), each with its byte offset in it.
    pub(crate) fn words(&self) -> impl Iterator<Item = (usize, &str)> {
        words(&self.code)
    }
}

/// The number, from 1, of the line that holds byte `offset` of `text`.
pub(crate) fn line_at(text: &str, offset: usize) -> usize {
    text[..offset].matches('\n').count() + 1
}

/// Maximal runs of letters, digits and `_` in `text`, each with its byte offset.
pub(crate) fn words(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest_start = 0;
    std::iter::from_fn(move || {
        let start = rest_start + text[rest_start..].find(is_word)?;
        let length = text[start..].find(|c| !is_word(c)).unwrap_or(text.len() - start);
        rest_start = start + length;
        Some((start, &text[start..rest_start]))
    })
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The text of a documentation line; four slashes make an ordinary comment.
fn doc_text(comment: &str) -> Option<&str> {
    let comment = comment.trim();
    let text = comment.strip_prefix("//!").or_else(|| comment.strip_prefix("///"))?;
    if text.starts_with('/') { None } else { Some(text.strip_prefix(' ').unwrap_or(text)) }
}

#[derive(Default)]
struct Scanner<'a> {
    rest: &'a str,
    code: String,
    comments: String,
    literals: String,
}

impl Scanner<'_> {
    fn scan(&mut self) {
        while let Some(first) = self.rest.chars().next() {
            if self.rest.starts_with("//") {
                self.take(self.rest.find('\n').unwrap_or(self.rest.len()), Part::Comment);
            } else if self.rest.starts_with("/*") {
                self.take(block_comment_length(self.rest), Part::Comment);
            } else if first == '"' {
                self.take(quoted_length(self.rest, '"'), Part::Literal);
            } else if first == '\'' {
                let (length, part) = character_or_lifetime(self.rest);
                self.take(length, part);
            } else if is_word(first) {
                let length = self.rest.find(|c| !is_word(c)).unwrap_or(self.rest.len());
                let raw = matches!(&self.rest[..length], "r" | "br" | "cr");
                self.take(length, Part::Code);
                if let Some(length) = raw.then(|| raw_string_length(self.rest)).flatten() {
                    self.take(length, Part::Literal);
                }
            } else {
                self.take(first.len_utf8(), Part::Code);
            }
        }
    }

    /// Moves `length` bytes into their part, and as many blanks into the other.
    fn take(&mut self, length: usize, part: Part) {
        let (taken, rest) = self.rest.split_at(length);
        for c in taken.chars() {
            // Blanks keep lines and columns; a blank in place of a wide letter keeps its column, not its byte.
            let blank = if c == '\n' { '\n' } else { ' ' };
            self.code.push(if part == Part::Code { c } else { blank });
            self.comments.push(if part == Part::Comment { c } else { blank });
            self.literals.push(if part == Part::Literal { c } else { blank });
        }
        self.rest = rest;
    }
}

/// Length of the block comment at the start of `text`; block comments nest.
fn block_comment_length(text: &str) -> usize {
    let (mut at, mut depth) = (0, 0);
    while at < text.len() {
        if text[at..].starts_with("/*") {
            depth += 1;
            at += 2;
        } else if text[at..].starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += text[at..].chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// Length of the literal at the start of `text`, which opens and closes with `quote`.
fn quoted_length(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        if escaped {
            escaped = false;
        } else if c == '\\' {
            escaped = true;
        } else if c == quote {
            return at + 1;
        }
    }
    text.len()
}

/// Length of the rest of a raw string after its `r`, or `None` for a raw identifier.
fn raw_string_length(text: &str) -> Option<usize> {
    let hashes = text.len() - text.trim_start_matches('#').len();
    let body = text[hashes..].strip_prefix('"')?;
    let close = format!("\"{}", "#".repeat(hashes));
    Some(body.find(&close).map_or(text.len(), |at| hashes + 1 + at + close.len()))
}

/// The part that the apostrophe at the start of `text` opens: a character literal, or a lifetime.
fn character_or_lifetime(text: &str) -> (usize, Part) {
    let mut after = text.chars().skip(1);
    match (after.next(), after.next()) {
        (Some('\\'), _) => (quoted_length(text, '\''), Part::Literal),
        (Some(c), Some('\'')) => (2 + c.len_utf8(), Part::Literal),
        _ => (1, Part::Code),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expect_code: &str, expect_comments: &str) {
        let source = RustSource::new(text);
        let squeezed = |s: &str| s.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(squeezed(&source.code), expect_code, "code of {text}");
        assert_eq!(squeezed(&source.comments), expect_comments, "comments of {text}");
        assert_eq!(source.code.lines().count(), text.lines().count(), "lines of {text}");
    }

    #[test]
    fn comments() {
        check("a(); // b\nc();", "a(); c();", "// b");
        check("a /* b /* c */ d */ e", "a e", "/* b /* c */ d */");
        check("a /* never closed", "a", "/* never closed");
        check("a / b // \"c", "a / b", "// \"c");
    }

    #[test]
    fn strings() {
        check(r#"f("a // b", c)"#, "f( , c)", "");
        check(r#"f("a \" b", c) // d"#, "f( , c)", "// d");
        check(r##"f(r#"a " b"#, c)"##, "f(r , c)", "");
        check(r#"f(br"a\", c)"#, "f(br , c)", "");
        check("f(\"a\nb\", c)", "f( , c)", "");
        check("r#type + b", "r#type + b", "");
    }

    #[test]
    fn characters_and_lifetimes() {
        check("f('\"', a) // b", "f( , a)", "// b");
        check(r"f('\'', a) // b", "f( , a)", "// b");
        check("f('é', b'x')", "f( , b )", "");
        check("fn f<'a>(x: &'a str) {} // b", "fn f<'a>(x: &'a str) {}", "// b");
    }

    #[test]
    fn doc_lines_are_documentation_only() {
        let text =
            "//! A\n/// B\n//// no\n// no\nlet s = \"\n/// no\n\";\nx, /// no\n    ///   C\n";
        assert_eq!(RustSource::new(text).doc_lines(), [(1, "A"), (2, "B"), (9, "  C")]);
    }

    #[test]
    fn words_know_their_lines() {
        let source = RustSource::new("let a_1 = \"b\"; // c\n d!()");
        let found: Vec<_> = source.words().map(|(at, w)| (line_at(&source.code, at), w)).collect();
        assert_eq!(found, [(1, "let"), (1, "a_1"), (2, "d")]);
    }
}
