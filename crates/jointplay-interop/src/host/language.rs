//! The language of a host.

use super::command::CommandRule;
use crate::controller_text::{AxisFormat, Checksum, Codes, OutputFormat, Template, Value};

/// Text of the file of the neutral language.
pub const NEUTRAL: &str = include_str!("neutral.toml");

/// Largest difference of a line's length from that of its text, for lines with checksums (bytes).
const MOST_FRAMING: usize = 64;

/// Language between a host and the simulated controller: patterns of commands and templates of answers.
#[derive(Debug, Clone, PartialEq)]
pub struct HostLanguage {
    /// Name of the language.
    pub name: String,
    /// Purpose of the language, in one line.
    pub about: String,
    pub(super) axis: AxisFormat,
    pub(super) effector: Template,
    pub(super) slot: Template,
    pub(super) commands: Vec<CommandRule>,
    pub(super) station_codes: Option<Codes>,
    pub(super) effector_codes: Option<Codes>,
    pub(super) input: InputFormat,
    pub(super) answer: Answers,
    pub(super) output: OutputFormat,
}

/// Form of the received lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct InputFormat {
    /// The part of a line that its checksum covers; of `None` the text.
    pub(super) covered: Option<Template>,
    /// The received line; of `None` the covered part.
    pub(super) line: Option<Template>,
    pub(super) checksum: Option<Checksum>,
}

impl InputFormat {
    /// The text within a line, whose form and checksum are verified by writing the line again.
    pub(super) fn text_of<'t>(&self, line: &'t str) -> Option<&'t str> {
        if self.covered.is_none() && self.line.is_none() {
            return Some(line);
        }
        self.candidates(line).find(|text| self.fits(text, line) == Some(true))
    }

    /// Whether a line is that of a text; `None` if templates have no value for it.
    fn fits(&self, text: &str, line: &str) -> Option<bool> {
        let text_value = || Value::Text(text.to_owned());
        let covered = match &self.covered {
            Some(template) => template.fill(|_| text_value()).ok()?,
            None => text.to_owned(),
        };
        let checksum = self.checksum.map_or(0, |one| one.compute(covered.as_bytes()));
        let written = match &self.line {
            Some(template) => template
                .fill(|name| match name {
                    "checksum" => Value::Integer(checksum),
                    "covered" => Value::Text(covered.clone()),
                    _ => text_value(),
                })
                .ok()?,
            None => covered,
        };
        Some(written == line)
    }

    /// Parts of a line that can be the text, the longest first: between a beginning and an end that do not depend on its length.
    fn candidates<'t>(&self, line: &'t str) -> impl Iterator<Item = &'t str> {
        let head = self.head();
        let starts = match &head {
            Some(head) if !line.starts_with(head) => None,
            Some(head) => Some((head.len(), head.len())),
            None => Some((0, MOST_FRAMING)),
        };
        starts.into_iter().flat_map(move |(first, last)| {
            let least = line.len().saturating_sub(MOST_FRAMING);
            (least..=line.len()).rev().flat_map(move |length| {
                let last = last.min(line.len() - length);
                (first..=last).filter_map(move |start| line.get(start..start + length))
            })
        })
    }

    /// What each line has before its text, if that is the same for all texts.
    fn head(&self) -> Option<String> {
        let of_covered = || match &self.covered {
            Some(covered) => covered.literal_before("text").map(str::to_owned),
            None => Some(String::new()),
        };
        let Some(line) = &self.line else { return of_covered() };
        match line.literal_before("covered") {
            Some(literal) => Some(literal.to_owned() + &of_covered()?),
            None => line.literal_before("text").map(str::to_owned),
        }
    }
}

/// Templates of answers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Answers {
    pub(super) welcome: Vec<Template>,
    pub(super) accepted: Vec<Template>,
    pub(super) completed: Vec<Template>,
    pub(super) stopped: Vec<Template>,
    pub(super) refused: Vec<Template>,
    pub(super) status: Vec<Template>,
    pub(super) map: Vec<Template>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(table: &str) -> InputFormat {
        HostLanguage::parse(&format!("{NEUTRAL}\n[input]\n{table}\n")).unwrap().input
    }

    /// Before, each part of a line was tried as the text: 2016 parts of a long line, and a checksum of each.
    #[test]
    fn texts_after_a_known_beginning_are_found_by_few_attempts() {
        let line = "x".repeat(1000);
        for (table, head) in [
            ("covered = \"${text},\"\nline = \"{covered}{checksum:02X}\"\nchecksum = \"sum\"", "$"),
            ("line = \"#{text}*{checksum:02X}\"\nchecksum = \"sum\"", "#"),
            ("covered = \"N{text}\"\nline = \"({covered})\"", "(N"),
            ("covered = \"{text};\"", ""),
        ] {
            let format = input(table);
            assert_eq!(format.head().as_deref(), Some(head), "{table}");
            let framed = format!("{head}{line}");
            assert!(format.candidates(&framed).count() <= MOST_FRAMING + 1, "{table}");
            if !head.is_empty() {
                assert_eq!(format.candidates(&line).count(), 0, "{table}");
            }
        }
    }

    #[test]
    fn texts_after_any_beginning_are_found() {
        for (table, line) in [
            ("line = \"{checksum:X} {text}\"\nchecksum = \"sum\"", "7A HOME 1"),
            ("line = \"{text:>6}|\"", "  HOME|"),
            ("covered = \"{text:>6}\"\nline = \"<{covered}>\"", "<  HOME>"),
        ] {
            let format = input(table);
            assert_eq!(format.head(), None, "{table}");
            let text = format.text_of(line);
            assert!(text.is_some_and(|text| text.trim().starts_with("HOME")), "{table}: {text:?}");
        }
    }
}
