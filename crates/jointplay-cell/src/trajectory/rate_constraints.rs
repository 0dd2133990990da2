//! Constraints of all axes, and of the friction of wafers, on the squared rate of a path at collocation points.

use super::spline::Spline;
use super::squared_rate::{Basis, COEFFICIENTS, INTERVALS, RateGrid, product};
use crate::extrema::{raise, smaller};
use crate::robot::{AxesMotion, KinematicLimits};

/// Fractions of the first and last interval at which the jerk is constrained besides its ends: jerk and acceleration start from rest there, and the constraint is strongly curved.
const END_FRACTIONS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Fractions of every other interval at which the jerk is constrained.
const INNER_FRACTIONS: [f64; 2] = [0.0, 1.0];
/// A constraint is omitted where all its coefficients are below this fraction of those of another axis.
const DOMINATED_FRACTION: f64 = 0.3;
/// Fraction of the largest constant squared rate that the search starts with.
const START_FRACTION: f64 = 0.7;

/// Bound of a constraint.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Bound {
    /// 1
    Acceleration,
    /// 1/√x
    Jerk,
    /// 1 above, none below.
    Friction,
}

impl Bound {
    /// Largest value and, below zero, largest magnitude, at a squared rate.
    fn values(self, x: f64) -> [f64; 2] {
        match self {
            Self::Acceleration => [1.0; 2],
            Self::Jerk => [1.0 / x.sqrt(); 2],
            Self::Friction => [1.0, UNBOUNDED],
        }
    }
}

/// Magnitude that no constraint reaches.
const UNBOUNDED: f64 = 1e6;

/// Coefficients k₀ and k₁ of the constraints k₀ x + k₁ x' ≤ 1 at a place of a path, from the positions of all axes and their first two derivatives with respect to u; `None` where no squared rate satisfies them.
pub(crate) type FrictionConstraints<'a> = dyn Fn(&AxesMotion<'_>) -> Option<Vec<[f64; 2]>> + 'a;

/// A collocation point, and its constraints on |k₀ x + k₁ x' + k₂ x''|.
pub(super) struct CollocationPoint {
    /// Interval of the spline, which is the index of its first coefficient.
    pub(super) interval: usize,
    pub(super) basis: Basis,
    pub(super) bound: Bound,
    /// Number of rows; those of all points are in a common list.
    pub(super) rows: usize,
}

/// Exceedance of the limits of acceleration and jerk by each axis in each interval of an earlier solution, as ratios.
pub(super) struct Exceedance {
    axes: usize,
    ratios: Vec<[f64; 2]>,
}

impl Exceedance {
    pub(super) fn none(axes: usize) -> Self {
        Self { axes, ratios: vec![[1.0; 2]; axes * INTERVALS] }
    }

    /// Ratios of all axes in an interval.
    pub(super) fn in_interval(&mut self, interval: usize) -> &mut [[f64; 2]] {
        &mut self.ratios[interval * self.axes..][..self.axes]
    }

    /// Multiplies the ratios by those of another solution.
    pub(super) fn accumulate(&mut self, other: &Self) {
        for (ratio, other) in self.ratios.iter_mut().zip(&other.ratios) {
            *ratio = [ratio[0] * other[0], ratio[1] * other[1]];
        }
    }
}

/// Constraints on the coefficients of the squared rate, in a unit of time in which a constant rate of 1 is feasible.
pub(super) struct RateConstraints<'a> {
    pub(super) grid: &'a RateGrid,
    pub(super) points: Vec<CollocationPoint>,
    /// k₀, k₁ and k₂ of all constraints.
    pub(super) rows: Vec<[f64; 3]>,
    /// Largest squared rate at each inner knot.
    pub(super) largest: Vec<f64>,
    /// Squared rate that has the value 1 (1/s²).
    pub(super) unit: f64,
}

