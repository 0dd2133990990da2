//! An arm as a sum of planar vectors, each rotating by a linear function of the axes.

use jointplay_core::bulk::sin_cos;
use jointplay_core::spatial::Pose;
use nalgebra::{Translation3, Vector2};

use super::hybrid_robot::{AxisKind, EffectorId, HybridRobot, MAX_JOINTS};
use super::rotation_about_z::rotation_by;

/// One number for each axis of an arm, in the order of [`ArmChain::axes`].
pub(super) type ArmVector = [f64; MAX_JOINTS];

/// A link vector, fixed in a frame that rotates by Σ coefficients · positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LinkVector {
    /// The vector where all axes are at zero, in the platform frame (m).
    pub(super) vector: Vector2<f64>,
    /// Rotation per position of each axis (1, or rad/m).
    pub(super) turn: ArmVector,
}

/// A prismatic joint: a vector of unit length, scaled by Σ coefficients · positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PrismaticJoint {
    /// Direction of the joint, and its rotation.
    pub(super) along: LinkVector,
    /// Length per position of each axis (1, or m/rad).
    pub(super) extension: ArmVector,
}

/// An arm from the platform to one of its wafers, in the arm's plane.
///
/// ```text
///    tip  =  origin  +  Σ_g R(ψ_g) v_g  +  Σ_s (σ_s · a) R(ψ_s) e_s        ψ = m · a
/// ```
/// a: positions of the arm's axes, m and σ: coefficients. Constants of joints are part of the vectors, and vectors that rotate alike are added to one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ArmChain {
    /// The effector that the chain leads to.
    pub(crate) effector: EffectorId,
    /// Indices of the axes that move the arm, of which the first `count` are used.
    axes: [usize; MAX_JOINTS],
    count: usize,
    /// Constant part of the tip (m).
    pub(super) origin: Vector2<f64>,
    /// Height of the wafer's plane over the platform plane (m).
    pub(super) height: f64,
    link_vectors: [LinkVector; MAX_JOINTS],
    link_count: usize,
    prismatic_joints: [PrismaticJoint; MAX_JOINTS],
    prismatic_count: usize,
    /// Heading of the wafer where all axes are at zero (rad), and its rotation per position of each axis.
    pub(super) heading: (f64, ArmVector),
}

#[inline]
pub(super) fn dot(slopes: &ArmVector, positions: &ArmVector) -> f64 {
    slopes[0] * positions[0]
        + slopes[1] * positions[1]
        + slopes[2] * positions[2]
        + slopes[3] * positions[3]
}

/// A vector rotated by an angle (rad).
#[inline]
pub(super) fn turned(vector: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    turned_by(vector, angle.sin_cos())
}

/// A vector rotated by an angle with this sine and cosine.
#[inline]
fn turned_by(vector: &Vector2<f64>, (sin, cos): (f64, f64)) -> Vector2<f64> {
    Vector2::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}

/// Largest number of angles by which vectors of an arm and its wafer rotate.
const MAX_ANGLES: usize = 2 * MAX_JOINTS + 1;

/// Vectors of an arm in one position, and sine and cosine of its heading.
pub(super) struct RotatedVectors {
    vectors: [Vector2<f64>; 2 * MAX_JOINTS],
    links: usize,
    count: usize,
    heading: (f64, f64),
}

impl RotatedVectors {
    /// Each of [`ArmChain::link_vectors`].
    #[inline]
    pub(super) fn links(&self) -> &[Vector2<f64>] {
        &self.vectors[..self.links]
    }

    /// Direction of each of [`ArmChain::prismatic_joints`].
    #[inline]
    pub(super) fn prismatic_joints(&self) -> &[Vector2<f64>] {
        &self.vectors[self.links..self.count]
    }
}

/// A vector rotated by a quarter revolution.
#[inline]
pub(super) fn perpendicular(vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}

