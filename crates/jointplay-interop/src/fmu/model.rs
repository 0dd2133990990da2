//! The model of a unit: a mechanism or a three-rod robot.

use super::error::Error;
use super::mechanism_model::MechanismModel;
use super::resources::Resources;
use super::robot_model::RobotModel;
use super::solved::Solved;
use super::variable::Variables;

/// A mechanism or a three-rod robot.
#[derive(Debug, Clone)]
pub(super) enum Model {
    Mechanism(Box<MechanismModel>),
    Robot(Box<RobotModel>),
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
