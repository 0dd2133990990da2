//! Errors of dialect files.

use jointplay_format::file_problem::FileProblem;
use jointplay_format::place::suggestion;

/// Errors of dialect files.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// An error that any TOML file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// An invalid file extension.
    #[error("`extension` is {found:?}, but has to be letters and digits")]
    Extension {
        /// The extension found.
        found: String,
    },
    /// An unknown name in braces.
    #[error(
        "`{{{found}}}` is not a name of this template{}; known here: {known}",
        suggestion(nearest)
    )]
    Name {
        /// The name found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All known names.
        known: String,
    },
    /// An opening brace without a closing one.
    #[error("a name that begins with {{ ends without }}; write {{{{ for the brace itself")]
    Open,
    /// A closing brace without an opening one.
    #[error("a }} has no opening brace; write }}}} for the brace itself")]
    Close,
    /// A dialect that describes motions in no manner, or in both.
    #[error("a dialect describes motions by either `axes`, `line` and `still`, or `point`")]
    Motions,
}
