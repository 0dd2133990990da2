//! Driving joints along a path with displaced virtual joints.

use std::ops::ControlFlow;

use super::motion::{DriveProblem, STEP_THRESHOLD, go_on};
use super::relieved_branch::RelievedBranch;
use super::{Closure, DrivePath, DrivenMotion, MechanismSystem, Relief, Stop};
use crate::Error;
use crate::constraint::System;

/// Drives joint coordinates along a path with the least displacements of the virtual joints.
///
/// # Arguments
/// * `home` – closed, virtual joints at rest: joints that the drives do not determine stay near it
/// * `start` – where the drives begin: the driven coordinates at the first point of the path
/// * `free` – joint coordinates that follow; all other joint coordinates are commanded
/// * `count` – number of steps to report
/// * `progress` – called again and again, with the number of reported steps that are done; ends the motion by [`ControlFlow::Break`]
///
/// # Errors
/// [`Error::Interrupted`]; [`Error::NotRelieved`] or [`Error::NotLeast`] if not even the start can be relieved; those of [`super::CommandedJoints::new`].
/// A motion that stops is not an error: see [`DrivenMotion::stopped`].
///
/// # Numerics
/// Each waypoint is the least displacement on the branch of the one before, by [`super::CommandedPositions::follow`]; by [`super::relieve`] in short steps where that ends, or where drives leave joints undetermined.
/// Singular configurations are not looked for.
pub fn drive_relieved(
    home: &MechanismSystem<'_>,
    start: &MechanismSystem<'_>,
    path: &DrivePath,
    free: &[usize],
    count: usize,
    progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<DrivenMotion, Error> {
    let run = DriveProblem::new(start, path, free);
    let joints = start.coordinate_dimensions().len();
    let commanded: Vec<usize> = (0..joints).filter(|k| !free.contains(k)).collect();
    let mut branch = RelievedBranch::new(home, start, &commanded)?;
    let closed = |found: Relief| Closure {
        coordinates: found.coordinates,
        residual: found.residual,
        iterations: found.iterations,
        is_searched: false,
    };
    let mut here = closed(branch.first()?);
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
        let values: Vec<f64> = commanded.iter().map(|&k| to[k]).collect();
        let Some(found) = branch.follow(&here.coordinates, &values)? else {
            motion.stopped = Some(Stop::Incompatible);
            break;
        };
        here = closed(found);
        let decomposition = run.decomposed(&here.coordinates)?;
        motion.waypoints.push(run.waypoint(share, here.clone(), &decomposition, regular_rank));
        go_on(progress(k))?;
    }
    Ok(motion)
}