impl ArmChain {
    /// The chain to an effector that exists, on an arm of at most [`MAX_JOINTS`] joints and axes.
    pub(crate) fn new(robot: &HybridRobot, id: EffectorId) -> Self {
        let arm = &robot.arms[id.arm];
        let effector = &arm.effectors[id.effector];
        let still = LinkVector { vector: Vector2::zeros(), turn: [0.0; MAX_JOINTS] };
        let mut chain = Self {
            effector: id,
            axes: [0; MAX_JOINTS],
            count: 0,
            origin: Vector2::new(arm.mount[0], arm.mount[1]),
            height: arm.mount[2] + effector.wafer_center[2],
            link_vectors: [still; MAX_JOINTS],
            link_count: 0,
            prismatic_joints: [PrismaticJoint { along: still, extension: still.turn }; MAX_JOINTS],
            prismatic_count: 0,
            heading: (0.0, still.turn),
        };
        let (mut constant, mut turn) = (0.0, [0.0; MAX_JOINTS]);
        for (k, joint) in arm.joints.iter().enumerate() {
            chain.height += joint.rise;
            let mut slopes = [0.0; MAX_JOINTS];
            for &(axis, ratio) in &joint.drives {
                slopes[chain.index_of(axis)] += ratio;
            }
            match joint.kind {
                AxisKind::Rotary => {
                    constant += joint.zero;
                    for (sum, slope) in turn.iter_mut().zip(slopes) {
                        *sum += slope;
                    }
                }
                AxisKind::Linear => {
                    let along = turned(&Vector2::x(), constant);
                    chain.add_prismatic_joint(PrismaticJoint {
                        along: LinkVector { vector: along, turn },
                        extension: slopes,
                    });
                    chain.add_link_vector(LinkVector { vector: along * joint.zero, turn });
                }
            }
            let link = if k + 1 == arm.joints.len() {
                Vector2::new(effector.wafer_center[0], effector.wafer_center[1])
            } else {
                Vector2::new(joint.length, joint.offset)
            };
            chain.add_link_vector(LinkVector { vector: turned(&link, constant), turn });
        }
        chain.heading = (constant + effector.heading, turn);
        chain
    }

    fn index_of(&mut self, axis: usize) -> usize {
        self.axes().iter().position(|&known| known == axis).unwrap_or_else(|| {
            self.axes[self.count] = axis;
            self.count += 1;
            self.count - 1
        })
    }

    fn add_link_vector(&mut self, link_vector: LinkVector) {
        if link_vector.turn == [0.0; MAX_JOINTS] {
            self.origin += link_vector.vector;
            return;
        }
        let known = self.link_vectors[..self.link_count].iter_mut();
        match known.into_iter().find(|known| known.turn == link_vector.turn) {
            Some(known) => known.vector += link_vector.vector,
            None => {
                self.link_vectors[self.link_count] = link_vector;
                self.link_count += 1;
            }
        }
    }

    fn add_prismatic_joint(&mut self, joint: PrismaticJoint) {
        self.prismatic_joints[self.prismatic_count] = joint;
        self.prismatic_count += 1;
    }

    /// Height of the wafer's plane over the platform plane (m).
    pub(crate) fn height(&self) -> f64 {
        self.height
    }

    /// Indices of the axes that move the arm.
    #[inline]
    pub(crate) fn axes(&self) -> &[usize] {
        &self.axes[..self.count]
    }

    #[inline]
    pub(super) fn link_vectors(&self) -> &[LinkVector] {
        &self.link_vectors[..self.link_count]
    }

    #[inline]
    pub(super) fn prismatic_joints(&self) -> &[PrismaticJoint] {
        &self.prismatic_joints[..self.prismatic_count]
    }

    /// Positions of the arm's own axes, from those of all axes.
    #[inline]
    pub(super) fn arm_positions(&self, positions: &[f64]) -> ArmVector {
        let mut arm_positions = [0.0; MAX_JOINTS];
        for (arm_positions, &axis) in arm_positions.iter_mut().zip(self.axes()) {
            *arm_positions = positions[axis];
        }
        arm_positions
    }

