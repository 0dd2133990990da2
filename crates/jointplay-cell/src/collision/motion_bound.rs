//! Motion bounds: upper bounds of the travel of any point of an object between two samples.
//!
//! `docs/explanation/collision-guarantee.md` derives the inequalities, in the chapters "Platform", "Arms" and "Deflection".

use std::ops::Range;

use nalgebra::Vector2;

use super::in_plane_motion::{InPlaneMotion, InPlaneRates};
use super::motion_bound_coefficients::MotionBoundCoefficients;
use crate::columns::map_rows;
use crate::extrema::{larger, raise, smaller};
use crate::robot::{HybridRobot, KinematicLimits, MAX_AXES, RODS};
use crate::trajectory::{AxisSampler, AxisState};

/// Velocities and accelerations are at most this multiple of their limits: lines are compared with them at some times only.
const LIMIT_EXCESS: f64 = 1.01;

/// Upper bounds of the displacement of any point of an object in an interval.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DisplacementBound {
    /// Displacement by the platform, the rotation of deflected arms with it included (m).
    pub(crate) platform: f64,
    /// Displacement by the arms, parallel to the platform (m).
    pub(crate) arms: f64,
    /// Displacement by the change of the deflection as the arm extends (m).
    pub(crate) deflection: f64,
    /// Horizontal part of `deflection` (m).
    pub(crate) lateral_deflection: f64,
    /// Displacement in the platform frame by the change of the deflection as the platform rotates (m).
    pub(crate) platform_deflection: f64,
}

impl DisplacementBound {
    /// Displacement in any direction (m).
    pub(crate) fn total(self) -> f64 {
        self.platform + self.arms + self.deflection
    }
}

/// Upper bounds of the travel of all axes and of the platform between two samples.
#[derive(Clone, Copy)]
pub(crate) struct AxisTravel<'a> {
    /// Indices of the axes that move.
    moving: &'a [usize],
    /// Prefix sums of each of these axes.
    sums: &'a [Vec<[f64; 3]>],
    /// First and last sample.
    samples: [usize; 2],
    /// Travel of the platform's origin (m).
    origin: f64,
    /// Rotation of the platform's normal (rad).
    pub(crate) normal_rotation: f64,
    /// Rotation of the platform about its normal, beyond the shortest rotation (rad).
    torsion: f64,
}

impl AxisTravel<'_> {
    /// Each axis that moves, with its travel, back and forth added up (m or rad).
    pub(super) fn paths(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        let [first, last] = self.samples;
        let path = move |sums: &Vec<[f64; 3]>| sums[last][0] - sums[first][0];
        self.moving.iter().zip(self.sums).map(move |(&axis, sums)| (axis, path(sums)))
    }

    /// Each axis that moves, with its travel, back and forth added up (m or rad), ∫|q̈| dt (m/s or rad/s) and ∫q̇² dt (m²/s or rad²/s).
    fn axes(&self) -> impl Iterator<Item = (usize, [f64; 3])> {
        let [first, last] = self.samples;
        self.moving.iter().zip(self.sums).map(move |(&axis, sums)| {
            let (first, last) = (&sums[first], &sums[last]);
            (axis, std::array::from_fn(|k| last[k] - first[k]))
        })
    }
}

/// Prefix sums of the travel of all axes and of the platform, by sample.
#[derive(Default)]
pub(crate) struct CumulativeAxisTravel {
    /// Travel, ∫|q̈| dt and ∫q̇² dt of each moving axis, in the order of the sampler; buffers of earlier steps may follow.
    axes: Vec<Vec<[f64; 3]>>,
    /// Travel of the platform's origin, rotation of its normal, and rotation about the normal; empty while no rod moves.
    platform: Vec<[f64; 3]>,
    /// Time between each sample and the next (s).
    intervals: Vec<f64>,
    /// Largest travel of a rod from each sample to the next (m).
    largest: Vec<f64>,
    /// Columns of intermediate results.
    buffers: [Vec<f64>; 3],
}

