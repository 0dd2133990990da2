//! Kinds of the parameters of routines.

use std::fmt;

/// Kind of a parameter of a routine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// A number.
    Number,
    /// A station.
    Station,
    /// An effector.
    Effector,
    /// An effector, or a station with one slot.
    Location,
}

impl fmt::Display for ParameterKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Number => "a number",
            Self::Station => "a station",
            Self::Effector => "an effector",
            Self::Location => "a station or an effector",
        })
    }
}

impl ParameterKind {
    /// The kind that is both; `None` where they contradict each other.
    pub(super) fn and(self, other: Self) -> Option<Self> {
        match (self, other) {
            (one, other) if one == other => Some(one),
            (Self::Location, it @ (Self::Station | Self::Effector))
            | (it @ (Self::Station | Self::Effector), Self::Location) => Some(it),
            _ => None,
        }
    }
}
