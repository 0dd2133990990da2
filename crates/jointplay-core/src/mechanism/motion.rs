//! Driving joints along a path.

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector};

use super::driven_motion::{DrivenMotion, SingularConfiguration, Stop, Waypoint};
use super::singular::{DrivenCurve, SINGULAR};
use super::{Closure, Drive, DrivePath, MechanismSystem, close};
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, System, scaled_jacobian, units};
use crate::linalg::{Svd, svd};
use crate::mobility::{finite_mobility, instantaneous_mobility};
use crate::random::Random;

/// Corrections after each step.
pub(super) const MAX_CORRECTIONS: usize = 20;
/// A correction longer than this share of its step may have left the branch.
const LARGEST_CORRECTION: f64 = 0.2;
/// Steps below this, in radians and characteristic lengths, are corrected by round-off as large as they are.
const SHORT: f64 = 1e-9;
/// The longest step of all coordinates together, in radians and characteristic lengths.
pub(super) const LONGEST_STEP: f64 = 0.5;
/// The shortest step, as a share of the whole path: drives that cannot move so far are locked.
pub(super) const SHORTEST_STEP: f64 = 1e-7;
/// Singular values up to this share of the largest are not used for a step.
pub(super) const STEP_THRESHOLD: f64 = 1e-9;
/// A motion that stops with a least singular value below this share of that of regular configurations is at a dead point.
pub(super) const DEAD: f64 = 1e-2;
/// Distance of a turning point that stops a step, as a share of the whole path.
const AT_ONCE: f64 = 1e-4;
/// First steps off a singular start, in radians and characteristic lengths of the drives, the longest first.
const FIRST_STEPS: [f64; 3] = [1e-3, 1e-4, 1e-5];
/// Off a branch, the mismatch near a singular start is of second order in the displacement: a configuration whose mismatch is above this share of the squared displacement is on no branch, although the loops count as closed.
const OFF_BRANCH: f64 = 1e-3;
/// Mismatches up to this one are round-off of closed loops, in radians and characteristic lengths.
const CLOSED_EXACTLY: f64 = 1e-13;
/// Corrections of a first step, which starts where the constraints are singular.
const MAX_FIRST_CORRECTIONS: usize = 100;
/// A branch is reached from a singular start if a quarter of a step leads to no more than this share of the displacement: half where the displacement grows with the root of the step, a quarter where it is proportional to it.
const NEARER: f64 = 0.75;

/// Drives some joints from a closed configuration along a straight line in their coordinates.
///
/// # Arguments
/// * `start` – at a closed configuration
/// * `drives` – target values; all are reached at the same time
/// * `free` – the coordinates that follow
/// * `count` – number of steps to report
///
/// # Errors
/// [`Error::NotClosed`] if the start is open, [`Error::NoSuchQuantity`] for an index of no coordinate.
/// A motion that stops is not an error: see [`DrivenMotion::stopped`].
///
/// # Numerics
/// Tangent step of least norm, then corrections; a step is halved until its correction is small against it, so that the motion stays on its branch.
/// A singular configuration on the path is passed along the tangent before it.
/// Off a singular start a small step is tried, from the tangent and from random instantaneous motions; of several branches that continue, the first found is taken.
pub fn drive(
    start: &MechanismSystem<'_>,
    drives: &[Drive],
    free: &[usize],
    count: usize,
) -> Result<DrivenMotion, Error> {
    let path = DrivePath::line(start.home(), drives)?;
    drive_along(start, &path, free, count, &mut |_| ControlFlow::Continue(()))
}

