//! Tables of TOML that are read key by key, every problem noted with its place.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use nalgebra::Vector3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::problem::{Fault, Problem};
use crate::number::number;
use crate::place::{Form, Place, malformed, nearest, shortened};
use crate::units::m_from_mm;

/// Longest name of a station, an effector, an axis: as much as fits a table of text.
const LONGEST_NAME: usize = 32;

/// Most problems listed of one file; the rest is most often their consequence, and is counted.
const MOST_PROBLEMS: usize = 20;

/// A text and what is wrong with it.
pub(super) struct Reader<'a> {
    text: &'a str,
    problems: RefCell<Vec<Problem>>,
    /// Whether the text is no TOML: then nothing is reported of its contents, which are guesses.
    malformed: Cell<bool>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, problems: RefCell::default(), malformed: Cell::new(false) }
    }

    /// The whole file; the first error of its syntax is noted, and hides those that follow from it.
    pub(super) fn parse(&self) -> Spanned<DeTable<'a>> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
        if let Some(first) = errors.iter().min_by_key(|error| start(error)) {
            self.wrong(first.span().unwrap_or(0..0), malformed(first.message()));
            self.malformed.set(true);
        }
        table
    }

    pub(super) fn wrong(&self, span: Range<usize>, fault: impl Into<Fault>) {
        if !self.malformed.get() {
            self.problems.borrow_mut().push(Problem::at(self.text, span, fault.into()));
        }
    }

    pub(super) fn line(&self, span: Range<usize>) -> usize {
        Place::of(self.text, span).line
    }

    pub(super) fn is_clean(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// The value if nothing was wrong, and otherwise all that was, in order of place.
    pub(super) fn done<T>(self, value: Option<T>) -> Result<T, Vec<Problem>> {
        let mut problems = self.problems.into_inner();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => {
                problems.sort_by_key(|problem| (problem.place.line, problem.place.column));
                problems.dedup();
                let more = problems.len().saturating_sub(MOST_PROBLEMS);
                if more > 0 {
                    problems.truncate(MOST_PROBLEMS + 1);
                    *problems[MOST_PROBLEMS].problem = Fault::More(more);
                }
                Err(problems)
            }
        }
    }
}

/// A table of the file, and which keys were asked of it.
pub(super) struct Table<'r, 'a> {
    pub(super) reader: &'r Reader<'a>,
    /// How messages call it: `the station "LP1"`.
    pub(super) whose: String,
    pub(super) span: Range<usize>,
    table: &'r DeTable<'a>,
    known: RefCell<Vec<&'static str>>,
}

/// A value with the key that it stands under.
#[derive(Clone, Copy)]
pub(super) struct Entry<'r, 'a> {
    pub(super) key: &'static str,
    pub(super) value: &'r Spanned<DeValue<'a>>,
}

/// Smaller numbers become 0 when their unit is changed, or divide to infinity.
const LEAST_POSITIVE: f64 = 1e-12;

/// What a number has to be.
#[derive(Clone, Copy)]
pub(super) enum Span {
    Any,
    Positive,
    NotNegative,
    Within(f64, f64),
}

impl Span {
    fn holds(self, value: f64) -> bool {
        value.is_finite()
            && value.abs() <= 1e12
            && match self {
                Self::Any => true,
                Self::Positive => value >= LEAST_POSITIVE,
                Self::NotNegative => value >= 0.0,
                Self::Within(min, max) => (min..=max).contains(&value),
            }
    }

    /// What a value has to be that is not.
    fn needed(self, value: f64) -> String {
        match self {
            Self::Any => "a finite number".to_owned(),
            Self::Positive if value > 0.0 => format!("at least {LEAST_POSITIVE:e}"),
            Self::Positive => "positive".to_owned(),
            Self::NotNegative => "0 or more".to_owned(),
            Self::Within(min, max) => format!("from {} to {}", number(min), number(max)),
        }
    }
}

impl<'r, 'a> Table<'r, 'a> {
    pub(super) fn new(
        reader: &'r Reader<'a>,
        whose: impl Into<String>,
        table: &'r DeTable<'a>,
        span: Range<usize>,
    ) -> Self {
        Self { reader, whose: whose.into(), span, table, known: RefCell::default() }
    }

