//! Redundancy resolution of arms whose free motor is a slide.

use std::array::from_fn;
use std::f64::consts::TAU;

use super::{Candidate, Redundant};
use crate::robot::inverse::barrier::{MAX_BARRIERS, Model, PerAxis, QuadraticModel};
use crate::robot::inverse::solution::Configuration;

/// Step of free unknowns for derivatives by differences (rad or m).
const DIFFERENCE_STEP: f64 = 1e-4;

impl Redundant<'_> {
    /// As [`Self::start`], for an arm with a free extension, by the revolutions of least cost.
    pub(super) fn start_with_extension(
        &self,
        count: usize,
        configuration: Configuration,
    ) -> Option<Candidate> {
        let [least, most] = self.decomposition.extension_range(self.ranges);
        let value = |unknown: usize, k: usize| {
            if self.decomposition.is_angle(unknown) {
                TAU * k as f64 / count as f64
            } else {
                least + (most - least) * (k as f64 + 0.5) / count as f64
            }
        };
        let counts = self.is_free.map(|is_free| if is_free { count } else { 1 });
        let mut best: Option<Candidate> = None;
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                let free = [value(2, i), value(3, j)];
                let Some(found) = self.candidate(free, configuration, &self.seed) else { continue };
                let found = self.wrapped_to_limits(found);
                if best.is_none_or(|best| found.cost < best.cost) {
                    best = Some(found);
                }
            }
        }
        best
    }

    /// Second-order model of the cost by differences, for arms with a free extension.
    pub(super) fn difference_model(&self, now: &Candidate) -> Option<Model> {
        let free = self.is_free;
        let numbers = |steps: [f64; 2]| {
            let at = from_fn(|f| now.unknown[2 + f] + DIFFERENCE_STEP * steps[f]);
            let found = self.candidate(at, now.found.configuration, &now.unknown)?;
            let ends = self.ends(&found.found).map(|end| end[0]);
            Some((found.normalized_positions, ends))
        };
        let (limits, ends) = numbers([0.0, 0.0])?;
        let still = |ends: [f64; MAX_BARRIERS]| ends.map(|_| 0.0);
        let mut model = Model {
            limits: QuadraticModel {
                values: limits,
                slopes: [PerAxis::default(); 2],
                curvatures: [PerAxis::default(); 3],
            },
            ends: QuadraticModel {
                values: ends,
                slopes: [still(ends); 2],
                curvatures: [still(ends); 3],
            },
            poles: self.poles,
            free,
        };
        for f in (0..2).filter(|&f| free[f]) {
            let along = |step: f64| from_fn(|k| if k == f { step } else { 0.0 });
            let (before, after) = (numbers(along(-1.0))?, numbers(along(1.0))?);
            model.limits.slopes[f] = slope(&before.0, &after.0);
            model.ends.slopes[f] = slope(&before.1, &after.1);
            model.limits.curvatures[2 * f] = curvature(&before.0, &limits, &after.0);
            model.ends.curvatures[2 * f] = curvature(&before.1, &ends, &after.1);
        }
        if free == [true; 2] {
            let corners = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
            let [a, b, c, d] = corners.map(numbers);
            let (a, b, c, d) = (a?, b?, c?, d?);
            let high = (slope(&b.0, &a.0), slope(&b.1, &a.1));
            let low = (slope(&d.0, &c.0), slope(&d.1, &c.1));
            model.limits.curvatures[1] = slope(&low.0, &high.0);
            model.ends.curvatures[1] = slope(&low.1, &high.1);
        }
        Some(model)
    }
}

/// Central difference of numbers at two steps from a place.
fn slope<const N: usize>(before: &[f64; N], after: &[f64; N]) -> [f64; N] {
    from_fn(|k| (after[k] - before[k]) / (2.0 * DIFFERENCE_STEP))
}

/// Second difference of numbers at two steps from a place.
fn curvature<const N: usize>(before: &[f64; N], here: &[f64; N], after: &[f64; N]) -> [f64; N] {
    from_fn(|k| (after[k] - 2.0 * here[k] + before[k]) / (DIFFERENCE_STEP * DIFFERENCE_STEP))
}
