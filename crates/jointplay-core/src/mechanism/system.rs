//! Any mechanism as a constraint system.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::ball::rotation_vector_rate;
use super::coupling_rows::{CouplingRow, coupling_rows};
use super::description::{Mechanism, default_length};
use super::kinematics::{
    KinematicState, Kinematics, bracket, carried, check_coordinates, minus, skew_part,
};
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, Configuration, Dimension, System};
use crate::spatial::{Pose, rotation_vector};

/// Most joint and virtual coordinates, or closure equations, of a mechanism that is analysed.
pub const MAX_DENSE: usize = 240;

/// The loop closures and couplings of a mechanism, in coordinates that count from a home configuration.
///
/// ```text
///    Φ  =  (Q ⊗ I_6) · (closure of each joint)        Q Qᵀ = I, rows of Q span the cycles of the graph
///  (6·loops)                                        then one row for each coupling
/// ```
/// Each loop asks three angles and three lengths; loops are combined to an orthonormal basis of cycles, so that singular values do not depend on which spanning tree was taken.
/// Lengths are those of the point in the middle of the joints, so that they do not depend on where the base is.
///
/// # Source
/// Loop closure in screws: \[Gogu\]; the orthonormal cycles are own derivation, `docs/explanation/mechanisms.md`
#[derive(Debug, Clone)]
pub struct MechanismSystem<'a> {
    kinematics: Kinematics<'a>,
    home: DVector<f64>,
    reference: Vector3<f64>,
    characteristic_length: f64,
    /// Largest distance of a joint frame from the origin of its link (m).
    reach: f64,
    /// (loops, joints) orthonormal cycles.
    cycles: DMatrix<f64>,
    /// Inverse of the Cholesky factor that makes them so.
    orthonormalizer: DMatrix<f64>,
    angular: AngularMismatch,
    couplings: Vec<CouplingRow>,
}

/// Measure of the angular mismatch of a loop; for small angles they are equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum AngularMismatch {
    /// Axis times sine of the angle.
    Sine,
    /// Axis times angle, which is not 0 for half turns.
    RotationVector,
}

/// How far apart the two frames of a closing joint are.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopGap {
    /// Between their origins (m).
    pub(super) distance: f64,
    /// Between their directions (rad).
    pub(super) angle: f64,
}

impl<'a> MechanismSystem<'a> {
    /// The system about a home configuration, closed or not.
    ///
    /// # Arguments
    /// * `home` – (f + M) coordinates of the joints, then of the virtual joints (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::TooLarge`] beyond [`MAX_DENSE`].
    pub fn new(mechanism: &'a Mechanism, home: DVector<f64>) -> Result<Self, Error> {
        Self::check_size(mechanism)?;
        let kinematics = Kinematics::new(mechanism);
        check_coordinates(&home, kinematics.dimensions().len())?;
        let (reference, spread) = middle(&kinematics, &home);
        let characteristic_length = mechanism.characteristic_length().unwrap_or(spread);
        let (cycles, orthonormalizer) = orthonormal_cycles(&kinematics);
        let couplings = coupling_rows(&kinematics, characteristic_length);
        let frames = mechanism.joints().iter().flat_map(|joint| &joint.frames);
        let reach = frames.map(|frame| frame.translation.vector.norm()).fold(0.0, f64::max);
        Ok(Self {
            kinematics,
            home,
            reference,
            characteristic_length,
            reach,
            cycles,
            orthonormalizer,
            angular: AngularMismatch::Sine,
            couplings,
        })
    }

    /// The same system with rotation vectors as angular mismatch, for searches far from closure; it has no second derivative.
    pub(super) fn with_rotation_vectors(self) -> Self {
        Self { angular: AngularMismatch::RotationVector, ..self }
    }

    /// The same system, in which balls with commanded coordinates change by their rotation vectors, so that these coordinates keep the values of their commands.
    ///
    /// # Arguments
    /// * `free` – indices of the coordinates that are not commanded
    pub(super) fn with_free(mut self, free: &[usize]) -> Self {
        self.kinematics.command(|k| free.contains(&k));
        self
    }

    /// Whether a mechanism is small enough for the dense algebra of a system; larger ones are for [`super::SparseSystem`].
    #[must_use]
    pub fn fits(mechanism: &Mechanism) -> bool {
        Self::check_size(mechanism).is_ok()
    }

