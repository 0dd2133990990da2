//! Closing loops from a rough guess.

use nalgebra::DVector;

use super::blocks::blocks;
use super::closing::close;
use super::closure::{Closure, SAME_BRANCH, START_RANGE};
use super::description::Mechanism;
use super::far_closing::{close_by_links, close_from_far, has_many_loops};
use super::nearest::nearest_closure;
use super::second_order_closing::{close_at_second_order, near_miss_at};
use super::system::{LoopGap, MechanismSystem};
use super::unassembled::{OpenCoupling, OpenLoop, Unassembled};
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, Dimension, System};
use crate::random::Random;

/// Corrections tried from one start.
const MAX_ITERATIONS: usize = 200;
/// A correction that reaches its limit of iterations and moved a slide farther than this drifts [characteristic lengths].
///
/// Twice the range of the other starts: closures of a mechanism are of its own size.
const DRIFT: f64 = 2.0 * START_RANGE;
/// Number of closed configurations from other starts at which a search ends: mechanisms with free motions have any number.
pub const MAX_BRANCHES: usize = 16;

/// Closed configurations that a search found, see [`branches`].
#[derive(Debug, Clone, PartialEq)]
pub struct Branches {
    /// The configurations; one that corrections from the guess lead to is first.
    pub closures: Vec<Closure>,
    /// Number of other starts that were tried.
    pub starts: usize,
    /// Whether the search ended before the requested number of starts because it had found [`MAX_BRANCHES`]: there may be more.
    pub is_limited: bool,
}

/// The configuration that the user's guesses describe: zeros where there are none, virtual joints at rest.
#[must_use]
pub fn guess(mechanism: &Mechanism) -> DVector<f64> {
    let joints = mechanism.joints().iter().flat_map(|joint| {
        (0..joint.kind.freedoms()).map(|k| joint.guess.get(k).copied().unwrap_or(0.0))
    });
    let at_rest = mechanism.virtual_joints().iter().map(|_| 0.0);
    DVector::from_iterator(
        mechanism.joint_freedoms() + mechanism.virtual_joints().len(),
        joints.chain(at_rest),
    )
}

/// Closes the loops near a guess, with some coordinates held.
///
/// Where corrections of first order end at a near miss, as they do near a singular configuration of exact dimensions, a closed configuration nearby is searched at second order; not with virtual joints, which take up a small mismatch.
/// Where that fails, other starts are tried, to distinguish a bad guess from links that do not fit, and the nearest closed configuration within the limits is searched, see [`Unassembled::accepted`].
///
/// # Arguments
/// * `start` – (f + M) coordinates (m, rad), see [`guess`]
/// * `held` – indices of the coordinates that keep their values; virtual joints always do
/// * `starts` – how many other starts to try where the guess fails
///
/// # Errors
/// [`Error::NotAssembled`] with the best closure and the branches found; [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NoSuchQuantity`].
///
/// # Numerics
/// Deterministic: the other starts are the same at every call.
pub fn assemble(
    mechanism: &Mechanism,
    start: &DVector<f64>,
    held: &[usize],
    starts: usize,
) -> Result<Closure, Error> {
    assemble_within(mechanism, start, held, starts, None)
}

