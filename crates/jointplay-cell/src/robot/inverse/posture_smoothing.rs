//! Smoothing of postures along a path by descent of its cost over the free angles.

use std::array::from_fn;

use nalgebra::{DMatrix, DVector};

use super::posture_search::{CURVATURE_WEIGHT, LIMIT_WEIGHT, Posture, PostureSearch};
use crate::robot::arm_chain::ArmVector;

/// Step of the free angles for derivatives (rad).
const DIFFERENCE_STEP: f64 = 1e-5;
/// Damping of the first descent step, and its limits, as a fraction of the diagonal.
const FIRST_DAMPING: f64 = 1e-3;
const MIN_DAMPING: f64 = 1e-9;
const MAX_DAMPING: f64 = 1e9;
/// Largest number of descent steps.
const MAX_ITERATIONS: usize = 60;
/// Fraction of the cost below which a gain ends the descent.
const RELATIVE_TOLERANCE: f64 = 1e-5;

/// Levenberg–Marquardt descent of the cost of a path over its free angles.
pub(super) struct Smoothing<'a> {
    pub(super) search: &'a PostureSearch<'a>,
    pub(super) fractions: &'a [f64],
    pub(super) postures: Vec<Posture>,
}

/// Derivatives of the positions, and of the root of the cost of limits, by the free angles of one posture.
#[derive(Clone, Copy, Default)]
struct PostureSlopes {
    arm_positions: [ArmVector; 2],
    root_cost: [f64; 2],
}

