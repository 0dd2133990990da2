//! The robot as a constraint system.

use nalgebra::{DMatrix, DVector, Vector3};

use super::{Gpr, PlatformPose, ball_sides};
use crate::Error;
use crate::constraint::{Configuration, Dimension, System};
use crate::mobility::kutzbach_mobility;
use crate::virtualization::{Sockets, VirtualJointKind, Virtualization, sides_of};

/// The constraint system of a robot under a virtualization.
///
/// ```text
///    P = (q_1, q_2, q_3, P_1, P_2, P_3) ∈ R¹²
///    Φ = ( B_k + q_k e_b3 − P_k                    k = 1, 2, 3       nine rod constraints [m]
///          |P_j − P_i|² − ℓ_ij(X)²    ij = 12, 23, 31 )     three side constraints [m²]
/// ```
///
/// # Source
/// \[Virtualization\], IV.A
#[derive(Clone, Copy)]
pub struct GprSystem<'a, V: ?Sized> {
    gpr: &'a Gpr,
    virtualization: &'a V,
}

/// Coordinates in P.
const COORDINATES: usize = 12;
/// Index of the first side constraint in Φ.
const FIRST_SIDE: usize = 9;

impl Gpr {
    /// Freedoms by the Kutzbach count: five links, three prismatic and three spherical joints give 0.
    #[must_use]
    pub fn kutzbach_mobility(&self) -> i64 {
        kutzbach_mobility(5, &[1, 1, 1, 3, 3, 3])
    }

    /// The constraint system of this robot under a virtualization.
    #[must_use]
    pub fn system<'a, V: Virtualization + ?Sized>(
        &'a self,
        virtualization: &'a V,
    ) -> GprSystem<'a, V> {
        GprSystem { gpr: self, virtualization }
    }
}

impl<V: Virtualization + ?Sized> GprSystem<'_, V> {
    /// Indices in P of what belongs to limb k (from 0): its rod length and its ball centre.
    #[must_use]
    pub fn limb_coordinates(limb: usize) -> [usize; 4] {
        let ball = 3 + 3 * limb;
        [limb, ball, ball + 1, ball + 2]
    }

    /// Index in Φ of side constraint 12, 23 or 31 (from 0).
    #[must_use]
    pub fn side_constraint(side: usize) -> usize {
        FIRST_SIDE + side
    }

    /// The configuration of a pose, which satisfies all constraints.
    #[must_use]
    pub fn configuration(&self, pose: &PlatformPose) -> Configuration {
        let balls = self.gpr.ball_centers(&pose.rods);
        let coordinates =
            pose.rods.iter().copied().chain(balls.iter().flat_map(|ball| ball.iter().copied()));
        Configuration {
            coordinates: DVector::from_iterator(COORDINATES, coordinates),
            virtual_joints: DVector::from_column_slice(&pose.solution.virtual_joints),
        }
    }

    fn sockets(&self, at: &Configuration) -> Sockets {
        self.virtualization.sockets(self.gpr.platform(), at.virtual_joints.as_slice())
    }
}

fn balls(at: &Configuration) -> [Vector3<f64>; 3] {
    [0, 1, 2].map(|k| at.coordinates.fixed_rows::<3>(3 + 3 * k).into_owned())
}

impl<V: Virtualization + ?Sized> System for GprSystem<'_, V> {
    fn constraint_dimensions(&self) -> Vec<Dimension> {
        let mut dimensions = vec![Dimension::Length; FIRST_SIDE];
        dimensions.extend([Dimension::SquaredLength; 3]);
        dimensions
    }

    fn coordinate_dimensions(&self) -> Vec<Dimension> {
        vec![Dimension::Length; COORDINATES]
    }

    fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
        let dimension = |motion| match motion {
            VirtualJointKind::Linear => Dimension::Length,
            VirtualJointKind::Angular => Dimension::Angle,
        };
        self.virtualization.joints().iter().map(|joint| dimension(joint.motion)).collect()
    }

    /// Mean socket radius.
    fn characteristic_length(&self) -> f64 {
        self.gpr.platform().mean_radius()
    }

    fn residual(&self, at: &Configuration) -> DVector<f64> {
        let balls = balls(at);
        let (found, wanted) = (ball_sides(&balls), sides_of(&self.sockets(at)));
        let mut phi = DVector::zeros(COORDINATES);
        for k in 0..3 {
            let rod_end = self.gpr.base_points()[k].push(at.coordinates[k]);
            phi.fixed_rows_mut::<3>(3 * k).copy_from(&(rod_end - balls[k]));
            phi[FIRST_SIDE + k] = (found[k] - wanted[k]) * (found[k] + wanted[k]);
        }
        phi
    }

    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let balls = balls(at);
        let mut jacobian = DMatrix::zeros(COORDINATES, COORDINATES);
        for i in 0..3 {
            let j = (i + 1) % 3;
            jacobian[(3 * i + 2, i)] = 1.0;
            for axis in 0..3 {
                jacobian[(3 * i + axis, 3 + 3 * i + axis)] = -1.0;
                let slope = 2.0 * (balls[j][axis] - balls[i][axis]);
                jacobian[(FIRST_SIDE + i, 3 + 3 * j + axis)] = slope;
                jacobian[(FIRST_SIDE + i, 3 + 3 * i + axis)] = -slope;
            }
        }
        jacobian
    }

    fn virtual_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let count = self.virtualization.joints().len();
        let sockets = self.sockets(at);
        let mut velocities = vec![Sockets::default(); count];
        self.virtualization.socket_velocities(
            self.gpr.platform(),
            at.virtual_joints.as_slice(),
            &mut velocities,
        );
        let mut jacobian = DMatrix::zeros(COORDINATES, count);
        for (m, velocity) in velocities.iter().enumerate() {
            for i in 0..3 {
                let j = (i + 1) % 3;
                let edge = sockets[j] - sockets[i];
                jacobian[(FIRST_SIDE + i, m)] = -2.0 * edge.dot(&(velocity[j] - velocity[i]));
            }
        }
        jacobian
    }

    fn second_derivative(&self, _at: &Configuration, direction: &DVector<f64>) -> DVector<f64> {
        let mut second = DVector::zeros(COORDINATES);
        for i in 0..3 {
            let j = (i + 1) % 3;
            let relative =
                direction.fixed_rows::<3>(3 + 3 * j) - direction.fixed_rows::<3>(3 + 3 * i);
            second[FIRST_SIDE + i] = 2.0 * relative.norm_squared();
        }
        second
    }
}

