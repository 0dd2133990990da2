//! Positions that differ by whole revolutions of links.

use std::array::from_fn;
use std::f64::consts::TAU;

use jointplay_core::spatial::nearest_angle;
use nalgebra::Vector4;

use super::decomposition::{Decomposition, Pair};
use crate::robot::arm_chain::ArmVector;

/// Largest number of combinations of revolutions that are tried; axes of at most ten revolutions have fewer on any usual arm.
const MAX_CANDIDATES: i64 = 20_000;

/// Tolerance of limits for round-off, as a fraction of the ranges.
const LIMIT_TOLERANCE: f64 = 1e-12;

/// Distance of two positions that are one, as a fraction of half of the ranges.
const SAME_POSITION: f64 = 1e-6;

/// Limits of the axes of an arm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranges {
    pub(super) min: ArmVector,
    pub(super) max: ArmVector,
    pub(super) count: usize,
}

impl Ranges {
    pub(super) fn middle(&self, axis: usize) -> f64 {
        0.5 * (self.min[axis] + self.max[axis])
    }

    /// Whether positions of the axes are within limits.
    pub(super) fn contain(&self, arm_positions: &ArmVector) -> bool {
        (0..self.count).all(|a| (self.min[a]..=self.max[a]).contains(&arm_positions[a]))
    }

    pub(super) fn half(&self, axis: usize) -> f64 {
        0.5 * (self.max[axis] - self.min[axis])
    }
}

/// The lattice of whole revolutions: positions a + Σ_m k_m generator_m are one pose for whole numbers k.
#[derive(Debug, Clone, Copy)]
pub(super) struct Revolutions {
    generators: [Vector4<f64>; 4],
    /// k = duals · a
    duals: [Vector4<f64>; 4],
    count: usize,
}

impl Decomposition {
    /// Unknowns of the same pose, nearest to other unknowns.
    #[inline]
    pub(super) fn wrapped(&self, unknown: &ArmVector, seed: &ArmVector) -> ArmVector {
        let mut wrapped = *unknown;
        for (r, (wrapped, seed)) in wrapped.iter_mut().zip(seed).enumerate() {
            if self.is_angle(r) && (r != 1 || matches!(self.pair, Pair::Links(_))) {
                *wrapped = nearest_angle(*wrapped, *seed);
            }
        }
        if let Pair::Belt(..) = self.pair {
            // The third link rotates by the mean: both unknowns change by one revolution, or one of them by two, its half by one.
            let other = unknown[1] + wrapped[0] - unknown[0];
            wrapped[1] = 2.0 * nearest_angle(0.5 * other, 0.5 * seed[1]);
        }
        wrapped
    }

    /// Least and largest extension of the free prismatic joint between limits (m).
    pub(super) fn extension_range(&self, ranges: &Ranges) -> [f64; 2] {
        let mut range = [0.0; 2];
        let Some(slide) = self.slide else { return range };
        for a in 0..ranges.count {
            let slope = self.forward[(slide.unknown, a)];
            let ends = [slope * ranges.min[a], slope * ranges.max[a]];
            range[0] += ends[0].min(ends[1]);
            range[1] += ends[0].max(ends[1]);
        }
        range
    }
}

impl Revolutions {
    pub(super) fn of(decomposition: &Decomposition) -> Self {
        let mut revolutions =
            Self { generators: [Vector4::zeros(); 4], duals: [Vector4::zeros(); 4], count: 0 };
        let row = |r: usize| decomposition.forward.row(r).transpose() / TAU;
        let column = |r: usize| decomposition.inverse.column(r) * TAU;
        let mut add = |generator: Vector4<f64>, dual: Vector4<f64>| {
            revolutions.generators[revolutions.count] = generator;
            revolutions.duals[revolutions.count] = dual;
            revolutions.count += 1;
        };
        match decomposition.pair {
            Pair::Links(_) => {
                add(column(0), row(0));
                add(column(1), row(1));
            }
            // The third link rotates by the mean: both unknowns change by one revolution, or one of them by two.
            Pair::Belt(..) => {
                add(column(0) + column(1), row(0));
                add(column(1) * 2.0, (row(1) - row(0)) * 0.5);
            }
            Pair::Prismatic(_) => add(column(0), row(0)),
        }
        for r in (2..decomposition.count).filter(|&r| decomposition.is_angle(r)) {
            add(column(r), row(r));
        }
        revolutions
    }

    fn shifted(&self, arm_positions: &ArmVector, k: &[i64; 4]) -> ArmVector {
        let mut shifted = Vector4::from(*arm_positions);
        for (generator, &k) in self.generators.iter().zip(k).take(self.count) {
            shifted += generator * k as f64;
        }
        shifted.into()
    }

