//! Motions of a mechanism along its closed configurations.

use nalgebra::{DMatrix, DVector};

use super::home::close_at_rest;
use super::motion::{MAX_CORRECTIONS, STEP_THRESHOLD};
use super::{Closure, CommandedJoints, MechanismSystem, ReliefSolver, close, relief, relieve};
use crate::Error;
use crate::constraint::{System, scaled_jacobian, units};
use crate::linalg::svd;

/// The closed configurations that a mechanism moves along.
pub(super) enum Motions<'a> {
    /// Those of all joints, virtual joints held.
    Rigid {
        /// The joint coordinates.
        free: Vec<usize>,
    },
    /// Those of the actuators, virtual joints at their least displacement.
    Relieved {
        /// At rest; its reference point and length define the displacement.
        home: Box<MechanismSystem<'a>>,
        commanded: CommandedJoints,
    },
}

impl<'a> Motions<'a> {
    /// # Errors
    /// Those of [`close_at_rest`] and [`CommandedJoints::new`], of a mechanism with virtual joints.
    pub(super) fn of(system: &MechanismSystem<'a>) -> Result<Self, Error> {
        let mechanism = system.kinematics().mechanism();
        let actuated = mechanism.actuated_coordinates();
        if mechanism.virtual_joints().is_empty() || actuated.is_empty() {
            return Ok(Self::Rigid { free: (0..mechanism.joint_freedoms()).collect() });
        }
        let home = close_at_rest(mechanism, None)?.coordinates;
        let home = Box::new(MechanismSystem::new(mechanism, home)?);
        let commanded = CommandedJoints::new(&home, &actuated)?;
        Ok(Self::Relieved { home, commanded })
    }

    /// (f + M, d) instantaneous motions at a closed configuration, in radians and characteristic lengths.
    pub(super) fn tangents(&self, here: &MechanismSystem<'_>) -> Result<DMatrix<f64>, Error> {
        match self {
            Self::Rigid { free } => {
                let length = here.characteristic_length();
                let rows = units(&here.constraint_dimensions(), length);
                let columns = units(here.kinematics().dimensions(), length);
                let columns = columns.select_rows(free);
                let jacobian = here.full_jacobian(&here.at_home()).select_columns(free);
                let decomposition = svd(&scaled_jacobian(&jacobian, &rows, &columns))?;
                let motions = decomposition.null_space(decomposition.rank(STEP_THRESHOLD));
                let mut tangents = DMatrix::zeros(here.home().len(), motions.ncols());
                for (row, &k) in free.iter().enumerate() {
                    tangents.set_row(k, &motions.row(row));
                }
                Ok(tangents)
            }
            Self::Relieved { commanded, .. } => relief::rates(here, commanded),
        }
    }

    /// The closed configuration near predicted coordinates; `None` if there is none.
    pub(super) fn closed(
        &self,
        system: &MechanismSystem<'_>,
        predicted: DVector<f64>,
    ) -> Result<Option<Closure>, Error> {
        match self {
            Self::Rigid { free } => {
                let closed = close(&system.moved_to(predicted)?, free, MAX_CORRECTIONS)?;
                Ok(closed.is_closed().then_some(closed))
            }
            Self::Relieved { home, commanded } => {
                let joints = home.coordinate_dimensions().len();
                let mut at_rest = predicted;
                let virtuals = at_rest.len() - joints;
                at_rest.rows_mut(joints, virtuals).fill(0.0);
                match relieve(&home.with_home(at_rest)?, commanded, ReliefSolver::LeastNorm) {
                    Ok(found) => Ok(Some(Closure {
                        coordinates: found.coordinates,
                        residual: found.residual,
                        iterations: found.iterations,
                        is_searched: false,
                    })),
                    Err(Error::NotRelieved { .. } | Error::NotLeast { .. }) => Ok(None),
                    Err(other) => Err(other),
                }
            }
        }
    }
}
