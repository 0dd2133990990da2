//! Jacobians of frames and their time derivatives.

use nalgebra::{DMatrix, DVector, Vector3};

use super::differential::DifferentialKinematics;
use crate::Error;
use crate::linalg::svd;
use crate::mechanism::FrameId;
use crate::mobility::RANK_THRESHOLD;
use crate::spatial::FrameTwist;

/// How well a frame can be moved by the commanded coordinates, from a Jacobian in radians and characteristic lengths.
///
/// All of it depends on the characteristic length where the frame both turns and translates, or where both lengths and angles are commanded.
#[derive(Debug, Clone, PartialEq)]
pub struct Dexterity {
    /// (min(6, n)) singular values, largest first: the velocity ratios along the principal directions.
    pub singular_values: DVector<f64>,
    /// Largest over smallest singular value; `None` where the smallest is zero but for round-off.
    pub condition_number: Option<f64>,
    /// Product of the singular values: √det(J Jᵀ), for fewer than six coordinates √det(Jᵀ J).
    pub manipulability: f64,
}

/// Dexterity from a geometric Jacobian.
///
/// # Arguments
/// * `jacobian` – (6, n) angular rows, then linear rows
/// * `units` – (n) one unit of each commanded coordinate: 1 for an angle, the characteristic length for a length (m)
/// * `characteristic_length` – unit of the linear rows (m)
///
/// # Errors
/// [`Error::LengthMismatch`]; [`Error::Linalg`] for numbers that are not finite.
///
/// # Source
/// \[Siciliano\], section 3.9: manipulability
pub fn dexterity(
    jacobian: &DMatrix<f64>,
    units: &[f64],
    characteristic_length: f64,
) -> Result<Dexterity, Error> {
    if units.len() != jacobian.ncols() {
        let (what, found) = ("the list of units", units.len());
        return Err(Error::LengthMismatch { what, found, expected: jacobian.ncols() });
    }
    let scaled = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |row, column| {
        let unit = if row < 3 { 1.0 } else { characteristic_length };
        jacobian[(row, column)] * units[column] / unit
    });
    let singular_values = svd(&scaled)?.singular_values;
    let (largest, smallest) = (singular_values.max(), singular_values.min());
    let is_regular = smallest > RANK_THRESHOLD * largest;
    Ok(Dexterity {
        condition_number: is_regular.then(|| largest / smallest),
        manipulability: singular_values.product(),
        singular_values,
    })
}

impl DifferentialKinematics {
    /// (f + M, n) derivative of all coordinates with respect to the commanded ones, in SI units; for a ball, in the components of its angular velocity in the turned frame.
    ///
    /// # Errors
    /// Those of [`velocities`](Self::velocities).
    pub fn coordinate_derivatives(&mut self) -> Result<DMatrix<f64>, Error> {
        let (all, count) = (self.coordinate_count(), self.commanded().len());
        let mut derivatives = DMatrix::zeros(all, count);
        let mut rates = vec![0.0; count];
        for (j, mut column) in derivatives.column_iter_mut().enumerate() {
            rates.fill(0.0);
            rates[j] = 1.0;
            self.velocities(&rates, column.as_mut_slice())?;
        }
        Ok(derivatives)
    }

    /// (6, n) geometric Jacobian of a frame: its angular velocity, then the velocity of its origin, in the base frame, for a unit velocity of each commanded coordinate.
    ///
    /// # Errors
    /// Those of [`velocities`](Self::velocities); [`Error::NoSuchQuantity`].
    pub fn jacobian(&mut self, frame: FrameId) -> Result<DMatrix<f64>, Error> {
        let count = self.commanded().len();
        let mut jacobian = DMatrix::zeros(6, count);
        let (mut rates, mut all) = (vec![0.0; count], vec![0.0; self.coordinate_count()]);
        for (j, mut column) in jacobian.column_iter_mut().enumerate() {
            rates.fill(0.0);
            rates[j] = 1.0;
            self.velocities(&rates, &mut all)?;
            column.copy_from_slice(&entries(self.frame_velocity(frame)?));
        }
        Ok(jacobian)
    }

    /// (6, n) rate of change of the geometric Jacobian of a frame while the commanded coordinates move.
    ///
    /// ```text
    ///    J̇ e_j  =  S(e_j, ȧ)  +  ½ (ω × ω_j, 0)  +  ½ J [ȧ, e_j]
    /// ```
    /// S is the symmetric bilinear form of the accelerations without ä; angular velocities are no derivatives of coordinates, so that theirs differ by ω × ω_j from symmetric ones, and so do those of a commanded ball.
    ///
    /// # Arguments
    /// * `commanded` – velocity of each commanded coordinate (m/s, rad/s)
    ///
    /// # Errors
    /// Those of [`velocities`](Self::velocities); [`Error::NoSuchQuantity`].
    ///
    /// # Source
    /// Own derivation
    pub fn jacobian_derivative(
        &mut self,
        frame: FrameId,
        commanded: &[f64],
    ) -> Result<DMatrix<f64>, Error> {
        let count = self.commanded().len();
        let jacobian = self.jacobian(frame)?;
        let mut derivative = DMatrix::zeros(6, count);
        let mut all = vec![0.0; self.coordinate_count()];
        // Also checks the velocities.
        self.velocities(commanded, &mut all)?;
        let turn = self.frame_velocity(frame)?.angular;
        let speed = commanded.iter().map(|rate| rate * rate).sum::<f64>().sqrt();
        if speed == 0.0 {
            return Ok(derivative);
        }
        let still = vec![0.0; count];
        let mut rates = vec![0.0; count];
        let brackets = self.commanded_brackets(commanded);
        for j in 0..count {
            // S(e_j, ȧ) by the quadratic form at e_j ± ȧ/|ȧ|: exact, the form has no other terms.
            let mut column = nalgebra::Vector6::zeros();
            for sign in [1.0, -1.0] {
                for (rate, along) in rates.iter_mut().zip(commanded) {
                    *rate = sign * along / speed;
                }
                rates[j] += 1.0;
                self.velocities(&rates, &mut all)?;
                self.accelerations(&still, &mut all)?;
                let part = entries(self.frame_acceleration(frame)?);
                column += nalgebra::Vector6::from(part) * (0.25 * sign * speed);
            }
            let own: Vector3<f64> = jacobian.fixed_view::<3, 1>(0, j).into_owned();
            let mut angular = column.fixed_rows_mut::<3>(0);
            angular += turn.cross(&own) * 0.5;
            column += &jacobian * brackets.column(j) * 0.5;
            derivative.set_column(j, &column);
        }
        Ok(derivative)
    }

    /// (n, n) [ȧ, e_j] by columns: not zero only for balls, whose rates are angular velocities in the turned frame.
    fn commanded_brackets(&self, rates: &[f64]) -> DMatrix<f64> {
        let count = rates.len();
        let mut brackets = DMatrix::zeros(count, count);
        for ball in self.commanded_balls() {
            let along = Vector3::from(ball.map(|k| rates[k]));
            for (axis, &j) in ball.iter().enumerate() {
                let bracket = along.cross(&Vector3::ith(axis, 1.0));
                for (part, &row) in ball.iter().enumerate() {
                    brackets[(row, j)] = bracket[part];
                }
            }
        }
        brackets
    }
}

/// Angular, then linear part.
fn entries(twist: FrameTwist) -> [f64; 6] {
    let FrameTwist { angular, linear } = twist;
    [angular.x, angular.y, angular.z, linear.x, linear.y, linear.z]
}
