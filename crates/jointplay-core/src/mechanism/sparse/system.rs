//! A mechanism in a configuration, for sparse algebra.

use nalgebra::{DVector, Rotation3, Translation3, Vector3, Vector6};

use super::coupling::{SparseCoupling, sparse_couplings};
use super::linear::{JointRow, Linear, Pattern};
use crate::Error;
use crate::mechanism::closure::Closure;
use crate::mechanism::description::Mechanism;
use crate::mechanism::kinematics::{Kinematics, cayley, check_coordinates, skew_part};
use crate::spatial::Pose;

/// A mechanism in a configuration, ready for sparse algebra; cost and memory grow about as its joints do.
///
/// Virtual joints stay where they are.
///
/// # Source
/// Own derivation, `docs/explanation/mechanisms.md`
#[derive(Debug, Clone)]
pub struct SparseSystem<'a> {
    pub(super) kinematics: Kinematics<'a>,
    pub(super) couplings: Vec<SparseCoupling>,
    pub(super) pattern: Pattern,
    pub(super) length: f64,
    /// Middle of the joints of each link, in its own frame (m).
    pub(super) middles: Vec<Vector3<f64>>,
    /// Pose of each link in the base frame.
    pub(super) poses: Vec<Pose>,
    pub(super) coordinates: DVector<f64>,
}

impl<'a> SparseSystem<'a> {
    /// The mechanism with links where the joints of the spanning tree put them.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) of the joints, then of the virtual joints (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`].
    pub fn new(mechanism: &'a Mechanism, coordinates: DVector<f64>) -> Result<Self, Error> {
        let kinematics = Kinematics::new(mechanism);
        check_coordinates(&coordinates, kinematics.dimensions().len())?;
        let poses = kinematics.link_poses(&coordinates)?;
        let middles = middles(mechanism);
        let length =
            mechanism.characteristic_length().unwrap_or_else(|| spread(mechanism, &middles));
        let couplings = sparse_couplings(&kinematics, length);
        let pattern = Pattern::new(&kinematics, &couplings);
        Ok(Self { kinematics, couplings, pattern, length, middles, poses, coordinates })
    }

