//! Targets and solutions of the inverse kinematics.

use std::fmt;

use jointplay_core::spatial::{Pose, tilt_rotation};
use nalgebra::Vector3;

use crate::robot::positions::Positions;

/// Target of a wafer, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaferTarget {
    /// Centre of the wafer, in the plane that it rests on (m).
    pub center: Vector3<f64>,
    /// Upward normal of that plane, of any length.
    pub normal: Vector3<f64>,
    /// Heading of the wafer about the normal; at 0 its x axis is the base x axis after the shortest rotation from +z to the normal (rad). `None` leaves it to the arm.
    pub heading: Option<f64>,
}

impl WaferTarget {
    /// The target that a wafer frame fulfils.
    #[must_use]
    pub fn from_pose(base_from_wafer: &Pose) -> Self {
        let normal = base_from_wafer.rotation * Vector3::z();
        let level = tilt_rotation(&normal).inverse() * (base_from_wafer.rotation * Vector3::x());
        let heading = Some(level.y.atan2(level.x));
        Self { center: base_from_wafer.translation.vector, normal, heading }
    }
}

/// Positions chosen where an arm has more motors than the target needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Redundancy {
    /// Those farthest from the limits of the axes and from the stretched arm, a local minimum near the present positions.
    AwayFromLimits,
    /// Those in which the redundant links keep the directions of the present positions; the pair of joints that places the wafer's centre follows.
    KeepRedundantAngles,
    /// Those nearest to the present positions, in units of the ranges of the axes; where they violate limits, those farthest from limits.
    NearestToPresent,
}

/// All solutions of the inverse kinematics for a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Inverse {
    /// All branches that bring the wafer to the target, including those that violate limits.
    pub branches: Vec<Branch>,
    /// Index of the branch to take; `None` where each violates a limit, or there is none.
    pub chosen: Option<usize>,
    /// Reason why there is no branch.
    pub out_of_reach: Option<OutOfReach>,
    /// Limits of rods and tilt that the target plane violates, whatever the arm does.
    pub plane_violations: Vec<LimitViolation>,
}

/// One solution of the inverse kinematics for a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Positions of all axes; axes that do not move the effector keep their positions.
    pub positions: Positions,
    /// Elbow and reach direction of the arm.
    pub configuration: Configuration,
    /// Limits that the branch violates, rods and tilt included; empty without allocation.
    pub violations: Vec<LimitViolation>,
    /// Whether the branch is taken, and why not.
    pub selection: BranchSelection,
    /// Duration of the slowest axis to the branch at its velocity limit without a wafer (s).
    pub travel_time: f64,
    /// Distance of the wafer's centre from the target (m).
    pub residual: f64,
    /// Angle between the wafer's plane and that of the target (rad).
    pub normal_residual: f64,
    /// Number of Newton steps of the whole chain; 0 where the closed form was exact.
    pub corrections: usize,
    /// Heading of the wafer, as in [`WaferTarget::heading`] (rad).
    pub heading: f64,
    /// Difference of the heading from the one asked for, where the arm cannot choose it (rad).
    pub heading_difference: f64,
}

/// Reason why a branch is taken or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchSelection {
    /// The branch to take.
    Chosen,
    /// The branch violates limits, see [`Branch::violations`].
    BreaksLimits,
    /// Another branch keeps the present configuration; this one would take the arm through its stretched or folded position.
    OtherConfiguration,
    /// Another branch of the same configuration is nearer.
    NotNearest,
}

/// A limit that positions violate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitViolation {
    /// An axis is outside its range.
    Axis {
        /// Index of the axis.
        axis: usize,
        /// Position of the axis (m or rad).
        position: f64,
        /// Least position of the axis (m or rad).
        min: f64,
        /// Largest position of the axis (m or rad).
        max: f64,
    },
    /// The platform tilts too far.
    Tilt {
        /// Tilt of the platform (rad).
        angle: f64,
        /// Largest tilt of the platform (rad).
        max: f64,
    },
}

/// Side of the line from first to last joint on which a two-link arm has its elbow, seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Elbow {
    /// Left of the line.
    Left,
    /// Right of the line.
    Right,
}

/// Side of the first joint on which a radial arm holds the wafer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ReachDirection {
    /// In front of the joint, where the arm points.
    Forward,
    /// Behind the joint.
    Backward,
}

/// Configuration of an arm; without meaning where the arm has no choice, or is stretched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Configuration {
    /// Side of the elbow.
    pub elbow: Option<Elbow>,
    /// Direction in which a radial arm reaches.
    pub reaching: Option<ReachDirection>,
}

impl Configuration {
    /// Whether an arm can move from one configuration to the other without passing its stretched or folded position.
    #[must_use]
    pub fn agrees_with(self, other: Self) -> bool {
        fn alike<T: PartialEq>(one: Option<T>, other: Option<T>) -> bool {
            one.is_none() || other.is_none() || one == other
        }
        alike(self.elbow, other.elbow) && alike(self.reaching, other.reaching)
    }
}

impl fmt::Display for Configuration {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let elbow = self.elbow.map(|side| match side {
            Elbow::Left => "elbow left",
            Elbow::Right => "elbow right",
        });
        let reaching = self.reaching.map(|side| match side {
            ReachDirection::Forward => "reaching forward",
            ReachDirection::Backward => "reaching backward",
        });
        formatter.pad(&match (elbow, reaching) {
            (Some(elbow), Some(reaching)) => format!("{elbow}, {reaching}"),
            (Some(one), None) | (None, Some(one)) => one.to_owned(),
            (None, None) => "no elbow".to_owned(),
        })
    }
}

/// Reason why no positions reach a target, whatever the limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfReach {
    /// Distance that the links have to span, from the joint that they rotate about (m).
    pub distance: f64,
    /// Least distance that the links span (m).
    pub min: f64,
    /// Largest distance that the links span (m).
    pub max: f64,
}

impl OutOfReach {
    /// Distance of the target from the nearest point that the links reach (m).
    #[must_use]
    pub fn missing(&self) -> f64 {
        (self.min - self.distance).max(self.distance - self.max).max(0.0)
    }
}

impl Inverse {
    /// The branch to take.
    #[must_use]
    pub fn chosen(&self) -> Option<&Branch> {
        self.branches.get(self.chosen?)
    }
}

impl fmt::Display for LimitViolation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axis { axis, position, min, max } => {
                write!(formatter, "axis {axis} at {position}, limits {min} to {max} (m or rad)")
            }
            Self::Tilt { angle, max } => {
                write!(formatter, "tilt {angle} rad, limit {max} rad")
            }
        }
    }
}
