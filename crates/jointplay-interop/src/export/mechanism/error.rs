//! Errors of exports of mechanisms.

/// Why a mechanism cannot be written in a format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A configuration that is not one of the mechanism.
    #[error(transparent)]
    Core(#[from] jointplay_core::Error),
    /// A link with a name that simulators reserve.
    #[error(
        "link {link:?} has a name that simulators reserve for the ground or the model; rename it"
    )]
    ReservedName {
        /// Name of the link.
        link: String,
    },
    /// A coupling that an export does not have.
    #[error("coupling {coupling:?} cannot be exported to {format}: {reason}")]
    Coupling {
        /// Name of the coupling.
        coupling: String,
        /// Why.
        reason: &'static str,
        /// The format.
        format: &'static str,
    },
    /// A joint that the format does not have.
    #[error("joint {joint:?} is {kind}, which {format} cannot describe{advice}")]
    Unsupported {
        /// Name of the joint.
        joint: String,
        /// Its kind.
        kind: &'static str,
        /// The format.
        format: &'static str,
        /// Advice on a remedy.
        advice: &'static str,
    },
}
