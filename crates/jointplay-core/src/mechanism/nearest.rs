//! The closed configuration nearest a guess that does not close, within joint limits.

use std::f64::consts::TAU;

use nalgebra::DVector;

use super::blocks::blocks;
use super::closing::close;
use super::closure::{Closure, SAME_BRANCH, START_RANGE};
use super::coupling_rows::coupling_rows;
use super::description::Mechanism;
use super::far_closing::{close_by_links, close_from_far, has_many_loops};
use super::joint::Factor;
use super::kinematics::Kinematics;
use super::limits::{ROUND_OFF, range_scale, within_limits};
use super::second_order_closing::{close_at_second_order, near_miss_at};
use super::system::MechanismSystem;
use crate::Error;
use crate::constraint::{Dimension, System, scaled_jacobian, units};
use crate::linalg::svd;
use crate::random::Random;
use crate::spatial::nearest_angle;

/// Corrections tried from one start.
const MAX_ITERATIONS: usize = 60;
/// Times that coordinates beyond their limits are put on them and held there.
const MAX_CLAMPINGS: usize = 6;
/// Closed configurations of a block that are compared.
const ENOUGH: usize = 4;
/// Steps towards the guess along the closed configurations.
const MAX_STEPS: usize = 40;
/// A step that was shortened to this share does not approach the guess.
const SHORTEST_STEP: f64 = 1.0 / 64.0;
/// A remaining motion towards the guess of this size is none, relative to the distance.
const STATIONARY: f64 = 1e-6;
/// Singular values below this share of the largest are round-off.
const RANK: f64 = 1e-9;

/// The nearest closed configuration that was found, by distance from the guess in radians and characteristic lengths.
///
/// Each block of loops is searched separately, from starts at increasing distance from the guess; from each closed configuration the search moves along closed ones towards the guess.
/// Coordinates of no loop keep their values, but are put within their limits.
///
/// # Arguments
/// * `guess` – (f + M) coordinates (m, rad)
/// * `held` – indices of the coordinates that keep their values; virtual joints always do
/// * `starts` – how many starts to try for each block
///
/// # Errors
/// Those of [`MechanismSystem::new`]; [`Error::NoSuchQuantity`] for an index of no coordinate. `None` where a block was closed from no start.
///
/// # Numerics
/// Deterministic. The configuration is a local minimum of the distance; a nearer one on another branch is missed if no start leads to it.
pub fn nearest_closure(
    mechanism: &Mechanism,
    guess: &DVector<f64>,
    held: &[usize],
    starts: usize,
) -> Result<Option<Closure>, Error> {
    crate::error::indices("coordinate", held, guess.len())?;
    let kinematics = Kinematics::new(mechanism);
    let mut coordinates = guess.clone();
    let free: Vec<usize> = (0..mechanism.joint_freedoms()).filter(|k| !held.contains(k)).collect();
    clamp(&mut coordinates, &free, &mechanism.limits());
    let mut iterations = 0;
    for block in blocks(mechanism).iter().filter(|block| block.has_constraints()) {
        let (part, _) = block.mechanism(mechanism);
        let indices = block.coordinates(&kinematics);
        let guess = DVector::from_fn(indices.len(), |k, _| guess[indices[k]]);
        let free = (0..part.joint_freedoms()).filter(|&k| free.contains(&indices[k])).collect();
        let search = Search::new(&part, guess, free)?;
        let Some(found) = search.nearest(starts)? else { return Ok(None) };
        iterations += found.iterations;
        indices
            .iter()
            .zip(found.coordinates.iter())
            .for_each(|(&k, &value)| coordinates[k] = value);
    }
    let system = MechanismSystem::new(mechanism, coordinates)?;
    let found = close(&system, &free, MAX_ITERATIONS)?;
    let is_within = within_limits(mechanism, &free, &found.coordinates);
    let iterations = iterations + found.iterations;
    Ok((found.is_closed() && is_within).then_some(Closure {
        iterations,
        is_searched: true,
        ..found
    }))
}

/// Puts coordinates within their limits.
fn clamp(coordinates: &mut DVector<f64>, free: &[usize], limits: &[Option<[f64; 2]>]) {
    for &k in free {
        if let Some([least, greatest]) = limits[k] {
            coordinates[k] = coordinates[k].clamp(least, greatest);
        }
    }
}

/// Result of corrections from one start.
struct Attempt {
    closure: Option<Closure>,
    /// Whether an angle that was put on its limit is within the limits a turn away.
    can_turn: bool,
}

/// Search for closed configurations of one block.
struct Search<'a> {
    /// At the guess.
    system: MechanismSystem<'a>,
    free: Vec<usize>,
    limits: Vec<Option<[f64; 2]>>,
    /// Coordinates that are the same after a whole turn.
    turns: Vec<usize>,
    /// Radians and characteristic lengths of the coordinates.
    units: DVector<f64>,
}

