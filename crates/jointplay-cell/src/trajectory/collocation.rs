//! Collocation points of a path: where its squared rate is constrained, and the motion of the axes there.

use super::rate_lanes::{INTERVALS, LANES, LanesOfBasis};
use super::spline::Spline;
use super::squared_rate::RateGrid;
use crate::robot::{AxesMotion, KinematicLimits};

/// Fractions of every interval at which there are collocation points.
const FRACTIONS: [f64; 3] = [0.0, 0.5, 1.0];
/// Fractions of the first and last interval at which the jerk is constrained besides: jerk and acceleration start from rest there, and the constraint is strongly curved.
const END_FRACTIONS: [f64; 2] = [0.25, 0.75];

/// Coefficients k₀ and k₁ of the constraints k₀ x + k₁ x' ≤ 1 at a place of a path, from the positions of all axes and their first two derivatives with respect to u; `None` where no squared rate satisfies them.
pub(crate) type FrictionConstraints<'a> = dyn Fn(&AxesMotion<'_>) -> Option<Vec<[f64; 2]>> + 'a;

/// A path at its collocation points, by blocks of points at the same fraction of successive intervals.
pub(super) struct CollocationPath<'a> {
    pub(super) grid: &'a RateGrid,
    /// Index and limits of each axis that moves.
    pub(super) limits: &'a [(usize, KinematicLimits)],
    /// First interval and basis of each block.
    pub(super) blocks: Vec<LanesOfBasis<3>>,
    /// Points of all blocks, as many of each as there are lanes.
    points: Vec<CollocationPoint>,
    /// Q', Q'' and Q''' of each axis that moves at each point.
    derivatives: Vec<[f64; 3]>,
}

/// What is constrained at a collocation point.
pub(super) struct CollocationPoint {
    pub(super) interval: usize,
    pub(super) has_jerk: bool,
    pub(super) has_acceleration: bool,
    /// Largest squared rate, by the limits of velocity.
    pub(super) max_squared_rate: Option<f64>,
    /// Constraints by the friction of wafers.
    pub(super) friction: Vec<[f64; 2]>,
}

impl<'a> CollocationPath<'a> {
    /// `None` where friction permits no squared rate.
    ///
    /// # Arguments
    /// * `limits` – index and limits of each axis that moves
    /// * `max_rate` – largest rate of the path parameter (1/s)
    pub(super) fn new(
        grid: &'a RateGrid,
        spline: &Spline,
        limits: &'a [(usize, KinematicLimits)],
        max_rate: f64,
        friction: Option<&FrictionConstraints<'_>>,
    ) -> Option<Self> {
        let (blocks, points, derivatives) = (Vec::new(), Vec::new(), Vec::new());
        let mut path = Self { grid, limits, blocks, points, derivatives };
        let firsts = || (0..INTERVALS).step_by(LANES);
        let everywhere =
            FRACTIONS.into_iter().flat_map(|at| firsts().map(move |first| (at, first)));
        let at_ends = END_FRACTIONS.into_iter().flat_map(|at| [(at, 0), (at, INTERVALS - LANES)]);
        for (fraction, first) in everywhere.chain(at_ends) {
            path.blocks.push(LanesOfBasis::new(first, |interval| grid.basis(interval, fraction)));
            for interval in first..first + LANES {
                path.add(spline, interval, fraction, max_rate, friction)?;
            }
        }
        Some(path)
    }

    /// Adds the point at a fraction of an interval.
    fn add(
        &mut self,
        spline: &Spline,
        interval: usize,
        fraction: f64,
        max_rate: f64,
        friction: Option<&FrictionConstraints<'_>>,
    ) -> Option<()> {
        let [s, s1, s2, s3] = self.grid.path_parameter(interval, fraction);
        let piece = spline.interval(s);
        let mut largest = max_rate / s1;
        for &(axis, limits) in self.limits {
            let [_, q1, q2, q3] = spline.jet(piece, axis, s);
            let d1 = q1 * s1;
            let d3 = q3 * s1 * s1 * s1 + 3.0 * q2 * s1 * s2 + q1 * s3;
            self.derivatives.push([d1, q2 * s1 * s1 + q1 * s2, d3]);
            largest = largest.min(limits.velocity / d1.abs());
        }
        let is_end = interval == 0 || interval + 1 == INTERVALS;
        let is_inner_start = fraction == 0.0 && interval > 0;
        let is_middle = fraction == 0.5;
        let mut point = CollocationPoint {
            interval,
            has_jerk: is_end || fraction == 0.0 || fraction == 1.0,
            has_acceleration: is_middle || is_inner_start,
            max_squared_rate: is_inner_start.then_some(largest * largest),
            friction: Vec::new(),
        };
        if let Some(friction) = friction.filter(|_| is_middle || is_inner_start) {
            let [mut positions, mut velocities, mut accelerations] = [const { Vec::new() }; 3];
            for axis in 0..spline.axes() {
                let [q, q1, q2, _] = spline.jet(piece, axis, s);
                positions.push(q);
                velocities.push(q1 * s1);
                accelerations.push(q2 * s1 * s1 + q1 * s2);
            }
            let [positions, velocities, accelerations] =
                [&positions, &velocities, &accelerations].map(Vec::as_slice);
            point.friction = friction(&AxesMotion { positions, velocities, accelerations })?;
        }
        self.points.push(point);
        Some(())
    }

    /// Points of a block, each with the derivatives of all axes that move.
    pub(super) fn points(
        &self,
        block: usize,
    ) -> impl Iterator<Item = (&CollocationPoint, &[[f64; 3]])> {
        let axes = self.limits.len();
        let first = block * LANES;
        let points = self.points[first..first + LANES].iter().enumerate();
        points.map(move |(lane, point)| (point, &self.derivatives[(first + lane) * axes..][..axes]))
    }
}
