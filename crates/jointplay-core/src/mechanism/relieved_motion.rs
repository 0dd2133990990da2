//! Driving joints along a path with displaced virtual joints.

use nalgebra::DVector;

use super::motion::{DriveProblem, STEP_THRESHOLD};
use super::{
    Closure, CommandedJoints, DrivePath, DrivenMotion, MechanismSystem, PositionSolver,
    ReliefSolver, Stop, relieve,
};
use crate::Error;
use crate::constraint::System;

/// Drives joint coordinates along a path with the least displacements of the virtual joints.
///
/// # Arguments
/// * `home` – closed, virtual joints at rest: joints that the drives do not determine stay near it
/// * `start` – where the drives begin: the driven coordinates at the first point of the path
/// * `free` – joint coordinates that follow; all other joint coordinates are commanded
/// * `count` – number of steps to report
/// * `progress` – called with the number of steps done after each
///
/// # Errors
/// [`Error::NotRelieved`] or [`Error::NotLeast`] if not even the start can be relieved; those of [`CommandedJoints::new`].
/// A motion that stops is not an error: see [`DrivenMotion::stopped`].
///
/// # Numerics
/// Each waypoint is the least displacement near the one before, by [`PositionSolver`]; by [`super::relieve`] from rest where that does not converge, or where drives leave joints undetermined.
/// Singular configurations are not looked for.
pub fn drive_relieved(
    home: &MechanismSystem<'_>,
    start: &MechanismSystem<'_>,
    path: &DrivePath,
    free: &[usize],
    count: usize,
    progress: &mut dyn FnMut(usize),
) -> Result<DrivenMotion, Error> {
    let run = DriveProblem::new(start, path, free);
    let joints = start.coordinate_dimensions().len();
    let commanded: Vec<usize> = (0..joints).filter(|k| !free.contains(k)).collect();
    let commanded = CommandedJoints::new(home, &commanded)?;
    let mut solver = match PositionSolver::new(start, commanded.coordinates()) {
        Ok(solver) => (commanded.undetermined() == 0).then_some(solver),
        Err(Error::PartlyCommanded { .. }) => None,
        Err(other) => return Err(other),
    };
    let at_rest = |values: &DVector<f64>| {
        let mut at_rest = values.clone();
        at_rest.rows_mut(joints, values.len() - joints).fill(0.0);
        start.with_home(at_rest)
    };
    let first = relieve(&at_rest(start.home())?, &commanded, ReliefSolver::LeastNorm)?;
    let closed = |coordinates: DVector<f64>, residual: f64, iterations: usize| Closure {
        coordinates,
        residual,
        iterations,
        is_searched: false,
    };
    let mut here = closed(first.coordinates, first.residual, first.iterations);
    let decomposition = run.decomposed(&here.coordinates)?;
    let regular_rank = decomposition.rank(STEP_THRESHOLD);
    let mut motion = DrivenMotion {
        waypoints: vec![run.waypoint(0.0, here.clone(), &decomposition, regular_rank)],
        singular: Vec::new(),
        stopped: None,
        steps: 0,
    };
    #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
    for k in 1..=count {
        motion.steps += 1;
        let share = k as f64 / count as f64;
        let mut to = here.coordinates.clone();
        for (k, value) in path.values_at(share) {
            to[k] = value;
        }
        let mut position = to.clone();
        let solved = solver
            .as_mut()
            .and_then(|solver| solver.solve(position.as_mut_slice(), ReliefSolver::LeastNorm).ok());
        here = match solved {
            Some(found) => closed(position, found.residual, found.iterations),
            None => match relieve(&at_rest(&to)?, &commanded, ReliefSolver::LeastNorm) {
                Ok(found) => closed(found.coordinates, found.residual, found.iterations),
                Err(Error::NotRelieved { .. } | Error::NotLeast { .. }) => {
                    motion.stopped = Some(Stop::Incompatible);
                    break;
                }
                Err(other) => return Err(other),
            },
        };
        let decomposition = run.decomposed(&here.coordinates)?;
        motion.waypoints.push(run.waypoint(share, here.clone(), &decomposition, regular_rank));
        progress(k);
    }
    Ok(motion)
}