impl CumulativeAxisTravel {
    /// Accumulates the travel over the samples of a window.
    ///
    /// # Arguments
    /// * `from` – positions of all axes at the start of the step (m or rad)
    pub(crate) fn accumulate(
        &mut self,
        bounds: &MotionBoundModel,
        times: &[f64],
        from: &[f64],
        sampler: &AxisSampler,
    ) {
        let (moving, states) = (sampler.moving(), sampler.states());
        if self.axes.len() < moving.len() {
            self.axes.resize_with(moving.len(), Vec::new);
        }
        let count = times.len() - 1;
        self.intervals.clear();
        self.intervals.extend(times.windows(2).map(|pair| pair[1] - pair[0]));
        self.largest.clear();
        self.largest.resize(count, 0.0);
        self.buffers.iter_mut().for_each(|buffer| buffer.resize(count, 0.0));
        for ((&axis, states), sums) in moving.iter().zip(states).zip(&mut self.axes) {
            let [_, v, a, j] = states.columns();
            let [travels, accelerations, squares] = self.buffers.each_mut().map(Vec::as_mut_slice);
            let limits = bounds.limits[axis];
            map_rows(
                [&self.intervals, &v[..count], &v[1..], &a[..count], &a[1..], &j[..count], &j[1..]],
                [&mut *travels, &mut *accelerations, &mut *squares],
                |[dt, v_0, v_1, a_0, a_1, j_0, j_1]| {
                    // Samples do not show the jerk between them.
                    let jerk = larger(j_0.abs(), larger(j_1.abs(), limits.jerk));
                    let acceleration = bound_between(dt, [a_0, a_1], jerk, limits.acceleration);
                    let speed = bound_between(dt, [v_0, v_1], acceleration, limits.velocity);
                    let travel = dt * speed;
                    [travel, dt * acceleration, travel * speed]
                },
            );
            let mut total = [0.0; 3];
            sums.clear();
            sums.push(total);
            let increments = travels.iter().zip(&*accelerations).zip(&*squares);
            sums.extend(increments.map(|((travel, acceleration), square)| {
                total[0] += travel;
                total[1] += acceleration;
                total[2] += square;
                total
            }));
            if axis < RODS {
                for (largest, travel) in self.largest.iter_mut().zip(&*travels) {
                    raise(largest, *travel);
                }
            }
        }
        self.platform.clear();
        if moving.first().is_some_and(|&axis| axis < RODS) {
            self.accumulate_tilt(bounds, from, sampler);
        }
    }

    /// Accumulates the travel of the platform: its origin by the weighted travel of the rods, its normal by the differences of their velocities.
    fn accumulate_tilt(&mut self, bounds: &MotionBoundModel, from: &[f64], sampler: &AxisSampler) {
        let count = self.intervals.len();
        let rods: [_; RODS] = std::array::from_fn(|rod| sampler.states_or_at_rest(rod, from[rod]));
        // The time to the next sample, then the states of all rods at the sample, then those at the next.
        let mut inputs = [&self.intervals[..]; 1 + 2 * 4 * RODS];
        for (rod, states) in rods.iter().enumerate() {
            for (order, column) in states.columns().into_iter().enumerate() {
                inputs[1 + 4 * rod + order] = &column[..count];
                inputs[1 + 4 * (RODS + rod) + order] = &column[1..];
            }
        }
        let [rotations, slopes, _] = self.buffers.each_mut().map(Vec::as_mut_slice);
        map_rows(
            inputs,
            [&mut *rotations, &mut *slopes],
            #[inline(always)]
            |[dt, states @ ..]| {
                let (states, _) = states.as_chunks::<4>();
                let first = bounds.tilt_motion([&states[0], &states[1], &states[2]]);
                let last = bounds.tilt_motion([&states[3], &states[4], &states[5]]);
                let rotation = bounds.normal_rotation(dt, [&first, &last]);
                [rotation, 0.5 * (first.slope + last.slope + rotation)]
            },
        );
        let mut total = [0.0; 3];
        self.platform.push(total);
        let rows = self.largest.iter().zip(&*rotations).zip(&*slopes);
        self.platform.extend(rows.map(|((largest, rotation), slope)| {
            let InPlaneRates { shift, torsion } = bounds.in_plane.rates(*slope);
            total[0] += bounds.weight_sum * largest + rotation * shift;
            total[1] += rotation;
            total[2] += rotation * torsion;
            total
        }));
    }

    /// Travel between two samples.
    pub(crate) fn between<'a>(
        &'a self,
        sampler: &'a AxisSampler,
        interval: &Range<usize>,
    ) -> AxisTravel<'a> {
        let samples = [interval.start, interval.end];
        let [first, last] = samples.map(|sample| self.platform.get(sample));
        let [origin, normal_rotation, torsion] = match (first, last) {
            (Some(first), Some(last)) => std::array::from_fn(|k| last[k] - first[k]),
            _ => [0.0; 3],
        };
        let (moving, sums) = (sampler.moving(), &*self.axes);
        AxisTravel { moving, sums, samples, origin, normal_rotation, torsion }
    }
}

/// Motion of the platform's tilt at a sample.
struct TiltMotion {
    /// Tangent of the tilt.
    slope: f64,
    /// Deviations of the rods' velocities from their mean (m/s).
    velocities: [f64; RODS],
    /// Deviations of the rods' accelerations from their mean (m/s²).
    accelerations: [f64; RODS],
    /// Largest jerk of a rod (m/s³).
    jerk: f64,
}

