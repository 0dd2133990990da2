//! Search for the largest squared rate within constraints: a primal-dual interior-point method.

use pulp::Arch;

use super::rate_constraints::{Bound, RateConstraints, Row, Sides};
use super::rate_lanes::{
    COEFFICIENTS, Coefficients, Derivatives, LANES, Lanes, dot, lanes, solve_banded,
};
use super::squared_rate::{RateGrid, SquaredRate};
use crate::extrema::raise;

/// Largest number of iterations.
const MAX_ITERATIONS: usize = 40;
/// Products of slacks and multipliers, summed and relative to the duration, at which the first solution starts.
const FIRST_GAP: f64 = 0.4;
/// Factor by which the products of slacks and multipliers are to decrease in one iteration.
const CENTERING: f64 = 0.1;
/// Fraction of the distance to the nearest bound that one iteration may use.
const STEP_FRACTION: f64 = 0.99;
/// Factor by which a step is shortened until the jerk, which is not linear, is within its bound.
const SHORTENING: f64 = 0.7;
/// Largest number of shortenings.
const MAX_SHORTENINGS: usize = 40;
/// Factor by which the squared rate of a start is lowered until it is feasible.
const SLOWDOWN: f64 = 0.97;
/// Largest number of slowdowns.
const MAX_SLOWDOWNS: usize = 100;

/// The search for the squared rate with the shortest duration.
///
/// Minimizes ∫ du/√x within [`RateConstraints`]; the bound of the jerk is replaced by its tangent in each iteration (the convex–concave procedure).
///
/// # Source
/// \[Verscheure\] for the formulation without jerk; \[LippBoyd\] for the tangents; \[NocedalWright\], chapter 19, for the method
pub(super) struct RateSearch<'a> {
    coefficients: Coefficients,
    slacks: Vec<Sides>,
    multipliers: Vec<Sides>,
    /// Multipliers of the sign of each coefficient.
    signs: Coefficients,
    constraints: RateConstraints<'a>,
}

/// Direction of a step, and the change of everything along it.
struct Step {
    coefficients: Coefficients,
    multipliers: Vec<Sides>,
    signs: Coefficients,
    /// Largest admissible fraction, one for coefficients and multipliers: the step then reduces the gradient of the Lagrange function too, without which small products of slacks and multipliers prove nothing.
    fraction: f64,
}

impl<'a> RateSearch<'a> {
    /// A search that starts with a constant rate.
    pub(super) fn new(constraints: RateConstraints<'a>) -> Option<Self> {
        Self::started(constraints, [1.0; COEFFICIENTS], FIRST_GAP)
    }

    /// A search that starts with another solution, slowed until it is feasible.
    ///
    /// # Arguments
    /// * `gap` – relative excess of the duration over the least one that the search starts with
    pub(super) fn continued(
        constraints: RateConstraints<'a>,
        solution: &SquaredRate<'_>,
        gap: f64,
    ) -> Option<Self> {
        let start = solution.coefficients.map(|value| value / constraints.unit);
        Self::started(constraints, start, gap)
    }

    /// A search from given coefficients; `None` where no slowdown makes them feasible, because numbers overflow.
    fn started(
        constraints: RateConstraints<'a>,
        coefficients: Coefficients,
        gap: f64,
    ) -> Option<Self> {
        Arch::new().dispatch(
            #[inline(always)]
            move || Self::started_by_lanes(constraints, coefficients, gap),
        )
    }

    #[inline(always)]
    fn started_by_lanes(
        constraints: RateConstraints<'a>,
        mut coefficients: Coefficients,
        gap: f64,
    ) -> Option<Self> {
        let mut slacks = vec![[[0.0; LANES]; 2]; constraints.rows.len()];
        let mut slowdowns = 0;
        while !constraints.slacks(&coefficients, &mut slacks) {
            coefficients = coefficients.map(|value| SLOWDOWN * value);
            slowdowns += 1;
            if slowdowns > MAX_SLOWDOWNS {
                return None;
            }
        }
        let count = constraints.bounds + COEFFICIENTS;
        let product = gap * duration(constraints.path.grid, &coefficients) / count as f64;
        let mut multipliers = slacks.clone();
        for (row, multipliers) in constraints.rows.iter().zip(&mut multipliers) {
            let active = row.active.as_flattened();
            for (multiplier, active) in multipliers.as_flattened_mut().iter_mut().zip(active) {
                *multiplier = active * product / *multiplier;
            }
        }
        let signs = coefficients.map(|value| product / value);
        Some(Self { coefficients, slacks, multipliers, signs, constraints })
    }

