//! What can be wrong in a cell file, or in the file of a robot with arms.

use crate::number::{counted, entries, number};
use crate::place::{Error, Form, listed, suggestion};

/// What is wrong with a file, and where.
pub type Problem = Error<Fault>;

/// What can be wrong in a cell file or in the file of a robot with arms; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// Not TOML, or an unknown key.
    #[error(transparent)]
    Form(#[from] Form),
    /// More text than a cell needs.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// A key that has to be there.
    #[error("{whose} needs `{key}`")]
    Missing {
        /// Whose key it is.
        whose: String,
        /// The key.
        key: String,
    },
    /// A value of another kind than is asked for.
    #[error("`{key}` has to be {needed}, but is {found}")]
    Kind {
        /// Which key.
        key: String,
        /// What is needed.
        needed: String,
        /// What was found.
        found: String,
    },
    /// A number that is too large, too small, or none.
    #[error("`{key}` is {}, but has to be {needed}", number(*.value))]
    Beyond {
        /// Which key.
        key: String,
        /// What was found.
        value: f64,
        /// What is allowed.
        needed: String,
    },
    /// A list with too few or too many entries.
    #[error("`{key}` has {}, but needs {needed}", entries(*.found))]
    Count {
        /// Which key.
        key: String,
        /// How many were found.
        found: usize,
        /// How many are needed.
        needed: String,
    },
    /// A word or name that is none of the known ones.
    #[error("{what} {found:?} is not known{}; known: {}", suggestion(nearest), listed(known))]
    Unknown {
        /// What it should name.
        what: String,
        /// What was found.
        found: String,
        /// The known one most like it.
        nearest: Option<String>,
        /// All that could stand there.
        known: Vec<String>,
    },
    /// An empty name, or one that programs could not write.
    #[error(
        "`{key}` is {found:?}, but a name is letters, digits, `_` and `-`, starts with a letter, and has at most {longest} of them"
    )]
    Name {
        /// Which key.
        key: String,
        /// What was found.
        found: String,
        /// Most letters.
        longest: usize,
    },
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
    /// Further errors, which are not listed.
    #[error("{} from here on", counted(*.0, "more error"))]
    More(usize),
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
