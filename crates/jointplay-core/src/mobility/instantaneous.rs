//! Instantaneous mobility, with redundancy and self-stress.

use nalgebra::{DMatrix, DVector};

use crate::Error;
use crate::constraint::{Configuration, ScaledSystem, System};
use crate::linalg::{Svd, svd};

/// Singular values up to this share of the largest count as zero.
///
/// Forming a scaled Jacobian costs a few units of round-off, 10⁻¹⁵; two decades above that no noise is taken for a constraint.
/// On a wafer robot it distinguishes rods that differ by a picometre.
pub const RANK_THRESHOLD: f64 = 1e-13;

/// Singular values up to this many times [`System::round_off`] count as zero: they are within the rounding of the dimensions.
const RANK_ROUND_OFF: f64 = 16.0;

/// Motions in the null space of the constraint Jacobian, with the evidence.
///
/// ```text
///      J   ·  N   =  0        Sᵀ  ·  J  =  0        J: scaled constraint Jacobian, r = rank
///    (c,n) (n,n−r)          (c−r,c) (c,n)
/// ```
/// J is dimensionless: lengths are measured in `characteristic_length`, so that rank and singular values do not depend on the unit.
#[derive(Debug, Clone, PartialEq)]
pub struct InstantaneousMobility {
    /// n − rank: dimension of the null space of J.
    pub mobility: usize,
    /// Number of independent constraints.
    pub rank: usize,
    /// c − rank: number of redundant constraints.
    pub redundancy: usize,
    /// Singular values of J, largest first.
    pub singular_values: DVector<f64>,
    /// Values at or below this one count as zero: the relative threshold times the largest value, or the round-off of the mechanism's dimensions where that is larger.
    pub threshold: f64,
    /// Length in which J is scaled (m).
    pub characteristic_length: f64,
    /// (n, mobility) orthonormal basis of the allowed motions; lengths are in units of `characteristic_length`.
    pub null_space: DMatrix<f64>,
    /// (c, redundancy) orthonormal basis of the self-stresses: constraint forces in balance by themselves, scaled like the rows of J.
    pub self_stress: DMatrix<f64>,
    /// All of it, for corrections.
    pub(super) decomposition: Svd,
}

impl InstantaneousMobility {
    /// The smallest singular value above the threshold, if there is one.
    #[must_use]
    pub fn smallest_nonzero(&self) -> Option<f64> {
        self.rank.checked_sub(1).map(|last| self.singular_values[last])
    }

    /// The largest singular value at or below the threshold, if there is one.
    #[must_use]
    pub fn largest_zero(&self) -> Option<f64> {
        self.singular_values.get(self.rank).copied()
    }
}

/// Instantaneous mobility of the mechanism with its virtual joints held.
///
/// # Arguments
/// * `at` – configuration; only ∂Φ/∂P is used
/// * `relative_threshold` – [`RANK_THRESHOLD`], or another share of the largest singular value
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
///
/// # Numerics
/// One singular value decomposition, O(c n²).
/// Near a singular configuration the smallest values shrink with the distance to it; the rank drops only where they pass the threshold.
///
/// # Source
/// \[Virtualization\], IV.A; self-stress: \[ConnellyWhiteley\]
pub fn instantaneous_mobility<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    relative_threshold: f64,
) -> Result<InstantaneousMobility, Error> {
    system.check(at)?;
    let length = system.characteristic_length();
    let jacobian = ScaledSystem::new(system, length).jacobian(at);
    analyse(&jacobian, length, relative_threshold, system.round_off())
}

/// Instantaneous mobility with the virtual joints free: of [∂Φ/∂P ∂Φ/∂X].
///
/// # Errors
/// As [`instantaneous_mobility`].
///
/// # Source
/// \[Virtualization\], eq. (2)
pub fn augmented_mobility<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    relative_threshold: f64,
) -> Result<InstantaneousMobility, Error> {
    system.check(at)?;
    let length = system.characteristic_length();
    let scaled = ScaledSystem::new(system, length);
    let (of_coordinates, of_virtual_joints) = (scaled.jacobian(at), scaled.virtual_jacobian(at));
    let (n, m) = (of_coordinates.ncols(), of_virtual_joints.ncols());
    let mut both = DMatrix::zeros(of_coordinates.nrows(), n + m);
    both.columns_mut(0, n).copy_from(&of_coordinates);
    both.columns_mut(n, m).copy_from(&of_virtual_joints);
    analyse(&both, length, relative_threshold, system.round_off())
}

fn analyse(
    jacobian: &DMatrix<f64>,
    characteristic_length: f64,
    relative_threshold: f64,
    round_off: f64,
) -> Result<InstantaneousMobility, Error> {
    let decomposition = svd(jacobian)?;
    let threshold = (relative_threshold * decomposition.largest()).max(RANK_ROUND_OFF * round_off);
    let rank = decomposition.singular_values.iter().filter(|&&value| value > threshold).count();
    Ok(InstantaneousMobility {
        mobility: jacobian.ncols() - rank,
        rank,
        redundancy: jacobian.nrows() - rank,
        threshold,
        characteristic_length,
        null_space: decomposition.null_space(rank),
        self_stress: decomposition.left_null_space(rank),
        singular_values: decomposition.singular_values.clone(),
        decomposition,
    })
}