    /// Checks that a mechanism is small enough for the dense algebra of a system.
    ///
    /// # Errors
    /// [`Error::TooLarge`] beyond [`MAX_DENSE`].
    pub fn check_size(mechanism: &Mechanism) -> Result<(), Error> {
        let sizes = [
            ("coordinates", mechanism.joint_freedoms() + mechanism.virtual_joints().len()),
            ("closure equations", mechanism.constraints()),
        ];
        match sizes.into_iter().find(|&(_, found)| found > MAX_DENSE) {
            Some((what, found)) => Err(Error::TooLarge { what, found, allowed: MAX_DENSE }),
            None => Ok(()),
        }
    }

    /// The same mechanism about another home.
    ///
    /// # Errors
    /// As [`MechanismSystem::new`].
    pub fn with_home(&self, home: DVector<f64>) -> Result<Self, Error> {
        check_coordinates(&home, self.home.len())?;
        let (reference, _) = middle(&self.kinematics, &home);
        Ok(Self { home, reference, ..self.clone() })
    }

    /// The same system with another characteristic length, such as that of a [`super::Relief`] (m).
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::OutOfRange`] unless it is positive.
    pub fn with_characteristic_length(self, length: f64) -> Result<Self, Error> {
        let what = "characteristic length";
        crate::error::finite(what, length)?;
        if length <= 0.0 {
            let (min, max) = (f64::MIN_POSITIVE, f64::MAX);
            return Err(Error::OutOfRange { what, value: length, min, max, unit: "m" });
        }
        let couplings = coupling_rows(&self.kinematics, length);
        Ok(Self { characteristic_length: length, couplings, ..self })
    }

    /// The same system at a displaced home; reference point and characteristic length stay.
    ///
    /// # Errors
    /// As [`MechanismSystem::new`].
    pub fn moved(&self, by: &DVector<f64>) -> Result<Self, Error> {
        check_coordinates(by, self.home.len())?;
        Ok(Self { home: self.kinematics.moved(&self.home, by), ..self.clone() })
    }

    /// The same system at another home; reference point and characteristic length stay.
    pub(super) fn moved_to(&self, home: DVector<f64>) -> Result<Self, Error> {
        check_coordinates(&home, self.home.len())?;
        Ok(Self { home, ..self.clone() })
    }

    /// Tree, loops and poses.
    #[must_use]
    pub fn kinematics(&self) -> &Kinematics<'a> {
        &self.kinematics
    }

    /// (f + M) the coordinates that displacements count from (m, rad).
    #[must_use]
    pub fn home(&self) -> &DVector<f64> {
        &self.home
    }

    /// The home configuration in the coordinates of the system: no displacement.
    #[must_use]
    pub fn at_home(&self) -> Configuration {
        let f = self.freedoms();
        Configuration {
            coordinates: DVector::zeros(f),
            virtual_joints: self.home.rows(f, self.home.len() - f).into_owned(),
        }
    }

    /// (loops, joints) how much each joint belongs to each of the orthonormal cycles; a self-stress s acts in joint j by the wrench Σ_l Q_lj s_l.
    #[must_use]
    pub fn cycles(&self) -> &DMatrix<f64> {
        &self.cycles
    }

    /// The point that lengths of the closures are those of, in the base frame (m).
    #[must_use]
    pub fn reference(&self) -> Vector3<f64> {
        self.reference
    }

    /// Largest mismatch of each loop at home, in units of the characteristic length and in radians, named by the joint that closes it.
    #[must_use]
    pub fn loop_residuals(&self) -> Vec<(usize, f64)> {
        let sizes = self.loop_mismatches(&self.at_home());
        self.kinematics.closing_joints().iter().copied().zip(sizes).collect()
    }

    /// Violation of each coupling at home, in radians and characteristic lengths, without sign.
    #[must_use]
    pub fn coupling_residuals(&self) -> Vec<f64> {
        self.coupling_violations(&self.at_home()).into_iter().map(f64::abs).collect()
    }

    /// Violation of each coupling, in radians and characteristic lengths.
    fn coupling_violations(&self, at: &Configuration) -> Vec<f64> {
        let coordinate = |k: usize| self.home[k] + at.coordinates[k];
        self.couplings.iter().map(|row| row.residual(coordinate)).collect()
    }

    /// How far apart the frames of each closing joint are at home.
    pub(super) fn loop_gaps(&self) -> Vec<LoopGap> {
        let placed = self.placed(&self.at_home(), None);
        let joints = self.kinematics.closing_joints().iter();
        let gap = |(&joint, mismatch): (&usize, &Pose)| {
            let joint = &self.kinematics.mechanism().joints()[joint];
            let frame = placed.links[joint.links[1]] * joint.frames[1];
            let point = frame.translation.vector;
            let missed = mismatch.rotation * point + mismatch.translation.vector;
            LoopGap {
                distance: (missed - point).norm(),
                angle: rotation_vector(&mismatch.rotation).norm(),
            }
        };
        joints.zip(&placed.mismatches).map(gap).collect()
    }

    /// Whether all loops are closed at home, to round-off.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.mismatch(&self.at_home()) <= CLOSURE_TOLERANCE
    }

    fn loop_mismatches(&self, at: &Configuration) -> Vec<f64> {
        self.placed(at, None).mismatches.iter().map(|mismatch| self.missed_by(mismatch)).collect()
    }

    /// Size of a mismatch, in radians and characteristic lengths.
    fn missed_by(&self, mismatch: &Pose) -> f64 {
        // Half turns leave no antisymmetric part behind, but are no closure: 2 sin(θ/2) sees them.
        let turned = (mismatch.rotation.matrix() - Matrix3::identity()).norm();
        let shifted = mismatch.rotation * self.reference + mismatch.translation.vector;
        let shift = (shifted - self.reference).norm() / self.characteristic_length;
        (turned / std::f64::consts::SQRT_2).max(shift)
    }

    fn freedoms(&self) -> usize {
        self.kinematics.mechanism().joint_freedoms()
    }

    /// Displacement from home of joints and virtual joints, in one vector.
    fn displacement(&self, at: &Configuration) -> DVector<f64> {
        let f = self.freedoms();
        DVector::from_fn(self.home.len(), |k, _| {
            if k < f { at.coordinates[k] } else { at.virtual_joints[k - f] - self.home[k] }
        })
    }

    fn placed(&self, at: &Configuration, along: Option<&DVector<f64>>) -> KinematicState {
        let by = self.displacement(at);
        self.kinematics.placed(&self.home, &by, &self.reference, along)
    }

    /// Angular and linear mismatch of each loop.
    fn raw_residual(&self, placed: &KinematicState) -> Vec<Vector3<f64>> {
        let parts = placed.mismatches.iter().flat_map(|mismatch| {
            let shifted = mismatch.rotation * self.reference + mismatch.translation.vector;
            let angular = match self.angular {
                AngularMismatch::Sine => skew_part(mismatch.rotation.matrix()),
                AngularMismatch::RotationVector => rotation_vector(&mismatch.rotation),
            };
            [angular, shifted - self.reference]
        });
        parts.collect()
    }

    /// (6·loops + couplings) the rows of the loops combined to orthonormal cycles, and those of the couplings.
    ///
    /// # Arguments
    /// * `raw` – (6·loops) rows of the loops of the tree
    fn combined(&self, raw: &DMatrix<f64>, coupled: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let first = raw.nrows();
        let rows = first + self.couplings.len();
        let mut combined = DMatrix::from_fn(rows, raw.ncols(), |row, column| {
            row.checked_sub(first).map_or(0.0, |coupling| coupled(coupling, column))
        });
        for l in 0..self.orthonormalizer.nrows() {
            for k in 0..=l {
                let weight = self.orthonormalizer[(l, k)];
                for row in 0..6 {
                    for column in 0..raw.ncols() {
                        combined[(6 * l + row, column)] += weight * raw[(6 * k + row, column)];
                    }
                }
            }
        }
        combined
    }

    /// (6·loops + couplings, f + M) derivative with respect to the displacement of every joint and virtual joint.
    pub(super) fn full_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let placed = self.placed(at, None);
        let loops = self.kinematics.closing_joints().len();
        let mut raw = DMatrix::zeros(6 * loops, self.home.len());
        for (l, &joint) in self.kinematics.closing_joints().iter().enumerate() {
            let mismatch = &placed.mismatches[l];
            let [first, second] = self.kinematics.mechanism().joints()[joint].links;
            let rotation = mismatch.rotation.matrix();
            let to_rows = match self.angular {
                AngularMismatch::Sine => (Matrix3::identity() * rotation.trace() - rotation) * 0.5,
                AngularMismatch::RotationVector => {
                    rotation_vector_rate(&rotation_vector(&mismatch.rotation))
                }
            };
            let arm = rotation * self.reference + mismatch.translation.vector - self.reference;
            let mut add = |column: usize, sense: f64, (angular, linear): super::joint::Twist| {
                let rows = [to_rows * angular, linear + angular.cross(&arm)];
                for (half, part) in rows.iter().enumerate() {
                    for axis in 0..3 {
                        raw[(6 * l + 3 * half + axis, column)] += sense * part[axis];
                    }
                }
            };
            for (j, sense) in self.kinematics.path_to(first).chain([(joint, 1.0)]) {
                self.kinematics.columns_of(j).for_each(|k| add(k, sense, placed.screws[k]));
            }
            for (j, sense) in self.kinematics.path_to(second) {
                self.kinematics.columns_of(j).for_each(|k| {
                    add(k, -sense, carried(mismatch, &placed.screws[k], &self.reference));
                });
            }
            // Joints before a closed loop carry it whole: what is left of them is round-off, and no constraint.
            if self.missed_by(mismatch) <= CLOSURE_TOLERANCE {
                let on_first: Vec<usize> = self.kinematics.path_to(first).map(|(j, _)| j).collect();
                let shared = self.kinematics.path_to(second).map(|(j, _)| j);
                for j in shared.filter(|j| on_first.contains(j)) {
                    let columns = self.kinematics.columns_of(j);
                    columns.for_each(|k| raw.view_mut((6 * l, k), (6, 1)).fill(0.0));
                }
            }
        }
        let coupled = |coupling: usize, column: usize| {
            let entries = self.couplings[coupling].entries.iter();
            entries.filter(|(k, _)| *k == column).map(|(_, factor)| factor).sum()
        };
        self.combined(&raw, coupled)
    }
}

impl System for MechanismSystem<'_> {
    fn constraint_dimensions(&self) -> Vec<Dimension> {
        let one = [[Dimension::Angle; 3], [Dimension::Length; 3]].concat();
        let loops = one.repeat(self.kinematics.closing_joints().len());
        [loops, vec![Dimension::Angle; self.couplings.len()]].concat()
    }

    fn coordinate_dimensions(&self) -> Vec<Dimension> {
        self.kinematics.dimensions()[..self.freedoms()].to_vec()
    }

    fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
        self.kinematics.dimensions()[self.freedoms()..].to_vec()
    }

    fn virtual_joint_stiffness(&self) -> Option<DVector<f64>> {
        let virtual_joints = self.kinematics.mechanism().virtual_joints();
        let all: Option<Vec<f64>> = virtual_joints.iter().map(|joint| joint.stiffness).collect();
        all.filter(|stiffness| !stiffness.is_empty()).map(DVector::from_vec)
    }

    /// The user's, or the root mean square distance of the joints from their middle at home.
    fn characteristic_length(&self) -> f64 {
        self.characteristic_length
    }

    /// Round-off of the joint frames, whose coordinates are rounded in proportion to their distance from the origin of their link.
    fn round_off(&self) -> f64 {
        f64::EPSILON * (self.reach / self.characteristic_length).max(1.0)
    }

    /// Largest mismatch of a loop or coupling.
    fn mismatch(&self, at: &Configuration) -> f64 {
        let couplings = self.coupling_violations(at).into_iter().map(f64::abs);
        self.loop_mismatches(at).into_iter().chain(couplings).fold(0.0, f64::max)
    }

    fn residual(&self, at: &Configuration) -> DVector<f64> {
        let raw = self.raw_residual(&self.placed(at, None));
        let raw =
            DMatrix::from_iterator(3 * raw.len(), 1, raw.iter().flat_map(|v| v.iter().copied()));
        let violations = self.coupling_violations(at);
        self.combined(&raw, |coupling, _| violations[coupling]).column(0).into_owned()
    }

    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        self.full_jacobian(at).columns(0, self.freedoms()).into_owned()
    }

    fn virtual_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let f = self.freedoms();
        self.full_jacobian(at).columns(f, self.home.len() - f).into_owned()
    }

    fn second_derivative(&self, at: &Configuration, direction: &DVector<f64>) -> DVector<f64> {
        let mut along = DVector::zeros(self.home.len());
        along.rows_mut(0, self.freedoms()).copy_from(direction);
        let placed = self.placed(at, Some(&along));
        let (links, closing) = self.kinematics.rates(&placed, &along);
        let c = &self.reference;
        let mut raw = DMatrix::zeros(6 * closing.len(), 1);
        for (l, (&joint, beyond)) in
            self.kinematics.closing_joints().iter().zip(&closing).enumerate()
        {
            let mismatch = &placed.mismatches[l];
            let end = &links[self.kinematics.mechanism().joints()[joint].links[1]];
            let other = carried(mismatch, &end.velocity, c);
            let velocity = minus(&beyond.velocity, &other);
            let other_rate = carried(mismatch, &end.acceleration, c);
            let acceleration =
                minus(&minus(&beyond.acceleration, &other_rate), &bracket(&velocity, &other));
            let (spin, spin_rate) = (velocity.0.cross_matrix(), acceleration.0.cross_matrix());
            let rotation = mismatch.rotation.matrix();
            let arm = rotation * c + mismatch.translation.vector - c;
            let angular = skew_part(&((spin_rate + spin * spin) * rotation));
            let linear = acceleration.1
                + acceleration.0.cross(&arm)
                + velocity.0.cross(&(velocity.1 + velocity.0.cross(&arm)));
            for axis in 0..3 {
                raw[(6 * l + axis, 0)] = angular[axis];
                raw[(6 * l + 3 + axis, 0)] = linear[axis];
            }
        }
        // Couplings are linear.
        self.combined(&raw, |_, _| 0.0).column(0).into_owned()
    }
}

/// Middle of the joints, and the characteristic length by their root mean square distance from it.
pub(super) fn middle(kinematics: &Kinematics<'_>, home: &DVector<f64>) -> (Vector3<f64>, f64) {
    let zero = DVector::zeros(home.len());
    let links = kinematics.placed(home, &zero, &Vector3::zeros(), None).links;
    let joints = kinematics.mechanism().joints();
    let points: Vec<Vector3<f64>> = joints
        .iter()
        .flat_map(|joint| {
            [0, 1].map(|side| (links[joint.links[side]] * joint.frames[side]).translation.vector)
        })
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
    let count = points.len() as f64;
    let middle = points.iter().sum::<Vector3<f64>>() / count;
    let largest = points.iter().map(Vector3::amax).fold(0.0, f64::max);
    let spread = points.iter().map(|point| (point - middle).norm_squared()).sum::<f64>() / count;
    let spread = spread.sqrt();
    (middle, default_length(spread, largest))
}

/// Orthonormal rows that span the cycles of the graph, and the matrix that makes them of the loops of the tree.
fn orthonormal_cycles(kinematics: &Kinematics<'_>) -> (DMatrix<f64>, DMatrix<f64>) {
    let joints = kinematics.mechanism().joints();
    let cuts = kinematics.closing_joints();
    let mut loops = DMatrix::zeros(cuts.len(), joints.len());
    for (l, &joint) in cuts.iter().enumerate() {
        let [first, second] = joints[joint].links;
        loops[(l, joint)] = 1.0;
        kinematics.path_to(first).for_each(|(j, sense)| loops[(l, j)] += sense);
        kinematics.path_to(second).for_each(|(j, sense)| loops[(l, j)] -= sense);
    }
    let gram = &loops * loops.transpose();
    let factor = gram.cholesky().expect("each loop has a closing joint of its own").l();
    let inverse = factor
        .solve_lower_triangular(&DMatrix::identity(cuts.len(), cuts.len()))
        .expect("a Cholesky factor has a positive diagonal");
    (&inverse * loops, inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn rates_of_rotation_vectors_equal_their_differences() {
        for vector in [[1e-5, 0.0, 0.0], [0.3, -0.2, 0.9], [2.0, 1.0, -1.8]] {
            let vector = Vector3::from(vector);
            let rate = rotation_vector_rate(&vector);
            let step = 1e-6;
            for k in 0..3 {
                let turned = |by: f64| {
                    let mut spin = Vector3::zeros();
                    spin[k] = by;
                    rotation_vector(&(Rotation3::new(spin) * Rotation3::new(vector)))
                };
                let difference = (turned(step) - turned(-step)) / (2.0 * step);
                assert!((difference - rate.column(k)).amax() < 1e-8, "{vector} {difference}");
            }
        }
    }
}
