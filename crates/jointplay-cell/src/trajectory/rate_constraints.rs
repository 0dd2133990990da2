//! Constraints of all axes, and of the friction of wafers, on the squared rate of a path at collocation points.

use super::collocation::{CollocationPath, CollocationPoint};
use super::rate_lanes::{Coefficients, INTERVALS, LANES, Lanes, lanes};
use crate::extrema::{raise, smaller};

/// A constraint is omitted where all its coefficients are below this fraction of those of another axis.
const DOMINATED_FRACTION: f64 = 0.3;
/// Fraction of the largest constant squared rate that the search starts with.
const START_FRACTION: f64 = 0.7;
/// Magnitude that no constraint reaches.
const UNBOUNDED: f64 = 1e6;

/// Bounds of a constraint, above and, in magnitude, below zero.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Bound {
    /// 1/√x on either side.
    Jerk,
    /// 1 on either side.
    Acceleration,
    /// 1 above, none below: the rate itself, and friction.
    Above,
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
    fn of_interval(&self, interval: usize) -> &[[f64; 2]] {
        &self.ratios[interval * self.axes..][..self.axes]
    }

    /// Ratios of all axes in an interval, to be raised.
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

/// A constraint on k₀ x + k₁ x' + k₂ x'' at one point of each of several successive intervals.
pub(super) struct Row {
    pub(super) bound: Bound,
    /// k₀, k₁ and k₂, zero where there is none.
    pub(super) coefficients: [Lanes; 3],
    /// 1 for each constraint, 0 where there is none, above and below.
    pub(super) active: Sides,
}

impl Row {
    #[inline(always)]
    pub(super) fn value(&self, [x, x1, x2]: &[Lanes; 3]) -> Lanes {
        let [k0, k1, k2] = &self.coefficients;
        lanes(|k| k0[k] * x[k] + k1[k] * x1[k] + k2[k] * x2[k])
    }
}

/// Numbers of the upper and the lower bound of each constraint of a row: slacks, or multipliers.
pub(super) type Sides = [Lanes; 2];

/// Constraints on the coefficients of the squared rate, in a unit of time in which a constant rate of 1 is feasible.
pub(super) struct RateConstraints<'a> {
    pub(super) path: &'a CollocationPath<'a>,
    /// Number of rows of each block of points.
    pub(super) counts: Vec<usize>,
    /// Rows of all blocks.
    pub(super) rows: Vec<Row>,
    /// Number of bounds of all constraints.
    pub(super) bounds: usize,
    /// Squared rate that has the value 1 (1/s²).
    pub(super) unit: f64,
}

impl<'a> RateConstraints<'a> {
    /// # Arguments
    /// * `exceedance` – ratios by which the limits are tightened
    pub(super) fn new(path: &'a CollocationPath<'a>, exceedance: &Exceedance) -> Self {
        let mut constraints = Self {
            path,
            counts: Vec::with_capacity(path.blocks.len()),
            rows: Vec::with_capacity(3 * path.blocks.len()),
            bounds: 0,
            unit: f64::INFINITY,
        };
        let mut of_point = Vec::new();
        for block in 0..path.blocks.len() {
            let before = constraints.rows.len();
            for bound in [Bound::Jerk, Bound::Acceleration, Bound::Above] {
                let first = constraints.rows.len();
                for (lane, (point, derivatives)) in path.points(block).enumerate() {
                    of_point.clear();
                    let at = (point, derivatives);
                    constraints.collect(bound, at, exceedance, &mut of_point);
                    constraints.add(bound, first, lane, &of_point);
                }
            }
            constraints.counts.push(constraints.rows.len() - before);
        }
        constraints.normalize();
        constraints
    }

