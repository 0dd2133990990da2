//! Test of whether taught points agree with a fit.

use super::quantile::chi_square;

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

/// Influence of a taught point on the fit, and its deviation relative to the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointDiagnostic {
    /// Share of an error of this point that the fit follows: 0 not at all, 1 wholly, so that the error does not show.
    pub leverage: f64,
    /// Deviation divided by its standard deviation; `None` where the noise is not known, or the point does not show errors.
    pub standardized: Option<f64>,
}

/// Relative difference below which two deviations are equal.
const EQUAL: f64 = 1e-9;

/// Number of redundant coordinates of known noise from which on a deviation can be assigned to a point.
pub(super) const REDUNDANT: usize = 2;

/// Quantile of the false alarm rate at which points with given noise count as inconsistent.
const FALSE_ALARM_QUANTILE: f64 = 3.090_232;
/// False alarm rate of that quantile, and of the test of single points.
pub(super) const FALSE_ALARM: f64 = 1e-3;
/// Redundancy below which the deviation of a point is round-off.
pub(super) const NO_REDUNDANCY: f64 = 1e-9;

/// How well taught points agree with a fit, and the test of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Influence and relative deviation of each point.
    pub diagnostics: Vec<PointDiagnostic>,
    /// Largest deviation (m).
    pub worst: f64,
    /// Largest allowed deviation (m).
    pub threshold: f64,
    /// Standard deviation of each coordinate of each point, if known (m).
    pub noise: Option<Vec<f64>>,
    /// Sum of the squared deviations, each divided by its variance; `None` where the noise is not known.
    pub chi_square: Option<f64>,
    /// Value of `chi_square` above which the points count as inconsistent; `None` without redundancy.
    pub chi_square_limit: Option<f64>,
    /// Redundancy: number of measured coordinates beyond those that determine the fit, the degrees of freedom of the residuals.
    pub redundancy: usize,
    /// Whether the points agree.
    pub result: FitResult,
}

/// Deviations of taught points from a fit, before they are tested.
pub(super) struct Deviations<'n> {
    pub(super) diagnostics: Vec<PointDiagnostic>,
    /// Largest one (m).
    pub(super) worst: f64,
    /// Largest allowed one (m).
    pub(super) threshold: f64,
    /// Standard deviation of each coordinate of each point, if known (m).
    pub(super) noise: Option<&'n [f64]>,
    /// Sum of their squares, each divided by its variance; `None` where the noise is not known.
    pub(super) chi_square: Option<f64>,
    pub(super) redundancy: usize,
    /// Standardized deviation above which a single point of known noise counts as an outlier.
    pub(super) outlier: f64,
    /// Whether the points suffice for a test.
    pub(super) is_testable: bool,
}

impl Deviations<'_> {
    /// The test of the deviations.
    pub(super) fn tested(self) -> Agreement {
        let largest = self.diagnostics.iter().filter_map(|point| point.standardized);
        let largest = largest.fold(0.0_f64, |largest, one| largest.max(one.abs()));
        let limit =
            (self.redundancy > 0).then(|| chi_square(self.redundancy, FALSE_ALARM_QUANTILE));
        let is_noisier = self.chi_square.zip(limit).is_some_and(|(found, limit)| found > limit);
        let has_outlier = self.noise.is_some() && self.redundancy > 0 && largest > self.outlier;
        let result = if self.worst > self.threshold || is_noisier || has_outlier {
            FitResult::Inconsistent
        } else if self.is_testable {
            FitResult::Fits
        } else {
            FitResult::Untested
        };
        Agreement {
            diagnostics: self.diagnostics,
            worst: self.worst,
            threshold: self.threshold,
            noise: self.noise.map(<[f64]>::to_vec),
            chi_square: self.chi_square,
            chi_square_limit: limit,
            redundancy: self.redundancy,
            result,
        }
    }
}

impl Agreement {
    /// Index of the point to be measured again, where the points are inconsistent: the one with the largest deviation relative to its noise, the first of equal ones.
    ///
    /// `None` where the points agree, and where one redundant coordinate does not determine which of them deviates.
    pub(super) fn suspect(&self) -> Option<usize> {
        if self.result != FitResult::Inconsistent || self.redundancy < REDUNDANT {
            return None;
        }
        let relative = |point: &PointDiagnostic| point.standardized.map_or(0.0, f64::abs);
        let largest = self.diagnostics.iter().map(relative).fold(0.0, f64::max);
        self.diagnostics.iter().position(|point| relative(point) >= largest * (1.0 - EQUAL))
    }
}
