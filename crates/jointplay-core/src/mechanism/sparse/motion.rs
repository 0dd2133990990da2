//! Closing and driving by sparse algebra.

use std::ops::ControlFlow;

use nalgebra::DVector;

use super::linear::Linear;
use super::system::SparseSystem;
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, Dimension};
use crate::mechanism::motion::{DEAD, MAX_CORRECTIONS, go_on, on_branch};
use crate::mechanism::{Drive, DrivePath, DrivenMotion, Stop, Waypoint};
use crate::mobility::RANK_THRESHOLD;

/// Residual that ends the corrections, unless the chains are so long that round-off is more.
const CLOSED: f64 = 0.01 * CLOSURE_TOLERANCE;
/// Changes of a step below this share of it end the iteration: Newton's method corrects the rest.
const SETTLED: f64 = 1e-6;
/// Corrections that are cut to less than this share, and those that gain nothing, are repeated with joints that resist.
const LEAST_SHARE: f64 = 0.1;
/// The least resistance of joints, for each unit of the gap, and the largest: a correction that gains nothing then has none to gain.
const FIRST_RESISTANCE: f64 = 0.01;
const MOST_RESISTANCE: f64 = 1e4;
/// Factor by which the resistance grows and declines.
const CHANGE: f64 = 3.0;
/// Resistance of joints that hardly move at all.
const RIGID: f64 = 0.999;
/// The longest step of a coordinate, in radians and characteristic lengths: more than the distance for which motions are followed, which can be one step.
const LONGEST_STEP: f64 = 0.31;
/// The shortest step, as a share of the whole path: drives that cannot move so far are locked.
const SHORTEST_STEP: f64 = 1e-5;

