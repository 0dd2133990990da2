//! Positions of a mechanism for many values of its commanded coordinates, each from the one before it.

use nalgebra::DVector;

use super::description::Mechanism;
use super::posing::close_commanded;
use super::position::{DifferentialKinematics, PositionSolver};
use super::relief::{CommandedJoints, ReliefSolver};
use super::system::MechanismSystem;
use crate::Error;
use crate::constraint::System as _;

/// Closes the loops of one mechanism for values of its commanded coordinates, again and again; virtual joints take their least displacement.
///
/// One value serves one thread; clone it for more.
#[derive(Debug, Clone)]
pub struct CommandedPositions {
    solver: PositionSolver,
    kinematics: DifferentialKinematics,
    /// Characteristic length of `kinematics` (m).
    length: f64,
    /// Only where commands leave motions undetermined, which must not save displacement of virtual joints.
    undetermined: Option<CommandedJoints>,
}

impl CommandedPositions {
    /// Lays out the solution for given commanded coordinates.
    ///
    /// # Arguments
    /// * `first` – (f + M) a closed configuration, which determines the characteristic length (m, rad)
    /// * `commanded` – indices of the commanded joint coordinates
    ///
    /// # Errors
    /// [`Error::PartlyCommanded`]; [`Error::TooLarge`] beyond dense algebra; those of [`close_commanded`] and [`CommandedJoints::new`].
    pub fn new(
        mechanism: &Mechanism,
        first: &DVector<f64>,
        commanded: &[usize],
    ) -> Result<Self, Error> {
        let system = MechanismSystem::new(mechanism, first.clone())?;
        let solver = PositionSolver::new(&system, commanded)?;
        let kinematics = DifferentialKinematics::new(&system, commanded)?;
        let undetermined = if mechanism.virtual_joints().is_empty() {
            None
        } else {
            let home = close_commanded(mechanism, &[], None)?.coordinates;
            let joints = CommandedJoints::new(&MechanismSystem::new(mechanism, home)?, commanded)?;
            Some(joints).filter(|joints| joints.undetermined() > 0)
        };
        Ok(Self { solver, kinematics, length: system.characteristic_length(), undetermined })
    }

    /// Closes the loops; returns the residual, in radians and characteristic lengths.
    ///
    /// # Arguments
    /// * `mechanism` – that of [`new`](Self::new)
    /// * `values` – of the commanded coordinates (m, rad)
    /// * `coordinates` – (f + M) a configuration nearby; takes the solution, and is unspecified after an error (m, rad)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NotReached`]; where commands leave motions undetermined, those of [`super::relieve`].
    ///
    /// # Numerics
    /// Joint limits are not checked: see [`Mechanism::beyond_limits`].
    /// Allocates nothing, except where commands leave motions undetermined.
    pub fn solve(
        &mut self,
        mechanism: &Mechanism,
        values: &[f64],
        coordinates: &mut DVector<f64>,
        solver: ReliefSolver,
    ) -> Result<f64, Error> {
        let commanded = self.kinematics.commanded();
        if values.len() != commanded.len() {
            let (what, expected) = ("the vector of commanded values", commanded.len());
            return Err(Error::LengthMismatch { what, found: values.len(), expected });
        }
        match &self.undetermined {
            None => {
                let all = self.kinematics.coordinate_count();
                if coordinates.len() != all {
                    let (what, found) = ("the coordinate vector", coordinates.len());
                    return Err(Error::LengthMismatch { what, found, expected: all });
                }
                commanded.iter().zip(values).for_each(|(&k, &value)| coordinates[k] = value);
                Ok(self.solver.solve(coordinates.as_mut_slice(), solver)?.residual)
            }
            Some(joints) => {
                let relief = joints.relieve(mechanism, values.iter().copied(), solver)?;
                *coordinates = relief.coordinates;
                if self.length.to_bits() != relief.characteristic_length.to_bits() {
                    let system = MechanismSystem::new(mechanism, coordinates.clone())?
                        .with_characteristic_length(relief.characteristic_length)?;
                    self.kinematics = DifferentialKinematics::new(&system, joints.coordinates())?;
                    self.length = relief.characteristic_length;
                }
                Ok(relief.residual)
            }
        }
    }

    /// Derivatives by the commanded coordinates at a configuration that [`solve`](Self::solve) found last by least norm.
    ///
    /// # Errors
    /// Those of [`DifferentialKinematics::linearize`].
    pub fn linearize(
        &mut self,
        coordinates: &DVector<f64>,
    ) -> Result<&mut DifferentialKinematics, Error> {
        self.kinematics.linearize(coordinates.as_slice())?;
        Ok(&mut self.kinematics)
    }
}