impl<V: Virtualization + ?Sized> GprSystem<'_, V> {
    /// The configuration midway between two others, whose derivatives are those of the chord between them.
    ///
    /// The side constraints are squares, so that their derivative here times the step is exactly their change over the step.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`].
    pub fn midpoint(
        &self,
        from: &Configuration,
        to: &Configuration,
    ) -> Result<Configuration, Error> {
        self.check(from)?;
        self.check(to)?;
        Ok(Configuration {
            coordinates: (&from.coordinates + &to.coordinates) * 0.5,
            virtual_joints: (&from.virtual_joints + &to.virtual_joints) * 0.5,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mobility::{
        RANK_THRESHOLD, augmented_mobility, finite_mobility, instantaneous_mobility,
    };
    use crate::sensitivity::sensitivity;
    use crate::virtualization::{Polar, SolveOptions};

    /// Every analysis refuses this configuration with this message.
    #[track_caller]
    fn check(change: impl Fn(&mut Configuration), message: &str) {
        let gpr = Gpr::paper().without_limit_checks();
        let system = gpr.system(&Polar);
        let pose = gpr.forward([0.5, 0.501, 0.502], &Polar, &SolveOptions::default()).unwrap();
        let good = system.configuration(&pose);
        let mut at = good.clone();
        change(&mut at);
        let errors = [
            system.check(&at).unwrap_err(),
            instantaneous_mobility(&system, &at, RANK_THRESHOLD).unwrap_err(),
            augmented_mobility(&system, &at, RANK_THRESHOLD).unwrap_err(),
            finite_mobility(&system, &at, RANK_THRESHOLD).unwrap_err(),
            sensitivity(&system, &at, 1e-3, RANK_THRESHOLD).unwrap_err(),
            system.midpoint(&good, &at).unwrap_err(),
            system.midpoint(&at, &good).unwrap_err(),
        ];
        for error in errors {
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn length_mismatches_and_non_finite_numbers_are_refused() {
        check(
            |at| at.coordinates = DVector::zeros(11),
            "the coordinate vector has 11 entries, but 12 are needed",
        );
        check(
            |at| at.virtual_joints = DVector::zeros(3),
            "the virtual joint vector has 3 entries, but 6 are needed",
        );
        check(
            |at| at.coordinates[7] = f64::NAN,
            "the coordinate vector is NaN, but has to be a finite number",
        );
        check(
            |at| at.virtual_joints[5] = f64::INFINITY,
            "the virtual joint vector is inf, but has to be a finite number",
        );
    }

    #[test]
    fn open_loops_have_no_finite_mobility() {
        let gpr = Gpr::paper().without_limit_checks();
        let system = gpr.system(&Polar);
        let pose = gpr.forward([0.5; 3], &Polar, &SolveOptions::default()).unwrap();
        let mut at = system.configuration(&pose);
        at.coordinates[0] += 1e-6 * system.characteristic_length();
        let Err(Error::NotClosed { residual, allowed }) =
            finite_mobility(&system, &at, RANK_THRESHOLD)
        else {
            panic!("an open loop was taken as closed");
        };
        assert!((residual - 1e-6).abs() < 1e-12 && allowed == 1e-9);
    }

    #[test]
    fn motion_with_a_length_mismatch_has_no_bounds() {
        let gpr = Gpr::paper().without_limit_checks();
        let system = gpr.system(&Polar);
        let pose = gpr.forward([0.5; 3], &Polar, &SolveOptions::default()).unwrap();
        let at = system.configuration(&pose);
        let found = sensitivity(&system, &at, 1e-3, RANK_THRESHOLD).unwrap();
        let error = found.bounds(&DVector::zeros(3)).unwrap_err();
        assert_eq!(error.to_string(), "the motion has 3 entries, but 12 are needed");
    }
}
