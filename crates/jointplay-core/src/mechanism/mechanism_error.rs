//! Errors of descriptions of mechanisms.

use crate::error::range_fault;

/// Why links and joints do not form a mechanism.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MechanismError {
    /// No joints at all.
    #[error("the mechanism has no joints")]
    NoJoints,
    /// Too many links.
    #[error("the mechanism has {found} links, but at most {allowed} are allowed")]
    TooManyLinks {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// Two things of one name.
    #[error("the name {name:?} is used twice")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// A joint that names a link that is not there.
    #[error("joint {joint:?} names link {link}, but there are {links} links")]
    NoSuchLink {
        /// The joint.
        joint: String,
        /// The index it names.
        link: usize,
        /// How many links there are.
        links: usize,
    },
    /// A loop of length one.
    #[error("joint {joint:?} joins link {link:?} to itself")]
    JoinedToItself {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A link that is not connected to the base.
    #[error("link {link:?} is not connected to the base {base:?} by any joints")]
    Dangling {
        /// The link.
        link: String,
        /// The base.
        base: String,
    },
    /// A number that is NaN or infinite.
    #[error("{what} of {name:?} is {value}, but has to be a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Of which joint.
        name: String,
        /// What was found.
        value: f64,
    },
    /// A number that has to be positive and is not.
    #[error("{what} of {name:?} is {value}, but has to be positive")]
    NotPositive {
        /// Which number.
        what: &'static str,
        /// Of which joint or mechanism.
        name: String,
        /// What was found.
        value: f64,
    },
    /// A characteristic length so long or so short that angles or lengths would have the weight of rounding errors.
    #[error(
        "the characteristic length is {found:e} m, but has to lie from {min:.1e} to {max:.1e} m for joints as far apart as these"
    )]
    CharacteristicLength {
        /// What was found (m).
        found: f64,
        /// Least allowed value (m).
        min: f64,
        /// Greatest allowed value (m).
        max: f64,
    },
    /// A list with too few or too many numbers.
    #[error(
        "{what} of {name:?} has {found} entries, but {expected} are needed, one for each freedom"
    )]
    CountMismatch {
        /// Which list.
        what: &'static str,
        /// Of which joint.
        name: String,
        /// How many were found.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A lower limit that is not below its upper limit.
    #[error("the limits of {name:?} are {}: least {min}, most {max}", range_fault(*.min, *.max))]
    LimitsReversed {
        /// Of which joint.
        name: String,
        /// Lower limit.
        min: f64,
        /// Upper limit.
        max: f64,
    },
    /// A virtual joint at a joint that is not there.
    #[error("virtual joint {name:?} names joint {joint}, but there are {joints} joints")]
    NoSuchJoint {
        /// The virtual joint.
        name: String,
        /// The index it names.
        joint: usize,
        /// How many joints there are.
        joints: usize,
    },
    /// A coupling of a coordinate that is not there.
    #[error(
        "coupling {coupling:?} names coordinate {freedom} of joint {joint}, which does not exist"
    )]
    NoSuchCoordinate {
        /// The coupling.
        coupling: String,
        /// The index of the joint.
        joint: usize,
        /// The index of the coordinate.
        freedom: usize,
    },
    /// A coupling of a coordinate of a rotation vector.
    #[error(
        "coupling {coupling:?} couples a rotation of joint {joint:?}, but only slides and turns about an axis can be coupled"
    )]
    CoupledRotation {
        /// The coupling.
        coupling: String,
        /// The joint.
        joint: String,
    },
    /// A coordinate that is in a coupling twice.
    #[error("coupling {coupling:?} names a coordinate of joint {joint:?} twice")]
    CoupledTwice {
        /// The coupling.
        coupling: String,
        /// The joint.
        joint: String,
    },
    /// A coupling of more coordinates than are allowed.
    #[error("coupling {coupling:?} relates {found} coordinates, but at most {allowed} are allowed")]
    CoupledMany {
        /// The coupling.
        coupling: String,
        /// How many coordinates it relates.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// A frame attached to a link that is not there.
    #[error("frame {frame:?} is attached to link {link}, but there are {links} links")]
    NoLinkOfFrame {
        /// The frame.
        frame: String,
        /// The index it names.
        link: usize,
        /// How many links there are.
        links: usize,
    },
}
