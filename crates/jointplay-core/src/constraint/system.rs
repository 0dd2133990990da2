//! The interface between mechanisms and analyses.

use nalgebra::{DMatrix, DVector};

use super::{Dimension, scaled_residual, units};
use crate::Error;

/// A configuration of a constraint system.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// (n) coordinates P of the links and joints, in SI.
    pub coordinates: DVector<f64>,
    /// (M) displacements X of the virtual joints, in SI.
    pub virtual_joints: DVector<f64>,
}

/// Constraints Φ(P, X) = 0 on the coordinates P of a mechanism, relieved by virtual joints X.
///
/// The mechanism without play is the same system with X held where it is.
/// Every mobility and sensitivity analysis is written against this trait; a mechanism of your own gets them all by implementing it.
///
/// # Source
/// \[Virtualization\], eq. (1) and (2)
pub trait System {
    /// (c) physical dimension of each constraint; their number is the length.
    fn constraint_dimensions(&self) -> Vec<Dimension>;

    /// (n) physical dimension of each coordinate.
    fn coordinate_dimensions(&self) -> Vec<Dimension>;

    /// (M) physical dimension of each virtual joint.
    fn virtual_joint_dimensions(&self) -> Vec<Dimension>;

    /// (M) stiffness of each virtual joint, which weighs its displacement, if all have one (N/m, N m/rad).
    fn virtual_joint_stiffness(&self) -> Option<DVector<f64>> {
        None
    }

    /// A length typical of the mechanism, by which lengths and angles are made comparable (m).
    fn characteristic_length(&self) -> f64;

    /// (c) Φ(P, X), each entry in the unit of its constraint.
    fn residual(&self, at: &Configuration) -> DVector<f64>;

    /// (c, n) ∂Φ/∂P: derivative of each constraint with respect to each coordinate.
    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64>;

    /// (c, M) ∂Φ/∂X: derivative of each constraint with respect to each virtual joint.
    fn virtual_jacobian(&self, at: &Configuration) -> DMatrix<f64>;

    /// (c) second derivative of Φ along a direction of P: d²Φ(P + t v, X)/dt² at t = 0.
    fn second_derivative(&self, at: &Configuration, direction: &DVector<f64>) -> DVector<f64>;

    /// Round-off of Φ near a closed configuration, in radians and characteristic lengths: that of the dimensions it is computed from.
    fn round_off(&self) -> f64 {
        f64::EPSILON
    }

    /// Violation of the constraints at a configuration: the largest entry of Φ, in radians and characteristic lengths.
    ///
    /// A system whose constraints are combinations of others may return the violation of those.
    fn mismatch(&self, at: &Configuration) -> f64 {
        let rows = units(&self.constraint_dimensions(), self.characteristic_length());
        scaled_residual(&self.residual(at), &rows).amax()
    }

    /// Whether a configuration has as many numbers as this system needs, all finite.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`].
    fn check(&self, at: &Configuration) -> Result<(), Error> {
        let parts = [
            ("the coordinate vector", &at.coordinates, self.coordinate_dimensions().len()),
            ("the virtual joint vector", &at.virtual_joints, self.virtual_joint_dimensions().len()),
        ];
        for (what, vector, expected) in parts {
            if vector.len() != expected {
                return Err(Error::LengthMismatch { what, found: vector.len(), expected });
            }
            if let Some(&value) = vector.iter().find(|value| !value.is_finite()) {
                return Err(Error::NotFinite { what, value });
            }
        }
        Ok(())
    }
}