/// As [`assemble`], but without a search at second order where the near miss is within a tolerance that the user accepts.
///
/// # Arguments
/// * `tolerance` – largest accepted mismatch, in radians and characteristic lengths
pub(super) fn assemble_within(
    mechanism: &Mechanism,
    start: &DVector<f64>,
    held: &[usize],
    starts: usize,
    tolerance: Option<f64>,
) -> Result<Closure, Error> {
    let free = free(mechanism, held)?;
    let system = MechanismSystem::new(mechanism, start.clone())?.with_free(&free);
    let best = close(&system, &free, MAX_ITERATIONS)?;
    if best.is_closed() {
        return Ok(best);
    }
    let is_accepted = tolerance.is_some_and(|tolerance| best.residual <= tolerance);
    if !is_accepted {
        for near in [near_miss_at(&system, &free)?, best.clone()] {
            if let Some(closed) = close_at_second_order(&system, &free, &near)? {
                return Ok(closed);
            }
        }
    }
    let near_guess = best.clone();
    let (branches, best) = search(&system, &free, starts, best)?;
    let mut loops = open_loops(&system.with_home(best.coordinates.clone())?);
    loops.sort_by(|a, b| b.mismatch.total_cmp(&a.mismatch));
    let couplings = open_couplings(&system.with_home(best.coordinates.clone())?);
    let nearest = nearest_closure(mechanism, start, held, starts)?;
    // The residual of a system at the closure itself, whose reference point and characteristic length differ from the guess's.
    let at_closure = |closure: Closure| {
        let there = MechanismSystem::new(mechanism, closure.coordinates.clone())?;
        let moved = &closure.coordinates - start;
        let dimensions = system.kinematics().dimensions();
        let slides = moved.iter().zip(dimensions).filter(|(_, unit)| **unit != Dimension::Angle);
        let farthest = slides.map(|(by, _)| by.abs()).fold(0.0, f64::max);
        let drifts = closure.iterations >= MAX_ITERATIONS
            && farthest > DRIFT * system.characteristic_length();
        let residual = there.mismatch(&there.at_home());
        Ok::<_, Error>((Closure { residual, ..closure }, drifts))
    };
    let ((best, best_drifts), (near_guess, near_guess_drifts)) =
        (at_closure(best)?, at_closure(near_guess)?);
    Err(Error::NotAssembled(Box::new(Unassembled {
        best,
        near_guess,
        loops,
        couplings,
        branches: branches.closures,
        nearest,
        starts: branches.starts,
        best_drifts,
        near_guess_drifts,
    })))
}

