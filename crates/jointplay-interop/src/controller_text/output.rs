//! Lines of the controller text: their numbers and checksums, and the checksum of the file.

use jointplay_format::place::Error;

use super::checksum::{Checksum, Digest};
use super::format_spec::{Kind, Value};
use super::problem::Problem;
use super::template::{Names, Template};

/// Form of the lines, and of the end of the file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OutputFormat {
    /// The part of a line that its checksum covers; of `None` the text.
    pub(crate) covered: Option<Template>,
    /// The written line; of `None` the covered part.
    pub(crate) line: Option<Template>,
    pub(crate) checksum: Option<Checksum>,
    /// Beginnings of lines that are written unchanged and without a number.
    pub(crate) except: Vec<String>,
    pub(crate) line_end: &'static str,
    pub(crate) file_checksum: Option<Checksum>,
    /// Lines after all others.
    pub(crate) last: Vec<Template>,
}

/// Line ends, with their names in files.
pub(crate) const LINE_ENDS: [(&str, &str); 2] = [("lf", "\n"), ("crlf", "\r\n")];

impl Default for OutputFormat {
    fn default() -> Self {
        let (checksum, file_checksum, except, last) = (None, None, Vec::new(), Vec::new());
        Self { covered: None, line: None, checksum, except, line_end: "\n", file_checksum, last }
    }
}

/// Names of `covered`.
pub(crate) fn covered_names() -> Names {
    Names::new(&[("text", Kind::Text), ("number", Kind::Integer)])
}

/// Names of `line`.
pub(crate) fn line_names(checksum: Option<Checksum>) -> Names {
    let known = [("text", Kind::Text), ("covered", Kind::Text), ("number", Kind::Integer)];
    Names::new(&known).with("checksum", "the key `checksum`", checksum.map(|_| Kind::Integer))
}

/// Names of `last`.
pub(crate) fn last_names(checksum: Option<Checksum>) -> Names {
    let kind = checksum.map(|_| Kind::Integer);
    Names::new(&[("lines", Kind::Integer)]).with("checksum", "the key `file_checksum`", kind)
}

/// The text of a file, line by line.
pub(crate) struct Output<'f> {
    format: &'f OutputFormat,
    /// Text that was not yet taken.
    pub(crate) text: String,
    /// Number of numbered lines.
    numbered: i64,
    /// Number of all lines.
    lines: i64,
    digest: Option<Digest>,
}

impl<'f> Output<'f> {
    pub(crate) fn new(format: &'f OutputFormat) -> Self {
        let digest = format.file_checksum.map(Checksum::digest);
        Self { format, text: String::new(), numbered: 0, lines: 0, digest }
    }

    /// Adds the lines of a text.
    pub(crate) fn push(&mut self, text: &str) -> Result<(), Error<Problem>> {
        text.split('\n').try_for_each(|line| self.push_line(line))
    }

    fn push_line(&mut self, text: &str) -> Result<(), Error<Problem>> {
        let start = self.text.len();
        if self.format.except.iter().any(|beginning| text.starts_with(beginning)) {
            self.text.push_str(text);
        } else {
            self.numbered += 1;
            let numbered = self.numbered;
            let text_value = || Value::Text(text.to_owned());
            let covered = match &self.format.covered {
                Some(template) => template.fill(|name| match name {
                    "number" => Value::Integer(numbered),
                    _ => text_value(),
                })?,
                None => text.to_owned(),
            };
            let checksum = self.format.checksum.map_or(0, |one| one.compute(covered.as_bytes()));
            match &self.format.line {
                Some(template) => self.text.push_str(&template.fill(|name| match name {
                    "number" => Value::Integer(numbered),
                    "checksum" => Value::Integer(checksum),
                    "covered" => Value::Text(covered.clone()),
                    _ => text_value(),
                })?),
                None => self.text.push_str(&covered),
            }
        }
        self.text.push_str(self.format.line_end);
        self.lines += 1;
        if let Some(digest) = &mut self.digest {
            digest.update(&self.text.as_bytes()[start..]);
        }
        Ok(())
    }

    /// Adds the last lines; the checksum covers all bytes before them.
    pub(crate) fn finish(&mut self) -> Result<(), Error<Problem>> {
        let (lines, checksum) = (self.lines, self.digest.as_ref().map_or(0, Digest::value));
        for template in &self.format.last {
            let line = template.fill(|name| match name {
                "lines" => Value::Integer(lines),
                _ => Value::Integer(checksum),
            })?;
            self.push(&line)?;
        }
        Ok(())
    }
}
