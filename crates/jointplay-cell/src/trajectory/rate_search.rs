//! Search for the largest squared rate within constraints: a primal-dual interior-point method.

use super::rate_constraints::{Bound, RateConstraints, Slacks};
use super::squared_rate::{
    COEFFICIENTS, INTERVALS, QuadraturePoint, RateGrid, SquaredRate, product,
};
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
/// Coefficients of the squared rate.
pub(super) type Coefficients = [f64; COEFFICIENTS];

/// A symmetric matrix with two diagonals above the main one: element k of each row is in column row + k.
type Banded = [[f64; 3]; COEFFICIENTS];

/// The search for the squared rate with the shortest duration.
///
/// Minimizes ∫ du/√x within [`RateConstraints`]; the bound of the jerk is replaced by its tangent in each iteration (the convex–concave procedure).
///
/// # Source
/// \[Verscheure\] for the formulation without jerk; \[LippBoyd\] for the tangents; \[NocedalWright\], chapter 19, for the method
pub(super) struct RateSearch<'a> {
    coefficients: Coefficients,
    slacks: Slacks,
    multipliers: Slacks,
    /// Multipliers of the sign of each coefficient.
    signs: Coefficients,
    constraints: RateConstraints<'a>,
}

/// Direction of a step, and the change of everything along it.
struct Step {
    coefficients: Coefficients,
    multipliers: Slacks,
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
        let mut start = [1.0; COEFFICIENTS];
        for (own, other) in start.iter_mut().zip(&solution.coefficients) {
            *own = other / constraints.unit;
        }
        Self::started(constraints, start, gap)
    }

    /// A search from given coefficients; `None` where no slowdown makes them feasible, because numbers overflow.
    fn started(
        constraints: RateConstraints<'a>,
        mut coefficients: Coefficients,
        gap: f64,
    ) -> Option<Self> {
        let rows = vec![[0.0; 2]; constraints.rows.len()];
        let mut slacks = Slacks { rows, knots: [1.0; INTERVALS + 1] };
        let mut slowdowns = 0;
        while !constraints.slacks(&coefficients, &mut slacks) {
            coefficients = coefficients.map(|value| SLOWDOWN * value);
            slowdowns += 1;
            if slowdowns > MAX_SLOWDOWNS {
                return None;
            }
        }
        let count = 2 * constraints.rows.len() + INTERVALS - 1 + COEFFICIENTS;
        let product = gap * duration(constraints.grid, &coefficients) / count as f64;
        let mut multipliers = slacks.clone();
        for multiplier in
            multipliers.rows.as_flattened_mut().iter_mut().chain(&mut multipliers.knots)
        {
            *multiplier = product / *multiplier;
        }
        let signs = coefficients.map(|value| product / value);
        Some(Self { coefficients, slacks, multipliers, signs, constraints })
    }

    /// Iterates until the duration exceeds the least one by at most a fraction, for linearized constraints; once at least: a search may start with that fraction.
    pub(super) fn solve(&mut self, gap: f64) {
        let count = 2 * self.constraints.rows.len() + INTERVALS - 1 + COEFFICIENTS;
        let mut products = self.products();
        for _ in 0..MAX_ITERATIONS {
            let step = self.step(CENTERING * products / count as f64);
            if !self.apply(&step) {
                return;
            }
            products = self.products();
            if products < gap * duration(self.constraints.grid, &self.coefficients) {
                return;
            }
        }
    }

    /// The squared rate that was found.
    pub(super) fn solution(&self) -> SquaredRate<'a> {
        let unit = self.constraints.unit;
        SquaredRate {
            grid: self.constraints.grid,
            coefficients: self.coefficients.iter().map(|value| value * unit).collect(),
        }
    }

    /// Sum of the products of slacks and multipliers: the duality gap of the linearized problem.
    fn products(&self) -> f64 {
        let rows = self.slacks.rows.as_flattened().iter().zip(self.multipliers.rows.as_flattened());
        let knots =
            self.slacks.knots[1..INTERVALS].iter().zip(&self.multipliers.knots[1..INTERVALS]);
        let signs = self.coefficients.iter().zip(&self.signs);
        rows.chain(knots).chain(signs).map(|(slack, multiplier)| slack * multiplier).sum()
    }

    /// Newton step toward the point at which all products of slacks and multipliers have one value.
    fn step(&self, target: f64) -> Step {
        let mut matrix: Banded = [[0.0; 3]; COEFFICIENTS];
        let mut right = [0.0; COEFFICIENTS];
        self.add_duration(&mut matrix, &mut right);
        let rows = self.constraints.rows.iter().zip(&self.slacks.rows).zip(&self.multipliers.rows);
        let mut rows = rows.map(|((row, slacks), multipliers)| (row, slacks, multipliers));
        for point in &self.constraints.points {
            let x = product(&point.basis[0], &self.coefficients[point.interval..]);
            let tangent = tangent(point.bound, x);
            let mut gradient = [0.0; 3];
            // Upper triangle, row by row.
            let mut hessian = [0.0; 6];
            for (row, slacks, multipliers) in rows.by_ref().take(point.rows) {
                let [k0, k1, k2] = *row;
                let inverse = slacks.map(|slack| 1.0 / slack);
                let weights = [multipliers[0] * inverse[0], multipliers[1] * inverse[1]];
                let (sum, difference) = (weights[0] + weights[1], weights[1] - weights[0]);
                let pull = target * (inverse[1] - inverse[0]);
                let across = sum * k0 + difference * tangent;
                gradient[0] += pull * k0 + target * tangent * (inverse[0] + inverse[1]);
                gradient[1] += pull * k1;
                gradient[2] += pull * k2;
                hessian[0] += across * k0 + tangent * (difference * k0 + sum * tangent);
                hessian[1] += across * k1;
                hessian[2] += across * k2;
                hessian[3] += sum * k1 * k1;
                hessian[4] += sum * k1 * k2;
                hessian[5] += sum * k2 * k2;
            }
            let [h00, h01, h02, h11, h12, h22] = hessian;
            let [b0, b1, b2] = &point.basis;
            for a in 0..3 {
                right[point.interval + a] +=
                    gradient[0] * b0[a] + gradient[1] * b1[a] + gradient[2] * b2[a];
                let along = [
                    h00 * b0[a] + h01 * b1[a] + h02 * b2[a],
                    h01 * b0[a] + h11 * b1[a] + h12 * b2[a],
                    h02 * b0[a] + h12 * b1[a] + h22 * b2[a],
                ];
                for b in a..3 {
                    matrix[point.interval + a][b - a] +=
                        along[0] * b0[b] + along[1] * b1[b] + along[2] * b2[b];
                }
            }
        }
        for knot in 1..INTERVALS {
            let inverse = 1.0 / self.slacks.knots[knot];
            let [first, second] = self.constraints.grid.knot_weights(knot);
            let weight = self.multipliers.knots[knot] * inverse;
            right[knot] -= first * target * inverse;
            right[knot + 1] -= second * target * inverse;
            matrix[knot][0] += weight * first * first;
            matrix[knot][1] += weight * first * second;
            matrix[knot + 1][0] += weight * second * second;
        }
        for k in 0..COEFFICIENTS {
            right[k] += target / self.coefficients[k];
            matrix[k][0] += self.signs[k] / self.coefficients[k];
        }
        solve_banded(matrix, &mut right);
        self.step_along(right, target)
    }

    /// Adds the gradient and the curvature of the duration.
    fn add_duration(&self, matrix: &mut Banded, right: &mut Coefficients) {
        for point in self.constraints.grid.quadrature() {
            let (interval, weights) = (point.interval, point.basis);
            let x = product(&weights, &self.coefficients[interval..]);
            let slope = 0.5 * point.weight / (x * x.sqrt());
            let curvature = 1.5 * slope / x;
            for a in 0..3 {
                right[interval + a] += slope * weights[a];
                for b in a..3 {
                    matrix[interval + a][b - a] += curvature * weights[a] * weights[b];
                }
            }
        }
    }

    /// Changes of multipliers, and the largest fractions of the step.
    fn step_along(&self, direction: Coefficients, target: f64) -> Step {
        let mut step = Step {
            coefficients: direction,
            multipliers: self.multipliers.clone(),
            signs: self.signs,
            fraction: 1.0,
        };
        // Reciprocal of the fraction.
        let mut divisor = 1.0_f64;
        // Change of a multiplier by the change of its slack.
        let mut change = |slack: f64, slack_change: f64, multiplier: &mut f64| {
            let inverse = 1.0 / slack;
            let relative = slack_change * inverse;
            let change = target * inverse - *multiplier * (relative + 1.0);
            raise(&mut divisor, -relative / STEP_FRACTION);
            // Compared before it is divided by: few multipliers limit the step.
            let most = STEP_FRACTION * *multiplier;
            if -change > divisor * most {
                divisor = -change / most;
            }
            *multiplier = change;
        };
        let mut rows =
            self.constraints.rows.iter().zip(&self.slacks.rows).zip(&mut step.multipliers.rows);
        for point in &self.constraints.points {
            let x = product(&point.basis[0], &self.coefficients[point.interval..]);
            let tangent = tangent(point.bound, x);
            let own = &direction[point.interval..];
            let [x, x1, x2] = point.basis.map(|weights| product(&weights, own));
            for ((row, slacks), multipliers) in rows.by_ref().take(point.rows) {
                let value = row[0] * x + row[1] * x1 + row[2] * x2;
                change(slacks[0], tangent * x - value, &mut multipliers[0]);
                change(slacks[1], tangent * x + value, &mut multipliers[1]);
            }
        }
        for knot in 1..INTERVALS {
            let slack_change = -self.constraints.at_knot(knot, &direction);
            change(self.slacks.knots[knot], slack_change, &mut step.multipliers.knots[knot]);
        }
        let values = self.coefficients.iter().zip(&direction);
        for ((&value, &change_of_value), sign) in values.zip(&mut step.signs) {
            change(value, change_of_value, sign);
        }
        step.fraction = divisor.recip();
        step
    }

    /// Applies a step as far as all slacks stay positive; `false` where they do not.
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
        let multipliers = self.multipliers.rows.as_flattened_mut().iter_mut();
        let multipliers = multipliers.chain(&mut self.multipliers.knots).chain(&mut self.signs);
        let changes = step.multipliers.rows.as_flattened().iter();
        let changes = changes.chain(&step.multipliers.knots).chain(&step.signs);
        for (multiplier, change) in multipliers.zip(changes) {
            *multiplier += fraction * change;
        }
        true
    }
}