/// Robot data that all motion bounds share: motion of the platform by the rods, and jerk limits of all axes.
pub(crate) struct MotionBoundModel {
    /// Sum of the absolute weights of the rods in the height of the platform's origin.
    weight_sum: f64,
    /// Heights of the base triangle, at the corner of each rod (m).
    heights: [f64; RODS],
    /// Gradient of the platform plane's slope by each rod (1/m).
    slopes: [Vector2<f64>; RODS],
    in_plane: InPlaneMotion,
    /// Largest velocity, acceleration and jerk that the limits of each axis allow: samples do not show those between them.
    limits: [KinematicLimits; MAX_AXES],
    /// The largest of the rods.
    rod_limits: KinematicLimits,
}

impl MotionBoundModel {
    pub(crate) fn new(robot: &HybridRobot) -> Self {
        let b = robot.gpr.base_points();
        let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let corner = |k: usize| [b[k].x, b[k].y];
        let whole = area(corner(0), corner(1), corner(2));
        let origin = [0.0, 0.0];
        let weight = |k: usize| area(corner((k + 1) % 3), corner((k + 2) % 3), origin) / whole;
        let side = |k: usize| (b[(k + 1) % 3] - b[(k + 2) % 3]).norm();
        let mut limits =
            [KinematicLimits { velocity: 0.0, acceleration: 0.0, jerk: 0.0 }; MAX_AXES];
        for (limits, axis) in limits.iter_mut().zip(&robot.axes) {
            *limits = largest_limits(axis.empty, axis.loaded);
        }
        let rod_limits = limits[..RODS].iter().copied().reduce(largest_limits);
        Self {
            limits,
            rod_limits: rod_limits.expect("there are rods"),
            weight_sum: (0..RODS).map(|k| weight(k).abs()).sum(),
            heights: [0, 1, 2].map(|k| whole.abs() / side(k)),
            slopes: [0, 1, 2].map(|k| {
                let side = b[(k + 2) % 3] - b[(k + 1) % 3];
                Vector2::new(-side.y, side.x) / whole
            }),
            in_plane: InPlaneMotion::new(robot),
        }
    }

    /// Upper bound of the distance of the platform's origin from the base origin (m).
    pub(crate) fn max_platform_distance(&self, robot: &HybridRobot) -> f64 {
        let rods = robot.axes[..RODS].iter().map(|rod| rod.min.abs().max(rod.max.abs()));
        // The offset of the origin from the base axis is by far smaller than the radius of the base points.
        let radius = robot.gpr.base_points().map(|point| point.norm()).into_iter();
        self.weight_sum * rods.fold(0.0, f64::max) + radius.fold(0.0, f64::max)
    }

    /// Motion of the platform's tilt by the states of the rods.
    #[inline(always)]
    fn tilt_motion(&self, rods: [&AxisState; RODS]) -> TiltMotion {
        let deviations = |order: usize| -> [f64; RODS] {
            let mean = (rods[0][order] + rods[1][order] + rods[2][order]) / 3.0;
            rods.map(|state| state[order] - mean)
        };
        let slope = self.slopes.iter().zip(rods).map(|(slope, state)| slope * state[0]);
        TiltMotion {
            slope: slope.sum::<Vector2<f64>>().norm(),
            velocities: deviations(1),
            accelerations: deviations(2),
            jerk: rods.iter().fold(0.0, |most, state| larger(state[3].abs(), most)),
        }
    }

    /// Upper bound of the rotation of the platform's normal between two samples (rad): the travel of the plane's slope.
    #[inline(always)]
    fn normal_rotation(&self, dt: f64, [from, to]: [&TiltMotion; 2]) -> f64 {
        let KinematicLimits { velocity, acceleration, jerk } = self.rod_limits;
        // A deviation from the mean is at most twice the largest.
        let jerk = 2.0 * larger(from.jerk, larger(to.jerk, jerk));
        let rotation = |rod: usize| {
            let accelerations = [from.accelerations[rod], to.accelerations[rod]];
            let velocities = [from.velocities[rod], to.velocities[rod]];
            let acceleration = bound_between(dt, accelerations, jerk, 2.0 * acceleration);
            let speed = bound_between(dt, velocities, acceleration, 2.0 * velocity);
            dt * speed / self.heights[rod]
        };
        (0..RODS).map(rotation).sum()
    }

    /// Upper bound of the rotation of the platform's normal by displacements of the rods (rad); of its rate by their velocities.
    #[inline(always)]
    pub(crate) fn tilt_bound(&self, rods: &[f64; RODS]) -> f64 {
        let mean = (rods[0] + rods[1] + rods[2]) / 3.0;
        (0..RODS).map(|rod| (rods[rod] - mean).abs() / self.heights[rod]).sum::<f64>()
    }