impl<'a> RateConstraints<'a> {
    /// # Arguments
    /// * `limits` – index and limits of each axis that moves
    /// * `max_rate` – largest rate of the path parameter (1/s)
    /// * `friction` – constraints by the friction of wafers
    pub(super) fn new(
        grid: &'a RateGrid,
        spline: &Spline,
        limits: &[(usize, KinematicLimits)],
        max_rate: f64,
        exceedance: &Exceedance,
        friction: Option<&FrictionConstraints<'_>>,
    ) -> Option<Self> {
        let mut constraints = Self {
            grid,
            points: Vec::new(),
            rows: Vec::new(),
            largest: vec![f64::INFINITY; INTERVALS + 1],
            unit: f64::INFINITY,
        };
        let mut path = PathAtPoint {
            grid,
            spline,
            limits,
            max_rate,
            exceedance,
            derivatives: Vec::new(),
            largest: f64::INFINITY,
        };
        for interval in 0..INTERVALS {
            let is_end = interval == 0 || interval + 1 == INTERVALS;
            let fractions =
                if is_end { END_FRACTIONS.as_slice() } else { INNER_FRACTIONS.as_slice() };
            path.advance(interval, 0.5);
            constraints.add(&path, interval, 0.5, Bound::Acceleration);
            for &fraction in fractions {
                path.advance(interval, fraction);
                constraints.add(&path, interval, fraction, Bound::Jerk);
                if fraction == 0.0 && interval > 0 {
                    constraints.largest[interval] = path.largest;
                    constraints.add(&path, interval, fraction, Bound::Acceleration);
                }
            }
        }
        if let Some(friction) = friction {
            constraints.add_friction(spline, friction)?;
        }
        constraints.normalize();
        Some(constraints)
    }

    /// Adds the constraints by friction at the middle and at the inner ends of all intervals.
    fn add_friction(&mut self, spline: &Spline, friction: &FrictionConstraints<'_>) -> Option<()> {
        for interval in 0..INTERVALS {
            for fraction in [0.0, 0.5] {
                if interval == 0 && fraction == 0.0 {
                    continue;
                }
                let [s, s1, s2, _] = self.grid.path_parameter(interval, fraction);
                let piece = spline.interval(s);
                let [mut positions, mut velocities, mut accelerations] = [const { Vec::new() }; 3];
                for axis in 0..spline.axes() {
                    let [q, q1, q2, _] = spline.jet(piece, axis, s);
                    positions.push(q);
                    velocities.push(q1 * s1);
                    accelerations.push(q2 * s1 * s1 + q1 * s2);
                }
                let [positions, velocities, accelerations] =
                    [&positions, &velocities, &accelerations].map(Vec::as_slice);
                let rows = friction(&AxesMotion { positions, velocities, accelerations })?;
                let most = rows.iter().map(|row| 1.0 / row[0].max(0.0));
                self.unit = most.fold(self.unit, f64::min);
                self.points.push(CollocationPoint {
                    interval,
                    basis: self.grid.basis(interval, fraction),
                    bound: Bound::Friction,
                    rows: rows.len(),
                });
                self.rows.extend(rows.iter().map(|&[k0, k1]| [k0, k1, 0.0]));
            }
        }
        Some(())
    }

    /// Adds a collocation point with the limits of acceleration or jerk of all axes.
    fn add(&mut self, path: &PathAtPoint<'_>, interval: usize, fraction: f64, bound: Bound) {
        let first = self.rows.len();
        let mut largest = 0.0;
        for (axis, ([d1, d2, d3], (_, limits))) in
            path.derivatives.iter().zip(path.limits).enumerate()
        {
            let ratios = path.exceedance.ratios[interval * path.limits.len() + axis];
            let row = if bound == Bound::Jerk {
                let inverse = ratios[1] / limits.jerk;
                [inverse * d3, 1.5 * inverse * d2, 0.5 * inverse * d1]
            } else {
                let inverse = ratios[0] / limits.acceleration;
                [inverse * d2, 0.5 * inverse * d1, 0.0]
            };
            self.rows.push(row);
            raise(&mut largest, row[0].abs());
        }
        // At a constant rate: k₀ x ≤ 1, or k₀ x ≤ 1/√x.
        let most = if bound == Bound::Jerk { largest.powf(-2.0 / 3.0) } else { largest.recip() };
        self.unit = self.unit.min(most);
        let mut kept = first;
        for index in first..self.rows.len() {
            let row = self.rows[index];
            let dominates = |other: &[f64; 3]| {
                other
                    .iter()
                    .zip(&row)
                    .all(|(other, own)| own.abs() <= DOMINATED_FRACTION * other.abs())
            };
            // Rows before this one have moved to the front, without those that are dominated.
            let (before, after) = (&self.rows[first..kept], &self.rows[index + 1..]);
            if !before.iter().chain(after).any(dominates) {
                self.rows[kept] = row;
                kept += 1;
            }
        }
        self.rows.truncate(kept);
        self.points.push(CollocationPoint {
            interval,
            basis: path.grid.basis(interval, fraction),
            bound,
            rows: kept - first,
        });
    }

