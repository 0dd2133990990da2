//! Tables of a file and the values of their keys.

use std::cell::RefCell;
use std::ops::Range;

use nalgebra::Vector3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::range::AllowedRange;
use super::reader::Reader;
use crate::file_problem::FileProblem;
use crate::number::number;
use crate::place::{Form, nearest, shortened};
use crate::units::m_from_mm;

/// Longest name of a station, an effector, an axis: as much as fits a table of text.
pub(crate) const LONGEST_NAME: usize = 32;

/// A table of the file, and the keys that were asked for.
pub struct Table<'r, 'a, P> {
    /// The reader that records its errors.
    pub reader: &'r Reader<'a, P>,
    /// How messages call it: `the station "LP1"`.
    pub whose: String,
    /// Where the table is in the text (bytes).
    pub span: Range<usize>,
    table: &'r DeTable<'a>,
    known: RefCell<Vec<&'static str>>,
    /// Keys that were reported already.
    refused: RefCell<Vec<&'static str>>,
}

/// A key with its value.
#[derive(Clone, Copy)]
pub struct Entry<'r, 'a> {
    /// The key.
    pub key: &'r str,
    /// The value.
    pub value: &'r Spanned<DeValue<'a>>,
}

impl<'r, 'a, P: From<FileProblem> + PartialEq> Table<'r, 'a, P> {
    /// A table, and how messages call it.
    pub fn new(
        reader: &'r Reader<'a, P>,
        whose: impl Into<String>,
        table: &'r DeTable<'a>,
        span: Range<usize>,
    ) -> Self {
        let (known, refused) = Default::default();
        Self { reader, whose: whose.into(), span, table, known, refused }
    }

    /// Records an error of the table as a whole.
    pub fn report(&self, problem: impl Into<P>) {
        self.reader.report(self.span.clone(), problem);
    }

    /// Records an error at the value of a key, or at the table if the key is absent.
    pub fn report_at(&self, key: &'static str, problem: impl Into<P>) {
        let span = self.entry(key).map_or(self.span.clone(), |entry| entry.span());
        self.reader.report(span, problem);
    }

    /// The value of a key, if present.
    pub fn entry(&self, key: &'static str) -> Option<Entry<'r, 'a>> {
        if !self.known.borrow().contains(&key) {
            self.known.borrow_mut().push(key);
        }
        self.table.get(key).map(|value| Entry { key, value })
    }

    /// The value of a key that does not belong here, and which `finish` neither reports nor lists.
    pub(crate) fn refused(&self, key: &'static str) -> Option<Entry<'r, 'a>> {
        self.refused.borrow_mut().push(key);
        self.table.get(key).map(|value| Entry { key, value })
    }

    /// The value of a key that is required.
    pub fn needed(&self, key: &'static str) -> Option<Entry<'r, 'a>> {
        let entry = self.entry(key);
        if entry.is_none() {
            self.missing(key);
        }
        entry
    }

    /// Whether the file names another kind, which is reported; the keys of such a file are not checked.
    pub(crate) fn has_other_kind(&self, kind: &'static str) -> bool {
        let Some(entry) = self.needed("kind") else { return false };
        entry.word(self.reader, "kind", &[(kind, ())]).is_none() && entry.is_text()
    }

    /// Records that a key is missing.
    pub fn missing(&self, key: &str) {
        self.report(FileProblem::MissingKey { whose: self.whose.clone(), key: key.to_owned() });
    }

    /// A number that is required, in the unit of the file.
    pub fn number(&self, key: &'static str, allowed: AllowedRange) -> Option<f64> {
        self.needed(key)?.number(self.reader, allowed)
    }

    /// A number that is optional, in the unit of the file.
    pub fn number_or(&self, key: &'static str, allowed: AllowedRange, default: f64) -> f64 {
        self.entry(key).and_then(|entry| entry.number(self.reader, allowed)).unwrap_or(default)
    }

    /// A length in a key that ends in `_mm` (m).
    pub fn length(&self, key: &'static str, allowed: AllowedRange) -> Option<f64> {
        self.number(key, allowed).map(m_from_mm)
    }

    /// A length that is optional (m).
    pub fn length_or(&self, key: &'static str, allowed: AllowedRange, default: f64) -> f64 {
        let found = self.entry(key).and_then(|entry| entry.number(self.reader, allowed));
        found.map_or(default, m_from_mm)
    }

    /// A name that is required and that programs can write.
    pub fn name(&self, key: &'static str) -> Option<String> {
        self.needed(key)?.name(self.reader)
    }

    /// Three lengths that have to be there (m).
    pub fn point(&self, key: &'static str) -> Option<Vector3<f64>> {
        self.needed(key)?.point(self.reader)
    }

