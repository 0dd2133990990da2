//! The reachable configuration that brings a point of a link nearest to a wanted position.

use nalgebra::{DMatrix, DVector, Vector3};

use super::limits::{ROUND_OFF, range_scale};
use super::motion::on_branch;
use super::motions::Motions;
use super::{Closure, Mechanism, MechanismSystem};
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, System, units};
use crate::linalg::svd;
use crate::spatial::Pose;

/// Steps of the minimization.
const MAX_STEPS: usize = 80;
/// Longest step of all coordinates together, in radians and characteristic lengths.
const LONGEST_STEP: f64 = 0.5;
/// Corrections that put coordinates on their limits after a step.
const MAX_CORRECTIONS: usize = 8;
/// A distance of this many characteristic lengths is none.
const REACHED: f64 = 1e-12;
/// The distance is stationary where its derivative along unit motions is this share of the motions of the point.
const STATIONARY: f64 = 1e-9;
/// The same where steps no longer shorten the distance, because of round-off in the closed loops.
const STALLED: f64 = 1e-6;
/// Least and largest damping, as shares of the largest singular value.
const DAMPING: [f64; 2] = [1e-7, 1e3];
/// Bounds of the curvature of half the squared distance along the last step, in units of that of the linearized point.
const CURVATURE: [f64; 2] = [0.05, 1e3];
/// Motions below this, in radians and characteristic lengths per unit step, do not move a coordinate.
const STILL: f64 = 1e-12;

/// A point of a link, and where it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointTarget {
    /// Index of the link.
    pub link: usize,
    /// The point, in the frame of the link (m).
    pub point_in_link: Vector3<f64>,
    /// The wanted position, in the base frame (m).
    pub position_in_base: Vector3<f64>,
}

/// The configuration that a minimization of the distance of a point ended with.
#[derive(Debug, Clone, PartialEq)]
pub struct ReachedPoint {
    /// The closed configuration.
    pub closed: Closure,
    /// Position of the point there, in the base frame (m).
    pub position_in_base: Vector3<f64>,
    /// Distance from the wanted position (m).
    pub distance: f64,
    /// Indices of the coordinates whose limits keep the point from being nearer.
    pub at_limits: Vec<usize>,
    /// Whether the distance is stationary there: zero, or perpendicular to all motions of the point that limits allow.
    pub is_stationary: bool,
    /// Steps done.
    pub steps: usize,
}

/// Moves a mechanism along closed configurations until a point of a link is as near as possible to a wanted position.
///
/// ```text
///    min ½ |p(q) − p*|²      subject to Φ(q) = 0 and joint limits
/// ```
/// A mechanism without virtual joints, or without actuators, moves in all its joints, with virtual joints at rest; it passes dead points of its actuators.
/// The actuators of a mechanism with virtual joints are moved, and the virtual joints take their least displacement.
/// A coordinate that begins beyond its limits does not get farther beyond; clearances of virtual joints are not limits here.
///
/// # Arguments
/// * `from` – (f + M) a closed configuration (m, rad)
///
/// # Errors
/// [`Error::NoSuchQuantity`] for an unknown link, [`Error::NotFinite`], [`Error::LengthMismatch`], [`Error::TooLarge`], [`Error::NotClosed`]; of a mechanism with virtual joints those of [`super::close_commanded`] without commands.
///
/// # Numerics
/// Damped Gauss–Newton steps in the tangent space, each followed by corrections of the loops; the secant of the last step corrects the curvature, so that distant positions converge too.
/// Limits are an active set with the signs of its multipliers.
/// Every step shortens the distance: the result is a local minimum on the branch of the start, or the start.
///
/// # Source
/// Own derivation; damped Gauss–Newton and active sets: \[NocedalWright\], chapters 10 and 16
pub fn reach_point(
    mechanism: &Mechanism,
    from: &DVector<f64>,
    target: &PointTarget,
) -> Result<ReachedPoint, Error> {
    let (index, count) = (target.link, mechanism.links().len());
    if index >= count {
        return Err(Error::NoSuchQuantity { what: "link", index, count });
    }
    for value in target.point_in_link.iter().chain(&target.position_in_base) {
        crate::error::finite("a coordinate of the point", *value)?;
    }
    let system = MechanismSystem::new(mechanism, from.clone())?;
    let residual = system.mismatch(&system.at_home());
    if residual.is_nan() || residual > CLOSURE_TOLERANCE {
        return Err(Error::NotClosed { residual, allowed: CLOSURE_TOLERANCE });
    }
    let start = Closure { coordinates: from.clone(), residual, iterations: 0, is_searched: false };
    let length = system.characteristic_length();
    let search = Search {
        units: units(system.kinematics().dimensions(), length),
        motions: Motions::of(&system)?,
        limits: mechanism.limits(),
        joints: mechanism.joint_freedoms(),
        system,
        target: *target,
        length,
    };
    search.minimum(start)
}

