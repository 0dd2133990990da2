//! Positions of a redundant arm that are nearest to its present ones.

use nalgebra::{Matrix2, Vector2};

use super::{Candidate, MAX_STEP, MIN_STEP, Redundant, STARTS};
use crate::robot::arm_chain::ArmVector;
use crate::robot::inverse::solution::Configuration;

/// Largest number of descent steps; two to four are usual.
const MAX_ITERATIONS: usize = 30;
/// Largest number of halvings of a step.
const MAX_HALVINGS: usize = 12;
/// Step of the free unknowns for derivatives (rad or m).
const DIFFERENCE_STEP: f64 = 1e-5;

impl Redundant<'_> {
    /// The positions of a given configuration that are nearest to the present ones:
    ///
    /// ```text
    ///    min Σ (a − a_present)² / h²        a: positions of the axes,   h: halves of their ranges
    /// ```
    /// a local minimum, by the Gauss–Newton method on the free unknowns.
    pub(in crate::robot::inverse) fn nearest(
        &self,
        configuration: Configuration,
    ) -> Option<ArmVector> {
        let here = self.candidate([self.seed[2], self.seed[3]], configuration, &self.seed);
        let start = || STARTS.iter().find_map(|&count| self.start(count, configuration));
        let mut now = here.or_else(start)?;
        let mut squared = self.squared_distance(&now);
        for _ in 0..MAX_ITERATIONS {
            let Some(step) = self.step_to_nearest(&now, configuration) else { break };
            let mut step = step * (MAX_STEP / step.amax()).min(1.0);
            let nearer = (0..MAX_HALVINGS).find_map(|_| {
                let free = [now.unknown[2] + step[0], now.unknown[3] + step[1]];
                step *= 0.5;
                let next = self.candidate(free, configuration, &now.unknown)?;
                (self.squared_distance(&next) < squared).then_some(next)
            });
            let Some(next) = nearer else { break };
            now = next;
            squared = self.squared_distance(&now);
            if 2.0 * step.amax() < MIN_STEP {
                break;
            }
        }
        Some(self.decomposition.positions(&now.unknown))
    }

    /// Differences from the present positions, in halves of the ranges.
    fn differences(&self, place: &Candidate) -> super::PerAxis {
        std::array::from_fn(|a| {
            let change = |r: usize| self.by_unknown[r][a] * (place.unknown[r] - self.seed[r]);
            (change(0) + change(1)) + (change(2) + change(3))
        })
    }

    fn squared_distance(&self, place: &Candidate) -> f64 {
        self.differences(place).iter().map(|change| change * change).sum()
    }

    /// Gauss–Newton step of the free unknowns.
    fn step_to_nearest(
        &self,
        now: &Candidate,
        configuration: Configuration,
    ) -> Option<Vector2<f64>> {
        let here = self.differences(now);
        let mut slopes = [super::PerAxis::default(); 2];
        for f in (0..2).filter(|&f| self.is_free[f]) {
            let at = |offset: f64| {
                let mut free = [now.unknown[2], now.unknown[3]];
                free[f] += offset;
                let found = self.candidate(free, configuration, &now.unknown)?;
                Some(self.differences(&found))
            };
            let (before, after) = (at(-DIFFERENCE_STEP)?, at(DIFFERENCE_STEP)?);
            slopes[f] = std::array::from_fn(|a| (after[a] - before[a]) / (2.0 * DIFFERENCE_STEP));
        }
        let product = |one: &super::PerAxis, other: &super::PerAxis| {
            one.iter().zip(other).map(|(one, other)| one * other).sum::<f64>()
        };
        let [p, q] = &slopes;
        let mut normal = Matrix2::new(product(p, p), product(p, q), product(p, q), product(q, q));
        for f in (0..2).filter(|&f| !self.is_free[f]) {
            normal[(f, f)] = 1.0;
        }
        let gradient = Vector2::new(product(p, &here), product(q, &here));
        Some(-(normal.try_inverse()? * gradient))
    }
}