/// Drives some joints from a closed configuration along a path, as [`drive`] does along a straight line.
///
/// # Arguments
/// * `start` – at a closed configuration, the driven coordinates at the first point of the path
/// * `free` – the coordinates that follow
/// * `count` – number of steps to report, of equal shares: that of the segments of the path, or a multiple, to report all its points
/// * `progress` – called again and again, with the number of reported steps that are done; ends the motion by [`ControlFlow::Break`]
///
/// # Errors
/// [`Error::Interrupted`]; those of [`drive`].
pub fn drive_along(
    start: &MechanismSystem<'_>,
    path: &DrivePath,
    free: &[usize],
    count: usize,
    progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<DrivenMotion, Error> {
    let closed = close(start, free, MAX_CORRECTIONS)?;
    let run = DriveProblem::new(start, path, free);
    if !closed.is_closed() {
        return Err(Error::NotClosed { residual: closed.residual, allowed: CLOSURE_TOLERANCE });
    }
    let first = run.decomposed(&closed.coordinates)?;
    let mut regular_rank = first.rank(STEP_THRESHOLD);
    let mut here = run.waypoint(0.0, closed, &first, regular_rank);
    let mut motion = DrivenMotion {
        waypoints: vec![here.clone()],
        singular: Vec::new(),
        stopped: None,
        steps: 0,
    };
    let mut trail = vec![here.clone()];
    #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
    'path: for k in 1..=count {
        let target = k as f64 / count as f64;
        let mut step = target - here.share;
        while here.share < target {
            motion.steps += 1;
            go_on(progress(k - 1))?;
            let share = if here.share + step >= target - 0.01 * SHORTEST_STEP {
                target
            } else {
                here.share + step
            };
            let mut there = run.step(&here, &here, share, regular_rank)?;
            if let (None, [.., before, _]) = (&there, trail.as_slice())
                && here.least_singular_value < SINGULAR
            {
                there = run.step(&here, before, share, regular_rank)?;
            }
            let is_singular_start = trail.len() == 1 && here.free_mobility > 0;
            if is_singular_start {
                there = there.filter(|there| run.is_on_branch(&here, there));
            }
            // From a singular start, shorter steps would count as closed along any tangent.
            let shortest = if is_singular_start { run.first_step(&here) } else { SHORTEST_STEP };
            if there.is_none() && 0.5 * step < shortest {
                if trail.len() == 1 {
                    there = run.off_start(&here, target, regular_rank)?;
                }
                if there.is_none() {
                    run.note_last_step(&trail, regular_rank, &mut motion.singular)?;
                    motion.stopped =
                        Some(run.stop(&mut here, &trail, regular_rank, &mut motion)?);
                    break 'path;
                }
            }
            let Some(there) = there else {
                step *= 0.5;
                continue;
            };
            here = there;
            step *= 2.0;
            if trail.len() == 1 && here.free_mobility < trail[0].free_mobility {
                // The start is singular: what is regular shows beyond it.
                regular_rank = free.len() - here.free_mobility;
                for point in [&mut trail[0], &mut motion.waypoints[0], &mut here] {
                    point.least_singular_value =
                        least(&run.decomposed(&point.coordinates)?, regular_rank);
                }
                motion.singular.push(run.singular(&trail[0], regular_rank)?);
            }
            trail.push(here.clone());
            run.note_singular(&trail, regular_rank, &mut motion.singular)?;
        }
        motion.waypoints.push(here.clone());
        go_on(progress(k))?;
    }
    if motion.stopped.is_none() {
        run.note_last_step(&trail, regular_rank, &mut motion.singular)?;
        if here.least_singular_value < SINGULAR && trail.len() > 1 {
            motion.singular.push(run.singular(&here, regular_rank)?);
        }
    } else if motion.waypoints.last() != Some(&here) {
        motion.waypoints.push(here);
    }
    Ok(motion)
}

/// An error where the caller ends the motion.
pub(super) fn go_on(flow: ControlFlow<()>) -> Result<(), Error> {
    if flow.is_break() { Err(Error::Interrupted) } else { Ok(()) }
}

/// The least singular value that counts at regular configurations, as a share of the largest.
fn least(svd: &Svd, regular_rank: usize) -> f64 {
    let least = regular_rank.checked_sub(1).map_or(1.0, |last| svd.singular_values[last]);
    if svd.largest() > 0.0 { least / svd.largest() } else { 1.0 }
}

/// Whether a step of some size whose correction is so large stayed on its branch.
pub(super) fn on_branch(correction: f64, size: f64) -> bool {
    correction <= LARGEST_CORRECTION * size.max(SHORT)
}

/// A path of driven coordinates, and the coordinates that follow.
pub(super) struct DriveProblem<'a> {
    system: MechanismSystem<'a>,
    path: &'a DrivePath,
    free: &'a [usize],
    rows: DVector<f64>,
    columns: DVector<f64>,
}

impl<'a> DriveProblem<'a> {
    pub(super) fn new(
        system: &MechanismSystem<'a>,
        path: &'a DrivePath,
        free: &'a [usize],
    ) -> Self {
        let system = system.clone().with_free(free);
        let length = system.characteristic_length();
        let rows = units(&system.constraint_dimensions(), length);
        let columns = units(system.kinematics().dimensions(), length);
        Self { system, path, free, rows, columns }
    }

    /// Scaled Jacobian of the coordinates that follow.
    fn jacobian(&self, coordinates: &DVector<f64>, of: &[usize]) -> Result<DMatrix<f64>, Error> {
        let here = self.system.with_home(coordinates.clone())?;
        let jacobian = here.full_jacobian(&here.at_home()).select_columns(of);
        let columns = DVector::from_iterator(of.len(), of.iter().map(|&k| self.columns[k]));
        Ok(scaled_jacobian(&jacobian, &self.rows, &columns))
    }

