//! Errors of files with their places: line, column and excerpt.

use std::ops::Range;

/// Most names listed in a message.
const MOST_LISTED: usize = 16;

/// Longest part of a line that a message shows, in characters.
const LONGEST_LINE: usize = 160;

/// Longest part of a line before the place, in characters.
const LONGEST_BEFORE: usize = 80;

/// A position in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// Number of characters.
    pub width: usize,
    /// The line itself.
    pub text: String,
}

impl Place {
    /// The place of a span of bytes; the first line of it, where it has several.
    #[must_use]
    pub fn of(text: &str, span: Range<usize>) -> Self {
        let start = text.floor_char_boundary(span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let line = text[line_start..].lines().next().unwrap_or_default();
        let within = text.get(start..span.end.min(line_start + line.len())).unwrap_or_default();
        Self {
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            width: within.chars().count(),
            text: line.to_owned(),
        }
    }
}

/// An error of a file with its place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct Error<P> {
    /// Where in the file.
    pub place: Place,
    /// The error.
    pub problem: Box<P>,
}

impl<P> Error<P> {
    /// A problem at a span of bytes of a text.
    #[must_use]
    pub fn at(text: &str, span: Range<usize>, problem: P) -> Self {
        Self { place: Place::of(text, span), problem: Box::new(problem) }
    }
}

impl<P: std::fmt::Display> Error<P> {
    /// The whole message: file, line and column, the line itself, and carets under the place.
    #[must_use]
    pub fn with_excerpt(&self, file: &str) -> String {
        let Place { line, column, width, text } = &self.place;
        let number = line.to_string();
        let gutter = " ".repeat(number.len());
        // Of a long line only the part around the place; a tab is one space, as for the carets.
        let skipped = column.saturating_sub(LONGEST_BEFORE + 1);
        let visible = |letter: char| if letter.is_control() { ' ' } else { letter };
        let shown: String = text.chars().map(visible).skip(skipped).take(LONGEST_LINE).collect();
        let (head, tail) = (
            if skipped > 0 { "…" } else { "" },
            if shown.chars().count() + skipped < text.chars().count() { "…" } else { "" },
        );
        let before = " ".repeat(column - 1 - skipped + head.chars().count());
        let room = LONGEST_LINE - (column - 1 - skipped);
        let carets = "^".repeat((*width).clamp(1, room));
        format!(
            "{file}:{line}:{column}: {self}\n{gutter} |\n{number} | {head}{shown}{tail}\n{gutter} | {before}{carets}"
        )
    }
}

/// All errors of a file in the order of their places, at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors<P>(Vec<Error<P>>);

impl<P: std::fmt::Display> Errors<P> {
    /// The messages with file, line, column and carets, one below the other.
    #[must_use]
    pub fn with_excerpt(&self, file: &str) -> String {
        self.0.iter().map(|error| error.with_excerpt(file)).collect::<Vec<_>>().join("\n")
    }
}

impl<P: std::fmt::Display> std::fmt::Display for Errors<P> {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            let line_break = if index > 0 { "\n" } else { "" };
            write!(to, "{line_break}line {}: {error}", error.place.line)?;
        }
        Ok(())
    }
}

impl<P: std::fmt::Debug + std::fmt::Display> std::error::Error for Errors<P> {}

impl<P> From<Vec<Error<P>>> for Errors<P> {
    fn from(errors: Vec<Error<P>>) -> Self {
        Self(errors)
    }
}

impl<P> std::ops::Deref for Errors<P> {
    type Target = [Error<P>];

    fn deref(&self) -> &[Error<P>] {
        &self.0
    }
}

impl<P> IntoIterator for Errors<P> {
    type Item = Error<P>;
    type IntoIter = std::vec::IntoIter<Error<P>>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

/// Errors in the form of any file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Form {
    /// A key that does not exist.
    #[error("unknown key `{key}`{}; known here: {}", suggestion(nearest), known.join(", "))]
    UnknownKey {
        /// The key found.
        key: String,
        /// The known key most like it.
        nearest: Option<String>,
        /// All keys known there.
        known: Vec<String>,
    },
    /// Invalid TOML.
    #[error("{message}")]
    Malformed {
        /// The message of the TOML parser.
        message: String,
    },
}

/// A message of the TOML reader about syntax, as one of ours.
pub(crate) fn malformed(message: &str) -> Form {
    let message = message.replace('\n', " ");
    Form::Malformed { message }
}

/// A text for a message, with `…` in place of what is beyond forty characters.
pub(crate) fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain("…".chars()).collect()
}

/// The known name most like this one, if any is like it at all.
#[must_use]
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.to_owned())
}

/// ` (did you mean …?)`, or nothing.
#[must_use]
pub fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

/// Message for an unknown name, with the most similar known one.
#[must_use]
pub fn not_known(what: &str, found: &str, known: &[String]) -> String {
    let nearest = nearest(found, known.iter().map(String::as_str));
    format!("{what} `{found}` is not known{}; known: {}", suggestion(&nearest), listed(known))
}

/// Names in one line; the first of them, where there are very many.
#[must_use]
pub fn listed(names: &[String]) -> String {
    match names.len() {
        0 => "none".to_owned(),
        count if count <= MOST_LISTED => names.join(", "),
        count => format!("{} and {} more", names[..MOST_LISTED].join(", "), count - MOST_LISTED),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_long_line_the_part_around_the_place_is_shown() {
        let text = format!("{}\tfault{}", "a".repeat(500), "b".repeat(500));
        let error = Error::at(&text, 501..506, Form::Malformed { message: "no".to_owned() });
        let shown = error.with_excerpt("x");
        let lines: Vec<Vec<char>> = shown.lines().map(|line| line.chars().collect()).collect();
        assert_eq!(shown.lines().next(), Some("x:1:502: no"));
        assert_eq!(lines[2].len(), "1 | ".len() + LONGEST_LINE + 2);
        let carets = lines[3].iter().position(|&letter| letter == '^').unwrap();
        assert_eq!(lines[3].len() - carets, 5);
        assert_eq!(lines[2][carets..carets + 5].iter().collect::<String>(), "fault");
        assert!(!shown.contains('\t'));
    }
}
