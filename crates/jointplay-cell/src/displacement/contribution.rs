//! Contributions to the uncertainty of a wafer's position, and their sum.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::cause::Cause;

/// Bound on the displacement of a wafer's centre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bound {
    /// In the horizontal plane, in any direction (m).
    pub horizontal: f64,
    /// Along the vertical, to either side (m).
    pub vertical: f64,
}

impl Bound {
    fn at_most(self, other: Self) -> Self {
        Self {
            horizontal: self.horizontal.min(other.horizontal),
            vertical: self.vertical.min(other.vertical),
        }
    }
}

/// Contribution of a cause to the uncertainty of a wafer's position, linear in the deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contribution {
    /// The cause.
    pub cause: Cause,
    /// Number of independent parameters.
    pub parameters: usize,
    /// Known displacement that is not compensated (m).
    pub offset: Vector3<f64>,
    /// Covariance of the random part, in the base frame (m²).
    pub covariance: Matrix3<f64>,
    /// Sum of the largest displacements by all parameters, the offset included.
    pub linear_sum: Bound,
}

impl Contribution {
    /// Without parameters.
    pub(super) fn new(cause: Cause) -> Self {
        let (offset, covariance) = (Vector3::zeros(), Matrix3::zeros());
        Self { cause, parameters: 0, offset, covariance, linear_sum: Bound::default() }
    }

    /// Adds a parameter that deviates by at most `half_width` to either side, all values equally probable: its variance is a third of the square.
    pub(super) fn add_rectangular(&mut self, effect: &Vector3<f64>, half_width: f64) {
        let largest = effect * half_width;
        self.parameters += 1;
        self.covariance += largest * largest.transpose() / 3.0;
        self.linear_sum.horizontal += largest.xy().norm();
        self.linear_sum.vertical += largest.z.abs();
    }

    /// For random deviations without a largest value: the linear sum contains the expanded uncertainty.
    pub(super) fn set_worst_to_expanded(&mut self, coverage_factor: f64) {
        self.linear_sum = expanded(&self.offset, &self.covariance, coverage_factor);
    }

    /// Adds a known displacement.
    pub(super) fn add_offset(&mut self, offset: &Vector3<f64>) {
        self.parameters += 1;
        self.offset += offset;
        self.linear_sum.horizontal += offset.xy().norm();
        self.linear_sum.vertical += offset.z.abs();
    }

    /// Coverage factor times the standard deviation, plus the offset; at most the linear sum.
    #[must_use]
    pub fn expanded(&self, coverage_factor: f64) -> Bound {
        expanded(&self.offset, &self.covariance, coverage_factor).at_most(self.linear_sum)
    }

    /// Linear sum of all contributions: all deviations are the largest at once, in one direction.
    #[must_use]
    pub fn linear_sum(all: &[Self]) -> Bound {
        let add = |sum: Bound, one: &Self| Bound {
            horizontal: sum.horizontal + one.linear_sum.horizontal,
            vertical: sum.vertical + one.linear_sum.vertical,
        };
        all.iter().fold(Bound::default(), add)
    }

    /// Expanded uncertainty of all contributions: independent deviations add by their variances, offsets as they are; at most the linear sum.
    #[must_use]
    pub fn expanded_sum(all: &[Self], coverage_factor: f64) -> Bound {
        let offset: Vector3<f64> = all.iter().map(|one| one.offset).sum();
        let covariance: Matrix3<f64> = all.iter().map(|one| one.covariance).sum();
        expanded(&offset, &covariance, coverage_factor).at_most(Self::linear_sum(all))
    }
}

fn expanded(offset: &Vector3<f64>, covariance: &Matrix3<f64>, coverage_factor: f64) -> Bound {
    let horizontal = covariance.fixed_view::<2, 2>(0, 0).into_owned();
    let largest = SymmetricEigen::new(horizontal).eigenvalues.max().max(0.0).sqrt();
    Bound {
        horizontal: offset.xy().norm() + coverage_factor * largest,
        vertical: offset.z.abs() + coverage_factor * covariance[(2, 2)].max(0.0).sqrt(),
    }
}
