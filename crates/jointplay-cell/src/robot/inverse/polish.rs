//! Residuals of positions with respect to a target, and Newton's method on the whole chain.

use jointplay_core::linalg::svd;
use jointplay_core::spatial::{Pose, tilt_rotation, wrap_angle};
use nalgebra::{DMatrix, DVector, Vector3};

use super::solution::WaferTarget;
use crate::CellError;
use crate::robot::hybrid_robot::{EffectorId, HybridRobot};
use crate::robot::positions::Positions;

/// Residual below which nothing is corrected: round-off of a metre (m or rad).
const MAX_RESIDUAL: f64 = 1e-13;

/// Largest number of Newton steps; one or two are usual.
const MAX_ITERATIONS: usize = 8;

/// Characteristic length by which angles are weighed against lengths (m).
const CHARACTERISTIC_LENGTH: f64 = 0.1;

/// Residual of a pose with respect to a target.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseResidual {
    /// Displacement to the centre (m).
    pub(super) center: Vector3<f64>,
    /// Rotation vector that lays the wafer into the plane, about an axis within the plane (rad).
    pub(super) tilt: Vector3<f64>,
    /// Heading of the wafer (rad).
    pub(super) heading: f64,
    /// Rotation about the normal to the heading asked for (rad).
    pub(super) turn: f64,
}

impl PoseResidual {
    /// The residual of a pose.
    ///
    /// # Arguments
    /// * `normal` – unit normal of the target
    pub(super) fn new(base_from_wafer: &Pose, target: &WaferTarget, normal: &Vector3<f64>) -> Self {
        let rotation = base_from_wafer.rotation.matrix();
        let found = rotation.column(2).into_owned();
        let level = tilt_rotation(normal);
        let x = level.inverse() * rotation.column(0);
        let heading = x.y.atan2(x.x);
        Self {
            center: target.center - base_from_wafer.translation.vector,
            tilt: found.cross(normal),
            heading,
            turn: target.heading.map_or(0.0, |wanted| wrap_angle(wanted - heading)),
        }
    }

    fn is_exact(&self, with_heading: bool) -> bool {
        self.center.norm() <= MAX_RESIDUAL
            && self.tilt.norm() <= MAX_RESIDUAL
            && (!with_heading || self.turn.abs() <= MAX_RESIDUAL)
    }
}

impl HybridRobot {
    /// Corrects the positions of all axes together where they are not exact yet; returns the number of steps and the residual.
    ///
    /// # Arguments
    /// * `base_from_wafer` – pose of the wafer in the given positions
    pub(super) fn polish(
        &self,
        id: EffectorId,
        base_from_wafer: &Pose,
        target: &WaferTarget,
        normal: &Vector3<f64>,
        with_heading: bool,
        positions: &mut Positions,
    ) -> Result<(usize, PoseResidual), CellError> {
        let mut missing = PoseResidual::new(base_from_wafer, target, normal);
        for step in 0..MAX_ITERATIONS {
            if missing.is_exact(with_heading) {
                return Ok((step, missing));
            }
            let jacobian = self.effector_jacobian(positions, id)?;
            let axes = self.axes_of(id)?;
            let rows = if with_heading { 6 } else { 5 };
            // Two directions span the plane: the tilt has no component along the normal.
            let level = tilt_rotation(normal);
            let (e_1, e_2) = (level * Vector3::x(), level * Vector3::y());
            let mut a = DMatrix::zeros(rows, axes.len());
            let mut b = DVector::zeros(rows);
            let mut fill = |row: usize, of: &dyn Fn(Vector3<f64>, Vector3<f64>) -> f64, value| {
                for (column, &axis) in axes.iter().enumerate() {
                    a[(row, column)] = of(jacobian.linear[axis], jacobian.angular[axis]);
                }
                b[row] = value;
            };
            for k in 0..3 {
                fill(k, &|linear, _| linear[k], missing.center[k]);
            }
            fill(
                3,
                &|_, angular| CHARACTERISTIC_LENGTH * angular.dot(&e_1),
                CHARACTERISTIC_LENGTH * missing.tilt.dot(&e_1),
            );
            fill(
                4,
                &|_, angular| CHARACTERISTIC_LENGTH * angular.dot(&e_2),
                CHARACTERISTIC_LENGTH * missing.tilt.dot(&e_2),
            );
            if with_heading {
                fill(
                    5,
                    &|_, angular| CHARACTERISTIC_LENGTH * angular.dot(normal),
                    CHARACTERISTIC_LENGTH * missing.turn,
                );
            }
            let found = svd(&a).map_err(jointplay_core::Error::from)?;
            let change = found.solve(&b, found.rank(1e-10));
            let mut next = *positions;
            for (&axis, change) in axes.iter().zip(change.iter()) {
                next[axis] += change;
            }
            let then = PoseResidual::new(&self.effector_pose(&next, id)?, target, normal);
            let size = |missing: &PoseResidual| {
                let turn = if with_heading { missing.turn } else { 0.0 };
                missing.center.norm() + CHARACTERISTIC_LENGTH * (missing.tilt.norm() + turn.abs())
            };
            if size(&then) >= size(&missing) {
                return Ok((step, missing));
            }
            (*positions, missing) = (next, then);
        }
        Ok((MAX_ITERATIONS, missing))
    }
}
