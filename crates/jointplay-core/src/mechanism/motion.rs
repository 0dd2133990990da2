//! Driving joints along a path.

use nalgebra::{DMatrix, DVector};

use super::{Closure, MechanismSystem, PositionSolver, ReliefSolver, close, relieve};
use crate::Error;
use crate::constraint::{System, scaled_jacobian, units};
use crate::linalg::{Svd, svd};
use crate::mobility::instantaneous_mobility;

/// Corrections after each step.
const MAX_CORRECTIONS: usize = 20;
/// A correction longer than this share of its step may have left the branch.
const LARGEST_CORRECTION: f64 = 0.2;
/// The shortest step, as a share of the whole way: what cannot go so far is locked.
const SHORTEST_STEP: f64 = 1e-7;
/// Singular values up to this share of the largest are left out of a step.
const STEP_THRESHOLD: f64 = 1e-9;
/// Singular values below this share of the largest make a configuration singular.
const SINGULAR: f64 = 1e-6;

/// A joint coordinate driven from where it is to a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Where it goes [m or rad].
    pub to: f64,
}

/// A configuration on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// How much of the way is done, 0 to 1.
    pub share: f64,
    /// (f + M) coordinates [m, rad].
    pub coordinates: DVector<f64>,
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Freedoms to first order with the drives held.
    pub free_mobility: usize,
    /// The least singular value that the start has, as a share of the largest: goes to zero at a singular configuration.
    pub least_singular_value: f64,
}

/// A configuration on the way where constraints become dependent.
#[derive(Debug, Clone, PartialEq)]
pub struct Singular {
    /// How much of the way is done there, 0 to 1.
    pub share: f64,
    /// (f + M) coordinates [m, rad].
    pub coordinates: DVector<f64>,
    /// Freedoms to first order there, drives free.
    pub instantaneous_mobility: usize,
    /// The least singular value found there, as a share of the largest.
    pub least_singular_value: f64,
}

/// Why a motion stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The drives cannot go on: a dead point, where the motion would turn back.
    Locked,
    /// The loops do not stay closed: the drives pull against each other or against redundant constraints.
    Incompatible,
}

/// A motion, as far as it went.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// One configuration for each step asked for, the start first.
    pub waypoints: Vec<Waypoint>,
    /// Singular configurations on the way.
    pub singular: Vec<Singular>,
    /// Why it stopped, if it did not come to the end.
    pub stopped: Option<Stop>,
    /// Steps done, the shortened ones among them.
    pub steps: usize,
}

/// Drives some joints from a closed configuration along a straight line in their coordinates.
///
/// # Arguments
/// * `start` – at a closed configuration
/// * `drives` – where to; all arrive together
/// * `free` – the coordinates that follow
/// * `count` – number of steps to report
///
/// # Errors
/// [`Error::NotClosed`] if the start is open.
/// A motion that stops is not an error: see [`Motion::stopped`].
///
/// # Numerics
/// Tangent step of least norm, then corrections; a step is halved until its correction is small against it, so that the motion stays on its branch.
pub fn drive(
    start: &MechanismSystem<'_>,
    drives: &[Drive],
    free: &[usize],
    count: usize,
) -> Result<Motion, Error> {
    let run = Run::new(start, drives, free);
    let closed = close(start, free, MAX_CORRECTIONS)?;
    if !closed.is_closed() {
        return Err(Error::NotClosed { residual: closed.residual, allowed: super::CLOSED });
    }
    let first = run.decomposed(&closed.coordinates)?;
    let regular_rank = first.rank(STEP_THRESHOLD);
    let mut here = run.waypoint(0.0, closed, &first, regular_rank);
    let mut motion =
        Motion { waypoints: vec![here.clone()], singular: Vec::new(), stopped: None, steps: 0 };
    let mut trail = vec![here.clone()];
    #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
    'way: for k in 1..=count {
        let target = k as f64 / count as f64;
        let mut step = target - here.share;
        while here.share < target {
            motion.steps += 1;
            let share = if here.share + step >= target - 0.01 * SHORTEST_STEP {
                target
            } else {
                here.share + step
            };
            if let Some(there) = run.step(&here, share, regular_rank)? {
                here = there;
                trail.push(here.clone());
                step *= 2.0;
                run.note_singular(&trail, regular_rank, &mut motion.singular)?;
            } else {
                step *= 0.5;
                if step < SHORTEST_STEP {
                    let dead =
                        here.least_singular_value < 1e-2 * trail[0].least_singular_value.min(1.0);
                    motion.stopped = Some(if dead { Stop::Locked } else { Stop::Incompatible });
                    break 'way;
                }
            }
        }
        motion.waypoints.push(here.clone());
    }
    if motion.stopped.is_some() && motion.waypoints.last() != Some(&here) {
        motion.waypoints.push(here);
    }
    Ok(motion)
}

