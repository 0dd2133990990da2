//! How lengths and angles of virtual joints are weighed against each other.

use super::{Platform, VirtualJointKind};
use crate::Error;
use crate::error::finite;

/// The length ρ by which an angle is multiplied before it is added to lengths.
///
/// ```text
///    ‖X‖²  =  Σ (linear)²  +  ρ² Σ (angular)²
/// ```
/// Without it, a least displacement would depend on the unit of length.
///
/// # Source
/// Own choice; that the paper's numbers in mm and rad are ρ = 1 mm is shown in `docs/explanation/errata.md`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Metric {
    /// ρ = 1 mm: the implicit metric of \[Virtualization\], which adds mm² to rad².
    #[default]
    Paper,
    /// ρ = the mean socket radius: an angle counts as the arc that the socket runs through.
    PlatformRadius,
    /// Any other ρ, positive (m).
    Length(f64),
}

impl Metric {
    /// ρ for a platform (m).
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::OutOfRange`] for a length that is not a positive number.
    #[inline]
    pub fn characteristic_length(self, platform: &Platform) -> Result<f64, Error> {
        match self {
            Self::Paper => Ok(1e-3),
            Self::PlatformRadius => Ok(platform.mean_radius()),
            Self::Length(length) => {
                let what = "characteristic length";
                // Beyond these, angles or lengths vanish in the round-off of the other.
                let (min, max) = (1e-12, 1e12);
                if (min..=max).contains(&finite("the characteristic length", length)?) {
                    Ok(length)
                } else {
                    Err(Error::OutOfRange { what, value: length, min, max, unit: "m" })
                }
            }
        }
    }
}

impl VirtualJointKind {
    /// Length of a unit of this coordinate in the metric: 1 for a slide, ρ for a turn.
    #[must_use]
    #[inline]
    pub fn weight(self, characteristic_length: f64) -> f64 {
        match self {
            Self::Linear => 1.0,
            Self::Angular => characteristic_length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(metric: Metric, expected: Result<f64, &str>) {
        let platform = Platform::new([0.1, 0.2, 0.3], [0.0, 2.0, 4.0]).unwrap();
        let found = metric.characteristic_length(&platform);
        match expected {
            Ok(length) => assert!((found.unwrap() - length).abs() < 1e-16),
            Err(message) => assert_eq!(found.unwrap_err().to_string(), message),
        }
    }

    #[test]
    fn lengths_and_what_is_none() {
        check(Metric::default(), Ok(1e-3));
        check(Metric::PlatformRadius, Ok(0.2));
        check(Metric::Length(0.05), Ok(0.05));
        for length in ["0", "-1"] {
            let message = format!(
                "the characteristic length is {length} m, but has to lie from {} to {} m",
                1e-12, 1e12
            );
            check(Metric::Length(length.parse().unwrap()), Err(&message));
        }
        check(
            Metric::Length(f64::NAN),
            Err("the characteristic length is NaN, but has to be a finite number"),
        );
        check(
            Metric::Length(f64::INFINITY),
            Err("the characteristic length is inf, but has to be a finite number"),
        );
    }
}
