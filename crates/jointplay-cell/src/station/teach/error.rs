//! Reasons why taught points determine no frame.

use nalgebra::Vector3;

/// Reason why taught points determine no frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TeachError {
    /// Not enough points for a plane.
    #[error(
        "{found} taught points determine no plane; teach 3, and better 5, that are not on one line"
    )]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// The noise is not a positive number.
    #[error("the noise of taught points is {found} m, but has to be positive")]
    Noise {
        /// The value found (m).
        found: f64,
    },
    /// There is not one noise for each point.
    #[error("the noise is given for {found} points, but there are {points}")]
    NoiseCount {
        /// Number of values.
        found: usize,
        /// Number of points.
        points: usize,
    },
    /// A coordinate is not finite.
    #[error("a taught point is not finite")]
    NotFinite,
    /// Two points have the same coordinates, and fewer than three differ.
    #[error(
        "taught points {} and {} have the same coordinates: teach three different points", .first + 1, .second + 1
    )]
    Repeated {
        /// Index of a point.
        first: usize,
        /// Index of the equal point.
        second: usize,
    },
    /// The points are on one line.
    #[error(
        "the taught points lie within {spread} m of one line, which leaves the tilt about it undetermined: teach a point at least {min} m from it, best at {best} (m)"
    )]
    Collinear {
        /// Root mean square distance of the points from the line (m).
        spread: f64,
        /// Least allowed value (m).
        min: f64,
        /// A point next to the middle of the line, as far from it as the points are from each other, in the base frame (m).
        best: Vector3<f64>,
    },
    /// The plane is upright.
    #[error("the plane of the taught points is upright: its normal is {tilt} rad from vertical")]
    Upright {
        /// Angle of the normal from vertical (rad).
        tilt: f64,
    },
    /// The last slot is not above the first.
    #[error(
        "the last slot was taught {rise} m above the first; it has to be above it, by the slots between them"
    )]
    NotAbove {
        /// Height of the last slot above the first (m).
        rise: f64,
    },
    /// A carrier axis of a station with one slot.
    #[error("a carrier axis needs several slots, but there are {slots}")]
    OneSlot {
        /// Number of slots.
        slots: usize,
    },
    /// No reference points.
    #[error("there are no reference points; teach 1 for the centre, and 2 or more for the heading")]
    NoReferences,
}

/// Checks the noise of points.
pub(super) fn check_noise(noise: Option<&[f64]>, points: usize) -> Result<(), TeachError> {
    let Some(noise) = noise else { return Ok(()) };
    if noise.len() != points {
        return Err(TeachError::NoiseCount { found: noise.len(), points });
    }
    match noise.iter().find(|noise| !(**noise > 0.0 && noise.is_finite())) {
        Some(&found) => Err(TeachError::Noise { found }),
        None => Ok(()),
    }
}
