//! What can be wrong with a dialect file.

use jointplay_format::place::{Form, suggestion};

/// What is wrong with a dialect file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not TOML, or an unknown key.
    #[error(transparent)]
    Form(#[from] Form),
    /// More text than a dialect needs.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// A unit that is none.
    #[error("`{key}` is {found:?}; known: {known}")]
    Unit {
        /// Which key.
        key: &'static str,
        /// What was found.
        found: String,
        /// All that there are.
        known: String,
    },
    /// More digits than numbers have, or fewer than none.
    #[error("`{key}` is {found}, but has to be 0 to 12")]
    Decimals {
        /// Which key.
        key: &'static str,
        /// What was found.
        found: i64,
    },
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