    /// Notes something wrong with the table as a whole.
    pub(super) fn wrong(&self, fault: impl Into<Fault>) {
        self.reader.wrong(self.span.clone(), fault);
    }

    /// Notes something wrong with what stands under a key, or with the table where nothing does.
    pub(super) fn wrong_at(&self, key: &'static str, fault: impl Into<Fault>) {
        let span = self.entry(key).map_or(self.span.clone(), |entry| entry.span());
        self.reader.wrong(span, fault);
    }

    /// The value of a key, if it is there.
    pub(super) fn entry(&self, key: &'static str) -> Option<Entry<'r, 'a>> {
        if !self.known.borrow().contains(&key) {
            self.known.borrow_mut().push(key);
        }
        self.table.get(key).map(|value| Entry { key, value })
    }

    /// The value of a key that has to be there.
    pub(super) fn needed(&self, key: &'static str) -> Option<Entry<'r, 'a>> {
        let entry = self.entry(key);
        if entry.is_none() {
            self.missing(key);
        }
        entry
    }

    pub(super) fn missing(&self, key: &str) {
        self.wrong(Fault::Missing { whose: self.whose.clone(), key: key.to_owned() });
    }

    /// A number that has to be there, in the unit of the file.
    pub(super) fn number(&self, key: &'static str, span: Span) -> Option<f64> {
        self.needed(key)?.number(self.reader, span)
    }

    /// A number that may be left out, in the unit of the file.
    pub(super) fn number_or(&self, key: &'static str, span: Span, default: f64) -> f64 {
        self.entry(key).and_then(|entry| entry.number(self.reader, span)).unwrap_or(default)
    }

    /// A length in a key that ends in `_mm` [m].
    pub(super) fn length(&self, key: &'static str, span: Span) -> Option<f64> {
        self.number(key, span).map(m_from_mm)
    }

    /// A length that may be left out [m].
    pub(super) fn length_or(&self, key: &'static str, span: Span, default: f64) -> f64 {
        let found = self.entry(key).and_then(|entry| entry.number(self.reader, span));
        found.map_or(default, m_from_mm)
    }

    /// A name that has to be there and that programs can write.
    pub(super) fn name(&self, key: &'static str) -> Option<String> {
        self.needed(key)?.name(self.reader)
    }

    /// Three lengths that have to be there [m].
    pub(super) fn point(&self, key: &'static str) -> Option<Vector3<f64>> {
        self.needed(key)?.point(self.reader)
    }

    /// A table within the table, if it is there.
    pub(super) fn table(
        &self,
        key: &'static str,
        whose: impl Into<String>,
    ) -> Option<Table<'r, 'a>> {
        self.entry(key)?.table(self.reader, whose)
    }

    /// The tables of `[[key]]`; none, if it is not there.
    pub(super) fn tables(&self, key: &'static str) -> Vec<Table<'r, 'a>> {
        let Some(entry) = self.entry(key) else { return Vec::new() };
        let Some(list) = entry.list(self.reader) else { return Vec::new() };
        let table = |entry: Entry<'r, 'a>| entry.table(self.reader, format!("`[[{key}]]`"));
        list.into_iter().filter_map(table).collect()
    }

    /// Notes all keys that were never asked for.
    pub(super) fn finish(&self) {
        let known = self.known.borrow();
        for key in self.table.keys() {
            let name: &str = key.get_ref();
            if !known.contains(&name) {
                let fault = Form::UnknownKey {
                    key: name.to_owned(),
                    nearest: nearest(name, known.iter().copied()),
                    known: known.iter().map(|&name| name.to_owned()).collect(),
                };
                self.reader.wrong(key.span(), fault);
            }
        }
    }
}

impl<'r, 'a> Entry<'r, 'a> {
    pub(super) fn span(&self) -> Range<usize> {
        self.value.span()
    }

    pub(super) fn wrong(&self, reader: &Reader, fault: impl Into<Fault>) {
        reader.wrong(self.span(), fault);
    }

    /// Notes that the value is of another kind.
    pub(super) fn misfit(&self, reader: &Reader, needed: &str) {
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
        self.wrong(reader, Fault::Kind { key, needed: needed.to_owned(), found });
    }

    pub(super) fn is_text(&self) -> bool {
        self.value.get_ref().is_str()
    }