/// Slope of a bound at a squared rate.
fn tangent(bound: Bound, x: f64) -> f64 {
    if bound == Bound::Jerk { -0.5 / (x * x.sqrt()) } else { 0.0 }
}

/// Duration of the path in the unit of time of the constraints.
fn duration(grid: &RateGrid, coefficients: &Coefficients) -> f64 {
    let duration = |point: &QuadraturePoint| {
        point.weight / product(&point.basis, &coefficients[point.interval..]).sqrt()
    };
    grid.quadrature().iter().map(duration).sum()
}

/// Solves a linear system with a positive definite matrix, in place.
fn solve_banded(mut matrix: Banded, right: &mut Coefficients) {
    // Factors L D Lᵀ: D in the first element of each row, the columns of L in the others.
    for k in 0..COEFFICIENTS {
        let [diagonal, first, second] = matrix[k];
        let (l1, l2) = (first / diagonal, second / diagonal);
        matrix[k] = [diagonal, l1, l2];
        if k + 1 < COEFFICIENTS {
            matrix[k + 1][0] -= l1 * first;
            matrix[k + 1][1] -= l1 * second;
            right[k + 1] -= l1 * right[k];
        }
        if k + 2 < COEFFICIENTS {
            matrix[k + 2][0] -= l2 * second;
            right[k + 2] -= l2 * right[k];
        }
        right[k] /= diagonal;
    }
    for k in (0..COEFFICIENTS - 1).rev() {
        right[k] -= matrix[k][1] * right[k + 1];
        if k + 2 < COEFFICIENTS {
            right[k] -= matrix[k][2] * right[k + 2];
        }
    }
}