    /// Collects the constraints of one kind at a point, and limits the unit of time by them.
    fn collect(
        &mut self,
        bound: Bound,
        (point, derivatives): (&CollocationPoint, &[[f64; 3]]),
        exceedance: &Exceedance,
        rows: &mut Vec<[f64; 3]>,
    ) {
        let limits = self.path.limits.iter().map(|(_, limits)| limits);
        let ratios = exceedance.of_interval(point.interval);
        let axes = derivatives.iter().zip(limits).zip(ratios);
        // The largest squared rate is that of a constant rate: k₀ x ≤ 1, or k₀ x ≤ 1/√x.
        let most = match bound {
            Bound::Jerk if point.has_jerk => {
                rows.extend(axes.map(|(([d1, d2, d3], limits), ratios)| {
                    let inverse = ratios[1] / limits.jerk;
                    [inverse * d3, 1.5 * inverse * d2, 0.5 * inverse * d1]
                }));
                largest_first(rows).powf(-2.0 / 3.0)
            }
            Bound::Acceleration if point.has_acceleration => {
                rows.extend(axes.map(|(([d1, d2, _], limits), ratios)| {
                    let inverse = ratios[0] / limits.acceleration;
                    [inverse * d2, 0.5 * inverse * d1, 0.0]
                }));
                largest_first(rows).recip()
            }
            Bound::Above => {
                rows.extend(point.friction.iter().map(|&[k0, k1]| [k0, k1, 0.0]));
                rows.extend(point.max_squared_rate.map(|most| [1.0 / most, 0.0, 0.0]));
                let most = rows.iter().map(|row| 1.0 / row[0].max(0.0));
                most.fold(f64::INFINITY, f64::min)
            }
            _ => return,
        };
        self.unit = self.unit.min(most);
        if bound != Bound::Above {
            remove_dominated(rows);
        }
    }

    /// Adds the constraints of a point to the rows of its block, from the row `first` on.
    fn add(&mut self, bound: Bound, first: usize, lane: usize, constraints: &[[f64; 3]]) {
        for (k, constraint) in constraints.iter().enumerate() {
            if first + k == self.rows.len() {
                let zero = [0.0; LANES];
                self.rows.push(Row { bound, coefficients: [zero; 3], active: [zero; 2] });
            }
            let row = &mut self.rows[first + k];
            for (coefficients, value) in row.coefficients.iter_mut().zip(constraint) {
                coefficients[lane] = *value;
            }
            let sides = if bound == Bound::Above { 1 } else { 2 };
            self.bounds += sides;
            row.active[..sides].iter_mut().for_each(|side| side[lane] = 1.0);
        }
    }

    /// Changes the unit of time to one in which a constant rate of 1 is feasible.
    fn normalize(&mut self) {
        self.unit *= START_FRACTION;
        let (acceleration, jerk) = (self.unit, self.unit * self.unit.sqrt());
        for row in &mut self.rows {
            let scale = if row.bound == Bound::Jerk { jerk } else { acceleration };
            row.coefficients.as_flattened_mut().iter_mut().for_each(|value| *value *= scale);
        }
    }

    /// Slacks of all constraints for coefficients of the squared rate; `false` where one is not positive.
    #[inline(always)]
    pub(super) fn slacks(&self, coefficients: &Coefficients, slacks: &mut [Sides]) -> bool {
        let mut least = [coefficients.iter().copied().fold(f64::INFINITY, f64::min); LANES];
        let mut rows = self.rows.iter().zip(slacks);
        for (block, &count) in self.path.blocks.iter().zip(&self.counts) {
            let values = block.values(coefficients);
            let by_rate = values[0].map(|x| 1.0 / x.sqrt());
            for (row, slacks) in rows.by_ref().take(count) {
                let value = row.value(&values);
                let above = if row.bound == Bound::Jerk { by_rate } else { [1.0; LANES] };
                let below = if row.bound == Bound::Above { [UNBOUNDED; LANES] } else { above };
                for k in 0..LANES {
                    slacks[0][k] = above[k] - value[k];
                    slacks[1][k] = below[k] + value[k];
                    least[k] = smaller(slacks[0][k], least[k]);
                    least[k] = smaller(slacks[1][k], least[k]);
                }
            }
        }
        // NaN passes: the caller rejects profiles whose duration is not finite.
        least.into_iter().all(|least| least > 0.0)
    }
}

/// Largest magnitude of the first coefficient of several constraints.
fn largest_first(rows: &[[f64; 3]]) -> f64 {
    let mut largest = 0.0;
    rows.iter().for_each(|row| raise(&mut largest, row[0].abs()));
    largest
}

/// Removes constraints all of whose coefficients are far below those of another one.
fn remove_dominated(rows: &mut Vec<[f64; 3]>) {
    let mut kept = 0;
    for index in 0..rows.len() {
        let row = rows[index];
        let dominates = |other: &[f64; 3]| {
            let mut pairs = other.iter().zip(&row);
            pairs.all(|(other, own)| own.abs() <= DOMINATED_FRACTION * other.abs())
        };
        // Rows before this one have moved to the front, without those that are dominated.
        let (before, after) = (&rows[..kept], &rows[index + 1..]);
        if !before.iter().chain(after).any(dominates) {
            rows[kept] = row;
            kept += 1;
        }
    }
    rows.truncate(kept);
}
