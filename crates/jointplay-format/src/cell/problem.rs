//! What can be wrong in a cell file, or in the file of a robot with arms.

use crate::file_problem::FileProblem;
use crate::place::Error;

/// What is wrong with a file, and where.
pub type Problem = Error<Fault>;

/// All errors of a file.
pub type Errors = crate::place::Errors<Fault>;

/// What can be wrong in a cell file or in the file of a robot with arms; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// An error that every file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// The same name a second time.
    #[error("{what} {found:?} is there twice, first in line {first}")]
    Twice {
        /// What has the name.
        what: String,
        /// The name.
        found: String,
        /// Line of the first, counted from 1.
        first: usize,
    },
    /// A file that cannot be had.
    #[error("the file {name:?} cannot be had: {why}")]
    File {
        /// How it is named.
        name: String,
        /// Why.
        why: String,
    },
    /// A file that is named and is wrong itself.
    #[error("line {} of {name:?} is wrong: {}{}", .inner.place.line, .inner.problem, more(.others))]
    Within {
        /// How the file is named.
        name: String,
        /// The first that is wrong in it.
        inner: Box<Problem>,
        /// The others, in order.
        others: Vec<Problem>,
    },
    /// Everything else: what does not fit together.
    #[error("{0}")]
    Unfit(String),
}

/// Further problems of a file that are listed.
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