    pub(super) fn list_is_empty(&self) -> bool {
        self.value.get_ref().as_array().is_some_and(|list| list.is_empty())
    }

    pub(super) fn number(&self, reader: &Reader, span: Span) -> Option<f64> {
        let value = match self.value.get_ref() {
            DeValue::Float(number) => number.as_str().replace('_', "").parse().ok(),
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
                .ok()
                .map(|number| number as f64),
            _ => None,
        };
        let Some(value) = value else {
            self.misfit(reader, "a number");
            return None;
        };
        if !span.holds(value) {
            let (key, needed) = (self.key.to_owned(), span.needed(value));
            self.wrong(reader, Fault::Beyond { key, value, needed });
            return None;
        }
        Some(value)
    }

    /// A whole number from `least` to `most`.
    pub(super) fn count(&self, reader: &Reader, least: usize, most: usize) -> Option<usize> {
        let value = self.number(reader, Span::Within(least as f64, most as f64))?;
        if value.fract() != 0.0 {
            self.misfit(reader, "a whole number");
            return None;
        }
        Some(value as usize)
    }

    pub(super) fn flag(&self, reader: &Reader) -> Option<bool> {
        let flag = self.value.get_ref().as_bool();
        if flag.is_none() {
            self.misfit(reader, "true or false");
        }
        flag
    }

    pub(super) fn text(&self, reader: &Reader) -> Option<&'r str> {
        let text = self.value.get_ref().as_str();
        if text.is_none() {
            self.misfit(reader, "a text");
        }
        text
    }

    /// A text without characters that would upset a terminal.
    pub(super) fn line(&self, reader: &Reader) -> Option<&'r str> {
        let text = self.text(reader)?;
        if text.is_empty() || text.chars().any(char::is_control) {
            self.misfit(reader, "one line of text");
            return None;
        }
        Some(text)
    }

    pub(super) fn name(&self, reader: &Reader) -> Option<String> {
        let name = self.text(reader)?;
        let letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
        let right = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.len() <= LONGEST_NAME
            && name.chars().all(letter);
        if !right {
            let (key, found) = (self.key.to_owned(), name.to_owned());
            self.wrong(reader, Fault::Name { key, found, longest: LONGEST_NAME });
            return None;
        }
        Some(name.to_owned())
    }

    /// One of a closed list of words.
    pub(super) fn word<T: Clone>(
        &self,
        reader: &Reader,
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

    /// Notes that a name is none of the known ones.
    pub(super) fn unknown(&self, reader: &Reader, what: &str, found: &str, known: &[String]) {
        let fault = Fault::Unknown {
            what: what.to_owned(),
            found: found.to_owned(),
            nearest: nearest(found, known.iter().map(String::as_str)),
            known: known.to_vec(),
        };
        self.wrong(reader, fault);
    }

    pub(super) fn list(&self, reader: &Reader) -> Option<Vec<Entry<'r, 'a>>> {
        let Some(list) = self.value.get_ref().as_array() else {
            self.misfit(reader, "a list");
            return None;
        };
        Some(list.iter().map(|value| Entry { key: self.key, value }).collect())
    }

    /// A list of exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, reader: &Reader, span: Span) -> Option<[f64; N]> {
        let list = self.list(reader)?;
        if list.len() != N {
            let (key, needed) = (self.key.to_owned(), N.to_string());
            self.wrong(reader, Fault::Count { key, found: list.len(), needed });
            return None;
        }
        let mut numbers = [0.0; N];
        let mut right = true;
        for (number, entry) in numbers.iter_mut().zip(&list) {
            match entry.number(reader, span) {
                Some(found) => *number = found,
                None => right = false,
            }
        }
        right.then_some(numbers)
    }

    /// Three lengths in mm [m].
    pub(super) fn point(&self, reader: &Reader) -> Option<Vector3<f64>> {
        self.numbers::<3>(reader, Span::Any).map(|numbers| numbers.map(m_from_mm).into())
    }

    pub(super) fn table(
        &self,
        reader: &'r Reader<'a>,
        whose: impl Into<String>,
    ) -> Option<Table<'r, 'a>> {
        let Some(table) = self.value.get_ref().as_table() else {
            self.misfit(reader, "a table");
            return None;
        };
        Some(Table::new(reader, whose, table, self.span()))
    }
}
