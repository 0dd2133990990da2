//! Results of the test of taught points.

/// Whether taught points agree with one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitResult {
    /// All points lie within the threshold, and as near to the fit as their noise predicts.
    Fits,
    /// There are too few points to test them.
    Untested,
    /// The points agree, and determine the tilt less accurately than is allowed: a result of [`PlaneFit::result_for`](super::PlaneFit::result_for) only.
    Uncertain,
    /// A point is farther from the fit than the threshold, or than its noise explains.
    Inconsistent,
}

/// Relative difference below which two deviations are equal.
const EQUAL: f64 = 1e-9;

/// Index of the point with the largest deviation relative to its noise, the first of equal ones.
pub(super) fn largest_deviation(points: &[PointDiagnostic]) -> Option<usize> {
    let relative = |point: &PointDiagnostic| point.standardized.map_or(0.0, f64::abs);
    let largest = points.iter().map(relative).fold(0.0, f64::max);
    points.iter().position(|point| relative(point) >= largest * (1.0 - EQUAL))
}

/// Influence of a taught point on the fit, and its deviation relative to the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointDiagnostic {
    /// Share of an error of this point that the fit follows: 0 not at all, 1 wholly, so that the error does not show.
    pub leverage: f64,
    /// Deviation divided by its standard deviation; `None` where the noise is not known, or the point does not show errors.
    pub standardized: Option<f64>,
}