    /// All vectors of the arm in a position.
    ///
    /// # Numerics
    /// All sines and cosines are computed at once.
    pub(super) fn rotated_vectors(&self, arm_positions: &ArmVector) -> RotatedVectors {
        let links = self.link_vectors().iter();
        let vectors = links.chain(self.prismatic_joints().iter().map(|joint| &joint.along));
        let (links, count) = (self.link_count, self.link_count + self.prismatic_count);
        let mut angles = [0.0; MAX_ANGLES];
        let mut rotated = [Vector2::zeros(); 2 * MAX_JOINTS];
        for ((angle, rotated), vector) in angles.iter_mut().zip(&mut rotated).zip(vectors) {
            *angle = dot(&vector.turn, arm_positions);
            *rotated = vector.vector;
        }
        angles[count] = self.heading(arm_positions);
        let (mut sines, mut cosines) = ([0.0; MAX_ANGLES], [0.0; MAX_ANGLES]);
        let used = ..=count;
        sin_cos(&angles[used], &mut sines[used], &mut cosines[used])
            .expect("the columns have one length");
        for (k, vector) in rotated[..count].iter_mut().enumerate() {
            *vector = turned_by(vector, (sines[k], cosines[k]));
        }
        RotatedVectors { vectors: rotated, links, count, heading: (sines[count], cosines[count]) }
    }

    /// Centre of the wafer, in the platform plane (m).
    #[inline]
    pub(super) fn tip(&self, arm_positions: &ArmVector) -> Vector2<f64> {
        self.tip_of(&self.rotated_vectors(arm_positions), arm_positions)
    }

    /// As [`Self::tip`], the vectors of the arm known.
    #[inline]
    fn tip_of(&self, rotated: &RotatedVectors, arm_positions: &ArmVector) -> Vector2<f64> {
        let tip = rotated.links().iter().fold(self.origin, |tip, vector| tip + vector);
        let joints = self.prismatic_joints().iter().zip(rotated.prismatic_joints());
        joints.fold(tip, |tip, (joint, along)| tip + along * dot(&joint.extension, arm_positions))
    }

    /// Pose `platform_from_wafer` for positions of all axes.
    pub(crate) fn wafer(&self, positions: &[f64]) -> Pose {
        let arm_positions = self.arm_positions(positions);
        let rotated = self.rotated_vectors(&arm_positions);
        self.wafer_pose(&self.tip_of(&rotated, &arm_positions), &rotated)
    }

    /// Pose `platform_from_wafer`, the position of the tip known.
    #[inline]
    pub(super) fn wafer_pose(&self, tip: &Vector2<f64>, rotated: &RotatedVectors) -> Pose {
        let center = tip.push(self.height);
        let (sin, cos) = rotated.heading;
        Pose::from_parts(Translation3::from(center), rotation_by(sin, cos))
    }

    /// Heading of the wafer, from the platform's x axis (rad).
    #[inline]
    pub(super) fn heading(&self, arm_positions: &ArmVector) -> f64 {
        self.heading.0 + dot(&self.heading.1, arm_positions)
    }

    /// Velocity of the tip per velocity of each of the arm's axes (m/m or m/rad).
    pub(super) fn tip_velocities(&self, arm_positions: &ArmVector) -> [Vector2<f64>; MAX_JOINTS] {
        let mut velocities = [Vector2::zeros(); MAX_JOINTS];
        let rotated = self.rotated_vectors(arm_positions);
        for (link_vector, rotated) in self.link_vectors().iter().zip(rotated.links()) {
            let turning = perpendicular(rotated);
            for (velocity, slope) in velocities.iter_mut().zip(link_vector.turn) {
                *velocity += turning * slope;
            }
        }
        for (joint, along) in self.prismatic_joints().iter().zip(rotated.prismatic_joints()) {
            let turning = perpendicular(along) * dot(&joint.extension, arm_positions);
            for (a, velocity) in velocities.iter_mut().enumerate() {
                *velocity += along * joint.extension[a] + turning * joint.along.turn[a];
            }
        }
        velocities
    }
}