    /// A table within the table, if present.
    pub fn table(&self, key: &'static str, whose: impl Into<String>) -> Option<Table<'r, 'a, P>> {
        self.entry(key)?.table(self.reader, whose)
    }

    /// The tables of `[[key]]`; none if absent.
    pub fn tables(&self, key: &'static str) -> Vec<Table<'r, 'a, P>> {
        let Some(entry) = self.entry(key) else { return Vec::new() };
        let Some(list) = entry.list(self.reader) else { return Vec::new() };
        let table = |entry: Entry<'r, 'a>| entry.table(self.reader, format!("`[[{key}]]`"));
        list.into_iter().filter_map(table).collect()
    }

    /// The keys with their values, and the spans of the keys (bytes).
    pub fn entries(&self) -> impl Iterator<Item = (Entry<'r, 'a>, Range<usize>)> {
        let entry = |(key, value): (&'r Spanned<_>, _)| {
            let name: &'r std::borrow::Cow<'a, str> = key.get_ref();
            (Entry { key: name, value }, key.span())
        };
        self.table.iter().map(entry)
    }

    /// Reports all keys that were never asked for.
    pub fn finish(&self) {
        let (known, refused) = (self.known.borrow(), self.refused.borrow());
        let is_unknown = |key: &&Spanned<_>| {
            let name: &std::borrow::Cow<str> = key.get_ref();
            !known.contains(&name.as_ref()) && !refused.contains(&name.as_ref())
        };
        let mut unknown: Vec<_> = self.table.keys().filter(is_unknown).collect();
        // Of very many, the first in the file are listed.
        unknown.sort_by_key(|key| key.span().start);
        for key in unknown {
            let name: &str = key.get_ref();
            let fault = || {
                let form = Form::UnknownKey {
                    key: name.to_owned(),
                    nearest: nearest(name, known.iter().copied()),
                    known: known.iter().map(|&name| name.to_owned()).collect(),
                };
                FileProblem::from(form).into()
            };
            self.reader.report_with(key.span(), fault);
        }
    }
}

impl<'r, 'a> Entry<'r, 'a> {
    /// Where the value is in the text (bytes).
    #[must_use]
    pub fn span(&self) -> Range<usize> {
        self.value.span()
    }