    /// Changes the unit of time to one in which a constant rate of 1 is feasible.
    fn normalize(&mut self) {
        self.unit = START_FRACTION * self.largest.iter().copied().fold(self.unit, f64::min);
        let (acceleration, jerk) = (self.unit, self.unit * self.unit.sqrt());
        let mut rows = self.rows.iter_mut();
        for point in &self.points {
            let scale = if point.bound == Bound::Jerk { jerk } else { acceleration };
            for row in rows.by_ref().take(point.rows) {
                *row = row.map(|value| scale * value);
            }
        }
        for largest in &mut self.largest {
            *largest /= self.unit;
        }
    }

    /// Squared rate at the start of an interval, or its change.
    pub(super) fn at_knot(&self, knot: usize, coefficients: &[f64; COEFFICIENTS]) -> f64 {
        let [first, second] = self.grid.knot_weights(knot);
        first * coefficients[knot] + second * coefficients[knot + 1]
    }

    /// Slacks of all constraints for coefficients of the squared rate; `false` where one is not positive.
    pub(super) fn slacks(&self, coefficients: &[f64; COEFFICIENTS], slacks: &mut Slacks) -> bool {
        let mut least = coefficients.iter().copied().fold(f64::INFINITY, f64::min);
        let mut rows = self.rows.iter().zip(&mut slacks.rows);
        for point in &self.points {
            let own = &coefficients[point.interval..point.interval + 3];
            let [x, x1, x2] = point.basis.map(|weights| product(&weights, own));
            let [above, below] = point.bound.values(x);
            for (row, slack) in rows.by_ref().take(point.rows) {
                let value = row[0] * x + row[1] * x1 + row[2] * x2;
                *slack = [above - value, below + value];
                for &slack in &*slack {
                    least = smaller(slack, least);
                }
            }
        }
        for knot in 1..INTERVALS {
            slacks.knots[knot] = self.largest[knot] - self.at_knot(knot, coefficients);
            least = least.min(slacks.knots[knot]);
        }
        // NaN passes: the caller rejects profiles whose duration is not finite.
        least > 0.0
    }
}

/// Slacks of all constraints, or their multipliers.
#[derive(Clone)]
pub(super) struct Slacks {
    /// Of the upper and lower bound of each row.
    pub(super) rows: Vec<[f64; 2]>,
    /// Of the largest squared rate at each knot.
    pub(super) knots: [f64; INTERVALS + 1],
}

/// Derivatives of a path by the reparameterization at a collocation point.
struct PathAtPoint<'a> {
    grid: &'a RateGrid,
    spline: &'a Spline,
    limits: &'a [(usize, KinematicLimits)],
    max_rate: f64,
    exceedance: &'a Exceedance,
    /// Q', Q'' and Q''' of each axis that moves.
    derivatives: Vec<[f64; 3]>,
    /// Largest squared rate by the velocity limits.
    largest: f64,
}

impl PathAtPoint<'_> {
    /// Computes everything at a fraction of an interval.
    fn advance(&mut self, interval: usize, fraction: f64) {
        let [s, s1, s2, s3] = self.grid.path_parameter(interval, fraction);
        let piece = self.spline.interval(s);
        self.derivatives.clear();
        let mut largest = self.max_rate / s1;
        for &(axis, limits) in self.limits {
            let [_, q1, q2, q3] = self.spline.jet(piece, axis, s);
            let d1 = q1 * s1;
            let d3 = q3 * s1 * s1 * s1 + 3.0 * q2 * s1 * s2 + q1 * s3;
            self.derivatives.push([d1, q2 * s1 * s1 + q1 * s2, d3]);
            largest = largest.min(limits.velocity / d1.abs());
        }
        self.largest = largest * largest;
    }
}