/// Drives joint coordinates along a straight line with the virtual joints giving way as little as they can.
///
/// # Arguments
/// * `start` – virtual joints at rest
/// * `free` – joint coordinates that follow; all other joint coordinates are commanded
/// * `count` – number of steps to report
///
/// # Errors
/// [`Error::NotRelieved`] if not even the start can be relieved.
/// A motion that stops is not an error: see [`Motion::stopped`].
///
/// # Numerics
/// Each waypoint is the least displacement near the one before, by [`PositionSolver`], or by [`super::relieve`] from rest where that does not converge; singular configurations are not looked for.
pub fn drive_relieved(
    start: &MechanismSystem<'_>,
    drives: &[Drive],
    free: &[usize],
    count: usize,
) -> Result<Motion, Error> {
    let run = Run::new(start, drives, free);
    let joints = start.coordinate_dimensions().len();
    let commanded: Vec<usize> = (0..joints).filter(|k| !free.contains(k)).collect();
    let mut solver = match PositionSolver::new(start, &commanded) {
        Ok(solver) => Some(solver),
        Err(Error::PartlyCommanded { .. }) => None,
        Err(other) => return Err(other),
    };
    let first = relieve(start, &commanded, ReliefSolver::LeastNorm)?;
    let closed = |coordinates: DVector<f64>, residual: f64, iterations: usize| Closure {
        coordinates,
        residual,
        iterations,
    };
    let mut here = closed(first.coordinates, first.residual, first.iterations);
    let decomposition = run.decomposed(&here.coordinates)?;
    let regular_rank = decomposition.rank(STEP_THRESHOLD);
    let mut motion = Motion {
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
        for (drive, from) in drives.iter().zip(&run.from) {
            to[drive.coordinate] = from + (drive.to - from) * share;
        }
        let mut position = to.clone();
        let solved = solver
            .as_mut()
            .and_then(|solver| solver.solve(position.as_mut_slice(), ReliefSolver::LeastNorm).ok());
        here = match solved {
            Some(found) => closed(position, found.residual, found.iterations),
            None => {
                to.rows_mut(joints, to.len() - joints).fill(0.0);
                match relieve(&start.at(to)?, &commanded, ReliefSolver::LeastNorm) {
                    Ok(found) => closed(found.coordinates, found.residual, found.iterations),
                    Err(Error::NotRelieved { .. }) => {
                        motion.stopped = Some(Stop::Incompatible);
                        break;
                    }
                    Err(other) => return Err(other),
                }
            }
        };
        let decomposition = run.decomposed(&here.coordinates)?;
        motion.waypoints.push(run.waypoint(share, here.clone(), &decomposition, regular_rank));
    }
    Ok(motion)
}

struct Run<'a> {
    system: &'a MechanismSystem<'a>,
    drives: &'a [Drive],
    free: &'a [usize],
    from: Vec<f64>,
    rows: DVector<f64>,
    columns: DVector<f64>,
}

impl<'a> Run<'a> {
    fn new(system: &'a MechanismSystem<'a>, drives: &'a [Drive], free: &'a [usize]) -> Self {
        let length = system.characteristic_length();
        Self {
            system,
            drives,
            free,
            from: drives.iter().map(|drive| system.home()[drive.coordinate]).collect(),
            rows: units(&system.constraint_dimensions(), length),
            columns: units(system.kinematics().dimensions(), length),
        }
    }

    /// Scaled Jacobian of the coordinates that follow.
    fn jacobian(&self, coordinates: &DVector<f64>, of: &[usize]) -> Result<DMatrix<f64>, Error> {
        let here = self.system.at(coordinates.clone())?;
        let jacobian = here.full_jacobian(&here.at_home()).select_columns(of);
        let columns = DVector::from_iterator(of.len(), of.iter().map(|&k| self.columns[k]));
        Ok(scaled_jacobian(&jacobian, &self.rows, &columns))
    }