/// Closed configurations found from many starts, the first from the guess itself.
///
/// The search ends when [`MAX_BRANCHES`] are found from other starts.
///
/// # Arguments
/// As [`assemble`].
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NoSuchQuantity`].
pub fn branches(
    mechanism: &Mechanism,
    start: &DVector<f64>,
    held: &[usize],
    starts: usize,
) -> Result<Branches, Error> {
    let free = free(mechanism, held)?;
    let system = MechanismSystem::new(mechanism, start.clone())?.with_free(&free);
    let first = close(&system, &free, MAX_ITERATIONS)?;
    let (mut found, _) = search(&system, &free, starts, first.clone())?;
    if first.is_closed() {
        found.closures.retain(|branch| !same(&system, &branch.coordinates, &first.coordinates));
        found.closures.insert(0, first);
    }
    Ok(found)
}

/// Whether all links have the same poses in two configurations, up to the difference by which assembled configurations are distinguished.
///
/// Coordinates that differ by whole turns are the same configuration.
///
/// # Arguments
/// * `a`, `b` – (f + M) coordinates (m, rad)
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
pub fn is_same_configuration(
    mechanism: &Mechanism,
    a: &DVector<f64>,
    b: &DVector<f64>,
) -> Result<bool, Error> {
    let system = MechanismSystem::new(mechanism, a.clone())?;
    super::kinematics::check_coordinates(b, a.len())?;
    Ok(same(&system, a, b))
}

/// The loops at home, with the frames that do not meet.
fn open_loops(system: &MechanismSystem<'_>) -> Vec<OpenLoop> {
    let mechanism = system.kinematics().mechanism();
    let gaps = system.loop_gaps().into_iter().zip(system.loop_residuals());
    let open = |(gap, (joint, mismatch)): (LoopGap, (usize, f64))| {
        let joint = &mechanism.joints()[joint];
        let links = joint.links.map(|link| mechanism.links()[link].clone());
        let LoopGap { distance, angle } = gap;
        OpenLoop { joint: joint.name.clone(), links, mismatch, distance, angle }
    };
    gaps.map(open).collect()
}

/// The couplings that do not hold at home, the most violated first.
fn open_couplings(system: &MechanismSystem<'_>) -> Vec<OpenCoupling> {
    let couplings = system.kinematics().mechanism().couplings().iter();
    let mut open: Vec<OpenCoupling> = couplings
        .zip(system.coupling_residuals())
        .filter(|(_, mismatch)| *mismatch > CLOSURE_TOLERANCE)
        .map(|(coupling, mismatch)| OpenCoupling { name: coupling.name.clone(), mismatch })
        .collect();
    open.sort_by(|a, b| b.mismatch.total_cmp(&a.mismatch));
    open
}

/// Joint coordinates that are not held.
fn free(mechanism: &Mechanism, held: &[usize]) -> Result<Vec<usize>, Error> {
    let joints = mechanism.joint_freedoms();
    crate::error::indices("coordinate", held, joints + mechanism.virtual_joints().len())?;
    Ok((0..joints).filter(|k| !held.contains(k)).collect())
}

fn search(
    system: &MechanismSystem<'_>,
    free: &[usize],
    starts: usize,
    mut best: Closure,
) -> Result<(Branches, Closure), Error> {
    let mut random = Random(1);
    let mut branches: Vec<Closure> = Vec::new();
    let mut tried = 0;
    let is_on_loops = on_loops(system);
    let moving: Vec<usize> = free.iter().copied().filter(|&k| is_on_loops[k]).collect();
    while tried < starts && branches.len() < MAX_BRANCHES {
        tried += 1;
        let mut by = DVector::zeros(system.home().len());
        for &k in free {
            let range = match system.kinematics().dimensions()[k] {
                Dimension::Angle => std::f64::consts::PI,
                _ => START_RANGE * system.characteristic_length(),
            };
            let share = random.next();
            by[k] = if is_on_loops[k] { share * range } else { 0.0 };
        }
        let from = system.kinematics().moved(system.home(), &by);
        let mut found = close_from_far(system, &moving, from.clone(), MAX_ITERATIONS)?;
        if !found.is_closed() && !has_many_loops(system) {
            let by_links = close_by_links(system, &moving, from, MAX_ITERATIONS)?;
            if by_links.residual < found.residual {
                found = by_links;
            }
        }
        if let Some(closed) = close_at_second_order(system, &moving, &found)? {
            found = closed;
        }
        let known = |branch: &Closure| same(system, &branch.coordinates, &found.coordinates);
        if found.is_closed() && !branches.iter().any(known) {
            branches.push(found.clone());
        }
        if found.residual < best.residual {
            best = found;
        }
    }
    let is_limited = tried < starts;
    Ok((Branches { closures: branches, starts: tried, is_limited }, best))
}

/// Whether loops or couplings constrain each coordinate: the others keep the values of the guess, since a different value is no other configuration of the loops.
fn on_loops(system: &MechanismSystem<'_>) -> Vec<bool> {
    let kinematics = system.kinematics();
    let mut on_loops = vec![false; system.home().len()];
    for block in blocks(kinematics.mechanism()).iter().filter(|block| block.has_constraints()) {
        block.coordinates(kinematics).into_iter().for_each(|k| on_loops[k] = true);
    }
    on_loops
}

/// Whether all links are where they are in another configuration.
fn same(system: &MechanismSystem<'_>, a: &DVector<f64>, b: &DVector<f64>) -> bool {
    let kinematics = system.kinematics();
    let (Ok(a), Ok(b)) = (kinematics.link_poses(a), kinematics.link_poses(b)) else {
        return false;
    };
    let unit = system.characteristic_length();
    a.iter().zip(&b).all(|(a, b)| {
        let turned = (a.rotation.matrix() - b.rotation.matrix()).amax();
        let moved = (a.translation.vector - b.translation.vector).amax() / unit;
        turned.max(moved) < SAME_BRANCH
    })
}