    /// Records an error at the value.
    pub fn report<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        problem: impl Into<P>,
    ) {
        reader.report(self.span(), problem);
    }

    /// Reports a value of another type.
    pub fn type_error<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        needed: &str,
    ) {
        if self.value.get_ref().is_integer() && self.any_integer().is_none() {
            let key = self.key.to_owned();
            self.report(reader, FileProblem::IntegerTooLarge { key });
            return;
        }
        let found = match self.value.get_ref() {
            DeValue::String(text) => format!("the text {}", shortened(&format!("{text:?}"))),
            DeValue::Integer(found) => {
                let value = found.as_str().replace('_', "").parse();
                let shown = value.map_or_else(|_| found.to_string(), number);
                format!("the number {shown}")
            }
            DeValue::Float(found) => {
                let value = found.as_str().replace('_', "").parse();
                format!("the number {}", value.map_or_else(|_| found.as_str().to_owned(), number))
            }
            DeValue::Boolean(value) => format!("{value}"),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(list) => format!("a list of {}", list.len()),
            DeValue::Table(_) => "a table".to_owned(),
        };
        let key = self.key.to_owned();
        self.report(reader, FileProblem::TypeMismatch { key, needed: needed.to_owned(), found });
    }

    /// Whether the value is a text.
    #[must_use]
    pub fn is_text(&self) -> bool {
        self.value.get_ref().is_str()
    }

    /// Whether the value is an empty list.
    #[must_use]
    pub fn list_is_empty(&self) -> bool {
        self.value.get_ref().as_array().is_some_and(|list| list.is_empty())
    }

    /// A number of any size, NaN and infinities included; nothing for another type.
    #[must_use]
    pub fn any_number(&self) -> Option<f64> {
        match self.value.get_ref() {
            DeValue::Float(number) => number.as_str().replace('_', "").parse().ok(),
            DeValue::Integer(_) => self.any_integer().map(|number| number as f64),
            _ => None,
        }
    }

    fn any_integer(&self) -> Option<i64> {
        let number = self.value.get_ref().as_integer()?;
        i64::from_str_radix(number.as_str(), number.radix()).ok()
    }

    /// A whole number, written without a decimal point.
    pub fn integer<P: From<FileProblem> + PartialEq>(&self, reader: &Reader<'_, P>) -> Option<i64> {
        let value = self.any_integer();
        if value.is_none() {
            self.type_error(reader, "a whole number");
        }
        value
    }

    /// A number, in the unit of the file, or the value of an expression where the file allows it.
    pub fn number<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        allowed: AllowedRange,
    ) -> Option<f64> {
        let value = match self.any_number() {
            Some(value) => value,
            None => self.expression(reader)?,
        };
        self.within(reader, value, allowed)
    }

    /// A number read from the value, if it is allowed; another number is reported.
    pub fn within<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        value: f64,
        allowed: AllowedRange,
    ) -> Option<f64> {
        if !allowed.holds(value) {
            let (key, needed) = (self.key.to_owned(), allowed.needed(value));
            self.report(reader, FileProblem::OutOfRange { key, value, needed });
            return None;
        }
        Some(value)
    }

    /// A whole number from `least` to `most`.
    pub fn count<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        least: usize,
        most: usize,
    ) -> Option<usize> {
        let value = self.number(reader, AllowedRange::Within(least as f64, most as f64))?;
        if value.fract() != 0.0 {
            if self.is_text() {
                let (key, needed) = (self.key.to_owned(), "a whole number".to_owned());
                self.report(reader, FileProblem::OutOfRange { key, value, needed });
            } else {
                self.type_error(reader, "a whole number");
            }
            return None;
        }
        Some(value as usize)
    }

    /// True or false.
    pub fn flag<P: From<FileProblem> + PartialEq>(&self, reader: &Reader<'_, P>) -> Option<bool> {
        let flag = self.value.get_ref().as_bool();
        if flag.is_none() {
            self.type_error(reader, "true or false");
        }
        flag
    }

    /// A text.
    pub fn text<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
    ) -> Option<&'r str> {
        let text = self.value.get_ref().as_str();
        if text.is_none() {
            self.type_error(reader, "a text");
        }
        text
    }

    /// One line of text without control characters.
    pub fn line<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
    ) -> Option<&'r str> {
        let text = self.text(reader)?;
        if text.is_empty() || text.chars().any(char::is_control) {
            self.type_error(reader, "one line of text");
            return None;
        }
        Some(text)
    }

    /// A name that programs can write.
    pub fn name<P: From<FileProblem> + PartialEq>(&self, reader: &Reader<'_, P>) -> Option<String> {
        let name = self.text(reader)?;
        let letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
        let right = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.len() <= LONGEST_NAME
            && name.chars().all(letter);
        if !right {
            let (key, found) = (self.key.to_owned(), name.to_owned());
            self.report(reader, FileProblem::Name { key, found, longest: LONGEST_NAME });
            return None;
        }
        Some(name.to_owned())
    }

    /// One of a closed list of words.
    pub fn word<T: Clone, P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        what: &str,
        known: &[(&str, T)],
    ) -> Option<T> {
        let word = self.text(reader)?;
        let found = known.iter().find(|(name, _)| *name == word).map(|(_, value)| value.clone());
        if found.is_none() {
            let names: Vec<String> = known.iter().map(|(name, _)| (*name).to_owned()).collect();
            self.unknown(reader, what, word, &names);
        }
        found
    }

    /// Reports a name that is none of the known ones.
    pub fn unknown<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        what: &str,
        found: &str,
        known: &[String],
    ) {
        let known = known.iter().map(String::as_str);
        reader.report_with(self.span(), || FileProblem::unknown(what, found, known).into());
    }

    /// The entries of a list.
    pub fn list<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
    ) -> Option<Vec<Entry<'r, 'a>>> {
        let Some(list) = self.value.get_ref().as_array() else {
            self.type_error(reader, "a list");
            return None;
        };
        Some(list.iter().map(|value| Entry { key: self.key, value }).collect())
    }

    /// A list of exactly `N` numbers.
    pub fn numbers<const N: usize, P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        allowed: AllowedRange,
    ) -> Option<[f64; N]> {
        let list = self.list(reader)?;
        if list.len() != N {
            let (key, needed) = (self.key.to_owned(), N.to_string());
            self.report(reader, FileProblem::Count { key, found: list.len(), needed });
            return None;
        }
        let mut numbers = [0.0; N];
        let mut right = true;
        for (number, entry) in numbers.iter_mut().zip(&list) {
            match entry.number(reader, allowed) {
                Some(found) => *number = found,
                None => right = false,
            }
        }
        right.then_some(numbers)
    }

    /// Three lengths in mm (m).
    pub fn point<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
    ) -> Option<Vector3<f64>> {
        self.numbers::<3, _>(reader, AllowedRange::Any).map(|numbers| numbers.map(m_from_mm).into())
    }

    /// A table, and how messages call it.
    pub fn table<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &'r Reader<'a, P>,
        whose: impl Into<String>,
    ) -> Option<Table<'r, 'a, P>> {
        let Some(table) = self.value.get_ref().as_table() else {
            self.type_error(reader, "a table");
            return None;
        };
        Some(Table::new(reader, whose, table, self.span()))
    }
}
