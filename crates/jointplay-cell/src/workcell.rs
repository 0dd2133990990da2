//! Robot, stations, wafers, bodies and zones together.

use jointplay_core::spatial::Pose;

use crate::displacement::Tolerances;
use crate::geometry::Shape;
use crate::incremental::{CacheKey, CacheKeyPart};
use crate::robot::{EffectorId, HybridRobot};
use crate::station::{SlotId, Station, WaferRules};
use crate::wafer::{Sag, SagError, Wafer, sag};

/// Frame that a body is attached to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParentFrame {
    /// The base frame.
    World,
    /// The platform frame.
    Platform,
    /// The frame of a link of an arm, both by index: origin at its joint, x along the link.
    Link {
        /// Index of the arm.
        arm: usize,
        /// Index of the link in the arm.
        link: usize,
    },
}

/// Rigid body of the cell or of the robot, for collision checks.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Frame that it is attached to.
    pub parent: ParentFrame,
    /// Pose of the shape in that frame.
    pub parent_from_shape: Pose,
    /// Shape.
    pub shape: Shape,
    /// Index of the station in whose frame it is described; it is fixed in the world.
    pub station: Option<usize>,
}

/// Keep-out or safe zone.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    /// Name.
    pub name: String,
    /// Rule of the zone.
    pub rule: ZoneRule,
    /// Pose of the shape in the base frame.
    pub base_from_shape: Pose,
    /// Shape.
    pub shape: Shape,
}

/// Rule of a zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZoneRule {
    /// No body of the robot and no held wafer may enter.
    KeepOut,
    /// The centre of the resting plane of each effector's wafer, empty or loaded, must stay inside during steps of the phases [`Turn`](crate::program::Phase::Turn) and [`PostureChange`](crate::program::Phase::PostureChange), in which the robot turns or changes its posture with retracted arms.
    /// Each safe zone is a condition of its own: with several, the centres must stay inside all of them.
    Safe,
}

/// Work cell: robot, stations, wafers, bodies and zones.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Name.
    pub name: String,
    /// Assumed values of the cell file, each as text with its reason.
    pub assumed: Vec<String>,
    /// The robot.
    pub robot: HybridRobot,
    /// Dimensions and material of all wafers.
    pub wafer: Wafer,
    /// Stations.
    pub stations: Vec<Station>,
    /// Slots with a wafer at the start.
    pub occupied: Vec<SlotId>,
    /// Effectors with a wafer at the start.
    pub loaded_effectors: Vec<EffectorId>,
    /// Bodies, without the wafers.
    pub bodies: Vec<Body>,
    /// Pairs of bodies, by index, that may touch.
    pub allowed_pairs: Vec<[usize; 2]>,
    /// Zones.
    pub zones: Vec<Zone>,
    /// Rules for the stays and visits of wafers.
    pub rules: WaferRules,
    /// Largest Euclidean norm of the displacements of all virtual joints, in the metric of the robot (m).
    pub play_budget: f64,
    /// Required clearance of bodies (m).
    pub clearance: f64,
    /// Required clearance of an end effector and its wafer in a slot (m).
    pub slot_clearance: f64,
    /// Gravitational acceleration, along −z of the base frame (m/s²).
    pub gravity: f64,
    /// Plane budget: largest angle between the plane of a held wafer and that of its station after compensation (rad).
    /// [`check`](crate::check::check) adds the expanded uncertainty of the station's tilt to the angle, where it is known.
    pub plane_threshold: f64,
    /// Multiple of the standard deviation of a station's frame that its clearances and its plane have to allow.
    pub coverage_factor: f64,
    /// Tolerances of robot and cell.
    pub tolerances: Tolerances,
}

impl Cell {
    /// Sag of the cell's wafer on an effector; it does not depend on the pose.
    ///
    /// # Errors
    /// As [`sag`].
    ///
    /// # Panics
    /// If the robot has no such effector.
    pub fn sag(&self, effector: EffectorId) -> Result<Sag, SagError> {
        let support = &self.robot.arms[effector.arm].effectors[effector.effector].support;
        sag(&self.wafer, support, self.gravity)
    }
}

impl CacheKeyPart for Zone {
    fn append_to(&self, cache_key: &mut CacheKey) {
        let Self { name, rule, base_from_shape, shape } = self;
        cache_key.add(name).add(&(*rule == ZoneRule::Safe)).add(base_from_shape).add(shape);
    }
}
