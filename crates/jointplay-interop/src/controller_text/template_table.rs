//! Templates of a table of a file, and the form of its lines.

use jointplay_format::toml_reader::Entry;

use super::checksum::Checksum;
use super::output::{LINE_ENDS, OutputFormat, covered_names, last_names, line_names};
use super::problem::Problem;
use super::template::{Decimals, Names, Template};
use super::tree::Table;

/// Largest number of decimals.
const MOST_DECIMALS: usize = 12;

/// A table with what its templates need.
pub(crate) struct TemplateTable<'t, 'r, 'a> {
    pub(crate) top: &'t Table<'r, 'a>,
    pub(crate) decimals: Decimals,
}

impl<'t, 'r, 'a> TemplateTable<'t, 'r, 'a> {
    /// The top table of a file, with its keys `decimals` and `time_decimals`, and whether these are valid; templates are also checked where they are not.
    pub(crate) fn of_file(top: &'t Table<'r, 'a>) -> (Self, bool) {
        let decimals = |key| top.needed(key)?.count(top.reader, 0, MOST_DECIMALS);
        let (values, times) = (decimals("decimals"), decimals("time_decimals"));
        let are_valid = values.is_some() && times.is_some();
        let decimals = Decimals { values: values.unwrap_or(0), times: times.unwrap_or(0) };
        (Self { top, decimals }, are_valid)
    }

    pub(crate) fn template(&self, entry: &Entry<'_, '_>, names: &Names) -> Option<Template> {
        let reader = self.top.reader;
        let text = entry.text(reader)?;
        let span = |part| entry.part_span(reader, text, part);
        let read = Template::parse(text, names, self.decimals, |part| reader.place(span(part)));
        read.map_err(|(part, problem)| reader.report(span(part), problem)).ok()
    }

    pub(crate) fn required(&self, key: &'static str, names: &Names) -> Option<Template> {
        self.template(&self.top.needed(key)?, names)
    }

    pub(crate) fn templates(&self, entry: &Entry<'_, '_>, names: &Names) -> Option<Vec<Template>> {
        // All templates are read, so that each error is reported.
        let list = entry.list(self.top.reader)?;
        let read: Vec<_> = list.iter().map(|one| self.template(one, names)).collect();
        read.into_iter().collect()
    }

    /// The templates of a key; none if absent.
    pub(crate) fn list(&self, key: &'static str, names: &Names) -> Option<Vec<Template>> {
        match self.top.entry(key) {
            Some(entry) => self.templates(&entry, names),
            None => Some(Vec::new()),
        }
    }

    /// Whether a template keeps the text that it is for; reports one that does not.
    pub(crate) fn keeps_text(
        &self,
        key: &'static str,
        keeps: bool,
        needed: &'static str,
        lost: &'static str,
    ) -> bool {
        if let Some(entry) = self.top.entry(key).filter(|_| !keeps) {
            entry.report(self.top.reader, Problem::TextLost { key, needed, lost });
        }
        keeps
    }

    /// The table `[output]` of a file, or the format of files without one.
    pub(crate) fn output_or_default(&self) -> Option<OutputFormat> {
        let Some(table) = self.top.table("output", "`[output]`") else {
            return Some(OutputFormat::default());
        };
        let output = TemplateTable { top: &table, decimals: self.decimals }.output();
        table.finish();
        output
    }

    /// The entries of the table `[output]`.
    fn output(&self) -> Option<OutputFormat> {
        let (top, reader) = (self.top, self.top.reader);
        let checksum = |key| {
            let word = |entry: Entry<'_, '_>| entry.word(reader, "checksum", &Checksum::ALL);
            top.entry(key).and_then(word)
        };
        // Where the checksum is not known, templates are checked as if it were.
        let (line_sum, file_sum) = (checksum("checksum"), checksum("file_checksum"));
        let assumed =
            |sum: Option<Checksum>, key| sum.or_else(|| top.entry(key).map(|_| Checksum::Xor));
        let one = |key, names| match top.entry(key) {
            Some(entry) => self.template(&entry, &names).map(Some),
            None => Some(None),
        };
        let covered = one("covered", covered_names());
        let line = one("line", line_names(assumed(line_sum, "checksum")));
        let last = self.list("last", &last_names(assumed(file_sum, "file_checksum")));
        let except = match top.entry("except") {
            Some(entry) => entry.list(reader).and_then(|list| {
                list.iter().map(|one| one.line(reader).map(str::to_owned)).collect()
            }),
            None => Some(Vec::new()),
        };
        let line_end = match top.entry("line_end") {
            Some(entry) => entry.word(reader, "line end", &LINE_ENDS),
            None => Some("\n"),
        };
        let (covered, line) = (covered?, line?);
        let is_covered = covered.as_ref().is_none_or(|covered| covered.uses("text"));
        let keeps = match &line {
            Some(line) => {
                let keeps = line.uses("text") || (line.uses("covered") && is_covered);
                self.keeps_text("line", keeps, "{text}, and no {covered} with it", "lines")
            }
            None => self.keeps_text("covered", is_covered, "{text}", "lines"),
        };
        keeps.then_some(OutputFormat {
            covered,
            line,
            checksum: line_sum,
            except: except?,
            line_end: line_end?,
            file_checksum: file_sum,
            last: last?,
        })
    }
}

/// The unit of a key.
pub(crate) fn unit<U: Copy>(
    top: &Table<'_, '_>,
    key: &'static str,
    all: &[(&str, U)],
) -> Option<U> {
    top.needed(key)?.word(top.reader, &format!("unit of {key}"), all)
}
