//! Taking the unit of length out of a Jacobian, so that its rank does not depend on it.

use nalgebra::{DMatrix, DVector};

/// Physical dimension of a coordinate or a constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A length (m).
    Length,
    /// A squared length (m²).
    SquaredLength,
    /// An angle, or a number without unit (rad).
    Angle,
}

impl Dimension {
    /// One unit of the scaled, dimensionless quantity, in SI.
    #[must_use]
    pub fn unit(self, characteristic_length: f64) -> f64 {
        match self {
            Self::Length => characteristic_length,
            Self::SquaredLength => characteristic_length * characteristic_length,
            Self::Angle => 1.0,
        }
    }
}

/// Units of each quantity, for a characteristic length (m).
pub(crate) fn units(dimensions: &[Dimension], characteristic_length: f64) -> DVector<f64> {
    DVector::from_iterator(
        dimensions.len(),
        dimensions.iter().map(|d| d.unit(characteristic_length)),
    )
}

/// J with each row divided by the unit of its constraint and each column multiplied by that of its coordinate.
pub(crate) fn scaled_jacobian(
    jacobian: &DMatrix<f64>,
    row_units: &DVector<f64>,
    column_units: &DVector<f64>,
) -> DMatrix<f64> {
    DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |row, column| {
        jacobian[(row, column)] * column_units[column] / row_units[row]
    })
}

/// Φ with each entry divided by the unit of its constraint.
pub(crate) fn scaled_residual(residual: &DVector<f64>, row_units: &DVector<f64>) -> DVector<f64> {
    residual.component_div(row_units)
}