    pub(super) fn decomposed(&self, coordinates: &DVector<f64>) -> Result<Svd, Error> {
        Ok(svd(&self.jacobian(coordinates, self.free)?)?)
    }

    pub(super) fn waypoint(
        &self,
        share: f64,
        closed: Closure,
        svd: &Svd,
        regular_rank: usize,
    ) -> Waypoint {
        Waypoint {
            share,
            coordinates: closed.coordinates,
            residual: closed.residual,
            free_mobility: self.free.len() - svd.rank(STEP_THRESHOLD),
            least_singular_value: least(svd, regular_rank),
        }
    }

    /// The next configuration on the branch, if a step to this share of the path stays on it.
    ///
    /// # Arguments
    /// * `tangent_at` – where the direction of the step is taken
    pub(super) fn step(
        &self,
        here: &Waypoint,
        tangent_at: &Waypoint,
        share: f64,
        regular_rank: usize,
    ) -> Result<Option<Waypoint>, Error> {
        let by = self.predicted(here, tangent_at, share)?;
        let predicted = self.system.with_home(here.coordinates.clone())?.moved(&by)?;
        let closed = close(&predicted, self.free, MAX_CORRECTIONS)?;
        let correction = self.size(&(&closed.coordinates - predicted.home()));
        let size = self.size(&by);
        let stayed = on_branch(correction, size) && size < LONGEST_STEP;
        if !closed.is_closed() || !stayed {
            return Ok(None);
        }
        let there = self.decomposed(&closed.coordinates)?;
        Ok(Some(self.waypoint(share, closed, &there, regular_rank)))
    }

    /// The configuration at a share of the path, in a step from a configuration before it, or in shorter ones.
    pub(super) fn reached(
        &self,
        from: &Waypoint,
        share: f64,
        regular_rank: usize,
        halvings: usize,
    ) -> Result<Option<Waypoint>, Error> {
        let found = self.step(from, from, share, regular_rank)?;
        if found.is_some() || halvings == 0 {
            return Ok(found);
        }
        let middle = 0.5 * (from.share + share);
        match self.reached(from, middle, regular_rank, halvings - 1)? {
            Some(between) => self.reached(&between, share, regular_rank, halvings - 1),
            None => Ok(None),
        }
    }

    /// Length of a displacement, in radians and characteristic lengths.
    fn size(&self, by: &DVector<f64>) -> f64 {
        by.component_div(&self.columns).norm()
    }

    /// Displacement of the drives from here to a share of the path.
    fn driven(&self, here: &Waypoint, share: f64) -> DVector<f64> {
        let mut by = DVector::zeros(here.coordinates.len());
        for (k, to) in self.path.values_at(share) {
            by[k] = to - here.coordinates[k];
        }
        by
    }

    /// (f + M) change of the drives per unit of the share (m, rad).
    fn rate(&self, share: f64) -> DVector<f64> {
        let mut rate = DVector::zeros(self.columns.len());
        for (k, value) in self.path.rate(share) {
            rate[k] = value;
        }
        rate
    }

    /// The step of the drives with the tangent motion of the other coordinates at another configuration.
    fn predicted(
        &self,
        here: &Waypoint,
        tangent_at: &Waypoint,
        share: f64,
    ) -> Result<DVector<f64>, Error> {
        let driven = self.path.coordinates();
        let mut by = self.driven(here, share);
        let asked =
            DVector::from_iterator(driven.len(), driven.iter().map(|&k| by[k] / self.columns[k]));
        let pull = self.jacobian(&tangent_at.coordinates, driven)? * &asked;
        let svd = self.decomposed(&tangent_at.coordinates)?;
        let follow = -svd.solve(&pull, svd.rank(STEP_THRESHOLD));
        for (&k, value) in self.free.iter().zip(follow.iter()) {
            by[k] = value * self.columns[k];
        }
        Ok(by)
    }

    /// The longest of the first steps off a singular start, as a share of the path.
    fn first_step(&self, start: &Waypoint) -> f64 {
        let whole = self.size(&self.rate(start.share));
        if whole > 0.0 { (FIRST_STEPS[0] / whole).max(SHORTEST_STEP) } else { SHORTEST_STEP }
    }

    /// Whether a configuration near a singular start is on a branch, and not only so near to the start that every tangent closes the loops.
    fn is_on_branch(&self, start: &Waypoint, there: &Waypoint) -> bool {
        let moved = self.size(&(&there.coordinates - &start.coordinates));
        there.residual <= (OFF_BRANCH * moved * moved).max(CLOSED_EXACTLY)
    }

