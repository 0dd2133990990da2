//! Quantities of many poses.

use crate::Error;
use crate::virtualization::Virtualization;

/// A number that each pose has; the column of a quantity is in its unit.
///
/// Indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Side L_12, L_23 or L_31 (m).
    Side(usize),
    /// Coordinate of a virtual joint, in the order of X ((m), (rad)).
    VirtualJoint(usize),
    /// Displacement of a virtual joint from nominal, in the order of X ((m), (rad)).
    VirtualDisplacement(usize),
    /// e_b1, e_b2 or e_b3 coordinate of O_p (m); the first two are the centre shift.
    Origin(usize),
    /// e_b1, e_b2 or e_b3 coordinate of the platform normal.
    Normal(usize),
    /// Row and column of the rotation from the platform frame to the base frame; the last column is the normal.
    Rotation(usize, usize),
    /// Azimuth toward which the platform tilts, from −π to π (rad).
    Azimuth,
    /// Tilt angle, from 0 to π (rad).
    TiltAngle,
    /// Turn about the platform normal beyond the shortest rotation to it (rad).
    Torsion,
    /// Axis height: height at which the platform plane crosses the base axis (m).
    AxisHeight,
    /// Displacement of the virtual joints from nominal, in the metric: √(Σ linear² + ρ² Σ angular²) (m).
    Displacement,
    /// Distance of ball 1, 2 or 3 from the centre of its nominal socket (m).
    BallDisplacement(usize),
    /// Singular values of ∂X/∂P in the metric, the largest first, as [`sensitivity`](crate::sensitivity::sensitivity) finds them.
    Sensitivity(usize),
    /// Largest difference between a side and its virtual length (m).
    Residual,
    /// Iterations of the solver, a whole number; 0 for a closed form, and for the polynomials of a [`PoseSolver`](super::PoseSolver).
    Iterations,
}

impl Quantity {
    /// Whether this quantity exists for a virtualization.
    ///
    /// # Errors
    /// [`Error::NoSuchQuantity`] with the indices that there are.
    pub fn check(self, virtualization: &dyn Virtualization) -> Result<(), Error> {
        let (what, index, count) = match self {
            Self::Side(index) => ("side", index, 3),
            Self::VirtualJoint(index) | Self::VirtualDisplacement(index) => {
                ("virtual joint", index, virtualization.joints().len())
            }
            Self::Origin(index) => ("coordinate of the origin", index, 3),
            Self::Normal(index) => ("coordinate of the normal", index, 3),
            Self::Rotation(row, column) => ("row or column of the rotation", row.max(column), 3),
            Self::BallDisplacement(index) => ("displacement of a ball", index, 3),
            Self::Sensitivity(index) => ("singular value of the sensitivity", index, 3),
            _ => return Ok(()),
        };
        crate::error::indices(what, &[index], count)
    }
}
