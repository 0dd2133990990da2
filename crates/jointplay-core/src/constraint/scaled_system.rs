//! A constraint system in dimensionless coordinates.

use nalgebra::{DMatrix, DVector};

use super::{Configuration, System, scaled_jacobian, scaled_residual, units};
use crate::Error;
use crate::linalg::{Svd, svd};

/// A constraint system in units of radians and characteristic lengths.
pub(crate) struct ScaledSystem<'a, S: ?Sized> {
    system: &'a S,
    characteristic_length: f64,
    /// Unit of each constraint.
    rows: DVector<f64>,
    /// Unit of each coordinate.
    columns: DVector<f64>,
}

impl<'a, S: System + ?Sized> ScaledSystem<'a, S> {
    /// The system with lengths divided by `characteristic_length` (m).
    pub(crate) fn new(system: &'a S, characteristic_length: f64) -> Self {
        let rows = units(&system.constraint_dimensions(), characteristic_length);
        let columns = units(&system.coordinate_dimensions(), characteristic_length);
        Self { system, characteristic_length, rows, columns }
    }

    /// The system in its own units.
    pub(crate) fn system(&self) -> &'a S {
        self.system
    }

    /// The configuration at a dimensionless displacement from another.
    pub(crate) fn displaced(&self, from: &Configuration, by: &DVector<f64>) -> Configuration {
        Configuration {
            coordinates: &from.coordinates + by.component_mul(&self.columns),
            virtual_joints: from.virtual_joints.clone(),
        }
    }

    /// Dimensionless residual of the constraints.
    pub(crate) fn residual(&self, at: &Configuration) -> DVector<f64> {
        scaled_residual(&self.system.residual(at), &self.rows)
    }

    /// Dimensionless constraint Jacobian.
    pub(crate) fn jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        scaled_jacobian(&self.system.constraint_jacobian(at), &self.rows, &self.columns)
    }

    /// Dimensionless Jacobian of the constraints by the virtual coordinates.
    pub(crate) fn virtual_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let dimensions = self.system.virtual_joint_dimensions();
        let columns = units(&dimensions, self.characteristic_length);
        scaled_jacobian(&self.system.virtual_jacobian(at), &self.rows, &columns)
    }

    /// Singular value decomposition of the dimensionless constraint Jacobian.
    pub(crate) fn decomposed(&self, at: &Configuration) -> Result<Svd, Error> {
        Ok(svd(&self.jacobian(at))?)
    }

    /// Round-off of the largest dimensionless coordinate.
    pub(crate) fn coordinate_round_off(&self, at: &Configuration) -> f64 {
        f64::EPSILON * at.coordinates.component_div(&self.columns).amax()
    }
}
