//! A mechanism in a configuration, for sparse algebra.

use std::sync::Arc;

use nalgebra::{DVector, Rotation3, Translation3, Vector3, Vector6};

use super::coupling::{SparseCoupling, sparse_couplings};
use super::linear::{JointRows, Linear, Pattern};
use crate::Error;
use crate::mechanism::ball::cayley;
use crate::mechanism::closure::Closure;
use crate::mechanism::description::Mechanism;
use crate::mechanism::joint::Twist;
use crate::mechanism::kinematics::{Kinematics, check_coordinates, skew_part};
use crate::mechanism::tree::{Branch, link_poses, short_loop_tree};
use crate::spatial::Pose;

/// How far joints and couplings are from closed, in radians and characteristic lengths.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    /// Largest mismatch.
    pub(super) largest: f64,
    /// Norm of all mismatches.
    pub(super) norm: f64,
}

impl Gap {
    fn include(&mut self, size: f64) {
        if size > self.largest || size.is_nan() {
            self.largest = size;
        }
    }
}

/// A mechanism in a configuration, ready for sparse algebra; cost and memory grow about as its joints do.
///
/// Virtual joints stay where they are.
///
/// # Source
/// Own derivation, `docs/explanation/mechanisms.md`
#[derive(Debug, Clone)]
pub struct SparseSystem<'a> {
    // Shared by all configurations, of which an iteration tries many.
    pub(super) kinematics: Arc<Kinematics<'a>>,
    couplings: Arc<[SparseCoupling]>,
    pattern: Arc<Pattern>,
    /// Joints over which links are placed, with short loops.
    tree: Arc<[Branch]>,
    /// Middle of the joints of each link, in its own frame (m).
    middles: Arc<[Vector3<f64>]>,
    pub(super) length: f64,
    /// Pose of each link in the base frame.
    pub(super) poses: Vec<Pose>,
    pub(super) coordinates: DVector<f64>,
    /// Displacement of each joint from its first link to its second, at the coordinates.
    displacements: Vec<Pose>,
    /// Twist of each coordinate in the frame of its joint's first link, the linear part at the point of the joint (m).
    screws: Vec<Twist>,
}

impl<'a> SparseSystem<'a> {
    /// The mechanism with links where the joints of the spanning tree put them.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) of the joints, then of the virtual joints (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`]; [`Error::TooConnected`] beyond a million blocks of the matrices.
    pub fn new(mechanism: &'a Mechanism, coordinates: DVector<f64>) -> Result<Self, Error> {
        let kinematics = Kinematics::new(mechanism);
        check_coordinates(&coordinates, kinematics.dimensions().len())?;
        let middles = mechanism.joint_middles();
        let spread = || mechanism.joint_spread(&middles);
        let length = mechanism.characteristic_length().unwrap_or_else(spread);
        let couplings = sparse_couplings(&kinematics, length);
        let pattern = Arc::new(Pattern::new(&kinematics, &couplings)?);
        let (displacements, screws) = joints_at(&kinematics, &coordinates);
        let tree = short_loop_tree(mechanism, kinematics.closing_joints());
        let poses = tree_poses(mechanism, &tree, &displacements);
        let (kinematics, middles) = (Arc::new(kinematics), middles.into());
        Ok(Self {
            kinematics,
            couplings: couplings.into(),
            pattern,
            tree: tree.into(),
            middles,
            length,
            poses,
            coordinates,
            displacements,
            screws,
        })
    }

    /// From here on, balls with held coordinates change by their rotation vectors, so that these coordinates keep their values.
    pub(super) fn hold(&mut self, held: &[bool]) {
        if self.kinematics.balls().next().is_some() {
            Arc::make_mut(&mut self.kinematics).command(|k| !held[k]);
            (self.displacements, self.screws) = joints_at(&self.kinematics, &self.coordinates);
        }
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
        self.gap().largest
    }

    /// How far joints and couplings are from closed.
    pub(super) fn gap(&self) -> Gap {
        self.gap_of(&self.poses)
    }

