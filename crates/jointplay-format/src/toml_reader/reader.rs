//! The text of a file and its errors.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use toml::Spanned;
use toml::de::DeTable;

use super::source::{Inclusion, Sources};
use crate::expression::Scope;
use crate::file_problem::FileProblem;
use crate::place::{Error, Errors, Place, malformed};

/// Largest number of errors listed for one file; the others, most often consequences, are counted.
const MOST_LISTED: usize = 20;

/// Largest number of errors recorded for one file; later ones are counted, so that time and memory stay limited.
const MOST_RECORDED: usize = 200;

/// A text and the errors found in it.
pub struct Reader<'a, P> {
    text: &'a str,
    /// Texts of the document; those of others have positions beyond the file.
    sources: RefCell<Sources<P>>,
    problems: RefCell<Vec<(Range<usize>, P)>>,
    /// Number of errors beyond those recorded.
    unrecorded: Cell<usize>,
    /// Whether the text is invalid TOML: then no errors of its contents are reported, which are guesses.
    malformed: Cell<bool>,
    /// Values of the expressions read so far, by the position of their text.
    evaluated: RefCell<BTreeMap<usize, f64>>,
}

impl<'a, P: From<FileProblem> + PartialEq> Reader<'a, P> {
    /// A reader of a text without errors so far.
    #[must_use]
    pub fn new(text: &'a str) -> Self {
        Self {
            text,
            sources: RefCell::new(Sources::new(text.len())),
            problems: RefCell::default(),
            unrecorded: Cell::new(0),
            malformed: Cell::new(false),
            evaluated: RefCell::default(),
        }
    }

    /// Whether the text has at most `allowed` bytes; a longer text is reported.
    pub fn has_at_most(&self, allowed: usize) -> bool {
        let found = self.text.len();
        if found > allowed {
            self.report(0..0, FileProblem::TooLong { found, allowed });
        }
        found <= allowed
    }

    /// Parses the whole text; the first syntax error is recorded and hides its consequences.
    pub fn parse(&self) -> Spanned<DeTable<'a>> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
        if let Some(first) = errors.iter().min_by_key(|error| start(error)) {
            let problem = FileProblem::from(malformed(first.message()));
            self.report(first.span().unwrap_or(0..0), problem);
            self.malformed.set(true);
        }
        table
    }

    /// Records an error at a span of bytes.
    pub fn report(&self, span: Range<usize>, problem: impl Into<P>) {
        self.report_with(span, || problem.into());
    }

    /// Records an error at a span of bytes; `problem` is evaluated only if the error can be listed.
    pub fn report_with(&self, span: Range<usize>, problem: impl FnOnce() -> P) {
        if self.malformed.get() {
            return;
        }
        if self.problems.borrow().len() < MOST_RECORDED {
            let problem = problem();
            self.problems.borrow_mut().push((span, problem));
        } else {
            self.unrecorded.set(self.unrecorded.get() + 1);
        }
    }

    /// The bytes of a span.
    #[must_use]
    pub fn slice(&self, span: Range<usize>) -> String {
        self.sources.borrow().slice(self.text, span)
    }

    /// The place of a span of bytes in the file; that of the original of a copy, and of the inclusion of a text.
    #[must_use]
    pub fn place(&self, span: Range<usize>) -> Place {
        Place::of(self.text, self.sources.borrow().span_in_file(span))
    }

    /// The line of a span of bytes in the file, counted from 1.
    #[must_use]
    pub fn line(&self, span: Range<usize>) -> usize {
        self.place(span).line
    }

    /// Adds a copy of the text around a position, with values of the names in its expressions; returns the offset from the original to the copy.
    pub(crate) fn copy(&self, position: usize, scope: Scope) -> usize {
        self.sources.borrow_mut().copy(position, scope)
    }

    /// Adds a text that the document includes; returns the position of its first byte.
    pub(crate) fn include(&self, text: &str, inclusion: Inclusion<P>) -> usize {
        self.sources.borrow_mut().include(text, inclusion)
    }

    /// Allows expressions in the text around a position, with values of their names.
    pub(crate) fn set_scope(&self, position: usize, scope: Scope) {
        self.sources.borrow_mut().set_scope(position, scope);
    }

    /// Values of the names in expressions at a position; `None` where expressions are not allowed.
    pub(crate) fn scope(&self, position: usize) -> Option<Rc<Scope>> {
        self.sources.borrow().scope(position)
    }

    /// Value of an expression that was read, by the position of its text.
    pub(crate) fn evaluated(&self, position: usize) -> Option<f64> {
        self.evaluated.borrow().get(&position).copied()
    }

    /// Records the value of an expression.
    pub(super) fn set_evaluated(&self, position: usize, value: f64) {
        self.evaluated.borrow_mut().insert(position, value);
    }

    /// Whether no error is recorded.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// The value if there are no errors, and otherwise all errors in the order of their places.
    ///
    /// # Errors
    /// At most 20 errors; one more counts the others.
    pub fn done<T>(self, value: Option<T>) -> Result<T, Errors<P>> {
        let (found, sources) = (self.problems.into_inner(), self.sources.into_inner());
        match value {
            Some(value) if found.is_empty() => Ok(value),
            _ => {
                let mut problems: Vec<(Range<usize>, P)> = Vec::new();
                for (span, problem) in found {
                    let error = sources.in_file(span, problem);
                    // An error of a table is that of each of its copies.
                    if !problems.contains(&error) {
                        problems.push(error);
                    }
                }
                problems.sort_by_key(|(span, _)| span.start);
                let more = problems.len().saturating_sub(MOST_LISTED) + self.unrecorded.get();
                if let Some((_, problem)) = problems.get_mut(MOST_LISTED) {
                    *problem = FileProblem::More(more).into();
                }
                problems.truncate(MOST_LISTED + 1);
                let place = |(span, problem)| Error::at(self.text, span, problem);
                Err(problems.into_iter().map(place).collect::<Vec<_>>().into())
            }
        }
    }
}