    /// Tree, loops and poses.
    #[must_use]
    pub fn kinematics(&self) -> &Kinematics<'a> {
        &self.kinematics
    }

    /// (f + M) coordinates of joints, then virtual joints (m, rad).
    #[must_use]
    pub fn coordinates(&self) -> &DVector<f64> {
        &self.coordinates
    }

    /// Pose of each link in the base frame.
    #[must_use]
    pub fn link_poses(&self) -> &[Pose] {
        &self.poses
    }

    /// Unit of mismatches: root mean square distance of the joints of a link from their middle, or the user's (m).
    #[must_use]
    pub fn characteristic_length(&self) -> f64 {
        self.length
    }

    /// Largest mismatch of a joint or coupling, in radians and characteristic lengths.
    #[must_use]
    pub fn residual(&self) -> f64 {
        let zero = DVector::zeros(self.coordinates.len());
        let mut largest = 0.0_f64;
        for (j, joint) in self.kinematics.mechanism().joints().iter().enumerate() {
            let [first, second] = joint.links.map(|link| self.poses[link]);
            let led =
                self.kinematics.through_elements(j, first, &self.coordinates, &zero, |_, _, _| {});
            let point = (first * joint.frames[0]).translation.vector;
            let apart = led * second.inverse_transform_point(&point.into()) - point;
            let turned = (led.rotation.matrix() - second.rotation.matrix()).norm();
            let size = (turned / std::f64::consts::SQRT_2).max(apart.coords.norm() / self.length);
            if size > largest || size.is_nan() {
                largest = size;
            }
        }
        for coupling in &self.couplings {
            let size = coupling.residual(&self.coordinates).abs();
            if size > largest || size.is_nan() {
                largest = size;
            }
        }
        largest
    }

    /// The configuration, and how well its joints are closed.
    #[must_use]
    pub fn closure(&self, iterations: usize) -> Closure {
        Closure {
            coordinates: self.coordinates.clone(),
            residual: self.residual(),
            iterations,
            is_searched: false,
        }
    }

    /// The closures of all joints, and the couplings, linearized in the twists of the links; coordinates for which `held` is true do not follow.
    pub(super) fn linear(&self, held: &[bool]) -> Result<Linear, Error> {
        let mechanism = self.kinematics.mechanism();
        let centers: Vec<Vector3<f64>> = self
            .middles
            .iter()
            .zip(&self.poses)
            .map(|(middle, pose)| pose.rotation * middle + pose.translation.vector)
            .collect();
        let zero = DVector::zeros(self.coordinates.len());
        let mut screws = vec![(Vector3::zeros(), Vector3::zeros()); self.coordinates.len()];
        let rows = mechanism.joints().iter().enumerate().map(|(j, joint)| {
            let [first, second] = joint.links.map(|link| self.poses[link]);
            let point = (first * joint.frames[0]).translation.vector;
            let led = self.kinematics.through_elements(
                j,
                first,
                &self.coordinates,
                &zero,
                |element, before, after| element.screws(before, after, &zero, &point, &mut screws),
            );
            let turned = skew_part(&(led.rotation.matrix() * second.rotation.matrix().transpose()));
            let apart = led * second.inverse_transform_point(&point.into()) - point;
            let following: Vec<(usize, Vector6<f64>)> = self
                .kinematics
                .columns_of(j)
                .filter(|&k| !held[k])
                .map(|k| (k, self.scaled(&screws[k].0, &screws[k].1)))
                .collect();
            let (follows, rates, refused) = JointRow::split(&following);
            JointRow {
                links: joint.links,
                arms: joint.links.map(|link| (point - centers[link]) / self.length),
                mismatch: self.scaled(&turned, &apart.coords),
                freedoms: follows.len(),
                follows,
                rates,
                refused,
            }
        });
        let rows: Vec<JointRow> = rows.collect();
        let by_twists = |j: usize, k: usize| {
            let joint: &JointRow = &rows[j];
            joint.rates_by_twists(k)
        };
        let couplings = self.couplings.iter().map(|one| one.linear(by_twists, &self.coordinates));
        let couplings = couplings.collect();
        Linear::new(&self.pattern, mechanism.links().len(), rows, couplings, screws)
    }

    pub(super) fn scaled(&self, angular: &Vector3<f64>, linear: &Vector3<f64>) -> Vector6<f64> {
        let linear = linear / self.length;
        Vector6::new(angular.x, angular.y, angular.z, linear.x, linear.y, linear.z)
    }

    /// Displaces links by small twists about their middles, and coordinates by small steps; returns the residual.
    ///
    /// Far links of a long chain sweep arcs that a twist is too straight for; where the spanning tree puts them with the new coordinates is tried too.
    pub(super) fn displace(&mut self, x: &[f64], by: &DVector<f64>) -> f64 {
        for (link, pose) in self.poses.iter_mut().enumerate().skip(1) {
            let x = &x[6 * (link - 1)..6 * link];
            let center = pose.rotation * self.middles[link] + pose.translation.vector;
            let turn: Rotation3<f64> = cayley(&Vector3::new(x[0], x[1], x[2]));
            let shifted = center + Vector3::new(x[3], x[4], x[5]) * self.length;
            let rotation = turn * pose.rotation;
            let translation = shifted - rotation * self.middles[link];
            *pose = Pose::from_parts(Translation3::from(translation), rotation);
        }
        self.coordinates = self.kinematics.moved(&self.coordinates, by);
        let by_twists = self.residual();
        let Ok(by_tree) = self.kinematics.link_poses(&self.coordinates) else { return by_twists };
        let twisted = std::mem::replace(&mut self.poses, by_tree);
        let residual = self.residual();
        if residual < by_twists {
            return residual;
        }
        self.poses = twisted;
        by_twists
    }

    /// For each coordinate whether it keeps its value: those named and all virtual joints.
    pub(super) fn held(&self, named: impl IntoIterator<Item = usize>) -> Vec<bool> {
        let freedoms = self.kinematics.mechanism().joint_freedoms();
        let mut held: Vec<bool> = (0..self.coordinates.len()).map(|k| k >= freedoms).collect();
        named.into_iter().for_each(|k| held[k] = true);
        held
    }
}

/// Middle of the joints of each link, in its own frame.
fn middles(mechanism: &Mechanism) -> Vec<Vector3<f64>> {
    let mut sums = vec![(Vector3::zeros(), 0.0); mechanism.links().len()];
    for joint in mechanism.joints() {
        for side in 0..2 {
            let (sum, count) = &mut sums[joint.links[side]];
            *sum += joint.frames[side].translation.vector;
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { sum }).collect()
}

/// Root mean square distance of joints from the middle of their link; 1 m where all are in one point.
fn spread(mechanism: &Mechanism, middles: &[Vector3<f64>]) -> f64 {
    let (mut sum, mut count, mut largest) = (0.0, 0.0, 0.0_f64);
    for joint in mechanism.joints() {
        for side in 0..2 {
            let point = joint.frames[side].translation.vector;
            sum += (point - middles[joint.links[side]]).norm_squared();
            count += 1.0;
            largest = largest.max(point.amax());
        }
    }
    let spread = f64::sqrt(sum / count);
    if spread > 1e-12 * largest { spread } else { 1.0 }
}
