//! What can be wrong with a dialect file.

use jointplay_format::file_problem::FileProblem;
use jointplay_format::place::suggestion;

/// What is wrong with a dialect file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// An error that every file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// An ending that is none of a file.
    #[error("`extension` is {found:?}, but has to be letters and digits")]
    Extension {
        /// What was found.
        found: String,
    },
    /// A name in braces that stands for nothing here.
    #[error("`{{{found}}}` stands for nothing here{}; known here: {known}", suggestion(nearest))]
    Name {
        /// What was found.
        found: String,
        /// The known one most like it.
        nearest: Option<String>,
        /// All that there are.
        known: String,
    },
    /// A brace without its other half.
    #[error("a name that begins with {{ ends without }}; write {{{{ for the brace itself")]
    Open,
    /// A brace without its first half.
    #[error("a }} stands alone; write }}}} for the brace itself")]
    Close,
    /// Motions told in no way, or in two.
    #[error("a dialect tells motions by either `axes`, `line` and `still`, or `point`")]
    Motions,
}
