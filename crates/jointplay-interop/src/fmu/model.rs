//! The model of a unit: a mechanism or a three-rod robot.

use nalgebra::DVector;

use super::error::Error;
use super::mechanism_model::MechanismModel;
use super::resources::Resources;
use super::robot_model::RobotModel;
use super::variable::{POSE_OUTPUTS, Variables};

use jointplay_core::spatial::{Pose, continued_quaternion};

/// A mechanism or a three-rod robot.
#[derive(Debug, Clone)]
pub(super) enum Model {
    Mechanism(Box<MechanismModel>),
    Robot(Box<RobotModel>),
}

/// A closed configuration and its outputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Solved {
    /// Values of the drives (m, rad).
    pub(super) drives: Vec<f64>,
    /// (f + M) coordinates of a mechanism (m, rad); none of a robot, whose rods are its drives.
    pub(super) coordinates: DVector<f64>,
    /// Poses, then displacements of virtual joints, in the order of the variables.
    pub(super) outputs: Vec<f64>,
}

impl Model {
    /// Reads the files; returns the initial configuration too.
    pub(super) fn new(resources: &Resources) -> Result<(Self, Variables, Solved), Error> {
        if resources.is_robot() {
            let (model, variables, solved) = RobotModel::new(resources)?;
            return Ok((Self::Robot(Box::new(model)), variables, solved));
        }
        let (model, variables, solved) = MechanismModel::new(resources)?;
        Ok((Self::Mechanism(Box::new(model)), variables, solved))
    }

    /// The configuration for values of the drives, from one nearby.
    pub(super) fn solve(&mut self, drives: &[f64], near: &Solved) -> Result<Solved, Error> {
        match self {
            Self::Mechanism(model) => model.solve(drives, near),
            Self::Robot(model) => model.solve(drives, Some(near)),
        }
    }

    /// The configuration for values of the drives, wherever the one before is.
    pub(super) fn initialize(&mut self, drives: &[f64], near: &Solved) -> Result<Solved, Error> {
        match self {
            Self::Mechanism(model) => model.initialize(drives, near),
            Self::Robot(model) => model.solve(drives, Some(near)),
        }
    }

    /// Rates of the outputs for rates of the drives.
    pub(super) fn rates(&mut self, at: &Solved, drives: &[f64]) -> Result<Vec<f64>, Error> {
        match self {
            Self::Mechanism(model) => model.rates(at, drives),
            Self::Robot(model) => model.rates(at, drives),
        }
    }
}

/// Appends position and unit quaternion of a pose.
///
/// # Arguments
/// * `before` – outputs of the configuration before, for the sign of the quaternion
pub(super) fn push_pose(outputs: &mut Vec<f64>, pose: &Pose, before: Option<&[f64]>) {
    let first = outputs.len();
    let near = before.and_then(|before| quaternion(before, first));
    outputs.extend_from_slice(pose.translation.vector.as_slice());
    outputs.extend(continued_quaternion(&pose.rotation, near.as_ref()));
}

/// The quaternion of the pose whose outputs begin at an index.
pub(super) fn quaternion(outputs: &[f64], first: usize) -> Option<[f64; 4]> {
    outputs.get(first + 3..first + POSE_OUTPUTS)?.try_into().ok()
}
