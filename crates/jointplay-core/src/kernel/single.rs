//! One pose at a time.

use nalgebra::{Matrix3, Rotation3, Translation3};
use pulp::{Scalar, Simd};

use super::found::Found;
use super::geometry::{Geometry, Task};
use super::joint_polynomials::JointPolynomials;
use super::lanes::Lanes;
use super::model::Model;
use super::pose::{InPlane, PlatformPoses};
use super::shape::Balls;
use super::solve::{placed, solved};
use crate::spatial::Pose;
use crate::virtualization::{Sides, VirtualJoints};

/// One over the cosine of the largest tilt that is computed here.
const STEEPEST: f64 = 2.0;

/// Virtual joints by the closed equations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SingleJoints {
    pub(crate) virtual_joints: VirtualJoints,
    pub(crate) iterations: usize,
    /// Largest difference between a side and its virtual length (m).
    pub(crate) residual: f64,
}

/// A pose by the closed equations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SinglePose {
    pub(crate) joints: SingleJoints,
    pub(crate) sides: Sides,
    pub(crate) base_from_platform: Pose,
}

/// Virtual joints of one pose and what they were found from, in scalar registers.
pub(crate) struct Single {
    balls: Balls<Scalar>,
    found: Found<Scalar>,
    /// Where it was found together with them.
    in_plane: Option<InPlane<Scalar>>,
}

impl Single {
    /// By the solver of the task for given rods; `None` where the answer is not beyond doubt.
    ///
    /// The same operations as for many poses: for a caller that [`Processor::run`](super::processor::Processor::run) has given the instructions of the processor.
    #[inline(always)]
    pub(crate) fn new<M: Model>(task: &Task<'_>, rods: &[f64; 3]) -> Option<Self> {
        if task.max_iterations == 0 {
            return None;
        }
        let balls = balls(task.geometry, rods);
        let found = solved::<Scalar, M>(task, &balls);
        Self::certain(task.geometry, balls, found, None)
    }

    /// By polynomials, for the pose too if `POSE`; `None` where the answer is not beyond doubt.
    #[inline(always)]
    pub(crate) fn by_polynomials<W: Simd, M: Model, const POSE: bool>(
        wide: W,
        task: &Task<'_>,
        polynomials: &JointPolynomials,
        rods: &[f64; 3],
    ) -> Option<Self> {
        let balls = balls(task.geometry, rods);
        let (found, in_plane) = polynomials.found_one::<W, M, POSE>(wide, task, &balls);
        Self::certain(task.geometry, balls, found, in_plane)
    }

    #[inline(always)]
    fn certain(
        geometry: &Geometry,
        balls: Balls<Scalar>,
        found: Found<Scalar>,
        in_plane: Option<InPlane<Scalar>>,
    ) -> Option<Self> {
        // Steeper triangles are slender: round-off in their sides is large in their corners.
        let area = balls.plane.area;
        let flat = area.at_most(area.like(STEEPEST * geometry.base_area.abs()));
        (found.met & flat).any().then_some(Self { balls, found, in_plane })
    }

    /// The pose of the platform, with the virtual joints.
    #[inline(always)]
    pub(crate) fn pose<M: Model>(&self, geometry: &Geometry) -> SinglePose {
        let Self { balls, found, in_plane } = self;
        let placed = match *in_plane {
            Some(in_plane) => PlatformPoses::at(geometry, balls, in_plane),
            None => placed::<Scalar, M>(geometry, balls, found),
        };
        let axes = placed.axes().map(|axis| axis.map(Lanes::number));
        let rotation = Matrix3::from_columns(&axes.map(Into::into));
        SinglePose {
            joints: self.joints::<M>(geometry),
            sides: balls.squares.map(|square| square.sqrt().number()),
            base_from_platform: Pose::from_parts(
                Translation3::from(placed.origin.map(Lanes::number)),
                Rotation3::from_matrix_unchecked(rotation),
            ),
        }
    }

    /// The virtual joints.
    #[inline(always)]
    pub(crate) fn joints<M: Model>(&self, geometry: &Geometry) -> SingleJoints {
        let mut virtual_joints = VirtualJoints::zeros(if M::ACROSS { 6 } else { 3 });
        for k in 0..3 {
            virtual_joints[k] = self.found.a[k].number();
            if M::ACROSS {
                virtual_joints[3 + k] = self.found.b[k].number();
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small whole number"
        )]
        let iterations = self.found.iterations.number() as usize;
        let residual = self.found.residual(geometry, &self.balls).number();
        SingleJoints { virtual_joints, iterations, residual }
    }
}

/// The balls of one pose.
#[inline(always)]
fn balls(geometry: &Geometry, rods: &[f64; 3]) -> Balls<Scalar> {
    let [a, b, c] = *rods;
    let rods = [Lanes::splat(Scalar, a), Lanes::splat(Scalar, b), Lanes::splat(Scalar, c)];
    Balls::new(geometry, rods)
}