impl SparseSystem<'_> {
    /// Corrects links and coordinates until all joints are closed, by Gauss–Newton steps of least norm; returns how many.
    ///
    /// Near singular configurations, where such steps are too long, joints resist: steps of Levenberg and Marquardt.
    ///
    /// # Arguments
    /// * `held` – indices of the coordinates that keep their values; virtual joints always do
    ///
    /// # Errors
    /// [`Error::NotReached`]: the system is then as near as it came.
    pub fn close(&mut self, held: &[usize], max_iterations: usize) -> Result<usize, Error> {
        let held = self.held(held.iter().copied());
        self.hold(&held);
        self.correct(&held, max_iterations, &mut None).map(|(iterations, _)| iterations)
    }

    /// Closes all joints; returns the steps done and the largest displacement of a coordinate.
    ///
    /// # Arguments
    /// * `former` – closures of which only the memory is used
    fn correct(
        &mut self,
        held: &[bool],
        max_iterations: usize,
        former: &mut Option<Linear>,
    ) -> Result<(usize, f64), Error> {
        #[expect(clippy::cast_precision_loss, reason = "a count of links")]
        let closed = CLOSED.max(f64::EPSILON * self.poses.len() as f64).min(CLOSURE_TOLERANCE);
        let mut gap = self.gap();
        let (mut iterations, mut moved) = (0, DVector::zeros(self.coordinates.len()));
        // Whether the former closures are those of the configuration before.
        let (mut is_near, mut before) = (false, f64::INFINITY);
        // Of the joints, for each unit of the norm of the gap.
        let mut resistance = 0.0;
        while gap.largest > closed && iterations < max_iterations && resistance < MOST_RESISTANCE {
            // Newton's steps square the residual; by the last factor the next one still takes a share as large as the last step left.
            let is_last = is_near && 2.0 * gap.largest * gap.largest / before <= closed;
            let linear = match former.take() {
                Some(last) if is_last => last,
                spare => self.linear(held, (resistance * gap.norm).min(RIGID), spare)?,
            };
            iterations += 1;
            let (x, by) = self.least_step(&linear, None);
            *former = Some(linear);
            is_near = false;
            let share = (LONGEST_STEP / self.largest(&by)).min(1.0);
            let (there, reached) = self.displaced((&x * share).as_slice(), &(&by * share));
            if reached.norm < gap.norm && share >= LEAST_SHARE {
                moved += &by * share;
                let stalled =
                    gap.largest <= CLOSURE_TOLERANCE && reached.largest > 0.5 * gap.largest;
                (*self, before, gap) = (there, gap.largest, reached);
                if stalled {
                    break;
                }
                is_near = resistance == 0.0;
                resistance /= CHANGE;
                if resistance < FIRST_RESISTANCE {
                    resistance = 0.0;
                }
            } else if gap.largest <= CLOSURE_TOLERANCE {
                // Only round-off is left.
                break;
            } else if !is_last {
                resistance = (CHANGE * resistance).max(FIRST_RESISTANCE);
            }
        }
        let residual = gap.largest;
        if residual <= CLOSURE_TOLERANCE {
            Ok((iterations, self.largest(&moved)))
        } else {
            Err(Error::NotReached { residual, allowed: CLOSURE_TOLERANCE, iterations })
        }
    }

    /// Twists of links and rates of coordinates that close the linearized joints while the drives move.
    fn least_step(
        &self,
        linear: &Linear,
        drives: Option<&DVector<f64>>,
    ) -> (DVector<f64>, DVector<f64>) {
        let mut beyond = self.mismatches();
        if let Some(drives) = drives {
            for j in 0..linear.joints.len() {
                for k in self.kinematics.columns_of(j).filter(|&k| drives[k] != 0.0) {
                    let (angular, linear) = &linear.screws[k];
                    let twist = self.scaled(angular, linear);
                    beyond.fixed_rows_mut::<6>(6 * j).axpy(drives[k], &twist, 1.0);
                }
            }
        }
        let rates = |x: &DVector<f64>| {
            let mut rates = linear.rates(x.as_slice(), &beyond, self.coordinates.len());
            if let Some(drives) = drives {
                rates += drives;
            }
            rates
        };
        let mut open = linear.violated(&beyond, &rates(&DVector::zeros(linear.size())));
        let mut of_couplings = open.rows_mut(6 * linear.joints.len(), linear.couplings.len());
        of_couplings += self.violations();
        let x = linear.solve_least(&-open, SETTLED);
        let by = rates(&x);
        (x, by)
    }

    /// The largest displacement of a coordinate, in radians and characteristic lengths.
    pub(super) fn largest(&self, by: &DVector<f64>) -> f64 {
        let sizes =
            by.iter().zip(self.kinematics.dimensions()).map(|(value, dimension)| match dimension {
                Dimension::Angle => value.abs(),
                Dimension::Length | Dimension::SquaredLength => value.abs() / self.length,
            });
        sizes.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Moves some coordinates by steps whose corrections stay small; returns the share done.
    ///
    /// # Arguments
    /// * `path` – (f + M) displacement of each driven coordinate; zero for those that follow
    /// * `here` – the closures linearized at this configuration
    /// * `former` – closures of which only the memory is used
    pub(super) fn follow(
        &mut self,
        path: &DVector<f64>,
        held: &[bool],
        here: &Linear,
        step: &mut f64,
        shortest: f64,
        former: &mut Option<Linear>,
    ) -> Result<f64, Error> {
        let mut done = 0.0;
        // The closures linearized where steps ended.
        let mut reached: Option<Linear> = None;
        while done < 1.0 {
            let share = if done + *step > 1.0 - 0.01 * shortest { 1.0 - done } else { *step };
            let linear = reached.as_ref().unwrap_or(here);
            let (x, by) = self.least_step(linear, Some(&(path * share)));
            let size = self.largest(&by);
            let (mut there, _) = self.displaced(x.as_slice(), &by);
            let stayed = size <= LONGEST_STEP
                && matches!(
                    there.correct(held, MAX_CORRECTIONS, former),
                    Ok((_, moved)) if on_branch(moved, size)
                );
            if stayed {
                *self = there;
                done = if share == 1.0 - done { 1.0 } else { done + share };
                *step *= 2.0;
                if done < 1.0 {
                    reached = Some(self.linear(held, 0.0, reached.take())?);
                }
            } else {
                *step *= 0.5;
                if *step < shortest {
                    break;
                }
            }
        }
        Ok(done)
    }

    /// Drives coordinates to their values along a straight line, as [`crate::mechanism::drive`] does.
    ///
    /// # Arguments
    /// * `drives` – target values; all are reached at the same time
    /// * `held` – indices of other coordinates that keep their values
    /// * `count` – number of steps to report
    ///
    /// # Errors
    /// [`Error::NotReached`] if the start does not close.
    /// A motion that stops is not an error: see [`DrivenMotion::stopped`].
    ///
    /// # Numerics
    /// Least singular values are computed at each waypoint, but singular configurations between them are not looked for.
    pub fn drive(
        self,
        drives: &[Drive],
        held: &[usize],
        count: usize,
    ) -> Result<DrivenMotion, Error> {
        let path = DrivePath::line(&self.coordinates, drives)?;
        self.drive_along(&path, held, count, &mut |_| ControlFlow::Continue(()))
    }

    /// Drives coordinates along a path, as [`crate::mechanism::drive_along`] does.
    ///
    /// # Arguments
    /// * `held` – indices of other coordinates that keep their values
    /// * `count` – number of steps to report; the drives are straight within each
    /// * `progress` – called again and again, with the number of reported steps that are done; ends the motion by [`ControlFlow::Break`]
    ///
    /// # Errors
    /// [`Error::Interrupted`]; those of [`Self::drive`].
    pub fn drive_along(
        mut self,
        path: &DrivePath,
        held: &[usize],
        count: usize,
        progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> Result<DrivenMotion, Error> {
        let held = self.held(path.coordinates().iter().chain(held).copied());
        self.hold(&held);
        let mut former = None;
        self.correct(&held, MAX_CORRECTIONS, &mut former)?;
        let mut here = self.linear(&held, 0.0, None)?;
        let first = self.waypoint(0.0, &here, None)?;
        let regular = first.free_mobility;
        let mut motion =
            DrivenMotion { waypoints: vec![first], singular: Vec::new(), stopped: None, steps: 0 };
        let mut step = 1.0;
        #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
        for k in 1..=count {
            let mut part = DVector::zeros(self.coordinates.len());
            for (coordinate, to) in path.values_at(k as f64 / count as f64) {
                part[coordinate] = to - self.coordinates[coordinate];
            }
            motion.steps += 1;
            let done = self.follow(&part, &held, &here, &mut step, SHORTEST_STEP, &mut former)?;
            let share = (k as f64 - 1.0 + done) / count as f64;
            if done == 1.0 {
                // Sums of many steps would be off by round-off.
                for (coordinate, to) in path.values_at(share) {
                    self.coordinates[coordinate] = to;
                }
            }
            here = self.linear(&held, 0.0, Some(here))?;
            motion.waypoints.push(self.waypoint(share, &here, Some(regular))?);
            if done < 1.0 {
                let least = |w: &Waypoint| w.least_singular_value;
                let dead = motion
                    .waypoints
                    .last()
                    .is_some_and(|last| least(last) < DEAD * least(&motion.waypoints[0]).min(1.0));
                motion.stopped = Some(if dead { Stop::Locked } else { Stop::Incompatible });
                break;
            }
            go_on(progress(k))?;
        }
        Ok(motion)
    }

    /// The present configuration, of which these are the closures, as a waypoint.
    fn waypoint(
        &self,
        share: f64,
        linear: &Linear,
        regular: Option<usize>,
    ) -> Result<Waypoint, Error> {
        let spectrum = linear.smallest(RANK_THRESHOLD, regular.map_or(2, |h| h + 1))?;
        let free = spectrum.zeros;
        let least =
            spectrum.values.get(regular.unwrap_or(free)).copied().unwrap_or(spectrum.largest);
        Ok(Waypoint {
            share,
            coordinates: self.coordinates.clone(),
            residual: self.residual(),
            free_mobility: free,
            least_singular_value: least / spectrum.largest.max(f64::MIN_POSITIVE),
        })
    }
}