    /// Positions of the same pose, nearest to other positions.
    fn nearest(&self, arm_positions: &ArmVector, to: &ArmVector) -> ArmVector {
        let away = Vector4::from(*to) - Vector4::from(*arm_positions);
        let mut k = [0; 4];
        for (k, dual) in k.iter_mut().zip(&self.duals).take(self.count) {
            *k = dual.dot(&away).round() as i64;
        }
        self.shifted(arm_positions, &k)
    }

    /// Amount by which an axis exceeds its limits once it is shifted by revolutions; negative within them.
    #[inline]
    fn beyond(&self, arm_positions: &ArmVector, k: &[f64; 4], ranges: &Ranges, axis: usize) -> f64 {
        let [a, b, c, d] = &self.generators;
        let shift = (a[axis] * k[0] + b[axis] * k[1]) + (c[axis] * k[2] + d[axis] * k[3]);
        let position = arm_positions[axis] + shift;
        f64::max(ranges.min[axis] - position, position - ranges.max[axis])
    }

    /// All positions of the poses of several positions that are within limits, each once.
    pub(super) fn all_within(&self, positions: &[ArmVector], ranges: &Ranges) -> Vec<ArmVector> {
        let mut all: Vec<ArmVector> = Vec::new();
        let is_same = |one: &ArmVector, other: &ArmVector| {
            (0..ranges.count).all(|a| (one[a] - other[a]).abs() <= SAME_POSITION * ranges.half(a))
        };
        for arm_positions in positions {
            self.within(arm_positions, ranges, |found| {
                if all.iter().all(|known| !is_same(known, found)) {
                    all.push(*found);
                }
            });
        }
        all
    }

    /// Calls a function with all positions of the same pose within limits; where there are none, with those that exceed them least.
    pub(super) fn within(
        &self,
        arm_positions: &ArmVector,
        ranges: &Ranges,
        mut each: impl FnMut(&ArmVector),
    ) {
        let (mut low, mut high) = ([0_i64; 4], [0_i64; 4]);
        let mut combinations = 1_i64;
        for m in 0..self.count {
            let (mut least, mut most) = (0.0, 0.0);
            for (a, now) in arm_positions.iter().enumerate().take(ranges.count) {
                let ends = [ranges.min[a] - now, ranges.max[a] - now];
                let products = ends.map(|end| end * self.duals[m][a]);
                least += products[0].min(products[1]);
                most += products[0].max(products[1]);
            }
            // The bounds are widened by round-off, for positions on a limit.
            (low[m], high[m]) = ((least - 1e-9).ceil() as i64, (most + 1e-9).floor() as i64);
            combinations = combinations.saturating_mul((high[m] - low[m] + 1).max(0));
        }
        let mut found = false;
        if combinations <= MAX_CANDIDATES {
            let tolerance: ArmVector =
                from_fn(|a| LIMIT_TOLERANCE * (ranges.max[a] - ranges.min[a]));
            for_each(&low[..self.count], &high[..self.count], |k| {
                let revolutions = k.map(|k| k as f64);
                if (0..ranges.count)
                    .all(|a| self.beyond(arm_positions, &revolutions, ranges, a) <= tolerance[a])
                {
                    found = true;
                    each(&self.shifted(arm_positions, k));
                }
            });
        }
        if found {
            return;
        }
        let mut middle = [0.0; 4];
        for (a, middle) in middle.iter_mut().enumerate().take(ranges.count) {
            *middle = ranges.middle(a);
        }
        let about = self.nearest(arm_positions, &middle);
        let (mut best, mut least) = ([0; 4], f64::INFINITY);
        let weights: ArmVector = from_fn(|a| 1.0 / (ranges.max[a] - ranges.min[a]));
        let (low, high) = ([-1; 4], [1; 4]);
        for_each(&low[..self.count], &high[..self.count], |k| {
            let (revolutions, mut excess) = (k.map(|k| k as f64), 0.0);
            for (a, weight) in weights.iter().enumerate().take(ranges.count) {
                excess += self.beyond(&about, &revolutions, ranges, a).max(0.0) * weight;
                if excess >= least {
                    return;
                }
            }
            (best, least) = (*k, excess);
        });
        each(&self.shifted(&about, &best));
    }
}

/// All vectors of whole numbers within a box.
fn for_each(low: &[i64], high: &[i64], mut each: impl FnMut(&[i64; 4])) {
    if low.iter().zip(high).any(|(low, high)| low > high) {
        return;
    }
    let mut k = [0; 4];
    k[..low.len()].copy_from_slice(low);
    loop {
        each(&k);
        let Some(next) = (0..low.len()).find(|&m| k[m] < high[m]) else { return };
        k[next] += 1;
        k[..next].copy_from_slice(&low[..next]);
    }
}
