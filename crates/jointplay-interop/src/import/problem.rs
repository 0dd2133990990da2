//! Errors of imported models.

use jointplay_core::mechanism::MechanismError;

use jointplay_format::number::{counted, number};
use jointplay_format::place::{listed, suggestion};

/// Error of an imported model, with its place.
pub type Error = jointplay_format::place::Error<Problem>;

/// Errors of imported models.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not XML.
    #[error("{0}")]
    Xml(String),
    /// Not YAML, or without the keys and values of a file of loops.
    #[error("{0}")]
    Yaml(String),
    /// A model that has loops before others are closed.
    #[error("the model has {} already; only the loops of an open chain can be closed", counted(*found, "loop"))]
    HasLoops {
        /// Number of loops found.
        found: usize,
    },
    /// A text that is too long.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// Length found (bytes).
        found: usize,
        /// Length allowed (bytes).
        allowed: usize,
    },
    /// An assembly without a unit of length.
    #[error(
        "an assembly of FreeCAD does not state its unit of length; give it when converting: `jointplay import FILE --units mm` for files written by FreeCAD"
    )]
    NoUnit,
    /// Elements that are nested too deeply.
    #[error("elements are nested more than {allowed} deep")]
    TooDeep {
        /// Depth allowed.
        allowed: usize,
    },
    /// More of something than is allowed.
    #[error("at most {allowed} {what} are allowed; here are more")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// Number allowed.
        allowed: usize,
    },
    /// An unsupported part that would affect the mechanism.
    #[error("{what} cannot be imported: {advice}")]
    Unsupported {
        /// The part.
        what: String,
        /// Reason or remedy.
        advice: String,
    },
    /// A value that cannot be used.
    #[error("`{what}` is {found:?}, but has to be {expected}")]
    Value {
        /// The attribute or element.
        what: String,
        /// The value found.
        found: String,
        /// Values allowed.
        expected: &'static str,
    },
    /// A missing element or attribute.
    #[error("`{whose}` needs `{what}`")]
    Missing {
        /// The element that needs it.
        whose: String,
        /// The missing part.
        what: &'static str,
    },
    /// An unknown name.
    #[error("{what} {found:?} is not known{}; known: {}", suggestion(nearest), listed(known))]
    Unknown {
        /// Kind of the named object.
        what: &'static str,
        /// The name found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// Poses or attachments that depend on each other.
    #[error("{what} {name:?} depends on itself: frames refer to each other in a circle")]
    Circle {
        /// The pose or the attachment.
        what: &'static str,
        /// Name of the frame.
        name: String,
    },
    /// A number that no mechanism file may have.
    #[error("{what} of {whose:?} is {}, but has to be within ±{allowed:e}", number(*found))]
    TooLarge {
        /// The quantity, with its unit.
        what: &'static str,
        /// The joint or the coupling.
        whose: String,
        /// The value found, in this unit.
        found: f64,
        /// Largest magnitude allowed, in the same unit.
        allowed: f64,
    },
    /// Links and joints that form no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
}
