//! Least displacements of virtual joints along one branch of a motion.

use nalgebra::DVector;

use super::commanded_positions::{CommandedPositions, STEP_WITHOUT_TANGENT};
use super::motion::LONGEST_STEP;
use super::{CommandedJoints, MechanismSystem, Relief, ReliefSolver, relieve};
use crate::Error;
use crate::constraint::{System as _, units};

/// Short steps to a command at most.
const MAX_STEPS: f64 = 400.0;

/// Follows the least displacements of the virtual joints from configuration to configuration, so that the branch does not depend on the number of steps.
pub(super) struct RelievedBranch<'a> {
    /// At the start, in the metric of home.
    system: MechanismSystem<'a>,
    commanded: CommandedJoints,
    /// None where commands leave motions undetermined, or command a part of a ball.
    positions: Option<CommandedPositions>,
    units: DVector<f64>,
}

impl<'a> RelievedBranch<'a> {
    /// # Arguments
    /// * `home` – closed, or nearly so, virtual joints at rest: joints that the commands do not determine stay near it
    /// * `start` – with the commanded coordinates at their first values
    /// * `commanded` – indices of the commanded joint coordinates
    ///
    /// # Errors
    /// Those of [`CommandedJoints::new`].
    pub(super) fn new(
        home: &MechanismSystem<'_>,
        start: &MechanismSystem<'a>,
        commanded: &[usize],
    ) -> Result<Self, Error> {
        let length = home.characteristic_length();
        let system = start.clone().with_characteristic_length(length)?;
        let commanded = CommandedJoints::new(home, commanded)?;
        let positions = match CommandedPositions::determined(&system, commanded.coordinates()) {
            Ok(positions) => (commanded.undetermined() == 0).then_some(positions),
            Err(Error::PartlyCommanded { .. }) => None,
            Err(other) => return Err(other),
        };
        let units = units(system.kinematics().dimensions(), length);
        Ok(Self { system, commanded, positions, units })
    }

    /// Indices of the commanded coordinates.
    pub(super) fn commanded(&self) -> &[usize] {
        self.commanded.coordinates()
    }

    /// The least displacement at the start.
    ///
    /// # Errors
    /// Those of [`relieve`].
    pub(super) fn first(&self) -> Result<Relief, Error> {
        self.relieved(self.system.home())
    }

    /// The least displacement for other values of the commanded coordinates, on the branch of a configuration; `None` where the branch ends before.
    ///
    /// # Arguments
    /// * `here` – (f + M) a configuration of least displacement (m, rad)
    /// * `values` – of the commanded coordinates (m, rad)
    ///
    /// # Errors
    /// Those of [`relieve`], except where there is no displacement.
    ///
    /// # Numerics
    /// By [`CommandedPositions::follow`]; by [`relieve`] in short steps where that ends, or where commands leave motions undetermined.
    pub(super) fn follow(
        &mut self,
        here: &DVector<f64>,
        values: &[f64],
    ) -> Result<Option<Relief>, Error> {
        let mechanism = self.system.kinematics().mechanism();
        if let Some(positions) = &mut self.positions {
            let mut there = here.clone();
            let solver = ReliefSolver::LeastNorm;
            if let Ok(residual) = positions.follow(mechanism, values, &mut there, solver) {
                return Ok(Some(Relief::of(&self.system.moved_to(there)?, residual, 1)));
            }
        }
        self.in_short_steps(here, values)
    }

    fn in_short_steps(&self, here: &DVector<f64>, values: &[f64]) -> Result<Option<Relief>, Error> {
        let commands = self.commanded().iter().copied().zip(values.iter().copied());
        let path: Vec<(usize, f64, f64)> = commands.map(|(k, to)| (k, here[k], to)).collect();
        let squares = path.iter().map(|&(k, from, to)| ((to - from) / self.units[k]).powi(2));
        let length = squares.sum::<f64>().sqrt();
        let step = STEP_WITHOUT_TANGENT.max(length / MAX_STEPS);
        let (mut here, mut done, mut found) = (here.clone(), 0.0, None);
        while found.is_none() || done < length {
            done = (done + step).min(length);
            let mut start = here.clone();
            for &(k, from, to) in &path {
                start[k] = if done < length { from + (to - from) * done / length } else { to };
            }
            let relief = match self.relieved(&start) {
                Ok(relief) => relief,
                Err(Error::NotRelieved { .. } | Error::NotLeast { .. }) => return Ok(None),
                Err(other) => return Err(other),
            };
            if self.distance(&start, &relief.coordinates) > LONGEST_STEP {
                return Ok(None);
            }
            here.copy_from(&relief.coordinates);
            found = Some(relief);
        }
        Ok(found)
    }

    /// The least displacement from a configuration with the virtual joints at rest.
    fn relieved(&self, start: &DVector<f64>) -> Result<Relief, Error> {
        let joints = self.system.coordinate_dimensions().len();
        let mut at_rest = start.clone();
        at_rest.rows_range_mut(joints..).fill(0.0);
        relieve(&self.system.with_home(at_rest)?, &self.commanded, ReliefSolver::LeastNorm)
    }

    /// Distance of the joint coordinates of two configurations, in radians and characteristic lengths.
    pub(super) fn distance(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        let by = self.system.kinematics().displacement(from, to);
        by.component_div(&self.units.rows(0, by.len())).norm()
    }
}