impl Smoothing<'_> {
    pub(super) fn run(&mut self) {
        let free: Vec<usize> = (0..2).filter(|&f| self.search.is_free[f]).collect();
        if free.is_empty() {
            return;
        }
        let mut damping = FIRST_DAMPING;
        let mut cost = self.residuals().norm_squared();
        for _ in 0..MAX_ITERATIONS {
            let residuals = self.residuals();
            let jacobian = self.jacobian(&free, residuals.len());
            let gradient = jacobian.tr_mul(&residuals);
            let normal = jacobian.tr_mul(&jacobian);
            let mut improved = None;
            while damping < MAX_DAMPING {
                let mut damped = normal.clone();
                for k in 0..damped.nrows() {
                    damped[(k, k)] *= 1.0 + damping;
                    damped[(k, k)] += f64::MIN_POSITIVE;
                }
                let step = damped.cholesky().map(|factors| factors.solve(&-&gradient));
                if let Some(found) = step.and_then(|step| self.moved(&free, &step)) {
                    let before = std::mem::replace(&mut self.postures, found);
                    let now = self.residuals().norm_squared();
                    if now < cost {
                        improved = Some((cost - now) / cost);
                        cost = now;
                        damping = (damping * 0.1).max(MIN_DAMPING);
                        break;
                    }
                    self.postures = before;
                }
                damping *= 10.0;
            }
            if improved.is_none_or(|gain| gain < RELATIVE_TOLERANCE) {
                break;
            }
        }
    }

    /// The postures after a step of all free angles; `None` where one cannot be reached, or jumps.
    fn moved(&self, free: &[usize], step: &DVector<f64>) -> Option<Vec<Posture>> {
        let moved = self.postures.iter().enumerate().map(|(k, posture)| {
            let mut angles = posture.free;
            for (row, &f) in free.iter().enumerate() {
                angles[f] += step[k * free.len() + row];
            }
            self.search.posture_near(self.fractions[k], angles, posture)
        });
        let moved = moved.collect::<Option<Vec<Posture>>>()?;
        let continuous = moved.windows(2).all(|pair| self.search.is_continuous(&pair[0], &pair[1]));
        continuous.then_some(moved)
    }

    /// Weighted differences of the positions, so that the sum of their squares is the cost of the path.
    fn residuals(&self) -> DVector<f64> {
        let step = self.step();
        let [first, second] = difference_weights(step);
        let inverse_speed = &self.search.inverse_speed;
        let arm_positions =
            |k: usize, a: usize| self.postures[k].arm_positions[a] * inverse_speed[a];
        let mut residuals = Vec::new();
        for a in 0..self.search.ranges.count {
            let from_home = self.postures[0].arm_positions[a] - self.search.home[a];
            residuals.push(self.search.home_weights[a] * from_home);
        }
        for (k, posture) in self.postures.iter().enumerate() {
            residuals.push((LIMIT_WEIGHT * step * posture.cost).sqrt());
            for a in 0..self.search.ranges.count {
                if k > 0 {
                    residuals.push(first * (arm_positions(k, a) - arm_positions(k - 1, a)));
                }
                if k > 1 {
                    let bend = arm_positions(k, a) - 2.0 * arm_positions(k - 1, a)
                        + arm_positions(k - 2, a);
                    residuals.push(second * bend);
                }
            }
        }
        DVector::from_vec(residuals)
    }

    /// Derivatives of the residuals with respect to the free angles, in the order of both.
    #[expect(
        clippy::needless_range_loop,
        reason = "the axes of several arrays, of which only the first ones are used"
    )]
    fn jacobian(&self, free: &[usize], rows: usize) -> DMatrix<f64> {
        let step = self.step();
        let [first, second] = difference_weights(step);
        let inverse_speed = &self.search.inverse_speed;
        let slopes: Vec<PostureSlopes> = (0..self.postures.len()).map(|k| self.slopes(k)).collect();
        let mut jacobian = DMatrix::zeros(rows, self.postures.len() * free.len());
        let mut row = 0;
        let mut add =
            |row: usize, k: usize, factor: f64, of: &dyn Fn(&PostureSlopes, usize) -> f64| {
                for (column, &f) in free.iter().enumerate() {
                    jacobian[(row, k * free.len() + column)] += factor * of(&slopes[k], f);
                }
            };
        for a in 0..self.search.ranges.count {
            add(row, 0, self.search.home_weights[a], &|slopes, f| slopes.arm_positions[f][a]);
            row += 1;
        }
        for k in 0..self.postures.len() {
            add(row, k, (LIMIT_WEIGHT * step).sqrt(), &|slopes, f| slopes.root_cost[f]);
            row += 1;
            for a in 0..self.search.ranges.count {
                let of = |slopes: &PostureSlopes, f: usize| {
                    slopes.arm_positions[f][a] * inverse_speed[a]
                };
                if k > 0 {
                    add(row, k, first, &of);
                    add(row, k - 1, -first, &of);
                    row += 1;
                }
                if k > 1 {
                    add(row, k, second, &of);
                    add(row, k - 1, -2.0 * second, &of);
                    add(row, k - 2, second, &of);
                    row += 1;
                }
            }
        }
        jacobian
    }

    /// Derivatives at one posture by central differences; one-sided at the end of what can be reached.
    fn slopes(&self, k: usize) -> PostureSlopes {
        let here = &self.postures[k];
        let mut slopes = PostureSlopes::default();
        for f in (0..2).filter(|&f| self.search.is_free[f]) {
            let at = |offset: f64| {
                let mut angles = here.free;
                angles[f] += offset;
                self.search.posture_near(self.fractions[k], angles, here)
            };
            let [(low, before), (high, after)] = [-DIFFERENCE_STEP, DIFFERENCE_STEP]
                .map(|offset| at(offset).map_or((0.0, *here), |found| (offset, found)));
            if high > low {
                let by = 1.0 / (high - low);
                slopes.arm_positions[f] =
                    from_fn(|a| (after.arm_positions[a] - before.arm_positions[a]) * by);
                slopes.root_cost[f] = (after.cost.sqrt() - before.cost.sqrt()) * by;
            }
        }
        slopes
    }

    fn step(&self) -> f64 {
        1.0 / (self.fractions.len() - 1) as f64
    }
}

/// Weights of first and second differences of neighbouring samples.
fn difference_weights(step: f64) -> [f64; 2] {
    [step.powf(-0.5), (CURVATURE_WEIGHT / (step * step * step)).sqrt()]
}
