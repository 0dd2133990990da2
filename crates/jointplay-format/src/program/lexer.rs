//! Splits a line into words, numbers and signs.

use super::words::{continues_word, starts_word};
use crate::expression::number_length;

/// A token of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Token<'t> {
    pub kind: Kind,
    /// Text of the token.
    pub text: &'t str,
    /// Column of its first character, counted from 1.
    pub column: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A keyword, a unit or a name.
    Word,
    /// A name between quotes.
    Quoted,
    /// A name without a closing quote.
    Unclosed,
    /// A number without sign; infinite if it is too large.
    Number(f64),
    /// A comparison of two characters, or any other character.
    Sign,
}

impl Token<'_> {
    pub(super) fn width(&self) -> usize {
        self.text.chars().count()
    }

    /// Whether the token is this word, in any letter case.
    pub(super) fn is(&self, word: &str) -> bool {
        self.kind == Kind::Word && self.text.eq_ignore_ascii_case(word)
    }

    /// Whether the token follows `before` without a space.
    pub(super) fn touches(&self, before: &Self) -> bool {
        before.column + before.width() == self.column
    }
}

/// One line of a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line<'t> {
    /// Line number, counted from 1.
    pub number: usize,
    /// Text of the line, without the line break.
    pub text: &'t str,
    pub tokens: Vec<Token<'t>>,
    /// The comment, including its `#`.
    pub comment: Option<&'t str>,
}

/// The lines of a text.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    unmarked(text).lines().enumerate().map(|(index, text)| line(index + 1, text))
}

/// The line with this number, counted from 1.
pub(super) fn line_at(text: &str, number: usize) -> Option<Line<'_>> {
    unmarked(text).lines().nth(number.checked_sub(1)?).map(|text| line(number, text))
}

/// The text without a byte-order mark.
fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

fn line(number: usize, text: &str) -> Line<'_> {
    let (mut tokens, mut rest, mut column) = (Vec::new(), text, 1);
    loop {
        let trimmed = rest.trim_start();
        column += rest[..rest.len() - trimmed.len()].chars().count();
        let Some(first) = trimmed.chars().next() else {
            return Line { number, text, tokens, comment: None };
        };
        if first == '#' {
            return Line { number, text, tokens, comment: Some(trimmed.trim_end()) };
        }
        let (kind, length) = token(trimmed, first);
        let (word, after) = trimmed.split_at(length);
        tokens.push(Token { kind, text: word, column });
        column += word.chars().count();
        rest = after;
    }
}

/// Kind and length in bytes of the first token of the text.
fn token(text: &str, first: char) -> (Kind, usize) {
    if first == '"' {
        return quoted(text);
    }
    if starts_word(first) {
        return (Kind::Word, text.find(|letter| !continues_word(letter)).unwrap_or(text.len()));
    }
    let length = number_length(text);
    match text[..length].parse() {
        Ok(value) => (Kind::Number(value), length),
        Err(_) if COMPARISONS.iter().any(|sign| text.starts_with(sign)) => (Kind::Sign, 2),
        Err(_) => (Kind::Sign, first.len_utf8()),
    }
}

/// Signs of two characters; the last two are those of other languages.
const COMPARISONS: [&str; 5] = ["<=", ">=", "<>", "==", "!="];

fn quoted(text: &str) -> (Kind, usize) {
    let mut end = 1;
    while let Some(quote) = text[end..].find('"') {
        end += quote + 1;
        // Two quotes are one quote within the name.
        if !text[end..].starts_with('"') {
            return (Kind::Quoted, end);
        }
        end += 1;
    }
    (Kind::Unclosed, text.trim_end().len())
}

/// The text of a name without its quotes.
pub(super) fn unquoted(token: &Token<'_>) -> String {
    match token.kind {
        Kind::Quoted => token.text[1..token.text.len() - 1].replace("\"\"", "\""),
        _ => token.text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, words: &[(Kind, &str, usize)], comment: Option<&str>) {
        let line = line(1, text);
        let found: Vec<_> = line.tokens.iter().map(|it| (it.kind, it.text, it.column)).collect();
        assert_eq!(found, words);
        assert_eq!(line.comment, comment);
    }

    #[test]
    fn lines_are_split_into_tokens_with_columns() {
        use Kind::{Number, Quoted, Sign, Unclosed, Word};
        check("", &[], None);
        check("  # only", &[], Some("# only"));
        check("GET port-1#x ", &[(Word, "GET", 1), (Word, "port-1", 5)], Some("#x"));
        check(
            "T 30deg -.5e-3mm 50%",
            &[
                (Word, "T", 1),
                (Number(30.0), "30", 3),
                (Word, "deg", 5),
                (Sign, "-", 9),
                (Number(0.0005), ".5e-3", 10),
                (Word, "mm", 15),
                (Number(50.0), "50", 18),
                (Sign, "%", 20),
            ],
            None,
        );
        check(
            "26-n n - 1 <=1",
            &[
                (Number(26.0), "26", 1),
                (Sign, "-", 3),
                (Word, "n", 4),
                (Word, "n", 6),
                (Sign, "-", 8),
                (Number(1.0), "1", 10),
                (Sign, "<=", 12),
                (Number(1.0), "1", 14),
            ],
            None,
        );
        check(
            "é \"a # \"\"b\" x",
            &[(Word, "é", 1), (Quoted, "\"a # \"\"b\"", 3), (Word, "x", 13)],
            None,
        );
        check("x \"open  ", &[(Word, "x", 1), (Unclosed, "\"open", 3)], None);
        check(
            "1e 2e+ 3. +",
            &[
                (Number(1.0), "1", 1),
                (Word, "e", 2),
                (Number(2.0), "2", 4),
                (Word, "e", 5),
                (Sign, "+", 6),
                (Number(3.0), "3.", 8),
                (Sign, "+", 11),
            ],
            None,
        );
        check("1e999 .", &[(Number(f64::INFINITY), "1e999", 1), (Sign, ".", 7)], None);
        assert_eq!(unquoted(&line(1, "\"a\"\"b\"").tokens[0]), "a\"b");
    }
}