    /// Upper bound of the vertical displacement of the platform's origin by displacements of the rods (m); of its rate by their velocities.
    #[inline(always)]
    pub(crate) fn heave_bound(&self, rods: &[f64; RODS]) -> f64 {
        self.weight_sum * rods.iter().fold(0.0, |most, rod| larger(rod.abs(), most))
    }

    /// Upper bounds of the displacement of any point of an object.
    pub(crate) fn displacement(
        &self,
        coefficients: &MotionBoundCoefficients,
        travel: &AxisTravel<'_>,
    ) -> DisplacementBound {
        let rotation = travel.normal_rotation + travel.torsion;
        let platform_deflection = rotation * coefficients.platform_deflection;
        let platform = travel.origin + rotation * coefficients.rigid_radius + platform_deflection;
        let mut bound = DisplacementBound { platform, platform_deflection, ..Default::default() };
        for (axis, [path, ..]) in travel.axes() {
            bound.arms += coefficients.arms[axis] * path;
            bound.deflection += coefficients.deflection[axis] * path;
            bound.lateral_deflection += coefficients.lateral_deflection[axis] * path;
        }
        bound
    }

    /// Upper bound of the variation of the arms' part of a point's velocity, ∫|p̈| dt (m/s).
    ///
    /// ```text
    ///    p̈  =  Σ_g |v_g| (φ̈_g e_⊥ − φ̇_g² e)
    /// ```
    /// p: the point in the platform frame; g: links from the first moving one on; |v_g|, φ_g: their lengths and angles; e, e_⊥: unit vectors along and across a link.
    pub(crate) fn velocity_variation(
        &self,
        coefficients: &MotionBoundCoefficients,
        travel: &AxisTravel<'_>,
    ) -> f64 {
        let of_axis = |(axis, [_, acceleration, square]): (usize, [f64; 3])| {
            coefficients.arms[axis] * acceleration + coefficients.centripetal[axis] * square
        };
        travel.axes().map(of_axis).sum()
    }
}

/// The larger of each limit.
fn largest_limits(one: KinematicLimits, other: KinematicLimits) -> KinematicLimits {
    KinematicLimits {
        velocity: one.velocity.max(other.velocity),
        acceleration: one.acceleration.max(other.acceleration),
        jerk: one.jerk.max(other.jerk),
    }
}

/// Upper bound of the magnitude between two values of a quantity whose rate is bounded, and which has a limit.
///
/// The travel at a speed with this bound is additive over parts of the interval: in half of the time at most half.
#[inline(always)]
fn bound_between(dt: f64, [first, last]: [f64; 2], rate: f64, limit: f64) -> f64 {
    let [first, last] = [first.abs(), last.abs()];
    let limit = larger(first, larger(last, limit));
    smaller(0.5 * (first + last + dt * rate), LIMIT_EXCESS * limit)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::RngExt;
    use proptest::test_runner::{RngAlgorithm, TestRng};

    use super::*;

    #[test]
    fn motion_bound_is_additive_over_halves() {
        // Pieces of constant jerk from any speed and acceleration, with and without reversal.
        let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[3; 32]);
        let mut random = || generator.random_range(-1.0..1.0_f64);
        for round in 0..2000 {
            let (dt, jerk) = (0.01, 100.0 * random());
            // From rest at constant acceleration, the second half is three times the first.
            let (v, a) = if round == 0 { (0.0, 5.0) } else { (0.2 * random(), 10.0 * random()) };
            let speed = |t: f64| v + a * t + 0.5 * jerk * t * t;
            // Limits that are not reached, and those that are.
            let most = |of: &dyn Fn(f64) -> f64| {
                let times = (0..=100).map(|k| of(dt * f64::from(k) / 100.0).abs());
                times.fold(0.0, f64::max) * if round % 2 == 0 { 1.0 } else { 3.0 }
            };
            let limit = most(&|t| a + jerk * t);
            let acceleration = bound_between(dt, [a, a + jerk * dt], jerk.abs(), limit);
            let bound = dt * bound_between(dt, [v, speed(dt)], acceleration, most(&speed));
            let travel = |from: f64| {
                let steps = 200;
                let step = 0.5 * dt / f64::from(steps);
                (0..steps)
                    .map(|k| speed(from + (f64::from(k) + 0.5) * step).abs() * step)
                    .sum::<f64>()
            };
            for from in [0.0, 0.5 * dt] {
                assert!(
                    travel(from) <= 0.5 * bound * (1.0 + 1e-4),
                    "{round}: {} {bound}",
                    travel(from)
                );
            }
        }
    }
}