    /// A configuration a small step off a singular start, on a branch that leads back to it.
    fn off_start(
        &self,
        start: &Waypoint,
        target: f64,
        regular_rank: usize,
    ) -> Result<Option<Waypoint>, Error> {
        let whole = self.size(&self.rate(start.share));
        let svd = self.decomposed(&start.coordinates)?;
        let motions = svd.null_space(svd.rank(STEP_THRESHOLD));
        let from = self.system.with_home(start.coordinates.clone())?;
        let mut random = Random(5);
        for length in FIRST_STEPS {
            let share = if whole > 0.0 { (length / whole).min(target) } else { target };
            for kick in 0..=2 * motions.ncols() + 2 {
                let direction = match kick {
                    0 => DVector::zeros(motions.ncols()),
                    _ => DVector::from_fn(motions.ncols(), |_, _| random.next()),
                };
                let reach = |share: f64| -> Result<Option<(Closure, f64)>, Error> {
                    let mut by = self.predicted(start, start, share)?;
                    // Where the motion grows with the root of the drives' step, it has to be searched for at that distance.
                    let size = (share * whole).sqrt();
                    for (&k, value) in self.free.iter().zip((&motions * &direction).iter()) {
                        by[k] += value * size * self.columns[k];
                    }
                    let closed = close(&from.moved(&by)?, self.free, MAX_FIRST_CORRECTIONS)?;
                    let moved = self.size(&(&closed.coordinates - &start.coordinates));
                    Ok((closed.is_closed() && moved < 10.0 * size).then_some((closed, moved)))
                };
                let Some((closed, moved)) = reach(share)? else { continue };
                let Some((_, nearer)) = reach(0.25 * share)? else { continue };
                if nearer <= NEARER * moved {
                    let there = self.decomposed(&closed.coordinates)?;
                    let there = self.waypoint(share, closed, &there, regular_rank);
                    if self.is_on_branch(start, &there) {
                        return Ok(Some(there));
                    }
                }
            }
        }
        Ok(None)
    }

    /// Why the drives cannot go on from here; at a dead point `here` becomes that point, and it is noted as singular.
    fn stop(
        &self,
        here: &mut Waypoint,
        trail: &[Waypoint],
        regular_rank: usize,
        motion: &mut DrivenMotion,
    ) -> Result<Stop, Error> {
        let at = self.system.with_home(here.coordinates.clone())?;
        let start = trail.len() == 1;
        if start && here.free_mobility > 0 {
            let held = DrivenCurve::new(&at, self.free, None);
            let finite = finite_mobility(&held, &held.here(), STEP_THRESHOLD)?.mobility;
            if finite != Some(here.free_mobility) {
                motion.singular.push(self.singular(here, regular_rank + 1)?);
                return Ok(Stop::SingularStart { free_mobility: here.free_mobility });
            }
        }
        let whole = self.size(&self.rate(here.share));
        let curve = DrivenCurve::new(&at, self.free, Some(self.direction(here.share)));
        if let Some((coordinates, beyond)) = curve.turning_point(regular_rank)?
            && beyond <= AT_ONCE * whole
        {
            let there = self.system.with_home(coordinates)?;
            let closed = Closure {
                residual: there.mismatch(&there.at_home()),
                coordinates: there.home().clone(),
                iterations: 0,
                is_searched: false,
            };
            let svd = self.decomposed(&closed.coordinates)?;
            *here = self.waypoint(here.share + beyond / whole, closed, &svd, regular_rank);
            motion.singular.push(self.singular(here, regular_rank)?);
            return Ok(Stop::Locked);
        }
        let most = trail.iter().map(|point| point.least_singular_value).fold(0.0, f64::max);
        let dead = here.least_singular_value < DEAD * most.min(1.0);
        Ok(if dead { Stop::Locked } else { Stop::Incompatible })
    }

    /// (f + M) direction of the drives, of unit length in radians and characteristic lengths; zero for drives that rest.
    fn direction(&self, share: f64) -> DVector<f64> {
        let rate = self.rate(share);
        let length = self.size(&rate);
        if length > 0.0 { rate / length } else { rate }
    }

    /// A configuration that is singular, with what meets there.
    pub(super) fn singular(
        &self,
        there: &Waypoint,
        regular_rank: usize,
    ) -> Result<SingularConfiguration, Error> {
        let at = self.system.with_home(there.coordinates.clone())?;
        let curve = DrivenCurve::new(&at, self.free, Some(self.direction(there.share)));
        let branches = curve.branches(regular_rank)?;
        Ok(SingularConfiguration {
            share: there.share,
            coordinates: there.coordinates.clone(),
            instantaneous_mobility: instantaneous_mobility(&at, &at.at_home(), SINGULAR)?.mobility,
            least_singular_value: there.least_singular_value,
            branches: branches.count,
            drives_reverse: branches.drives_reverse,
        })
    }
}