struct Search<'a> {
    system: MechanismSystem<'a>,
    motions: Motions<'a>,
    target: PointTarget,
    limits: Vec<Option<[f64; 2]>>,
    joints: usize,
    /// One radian or characteristic length of each coordinate.
    units: DVector<f64>,
    length: f64,
}

/// A closed configuration with everything that a step needs.
struct Here {
    closed: Closure,
    position: Vector3<f64>,
    /// (3) from the point to the wanted position, in characteristic lengths.
    off: DVector<f64>,
    /// (f + M, d) motions of the coordinates, in radians and characteristic lengths.
    tangents: DMatrix<f64>,
    /// (3, d) motions of the point, in characteristic lengths.
    jacobian: DMatrix<f64>,
}

/// A step in the tangent space, with the limits that it stays on.
struct Step {
    by: DVector<f64>,
    working: Vec<usize>,
    /// Derivative of half the squared distance along the motions that these limits allow, as a share of the motions of the point.
    slope: f64,
}

impl Search<'_> {
    fn minimum(&self, start: Closure) -> Result<ReachedPoint, Error> {
        let mut here = self.at(start)?;
        let (mut damping, mut curvature) = (DAMPING[0], 1.0);
        let mut steps = 0;
        let mut step = self.step(&here, damping, curvature)?;
        while steps < MAX_STEPS && here.off.norm() > REACHED && step.slope > STATIONARY {
            steps += 1;
            let there = self.moved(&here, &step)?;
            let nearer = there.filter(|there| there.off.norm() < here.off.norm());
            if let Some(there) = nearer {
                curvature = self.curvature(&here, &there, &step)?;
                here = there;
                damping = (0.1 * damping).max(DAMPING[0]);
            } else {
                damping = (10.0 * damping).max(1e-2);
                if damping > DAMPING[1] {
                    break;
                }
            }
            step = self.step(&here, damping, curvature)?;
        }
        let distance = here.off.norm() * self.length;
        let is_reached = here.off.norm() <= REACHED;
        Ok(ReachedPoint {
            closed: here.closed,
            position_in_base: here.position,
            distance,
            at_limits: if is_reached { Vec::new() } else { step.working },
            is_stationary: is_reached || step.slope <= STALLED,
            steps,
        })
    }

    fn at(&self, closed: Closure) -> Result<Here, Error> {
        let system = self.system.moved_to(closed.coordinates.clone())?;
        let kinematics = system.kinematics();
        let still = DVector::zeros(closed.coordinates.len());
        let pose = |reference: &Vector3<f64>| -> (Pose, Vec<super::joint::Twist>) {
            let placed = kinematics.placed(system.home(), &still, reference, None);
            (placed.links[self.target.link], placed.screws)
        };
        let (link, _) = pose(&Vector3::zeros());
        let position = link.rotation * self.target.point_in_link + link.translation.vector;
        let (_, screws) = pose(&position);
        // (3, f + M) motion of the point for a radian or characteristic length of each coordinate.
        let mut full = DMatrix::zeros(3, still.len());
        for (joint, sense) in kinematics.path_to(self.target.link) {
            for k in kinematics.columns_of(joint) {
                let moved = screws[k].1 * (sense * self.units[k] / self.length);
                full.set_column(k, &moved);
            }
        }
        let tangents = self.motions.tangents(&system)?;
        let jacobian = &full * &tangents;
        let off = (self.target.position_in_base - position) / self.length;
        let off = DVector::from_column_slice(off.as_slice());
        Ok(Here { closed, position, off, tangents, jacobian })
    }

    /// Limits of a coordinate, as far as it is not beyond them already, with the round-off at them (m, rad).
    fn bounds(&self, k: usize, value: f64) -> Option<([f64; 2], f64)> {
        let limits @ [least, greatest] = self.limits[k].filter(|_| k < self.joints)?;
        Some(([least.min(value), greatest.max(value)], ROUND_OFF * range_scale(limits)))
    }

    /// The damped step, with an active set of limits.
    fn step(&self, here: &Here, damping: f64, curvature: f64) -> Result<Step, Error> {
        // +1 for a coordinate on its greatest value, −1 on its least.
        let on_limit = |k: usize| {
            let value = here.closed.coordinates[k];
            let ([least, greatest], slack) = self.bounds(k, value)?;
            if value >= greatest - 2.0 * slack {
                return Some((k, 1.0));
            }
            (value <= least + 2.0 * slack).then_some((k, -1.0))
        };
        let on_limits: Vec<(usize, f64)> = (0..self.joints).filter_map(on_limit).collect();
        let mut working: Vec<(usize, f64)> = Vec::new();
        let scale = svd(&here.jacobian)?.largest();
        let mut rounds = 2 * on_limits.len() + 2;
        loop {
            rounds -= 1;
            let outward = self.outward(here, &working);
            let of_limits = svd(&outward)?;
            let free = of_limits.null_space(of_limits.rank(STATIONARY));
            let jacobian = &here.jacobian * &free;
            let decomposition = svd(&jacobian)?;
            let slope = decomposition.largest() * here.off.norm();
            let slope = match (jacobian.transpose() * &here.off).norm() {
                derivative if slope > 0.0 => derivative / slope,
                _ => 0.0,
            };
            let shares = damping * scale / curvature.sqrt();
            let by = &free * decomposition.solve_damped(&(&here.off / curvature), shares);
            let leaves = |&&(k, sense): &&(usize, f64)| {
                let rate = sense * here.tangents.row(k).tr_dot(&by);
                rate > STILL * by.norm() && !working.contains(&(k, sense))
            };
            if let (Some(&left), true) = (on_limits.iter().find(leaves), rounds > 0) {
                working.push(left);
                continue;
            }
            // A limit whose multiplier is negative does not hold the point.
            let pull = here.jacobian.transpose() * &here.off;
            let multipliers = svd(&outward.transpose())?;
            let multipliers = multipliers.solve(&pull, multipliers.rank(STATIONARY));
            let holds = |(k, value): &(usize, &f64)| (*k, **value);
            let least = multipliers.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
            if let Some((k, least)) = least.as_ref().map(holds)
                && rounds > 0
                && least < -STALLED * pull.norm()
            {
                working.remove(k);
                continue;
            }
            let working = working.into_iter().map(|(k, _)| k).collect();
            return Ok(Step { by, working, slope });
        }
    }

    /// (w, d) motions of coordinates out of their limits.
    fn outward(&self, here: &Here, working: &[(usize, f64)]) -> DMatrix<f64> {
        DMatrix::from_fn(working.len(), here.tangents.ncols(), |row, column| {
            let (k, sense) = working[row];
            sense * here.tangents[(k, column)]
        })
    }

    /// The closed configuration after a step, within limits.
    fn moved(&self, here: &Here, step: &Step) -> Result<Option<Here>, Error> {
        let mut along = &here.tangents * &step.by;
        let size = along.rows(0, self.joints).norm();
        let mut share = (LONGEST_STEP / size).min(1.0);
        // Up to the first limit.
        for k in (0..self.joints).filter(|k| !step.working.contains(k)) {
            let value = here.closed.coordinates[k];
            let Some(([least, greatest], slack)) = self.bounds(k, value) else { continue };
            let rate = along[k] * self.units[k];
            let room = if rate > 0.0 { greatest - value } else { least - value };
            if (room / rate).is_finite() && room.abs() > 2.0 * slack {
                share = share.min(room / rate);
            }
        }
        along *= share;
        let kinematics = self.system.kinematics();
        let predicted =
            kinematics.moved(&here.closed.coordinates, &along.component_mul(&self.units));
        let Some(mut closed) = self.motions.closed(&self.system, predicted.clone())? else {
            return Ok(None);
        };
        let correction = kinematics.displacement(&predicted, &closed.coordinates);
        let correction = correction.component_div(&self.units.rows(0, self.joints)).norm();
        if !on_branch(correction, share * size) {
            return Ok(None);
        }
        for _ in 0..MAX_CORRECTIONS {
            let beyond = |k: usize| {
                let ([least, greatest], slack) = self.bounds(k, here.closed.coordinates[k])?;
                let value = closed.coordinates[k];
                let is_within = (least - 0.5 * slack..=greatest + 0.5 * slack).contains(&value);
                (!is_within).then(|| (k, value.clamp(least, greatest) - value))
            };
            let beyond: Vec<(usize, f64)> = (0..self.joints).filter_map(beyond).collect();
            if beyond.is_empty() {
                return self.at(closed).map(Some);
            }
            // Back to the limits, as short as possible; coordinates that are on theirs stay.
            let mut rows = beyond;
            let stays = |k: &&usize| rows.iter().all(|(other, _)| other != *k);
            let staying: Vec<(usize, f64)> =
                step.working.iter().filter(stays).map(|&k| (k, 0.0)).collect();
            rows.extend(staying);
            let tangents =
                self.motions.tangents(&self.system.moved_to(closed.coordinates.clone())?)?;
            let motions = tangents.select_rows(rows.iter().map(|(k, _)| k));
            let back = rows.iter().map(|&(k, by)| by / self.units[k]);
            let decomposition = svd(&motions)?;
            let back = DVector::from_iterator(rows.len(), back);
            let back = decomposition.solve(&back, decomposition.rank(STATIONARY));
            let by = (tangents * back).component_mul(&self.units);
            let predicted = kinematics.moved(&closed.coordinates, &by);
            let Some(found) = self.motions.closed(&self.system, predicted)? else {
                return Ok(None);
            };
            closed = found;
        }
        Ok(None)
    }

    /// Curvature of half the squared distance along a step, in units of the motion of the linearized point.
    fn curvature(&self, here: &Here, there: &Here, step: &Step) -> Result<f64, Error> {
        let by = &here.tangents * &step.by;
        let carried = svd(&there.tangents)?;
        let carried = carried.solve(&by, carried.rank(STATIONARY));
        let (before, after) = (&here.jacobian * &step.by, &there.jacobian * carried);
        let kinematics = self.system.kinematics();
        let moved = kinematics.displacement(&here.closed.coordinates, &there.closed.coordinates);
        let moved = moved.component_div(&self.units.rows(0, self.joints)).norm();
        let share = moved / by.rows(0, self.joints).norm();
        let change = here.off.dot(&before) - there.off.dot(&after);
        let curvature = change / (share * before.norm_squared());
        if !curvature.is_finite() {
            return Ok(1.0);
        }
        Ok(curvature.clamp(CURVATURE[0], CURVATURE[1]))
    }
}
