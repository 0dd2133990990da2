//! Frame of every entry: catches panics, stores the error, and returns the code.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use jointplay::Error;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::explain::explain;
use jointplay::format::json::JsonError;

use crate::status::{JP_BAD_INPUT, JP_INTERNAL, JP_NO_ANSWER, JP_OK};

thread_local! {
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Why an entry has no result.
pub(crate) struct Failure {
    pub(crate) code: i32,
    pub(crate) text: String,
}

impl Failure {
    pub(crate) fn input(text: impl Into<String>) -> Self {
        Self { code: JP_BAD_INPUT, text: text.into() }
    }

    pub(crate) fn no_answer(text: impl Into<String>) -> Self {
        Self { code: JP_NO_ANSWER, text: text.into() }
    }

    pub(crate) fn internal(text: impl Into<String>) -> Self {
        Self { code: JP_INTERNAL, text: text.into() }
    }

    /// The same failure of one of many, which the text names.
    pub(crate) fn of(self, which: &str) -> Self {
        Self { text: format!("{which}: {}", self.text), ..self }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::from(&error)
    }
}

impl From<&Error> for Failure {
    #[cold]
    fn from(error: &Error) -> Self {
        let text = explain(error, DisplayUnits::Metric);
        if error.is_infeasible() { Self::no_answer(text) } else { Self::input(text) }
    }
}

impl From<JsonError> for Failure {
    #[cold]
    fn from(error: JsonError) -> Self {
        Self::input(format!("request: {error}"))
    }
}

/// Runs the work of an entry.
#[inline]
pub(crate) fn entry(work: impl FnOnce() -> Result<(), Failure>) -> i32 {
    // Results are written at the end of an entry, and what handles share is behind a lock that a panic poisons.
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => JP_OK,
        Ok(Err(failure)) => store(failure),
        Err(panic) => store(Failure::internal(message(&*panic))),
    }
}

/// As [`entry`], for entries that return a value; `otherwise` after a panic.
pub(crate) fn value<T>(otherwise: T, work: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(otherwise)
}

/// Reads the last error of this thread.
pub(crate) fn last_error<T>(read: impl FnOnce(&str) -> T) -> T {
    LAST.with_borrow(|text| read(text))
}

#[cold]
fn store(failure: Failure) -> i32 {
    // A NUL would end the text early.
    LAST.set(failure.text.replace('\0', "\u{fffd}"));
    failure.code
}

/// The text of a panic.
pub(crate) fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    format!("internal error: {}", text.unwrap_or("unknown"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_code_and_a_text() {
        assert_eq!(entry(|| panic!("broken {}", 1)), JP_INTERNAL);
        assert_eq!(last_error(str::to_owned), "internal error: broken 1");
        assert_eq!(value(7, || panic!("again")), 7);
    }
}