    /// Iterates until the duration exceeds the least one by at most a fraction, for linearized constraints; once at least: a search may start with that fraction.
    pub(super) fn solved(self, gap: f64) -> Self {
        // By the instructions that the processor has: the search is moved into the closure, which is inlined only so.
        Arch::new().dispatch(
            #[inline(always)]
            move || self.solved_by_lanes(gap),
        )
    }

    #[inline(always)]
    fn solved_by_lanes(mut self, gap: f64) -> Self {
        let count = self.constraints.bounds + COEFFICIENTS;
        let mut products = self.products();
        for _ in 0..MAX_ITERATIONS {
            let step = self.step(CENTERING * products / count as f64);
            if !self.apply(&step) {
                break;
            }
            products = self.products();
            if products < gap * duration(self.constraints.path.grid, &self.coefficients) {
                break;
            }
        }
        self
    }

    /// The squared rate that was found.
    pub(super) fn solution(&self) -> SquaredRate<'a> {
        let RateConstraints { path, unit, .. } = self.constraints;
        let coefficients = self.coefficients.map(|value| value * unit);
        SquaredRate { grid: path.grid, coefficients }
    }

    /// Sum of the products of slacks and multipliers: the duality gap of the linearized problem.
    #[inline(always)]
    fn products(&self) -> f64 {
        let [slacks, multipliers] = [&self.slacks, &self.multipliers].map(|sides| numbers(sides));
        dot(slacks, multipliers) + dot(&self.coefficients, &self.signs)
    }

    /// Newton step toward the point at which all products of slacks and multipliers have one value.
    #[inline(always)]
    fn step(&self, target: f64) -> Step {
        // Second derivatives, and the negative gradient.
        let mut derivatives = Derivatives::ZERO;
        self.add_duration(&mut derivatives);
        let RateConstraints { path, counts, rows, .. } = &self.constraints;
        let mut rows = rows.iter().zip(&self.slacks).zip(&self.multipliers);
        for (block, &count) in path.blocks.iter().zip(counts) {
            let [x, ..] = block.values(&self.coefficients);
            let by_rate = jerk_tangent(&x);
            // Gradient and upper triangle of the second derivatives.
            let mut sums = [[0.0; LANES]; 9];
            for ((row, slacks), [above, below]) in rows.by_ref().take(count) {
                let [k0, k1, k2] = &row.coefficients;
                let tangent = row.bound.tangent(&by_rate);
                let [inverse_above, inverse_below] = inverse(row, slacks);
                let [g0, g1, g2, h00, h01, h02, h11, h12, h22] = &mut sums;
                for k in 0..LANES {
                    let weights = [above[k] * inverse_above[k], below[k] * inverse_below[k]];
                    let (sum, difference) = (weights[0] + weights[1], weights[1] - weights[0]);
                    let pull = target * (inverse_below[k] - inverse_above[k]);
                    let push = target * tangent[k] * (inverse_above[k] + inverse_below[k]);
                    let across = sum * k0[k] + difference * tangent[k];
                    let along = difference * k0[k] + sum * tangent[k];
                    g0[k] += pull * k0[k] + push;
                    g1[k] += pull * k1[k];
                    g2[k] += pull * k2[k];
                    h00[k] += across * k0[k] + tangent[k] * along;
                    h01[k] += across * k1[k];
                    h02[k] += across * k2[k];
                    h11[k] += sum * k1[k] * k1[k];
                    h12[k] += sum * k1[k] * k2[k];
                    h22[k] += sum * k2[k] * k2[k];
                }
            }
            let [g0, g1, g2, h00, h01, h02, h11, h12, h22] = sums;
            let hessian = [[h00, h01, h02], [h01, h11, h12], [h02, h12, h22]];
            block.add_derivatives(&[g0, g1, g2], &hessian, &mut derivatives);
        }
        let (mut matrix, mut right) = derivatives.assembled();
        for k in 0..COEFFICIENTS {
            let inverse = 1.0 / self.coefficients[k];
            right[k] += target * inverse;
            matrix[0][k] += self.signs[k] * inverse;
        }
        solve_banded(matrix, &mut right);
        self.step_along(right, target)
    }

    /// Adds the slope and the curvature of the duration.
    #[inline(always)]
    fn add_duration(&self, to: &mut Derivatives) {
        for points in self.constraints.path.grid.quadrature() {
            let [x] = points.basis.values(&self.coefficients);
            let (mut slope, mut curvature) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                slope[k] = 0.5 * points.weights[k] / (x[k] * x[k].sqrt());
                curvature[k] = 1.5 * slope[k] / x[k];
            }
            points.basis.add_derivatives(&[slope], &[[curvature]], to);
        }
    }

    /// Changes of multipliers, and the largest fractions of the step.
    #[inline(always)]
    fn step_along(&self, direction: Coefficients, target: f64) -> Step {
        let mut step = Step {
            coefficients: direction,
            multipliers: self.multipliers.clone(),
            signs: self.signs,
            fraction: 1.0,
        };
        // Reciprocal of the fraction at which the first slack or multiplier is zero.
        let mut divisor = [0.0; LANES];
        let RateConstraints { path, counts, rows, .. } = &self.constraints;
        let mut rows = rows.iter().zip(&self.slacks).zip(&mut step.multipliers);
        for (block, &count) in path.blocks.iter().zip(counts) {
            let [x, ..] = block.values(&self.coefficients);
            let by_rate = jerk_tangent(&x);
            let changes = block.values(&direction);
            for ((row, slacks), multipliers) in rows.by_ref().take(count) {
                let value = row.value(&changes);
                let tangent = row.bound.tangent(&by_rate);
                let inverse = inverse(row, slacks);
                for (side, multipliers) in multipliers.iter_mut().enumerate() {
                    let sign = [-1.0, 1.0][side];
                    for k in 0..LANES {
                        let slack_change = tangent[k] * changes[0][k] + sign * value[k];
                        let inverse = inverse[side][k];
                        let multiplier = &mut multipliers[k];
                        change(&mut divisor[k], target, inverse, slack_change, multiplier);
                    }
                }
            }
        }
        let mut largest = 0.0;
        let values = self.coefficients.iter().zip(&direction);
        for ((&value, &change_of_value), sign) in values.zip(&mut step.signs) {
            change(&mut largest, target, 1.0 / value, change_of_value, sign);
        }
        divisor.into_iter().for_each(|other| raise(&mut largest, other));
        step.fraction = (STEP_FRACTION / largest).min(1.0);
        step
    }

    /// Applies a step as far as all slacks stay positive; `false` where they do not.
    #[inline(always)]
    fn apply(&mut self, step: &Step) -> bool {
        let mut fraction = step.fraction;
        let before = self.coefficients;
        let mut is_feasible = false;
        for _ in 0..MAX_SHORTENINGS {
            for (k, value) in self.coefficients.iter_mut().enumerate() {
                *value = before[k] + fraction * step.coefficients[k];
            }
            is_feasible = self.constraints.slacks(&self.coefficients, &mut self.slacks);
            if is_feasible {
                break;
            }
            fraction *= SHORTENING;
        }
        if !is_feasible {
            self.coefficients = before;
            return false;
        }
        let multipliers = self.multipliers.as_flattened_mut().as_flattened_mut().iter_mut();
        for (multiplier, change) in multipliers.zip(numbers(&step.multipliers)) {
            *multiplier += fraction * change;
        }
        for (sign, change) in self.signs.iter_mut().zip(&step.signs) {
            *sign += fraction * change;
        }
        true
    }
}

