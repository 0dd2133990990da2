//! Errors of cell files and of files of robots with arms.

use crate::file_problem::FileProblem;
use crate::place::Error;

/// An error of a cell file or of the file of a robot with arms, with its place.
pub type Problem = Error<Fault>;

/// All errors of a file.
pub type Errors = crate::place::Errors<Fault>;

/// Errors of cell files and of files of robots with arms; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// An error that any TOML file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// A name that is used twice.
    #[error("{what} {found:?} is defined twice, first in line {first}")]
    Twice {
        /// Kind of the named object.
        what: String,
        /// The name.
        found: String,
        /// Line of the first definition, counted from 1.
        first: usize,
    },
    /// A file that cannot be read.
    #[error("cannot read the file {name:?}: {why}")]
    File {
        /// Name of the file.
        name: String,
        /// Reason.
        why: String,
    },
    /// A named file with errors.
    #[error("{name:?} has an error in line {}: {}{}", .inner.place.line, .inner.problem, more(.others))]
    Within {
        /// Name of the file.
        name: String,
        /// First error of the file.
        inner: Box<Problem>,
        /// Further errors, in order.
        others: Vec<Problem>,
    },
    /// Values that contradict each other.
    #[error("{0}")]
    Unfit(String),
}

/// Largest number of further errors that are listed.
const MOST_LISTED: usize = 8;

fn more(others: &[Problem]) -> String {
    let mut text = String::new();
    for other in others.iter().take(MOST_LISTED) {
        text += &format!("; line {}: {}", other.place.line, other.problem);
    }
    match others.len().saturating_sub(MOST_LISTED) {
        0 => text,
        count => text + &format!("; and {count} more"),
    }
}
