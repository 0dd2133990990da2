//! The text of a file and its errors.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use toml::Spanned;
use toml::de::DeTable;

use crate::file_problem::FileProblem;
use crate::place::{Error, Errors, Place, malformed};

/// Largest number of errors listed for one file; the others, most often consequences, are counted.
const MOST_LISTED: usize = 20;

/// Largest number of errors recorded for one file; later ones are counted, so that time and memory stay limited.
const MOST_RECORDED: usize = 200;

/// A text and the errors found in it.
pub struct Reader<'a, P> {
    text: &'a str,
    problems: RefCell<Vec<(Range<usize>, P)>>,
    /// Number of errors beyond those recorded.
    unrecorded: Cell<usize>,
    /// Whether the text is invalid TOML: then no errors of its contents are reported, which are guesses.
    malformed: Cell<bool>,
}

impl<'a, P: From<FileProblem> + PartialEq> Reader<'a, P> {
    /// A reader of a text without errors so far.
    #[must_use]
    pub fn new(text: &'a str) -> Self {
        Self {
            text,
            problems: RefCell::default(),
            unrecorded: Cell::new(0),
            malformed: Cell::new(false),
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
    pub fn slice(&self, span: Range<usize>) -> &'a str {
        self.text.get(span).unwrap_or_default()
    }

    /// The place of a span of bytes.
    #[must_use]
    pub fn place(&self, span: Range<usize>) -> Place {
        Place::of(self.text, span)
    }

    /// The line of a span of bytes, counted from 1.
    #[must_use]
    pub fn line(&self, span: Range<usize>) -> usize {
        Place::of(self.text, span).line
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
        let mut problems = self.problems.into_inner();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => {
                problems.sort_by_key(|(span, _)| span.start);
                problems.dedup();
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
