//! The values allowed for a number.

use crate::number::number;

/// Smaller numbers become 0 when their unit is changed, or divide to infinity.
const LEAST_POSITIVE: f64 = 1e-12;

/// Largest magnitude of a number in its own unit, so that no product of two numbers overflows.
pub const LARGEST: f64 = 1e12;

/// The values allowed for a number; all of them lie within ±1e12.
#[derive(Clone, Copy)]
pub enum AllowedRange {
    /// Finite.
    Any,
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
    /// From the first to the second.
    Within(f64, f64),
}

impl AllowedRange {
    /// Whether a value is allowed.
    pub(super) fn holds(self, value: f64) -> bool {
        value.is_finite()
            && value.abs() <= LARGEST
            && match self {
                Self::Any => true,
                Self::Positive => value >= LEAST_POSITIVE,
                Self::NotNegative => value >= 0.0,
                Self::Within(min, max) => (min..=max).contains(&value),
            }
    }

    /// The values allowed, for a message about another value.
    pub(super) fn needed(self, value: f64) -> String {
        match self {
            Self::Within(min, max) => format!("from {} to {}", number(min), number(max)),
            _ if value.is_finite() && value.abs() > LARGEST => format!("within ±{LARGEST:e}"),
            _ if value == f64::INFINITY => "a finite number".to_owned(),
            Self::Any => "a finite number".to_owned(),
            Self::Positive if value > 0.0 => format!("at least {LEAST_POSITIVE:e}"),
            Self::Positive => "positive".to_owned(),
            Self::NotNegative => "0 or more".to_owned(),
        }
    }
}
