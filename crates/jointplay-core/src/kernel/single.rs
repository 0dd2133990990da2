//! One pose at a time.

use nalgebra::{Matrix3, Rotation3, Translation3};
use pulp::Scalar;

use super::geometry::Task;
use super::lanes::Lanes;
use super::model::Model;
use super::pose::{Plane, PlatformPoses};
use super::shape::Balls;
use super::solve::solved;
use crate::spatial::Pose;
use crate::virtualization::VirtualJoints;

/// One over the cosine of the largest tilt that is computed here.
const STEEPEST: f64 = 2.0;

/// A pose by the closed equations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SinglePose {
    pub(crate) virtual_joints: VirtualJoints,
    pub(crate) iterations: usize,
    /// Largest difference between a side and its virtual length (m).
    pub(crate) residual: f64,
    pub(crate) base_from_platform: Pose,
}

impl SinglePose {
    /// The pose for given rods; `None` where the answer is not beyond doubt.
    ///
    /// The same operations as for many poses, in scalar registers: for a caller that [`Processor::run`] has given the instructions of the processor.
    #[inline(always)]
    pub(crate) fn new<M: Model>(task: &Task<'_>, rods: &[f64; 3]) -> Option<Self> {
        if task.max_iterations == 0 {
            return None;
        }
        let geometry = task.geometry;
        let balls = Balls::new(geometry, rods.map(|rod| Lanes::splat(Scalar, rod)));
        let found = solved::<Scalar, M>(task, &balls);
        let upright = balls.mean.like(0.0).below(found.shape.area() * geometry.base_area);
        // Steeper triangles are slender: round-off in their sides is large in their corners.
        let plane = Plane::new(geometry, &balls);
        let flat = plane.area.at_most(plane.area.like(STEEPEST * geometry.base_area.abs()));
        if !(found.met & upright & flat).any() {
            return None;
        }
        let mut virtual_joints = VirtualJoints::zeros(if M::ACROSS { 6 } else { 3 });
        for k in 0..3 {
            virtual_joints[k] = found.shape.a[k].number();
            if M::ACROSS {
                virtual_joints[3 + k] = found.shape.b[k].number();
            }
        }
        let placed = PlatformPoses::new(geometry, &balls, &plane, &found.shape);
        let axes = placed.axes().map(|axis| axis.map(Lanes::number));
        let rotation = Matrix3::from_columns(&axes.map(Into::into));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small whole number"
        )]
        let iterations = found.iterations.number() as usize;
        Some(Self {
            virtual_joints,
            iterations,
            residual: found.residual(&balls).number(),
            base_from_platform: Pose::from_parts(
                Translation3::from(placed.origin.map(Lanes::number)),
                Rotation3::from_matrix_unchecked(rotation),
            ),
        })
    }
}
