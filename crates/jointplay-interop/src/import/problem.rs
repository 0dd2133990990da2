//! What can be wrong in a model of another program.

use jointplay_core::mechanism::MechanismError;

use jointplay_format::place::{listed, suggestion};

/// Why a text is no model that can be taken over, and where.
pub type Error = jointplay_format::place::Error<Problem>;

/// What can be wrong in a model of another program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not XML.
    #[error("{0}")]
    Xml(String),
    /// More text than a mechanism needs.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// Elements inside elements without end.
    #[error("elements stand inside one another more than {allowed} deep")]
    TooDeep {
        /// How deep they may stand.
        allowed: usize,
    },
    /// Something that would change the mechanism if it were passed over.
    #[error("{what} cannot be taken over: {advice}")]
    Unsupported {
        /// What it is.
        what: String,
        /// Why not, or what to do instead.
        advice: String,
    },
    /// A value that cannot be used.
    #[error("`{what}` is {found:?}, but has to be {expected}")]
    Value {
        /// The attribute or element.
        what: String,
        /// What was found.
        found: String,
        /// What it has to be.
        expected: &'static str,
    },
    /// An element or attribute that is not there.
    #[error("`{whose}` needs `{what}`")]
    Missing {
        /// The element that needs it.
        whose: String,
        /// What it needs.
        what: &'static str,
    },
    /// A name that nothing has.
    #[error("{what} {found:?} is not known{}; known: {}", suggestion(nearest), listed(known))]
    Unknown {
        /// What it should name.
        what: &'static str,
        /// What was found.
        found: String,
        /// The known one most like it.
        nearest: Option<String>,
        /// All that could stand there.
        known: Vec<String>,
    },
    /// Places or attachments that need each other.
    #[error("{what} {name:?} depends on itself: frames refer to each other in a circle")]
    Circle {
        /// The place or the attachment.
        what: &'static str,
        /// Of which frame.
        name: String,
    },
    /// Bodies and joints that make no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
}