impl<'a> Search<'a> {
    fn new(part: &'a Mechanism, guess: DVector<f64>, free: Vec<usize>) -> Result<Self, Error> {
        let system = MechanismSystem::new(part, guess)?.with_rotation_vectors().with_free(&free);
        let elements = system.kinematics().chains().iter().flat_map(|chain| &chain.elements);
        // A whole turn of a coupled coordinate changes the others.
        let coupled = coupling_rows(system.kinematics(), system.characteristic_length());
        let is_coupled = |k: &usize| coupled.iter().any(|row| row.contains(*k));
        let turns = elements
            .filter(|element| matches!(element.factor, Factor::Turn { .. }))
            .map(|element| element.coordinate)
            .filter(|k| !is_coupled(k))
            .filter(|k| free.contains(k))
            .collect();
        let units = units(system.kinematics().dimensions(), system.characteristic_length());
        Ok(Self { free, limits: part.limits(), turns, units, system })
    }

    fn nearest(&self, starts: usize) -> Result<Option<Closure>, Error> {
        let mut random = Random(1);
        let mut found: Vec<Closure> = Vec::new();
        for number in 0..=starts {
            let mut by = DVector::zeros(self.system.home().len());
            #[expect(clippy::cast_precision_loss, reason = "a count of starts")]
            let share = number as f64 / starts.max(1) as f64;
            for &k in &self.free {
                let range = match self.system.kinematics().dimensions()[k] {
                    Dimension::Angle => std::f64::consts::PI,
                    _ => START_RANGE * self.system.characteristic_length(),
                };
                by[k] = share * range * random.next();
            }
            let from = self.system.kinematics().moved(self.system.home(), &by);
            let closed = match self.closed_from(from.clone())? {
                // Steps of second order take long where there are many loops.
                None if has_many_loops(&self.system) && number > 0 => None,
                None if has_many_loops(&self.system) => self.closed_at_second_order(from)?,
                None => self.closed_by_links(from)?,
                closed => closed,
            };
            let Some(closed) = closed else { continue };
            let closed = self.approached(closed)?;
            let is_known = |one: &Closure| {
                let by = self.displacement(&one.coordinates, &closed.coordinates);
                by.norm() < SAME_BRANCH
            };
            if !found.iter().any(is_known) {
                found.push(closed);
            }
            if found.len() >= ENOUGH {
                break;
            }
        }
        let distance = |one: &Closure| self.distance(&one.coordinates);
        Ok(found.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))))
    }

    /// Displacement of the free coordinates, in radians and characteristic lengths.
    fn displacement(&self, from: &DVector<f64>, to: &DVector<f64>) -> DVector<f64> {
        let by = self.system.kinematics().displacement(from, to);
        DVector::from_iterator(self.free.len(), self.free.iter().map(|&k| by[k] / self.units[k]))
    }

    fn distance(&self, to: &DVector<f64>) -> f64 {
        self.displacement(self.system.home(), to).norm()
    }

    /// Closes the loops; coordinates beyond their limits are put on them and held there. Where this does not close, angles beyond take another turn, and a few loops are closed at second order.
    fn closed_from(&self, from: DVector<f64>) -> Result<Option<Closure>, Error> {
        let found = match self.closed_by(from.clone(), |_, angle| angle)? {
            Attempt { closure: None, can_turn: true } => {
                let turned = |k, angle| self.turned_within(k, angle).unwrap_or(angle);
                self.closed_by(from.clone(), turned)?.closure
            }
            Attempt { closure, .. } => closure,
        };
        match found {
            None if !has_many_loops(&self.system) => self.closed_at_second_order(from),
            found => Ok(found),
        }
    }

    /// Closes the loops by moving links.
    fn closed_by_links(&self, mut from: DVector<f64>) -> Result<Option<Closure>, Error> {
        clamp(&mut from, &self.free, &self.limits);
        let found = close_by_links(&self.system, &self.free, from, MAX_ITERATIONS)?;
        if found.is_closed() { self.closed_from(found.coordinates) } else { Ok(None) }
    }

    /// Closes the loops where corrections of first order miss closed configurations nearby, or end beyond limits.
    fn closed_at_second_order(&self, mut from: DVector<f64>) -> Result<Option<Closure>, Error> {
        clamp(&mut from, &self.free, &self.limits);
        let near = near_miss_at(&self.system.moved_to(from)?, &self.free)?;
        if near.is_closed() {
            let mechanism = self.system.kinematics().mechanism();
            let is_within = within_limits(mechanism, &self.free, &near.coordinates);
            return Ok(is_within.then_some(near));
        }
        close_at_second_order(&self.system, &self.free, &near)
    }

    /// Closes the loops; coordinates beyond their limits are put on them and held there.
    ///
    /// # Arguments
    /// * `turned` – the angle of a coordinate for its angle nearest the guess
    fn closed_by(
        &self,
        mut from: DVector<f64>,
        turned: impl Fn(usize, f64) -> f64,
    ) -> Result<Attempt, Error> {
        clamp(&mut from, &self.free, &self.limits);
        let mut free = self.free.clone();
        let mut iterations = 0;
        let mut can_turn = false;
        for _ in 0..MAX_CLAMPINGS {
            let found = close_from_far(&self.system, &free, from, MAX_ITERATIONS)?;
            iterations += found.iterations;
            if !found.is_closed() {
                break;
            }
            let mut coordinates = found.coordinates;
            for &k in self.turns.iter().filter(|k| free.contains(k)) {
                coordinates[k] = turned(k, nearest_angle(coordinates[k], self.system.home()[k]));
            }
            let mechanism = self.system.kinematics().mechanism();
            let beyond = mechanism.beyond_limits(&coordinates);
            let beyond = |k: &usize| beyond.iter().any(|one| one.coordinate == *k);
            if !free.iter().any(beyond) {
                let closure = Some(Closure { coordinates, iterations, ..found });
                return Ok(Attempt { closure, can_turn });
            }
            let turns = |k: &usize| beyond(k) && self.turned_within(*k, coordinates[*k]).is_some();
            can_turn |= self.turns.iter().any(turns);
            clamp(&mut coordinates, &self.free, &self.limits);
            free.retain(|k| !beyond(k));
            from = coordinates;
        }
        Ok(Attempt { closure: None, can_turn })
    }

    /// The same angle within its limits, if it is there at this turn, the next or the last.
    fn turned_within(&self, k: usize, angle: f64) -> Option<f64> {
        let [least, greatest] = self.limits[k]?;
        let others = [angle, angle + TAU, angle - TAU];
        others.into_iter().find(|angle| (least..=greatest).contains(angle))
    }

    /// Moves a closed configuration towards the guess, as far as the loops and the limits allow.
    fn approached(&self, closed: Closure) -> Result<Closure, Error> {
        let mut here = closed;
        for _ in 0..MAX_STEPS {
            let towards = self.displacement(&here.coordinates, self.system.home());
            let leaves = |k: usize, by: f64| {
                self.limits[k].is_some_and(|limits @ [least, greatest]| {
                    let slack = ROUND_OFF * range_scale(limits);
                    let value = here.coordinates[k];
                    (by < 0.0 && value <= least + slack) || (by > 0.0 && value >= greatest - slack)
                })
            };
            let (free, towards): (Vec<usize>, Vec<f64>) = self
                .free
                .iter()
                .copied()
                .zip(towards.iter().copied())
                .filter(|&(k, by)| !leaves(k, by))
                .unzip();
            let towards = DVector::from_vec(towards);
            let along = self.tangential(&here.coordinates, &free, &towards)?;
            let distance = self.distance(&here.coordinates);
            if along.norm() <= STATIONARY * (STATIONARY + distance) {
                break;
            }
            let Some(nearer) = self.nearer(&here.coordinates, &free, &along, distance)? else {
                break;
            };
            here = Closure { iterations: here.iterations + nearer.iterations, ..nearer };
        }
        Ok(here)
    }

    /// The part of a small displacement that the loops allow.
    fn tangential(
        &self,
        at: &DVector<f64>,
        free: &[usize],
        displacement: &DVector<f64>,
    ) -> Result<DVector<f64>, Error> {
        if free.is_empty() {
            return Ok(displacement.clone());
        }
        let system = self.system.moved_to(at.clone())?;
        let rows = units(&system.constraint_dimensions(), system.characteristic_length());
        let columns = DVector::from_iterator(free.len(), free.iter().map(|&k| self.units[k]));
        let jacobian = system.full_jacobian(&system.at_home()).select_columns(free);
        let jacobian = scaled_jacobian(&jacobian, &rows, &columns);
        let decomposition = svd(&jacobian)?;
        let rank = decomposition.rank(RANK);
        Ok(displacement - decomposition.solve(&(&jacobian * displacement), rank))
    }

    /// A closed configuration nearer the guess, in a direction.
    fn nearer(
        &self,
        at: &DVector<f64>,
        free: &[usize],
        along: &DVector<f64>,
        distance: f64,
    ) -> Result<Option<Closure>, Error> {
        let mut share = 1.0;
        while share >= SHORTEST_STEP {
            let mut by = DVector::zeros(at.len());
            free.iter()
                .zip(along.iter())
                .for_each(|(&k, step)| by[k] = share * step * self.units[k]);
            let found = self.closed_from(self.system.kinematics().moved(at, &by))?;
            let is_nearer = |one: &Closure| {
                self.distance(&one.coordinates) < distance * (1.0 - STATIONARY * STATIONARY)
            };
            if let Some(found) = found.filter(is_nearer) {
                return Ok(Some(found));
            }
            share *= 0.5;
        }
        Ok(None)
    }
}