    fn decomposed(&self, coordinates: &DVector<f64>) -> Result<Svd, Error> {
        svd(&self.jacobian(coordinates, self.free)?)
    }

    fn waypoint(&self, share: f64, closed: Closure, svd: &Svd, regular_rank: usize) -> Waypoint {
        let least = regular_rank.checked_sub(1).map_or(1.0, |last| svd.singular_values[last]);
        Waypoint {
            share,
            coordinates: closed.coordinates,
            residual: closed.residual,
            free_mobility: self.free.len() - svd.rank(STEP_THRESHOLD),
            least_singular_value: if svd.largest() > 0.0 { least / svd.largest() } else { 1.0 },
        }
    }

    /// The next configuration on the branch, if a step to this share of the way stays on it.
    fn step(
        &self,
        here: &Waypoint,
        share: f64,
        regular_rank: usize,
    ) -> Result<Option<Waypoint>, Error> {
        let driven: Vec<usize> = self.drives.iter().map(|drive| drive.coordinate).collect();
        let mut by = DVector::zeros(here.coordinates.len());
        for (drive, from) in self.drives.iter().zip(&self.from) {
            let to = from + (drive.to - from) * share;
            by[drive.coordinate] = to - here.coordinates[drive.coordinate];
        }
        let asked =
            DVector::from_iterator(driven.len(), driven.iter().map(|&k| by[k] / self.columns[k]));
        let pull = self.jacobian(&here.coordinates, &driven)? * &asked;
        let svd = self.decomposed(&here.coordinates)?;
        let follow = -svd.solve(&pull, svd.rank(STEP_THRESHOLD));
        for (&k, value) in self.free.iter().zip(follow.iter()) {
            by[k] = value * self.columns[k];
        }
        let predicted = self.system.at(here.coordinates.clone())?.moved(&by)?;
        let closed = close(&predicted, self.free, MAX_CORRECTIONS)?;
        let size = |by: &DVector<f64>| by.component_div(&self.columns).norm();
        let correction = size(&(&closed.coordinates - predicted.home()));
        let stayed = correction <= LARGEST_CORRECTION * size(&by).max(1e-9) && size(&by) < 0.5;
        if !closed.is_closed() || !stayed {
            return Ok(None);
        }
        let there = self.decomposed(&closed.coordinates)?;
        Ok(Some(self.waypoint(share, closed, &there, regular_rank)))
    }

    /// Looks into a dip of the least singular value between the last three steps.
    fn note_singular(
        &self,
        trail: &[Waypoint],
        regular_rank: usize,
        found: &mut Vec<Singular>,
    ) -> Result<(), Error> {
        let count = trail.len();
        if count < 3 {
            return Ok(());
        }
        let values = [3, 2, 1].map(|back| trail[count - back].least_singular_value);
        if values[1] > values[0] || values[1] >= values[2] {
            return Ok(());
        }
        let (mut low, mut high) = (trail[count - 3].share, trail[count - 1].share);
        let mut least = trail[count - 2].clone();
        let base = trail[count - 3].clone();
        for _ in 0..60 {
            if least.least_singular_value < SINGULAR || high - low < 1e-12 {
                break;
            }
            let shares = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            let [Some(a), Some(b)] = [
                self.step(&base, shares[0], regular_rank)?,
                self.step(&base, shares[1], regular_rank)?,
            ] else {
                break;
            };
            if a.least_singular_value < b.least_singular_value {
                high = shares[1];
            } else {
                low = shares[0];
            }
            for candidate in [a, b] {
                if candidate.least_singular_value < least.least_singular_value {
                    least = candidate;
                }
            }
        }
        if least.least_singular_value < SINGULAR {
            let there = self.system.at(least.coordinates.clone())?;
            let mobility = instantaneous_mobility(&there, &there.at_home(), SINGULAR)?.mobility;
            found.push(Singular {
                share: least.share,
                coordinates: least.coordinates,
                instantaneous_mobility: mobility,
                least_singular_value: least.least_singular_value,
            });
        }
        Ok(())
    }
}
