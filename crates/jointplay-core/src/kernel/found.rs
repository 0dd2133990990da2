//! Virtual joints found, and what all solvers of the kernels share.

use pulp::Simd;

use super::geometry::{Geometry, Task};
use super::lanes::{Lanes, Mask};
use super::model::Model;
use super::shape::{Balls, Three};

/// Steps of Newton's method that are done here: it doubles its digits, and starts with five or more.
pub(super) const NEWTON_STEPS: usize = 8;
/// Steps toward the least displacement that are done here: each gains three digits at 2°, one at 10°.
pub(super) const LEAST_NORM_STEPS: usize = 40;
/// Least share of a pivot that elimination may leave here: less is nearly dependent, and taken with more care elsewhere.
pub(super) const LEAST_PIVOT: f64 = 1e-6;

/// Virtual joints found, where they are, and the steps that it took.
#[derive(Clone, Copy)]
pub(crate) struct Found<S: Simd> {
    /// Coordinates along the directions (m).
    pub(crate) a: Three<S>,
    /// Coordinates across ((m), (rad)).
    pub(crate) b: Three<S>,
    pub(super) gaps: Gaps<S>,
    /// Where the triangle of the sockets is, if its sides are those of the balls to round-off.
    pub(super) laid: Option<Laid<S>>,
    pub(crate) iterations: Lanes<S>,
    /// Where the sides are met by a triangle of the same sense as the base.
    pub(crate) met: Mask<S>,
}

/// A triangle of sockets, seen from O_p in axes of the platform.
#[derive(Clone, Copy)]
pub(super) struct Laid<S: Simd> {
    /// From the first corner to the second, divided by the square of that length (1/m).
    pub(super) side: [Lanes<S>; 2],
    /// Centroid (m).
    pub(super) center: [Lanes<S>; 2],
    /// [`Plane::factors`](super::plane::Plane::factors) of the balls.
    pub(super) factors: [Lanes<S>; 2],
}

/// Numbers that most others of a block wait for, each from a root or a division: with many poses they are computed while the blocks before are finished.
#[derive(Clone, Copy)]
pub(crate) struct Ahead<S: Simd> {
    /// Factor from the triangle of the balls, times a length, to that of the sockets.
    pub(super) scale: Lanes<S>,
    /// One over the square of the first side (1/m²); for the platform.
    pub(super) per_square: Lanes<S>,
    /// [`Plane::factors`](super::plane::Plane::factors) of the balls; for the platform.
    pub(super) factors: [Lanes<S>; 2],
}

impl<S: Simd> Ahead<S> {
    /// Of methods that compute nothing ahead.
    #[inline(always)]
    pub(crate) fn none(any: Lanes<S>) -> Self {
        Self { scale: any, per_square: any, factors: [any; 2] }
    }
}

/// By how much the sides are not met.
#[derive(Clone, Copy)]
pub(super) enum Gaps<S: Simd> {
    /// Difference of each squared side from that of the sockets (m²).
    Squares(Three<S>),
    /// Largest difference between a side and its virtual length (m).
    Largest(Lanes<S>),
}

impl<S: Simd> Found<S> {
    /// Largest difference between a side and its virtual length, see [`Balls::residual`] (m).
    #[inline(always)]
    pub(crate) fn residual(&self, geometry: &Geometry, balls: &Balls<S>) -> Lanes<S> {
        match &self.gaps {
            Gaps::Squares(missing) => balls.residual(geometry, missing),
            Gaps::Largest(residual) => *residual,
        }
    }
}

/// Where a triangle of this signed area has the sense of the base.
#[inline(always)]
pub(super) fn upright<S: Simd>(geometry: &Geometry, area: Lanes<S>) -> Mask<S> {
    area.like(0.0).below(area * geometry.base_area)
}

/// Three numbers, and zero where the sides are met already.
#[inline(always)]
pub(super) fn unless<S: Simd>(met: Mask<S>, numbers: Three<S>) -> Three<S> {
    if !met.any() {
        return numbers;
    }
    let mut left = numbers;
    for number in &mut left {
        *number = met.select(number.like(0.0), *number);
    }
    left
}

/// As [`unless`], without a branch.
#[inline(always)]
pub(super) fn unless_branchless<S: Simd>(met: Mask<S>, numbers: Three<S>) -> Three<S> {
    either(met, [numbers[0].like(0.0); 3], numbers)
}

/// These numbers where the mask is true, others elsewhere.
#[inline(always)]
fn either<S: Simd>(mask: Mask<S>, [a, b, c]: Three<S>, [d, e, f]: Three<S>) -> Three<S> {
    [mask.select(a, d), mask.select(b, e), mask.select(c, f)]
}

/// ‖(a, b)‖² in the metric.
#[inline(always)]
pub(crate) fn squared<S: Simd, M: Model>(task: &Task<'_>, a: &Three<S>, b: &Three<S>) -> Lanes<S> {
    let of_a = sum_of_squares(a);
    if M::ACROSS {
        sum_of_squares(b).times_plus(a[0].like(1.0 / task.compliance), of_a)
    } else {
        of_a
    }
}

#[inline(always)]
fn sum_of_squares<S: Simd>([a, b, c]: &Three<S>) -> Lanes<S> {
    a.times_plus(*a, b.times_plus(*b, *c * *c))
}