    /// How far joints and couplings are from closed for other poses of the links.
    fn gap_of(&self, poses: &[Pose]) -> Gap {
        let mut gap = Gap { largest: 0.0, norm: 0.0 };
        let mut squares = 0.0;
        let joints = self.kinematics.mechanism().joints();
        for (joint, displacement) in joints.iter().zip(&self.displacements) {
            let [first, second] = joint.links.map(|link| &poses[link]);
            let (led, _, apart) = joined(first, second, displacement, &joint.frames[0]);
            let turned = (led.rotation.matrix() - second.rotation.matrix()).norm();
            let (turned, apart) = (turned / std::f64::consts::SQRT_2, apart.norm() / self.length);
            gap.include(turned.max(apart));
            squares += turned * turned + apart * apart;
        }
        for coupling in self.couplings.iter() {
            let size = coupling.residual(&self.coordinates).abs();
            gap.include(size);
            squares += size * size;
        }
        gap.norm = f64::sqrt(squares);
        gap
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
    ///
    /// # Arguments
    /// * `resistance` – of the joints, from 0, for joints that move freely, to 1
    /// * `former` – closures of another configuration that are not needed any more; their memory is used again
    pub(super) fn linear(
        &self,
        held: &[bool],
        resistance: f64,
        former: Option<Linear>,
    ) -> Result<Linear, Error> {
        let mechanism = self.kinematics.mechanism();
        let centers: Vec<Vector3<f64>> = self
            .middles
            .iter()
            .zip(&self.poses)
            .map(|(middle, pose)| pose.rotation * middle + pose.translation.vector)
            .collect();
        let mut rows = JointRows::new(&self.pattern, resistance, &self.screws, former);
        for (j, joint) in mechanism.joints().iter().enumerate() {
            let first = &self.poses[joint.links[0]];
            let point =
                first.rotation * joint.frames[0].translation.vector + first.translation.vector;
            for k in self.kinematics.columns_of(j) {
                let (angular, linear) = &mut rows.screws[k];
                (*angular, *linear) = (first.rotation * *angular, first.rotation * *linear);
            }
            let arms = joint.links.map(|link| (point - centers[link]) / self.length);
            let follows = self.kinematics.columns_of(j).filter(|&k| !held[k]);
            rows.push(joint.links, arms, follows, |twist| self.scaled(&twist.0, &twist.1));
        }
        let couplings = self.couplings.iter();
        let couplings = couplings.map(|one| one.linear(|j, k| rows.rates_by_twists(j, k)));
        let couplings = couplings.collect();
        Linear::new(&self.pattern, rows, couplings)
    }

    /// (6·joints) what the first link and the joint make of the second link's pose, against where it is; lengths over the length of the system.
    pub(super) fn mismatches(&self) -> DVector<f64> {
        let joints = self.kinematics.mechanism().joints();
        let mut mismatches = DVector::zeros(6 * joints.len());
        for (j, (joint, displacement)) in joints.iter().zip(&self.displacements).enumerate() {
            let [first, second] = joint.links.map(|link| &self.poses[link]);
            let (led, _, apart) = joined(first, second, displacement, &joint.frames[0]);
            let turned = skew_part(&(led.rotation.matrix() * second.rotation.matrix().transpose()));
            mismatches.fixed_rows_mut::<6>(6 * j).copy_from(&self.scaled(&turned, &apart));
        }
        mismatches
    }

    /// Violation of each coupling, in radians and characteristic lengths.
    pub(super) fn violations(&self) -> DVector<f64> {
        let found = self.couplings.iter().map(|one| one.residual(&self.coordinates));
        DVector::from_iterator(self.couplings.len(), found)
    }

    pub(super) fn scaled(&self, angular: &Vector3<f64>, linear: &Vector3<f64>) -> Vector6<f64> {
        let linear = linear / self.length;
        Vector6::new(angular.x, angular.y, angular.z, linear.x, linear.y, linear.z)
    }

    /// The system with links displaced by small twists about their middles, and coordinates by small steps; and how far joints are from closed then.
    ///
    /// Far links of a long chain sweep arcs that a twist is too straight for; where the joints of a spanning tree with short loops put them with the new coordinates is tried too.
    pub(super) fn displaced(&self, x: &[f64], by: &DVector<f64>) -> (Self, Gap) {
        let mut poses = Vec::with_capacity(self.poses.len());
        poses.push(self.poses[0]);
        let (twists, _) = x.as_chunks::<6>();
        let links = self.poses.iter().zip(self.middles.iter()).skip(1);
        poses.extend(links.zip(twists).map(|((pose, middle), x)| {
            let center = pose.rotation * middle + pose.translation.vector;
            let turn: Rotation3<f64> = cayley(&Vector3::new(x[0], x[1], x[2]));
            let shifted = center + Vector3::new(x[3], x[4], x[5]) * self.length;
            let rotation = turn * pose.rotation;
            let translation = shifted - rotation * middle;
            Pose::from_parts(Translation3::from(translation), rotation)
        }));
        let coordinates = self.kinematics.moved(&self.coordinates, by);
        let (displacements, screws) = joints_at(&self.kinematics, &coordinates);
        let mut there = Self {
            kinematics: Arc::clone(&self.kinematics),
            couplings: Arc::clone(&self.couplings),
            pattern: Arc::clone(&self.pattern),
            tree: Arc::clone(&self.tree),
            middles: Arc::clone(&self.middles),
            length: self.length,
            poses,
            coordinates,
            displacements,
            screws,
        };
        let by_twists = there.gap();
        let mechanism = self.kinematics.mechanism();
        let by_tree = tree_poses(mechanism, &self.tree, &there.displacements);
        let gap = there.gap_of(&by_tree);
        if gap.norm < by_twists.norm {
            there.poses = by_tree;
            return (there, gap);
        }
        (there, by_twists)
    }

    /// For each coordinate whether it keeps its value: those named and all virtual joints.
    pub(super) fn held(&self, named: impl IntoIterator<Item = usize>) -> Vec<bool> {
        let freedoms = self.kinematics.mechanism().joint_freedoms();
        let mut held: Vec<bool> = (0..self.coordinates.len()).map(|k| k >= freedoms).collect();
        named.into_iter().for_each(|k| held[k] = true);
        held
    }
}

/// Pose of a joint's second link after a displacement of the joint, the point of the joint, and the distance of the second link from that pose at the point; all in the base frame.
#[inline]
fn joined(
    first: &Pose,
    second: &Pose,
    displacement: &Pose,
    frame: &Pose,
) -> (Pose, Vector3<f64>, Vector3<f64>) {
    let led = first * displacement;
    let point = first.rotation * frame.translation.vector + first.translation.vector;
    let on_second = second.rotation.inverse() * (point - second.translation.vector);
    let apart = led.rotation * on_second + led.translation.vector - point;
    (led, point, apart)
}

/// Displacement of each joint from its first link to its second; twist of each coordinate in the frame of the first link, the linear part at the point of the joint (m).
fn joints_at(kinematics: &Kinematics<'_>, coordinates: &DVector<f64>) -> (Vec<Pose>, Vec<Twist>) {
    let zero = DVector::zeros(coordinates.len());
    let mut screws = vec![(Vector3::zeros(), Vector3::zeros()); coordinates.len()];
    let joints = kinematics.mechanism().joints().iter().enumerate();
    let displacements = joints.map(|(j, joint)| {
        let (first, point) = (Pose::identity(), joint.frames[0].translation.vector);
        kinematics.through_elements(j, first, coordinates, &zero, |element, before, after| {
            element.screws(before, after, [coordinates, &zero], &point, &mut screws);
        })
    });
    (displacements.collect(), screws)
}

/// Poses of the links where the joints of a spanning tree put them.
fn tree_poses(mechanism: &Mechanism, tree: &[Branch], displacements: &[Pose]) -> Vec<Pose> {
    let joints = mechanism.joints();
    let branches = tree.iter().map(|&(j, against)| (joints[j].links, against, displacements[j]));
    link_poses(mechanism.links().len(), branches)
}
