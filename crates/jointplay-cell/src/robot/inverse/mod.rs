//! From a wafer's plane, centre and heading to all positions that reach it.

mod barrier;
mod branches;
mod closed;
mod newton;
mod plan;
mod polish;
mod redundant;
mod revolutions;

use std::fmt;

use jointplay_core::spatial::{Pose, tilt_rotation};
use nalgebra::Vector3;

use super::Positions;

/// Where a wafer is to lie, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaferTarget {
    /// Its centre, on the plane that it rests on [m].
    pub center: Vector3<f64>,
    /// Normal of that plane, upward, of any length.
    pub normal: Vector3<f64>,
    /// Its heading about the normal, from the shortest rotation of level to the normal [rad]; `None` leaves it to the arm.
    pub heading: Option<f64>,
}

impl WaferTarget {
    /// The target that a wafer frame fulfils.
    #[must_use]
    pub fn of(base_from_wafer: &Pose) -> Self {
        let normal = base_from_wafer.rotation * Vector3::z();
        let level = tilt_rotation(&normal).inverse() * (base_from_wafer.rotation * Vector3::x());
        let heading = Some(level.y.atan2(level.x));
        Self { center: base_from_wafer.translation.vector, normal, heading }
    }
}

/// All ways to reach a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Inverse {
    /// Every set of positions that puts the wafer there, also those beyond limits.
    pub branches: Vec<Branch>,
    /// Which of them to take; `None` where each breaks a limit, or there is none.
    pub chosen: Option<usize>,
    /// Why there is no branch.
    pub out_of_reach: Option<OutOfReach>,
    /// Limits of rods and tilt that the plane asked for breaks, whatever the arm does.
    pub broken_by_plane: Vec<LimitViolation>,
}

/// One way to reach a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Positions of all axes; those that do not move the effector are where they were.
    pub positions: Positions,
    /// How the arm is bent.
    pub configuration: Configuration,
    /// Limits that it breaks, rods and tilt included; empty without allocating.
    pub broken: Vec<LimitViolation>,
    /// Whether it is the one to take, and why not.
    pub standing: BranchSelection,
    /// Time of the slowest axis on the way there at its top speed without a wafer [s].
    pub distance: f64,
    /// How far the wafer's centre is from the target [m].
    pub residual: f64,
    /// How far the wafer's plane is from that of the target [rad].
    pub normal_residual: f64,
    /// Newton steps of the whole chain that it took; 0 where the closed form was exact.
    pub corrections: usize,
    /// Heading that the wafer has, as in [`WaferTarget::heading`] [rad].
    pub heading: f64,
    /// How far that is from the heading asked for, where the arm is not free to choose it [rad].
    pub heading_off: f64,
}

/// Why a branch is taken, or is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchSelection {
    /// It is the one to take.
    Chosen,
    /// It breaks limits, see [`Branch::broken`].
    BreaksLimits,
    /// Another one keeps the arm bent as it is; this one would take it through its stretched or folded position.
    OtherElbow,
    /// Another one is bent alike and nearer.
    NotNearest,
}

/// A limit that a branch breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitViolation {
    /// An axis is beyond its stops.
    Axis {
        /// Index of the axis.
        axis: usize,
        /// Where it would have to be [m or rad].
        position: f64,
        /// Its least position [m or rad].
        min: f64,
        /// Its largest position [m or rad].
        max: f64,
    },
    /// The platform leans too far.
    Tilt {
        /// How far it leans [rad].
        pitch: f64,
        /// How far it may [rad].
        max: f64,
    },
}

/// On which side of the line from its first to its last joint a two-link arm has its elbow, seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Elbow {
    /// To the left of it.
    Left,
    /// To the right of it.
    Right,
}

/// Whether a radial arm holds the wafer before or behind the joint that it turns about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Reaching {
    /// Before it, where the arm points.
    Forward,
    /// Behind it.
    Backward,
}

/// How an arm is bent; of no meaning where it has no choice, or is stretched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Configuration {
    /// Side of the elbow.
    pub elbow: Option<Elbow>,
    /// Side of the wafer.
    pub reaching: Option<Reaching>,
}

impl Configuration {
    /// Whether an arm goes from one to the other without passing its stretched or folded position.
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
            Reaching::Forward => "reaching forward",
            Reaching::Backward => "reaching backward",
        });
        formatter.pad(&match (elbow, reaching) {
            (Some(elbow), Some(reaching)) => format!("{elbow}, {reaching}"),
            (Some(one), None) | (None, Some(one)) => one.to_owned(),
            (None, None) => "no elbow".to_owned(),
        })
    }
}

/// Why no positions at all reach a target, limits aside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfReach {
    /// Distance that the links have to span, from the joint that they turn about [m].
    pub distance: f64,
    /// Least distance that they span [m].
    pub min: f64,
    /// Largest distance that they span [m].
    pub max: f64,
}

impl OutOfReach {
    /// How far the target is from the nearest place that the links reach [m].
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