impl Bound {
    /// Slopes of the bound, from those of a bound of the jerk.
    #[inline(always)]
    fn tangent(self, by_rate: &Lanes) -> Lanes {
        if self == Self::Jerk { *by_rate } else { [0.0; LANES] }
    }
}

/// Slopes of a bound of the jerk at squared rates.
#[inline(always)]
fn jerk_tangent(x: &Lanes) -> Lanes {
    lanes(|k| -0.5 / (x[k] * x[k].sqrt()))
}

/// Reciprocals of the slacks of a row, zero where there is no constraint.
#[inline(always)]
fn inverse(row: &Row, slacks: &Sides) -> Sides {
    std::array::from_fn(|side| lanes(|k| row.active[side][k] / slacks[side][k]))
}

/// Replaces a multiplier by its change, by the change of its slack.
///
/// # Arguments
/// * `divisor` – raised to the reciprocal of the fraction of the step at which slack or multiplier is zero; NaN, of places without a constraint, is passed over
/// * `inverse` – reciprocal of the slack
#[inline(always)]
fn change(divisor: &mut f64, target: f64, inverse: f64, slack_change: f64, multiplier: &mut f64) {
    let relative = slack_change * inverse;
    let change = target * inverse - *multiplier * (relative + 1.0);
    raise(divisor, -relative);
    raise(divisor, -change / *multiplier);
    *multiplier = change;
}

/// All numbers of the bounds of several rows.
#[inline(always)]
fn numbers(sides: &[Sides]) -> &[f64] {
    sides.as_flattened().as_flattened()
}

/// Duration of the path in the unit of time of the constraints.
#[inline(always)]
fn duration(grid: &RateGrid, coefficients: &Coefficients) -> f64 {
    let mut durations = [0.0; LANES];
    for points in grid.quadrature() {
        let [x] = points.basis.values(coefficients);
        for k in 0..LANES {
            durations[k] += points.weights[k] / x[k].sqrt();
        }
    }
    durations.into_iter().sum()
}
