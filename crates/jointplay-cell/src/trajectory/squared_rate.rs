//! The fastest parameterization of a path under jerk limits, as a nonlinear program in the squared rate.
//!
//! The path q(s) is reparameterized by s = σ(u), where σ has zero slope and curvature at both ends.
//! The squared rate x(u) = u̇² is then positive everywhere, also at rest, and bounds the axes by
//!
//! ```text
//!    |Q' √x| ≤ v        |Q'' x + Q' x' / 2| ≤ a        |Q''' x + 3/2 Q'' x' + 1/2 Q' x''|  ≤  j / √x        Q(u) = q(σ(u))
//! ```
//! x is a quadratic spline over intervals of u; the constraints hold at collocation points.
//! All left sides are linear in x, and so is everything but the right side of the jerk, which is convex: its tangents are inner approximations.

use super::profile::JerkLimitedProfile;
use super::rate_lanes::{Coefficients, INTERVALS, LANES, Lanes, LanesOfBasis};
use super::spline::Jet;

/// Positions and weights of the Gauss–Legendre quadrature with three points on an interval from 0 to 1.
const QUADRATURE: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Positions on an interval from 0 to 1 of the Gauss–Legendre quadrature with two points of equal weight.
const TWO_POINTS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Coefficients of three consecutive basis splines in x, x' and x'' at one place of their interval.
pub(super) type Basis = [[f64; 3]; 3];

/// Product of basis splines and their coefficients.
pub(super) fn product(weights: &[f64; 3], coefficients: &[f64]) -> f64 {
    weights[0] * coefficients[0] + weights[1] * coefficients[1] + weights[2] * coefficients[2]
}

/// Fraction of the reparameterization in which the acceleration grows from rest, for motions that take much of their time for it.
const LONG_RAMP: f64 = 0.28;
/// Number of intervals in a long ramp: as wide as the others.
const LONG_RAMP_INTERVALS: usize = 13;
/// Fraction of the duration from which on a ramp is long.
const LONG_RAMP_THRESHOLD: f64 = 0.05;
/// Least fraction of a ramp.
const MIN_RAMP: f64 = 1e-3;
/// Number of intervals in a short ramp.
const SHORT_RAMP_INTERVALS: usize = 4;

/// The reparameterization σ(u) and the intervals of u.
///
/// ```text
///    σ'''  =  k / r  for u < r        −k / (1/2 − r)  for r < u < 1 − r        k / r  for u > 1 − r
/// ```
#[derive(Debug)]
pub(super) struct RateGrid {
    /// r
    ramp: f64,
    /// k
    peak: f64,
    /// Number of intervals in a ramp.
    ramp_intervals: usize,
    /// Points and weights at which durations of intervals are integrated.
    quadrature: Vec<QuadraturePoints>,
}

/// Points of successive intervals at which the duration is integrated.
#[derive(Debug)]
pub(super) struct QuadraturePoints {
    pub(super) basis: LanesOfBasis<1>,
    /// Weights of 1/√x.
    pub(super) weights: Lanes,
}

impl RateGrid {
    /// # Arguments
    /// * `ramp_fraction` – fraction of its duration in which the acceleration of a motion grows from rest
    pub(super) fn new(ramp_fraction: f64) -> Self {
        let (ramp, ramp_intervals) = if ramp_fraction >= LONG_RAMP_THRESHOLD {
            (LONG_RAMP, LONG_RAMP_INTERVALS)
        } else {
            (ramp_fraction.max(MIN_RAMP), SHORT_RAMP_INTERVALS)
        };
        let rest = 0.5 - ramp;
        let peak = 0.5 / (ramp * ramp / 6.0 + rest / 4.0 - rest * rest / 6.0);
        let mut grid = Self { ramp, peak, ramp_intervals, quadrature: Vec::new() };
        for first in (0..INTERVALS).step_by(LANES) {
            let weights = std::array::from_fn(|lane| 0.5 * grid.width(first + lane));
            let points = TWO_POINTS.map(|fraction| {
                let basis = |interval| [grid.basis(interval, fraction)[0]];
                QuadraturePoints { basis: LanesOfBasis::new(first, basis), weights }
            });
            grid.quadrature.extend(points);
        }
        grid
    }

    /// Points at which the duration is integrated.
    pub(super) fn quadrature(&self) -> &[QuadraturePoints] {
        &self.quadrature
    }

    /// Width of an interval; those before the first and after the last are as wide as these.
    pub(super) fn width(&self, interval: usize) -> f64 {
        let inner = INTERVALS - 2 * self.ramp_intervals;
        if interval < self.ramp_intervals || interval >= INTERVALS - self.ramp_intervals {
            self.ramp / self.ramp_intervals as f64
        } else {
            (1.0 - 2.0 * self.ramp) / inner as f64
        }
    }

    /// Basis splines at a fraction of an interval.
    pub(super) fn basis(&self, interval: usize, fraction: f64) -> Basis {
        let width = self.width(interval);
        let before = width + self.width(interval.saturating_sub(1));
        let after = width + self.width((interval + 1).min(INTERVALS - 1));
        let (t, rest) = (fraction * width, (1.0 - fraction) * width);
        let [first, last] = [1.0 / (width * before), 1.0 / (width * after)];
        let (b0, b2) = (rest * rest * first, t * t * last);
        let (s0, s2) = (-2.0 * rest * first, 2.0 * t * last);
        let (c0, c2) = (2.0 * first, 2.0 * last);
        [[b0, 1.0 - b0 - b2, b2], [s0, -s0 - s2, s2], [c0, -c0 - c2, c2]]
    }

    /// Path parameter σ with its first three derivatives with respect to u at a fraction of an interval.
    pub(super) fn path_parameter(&self, interval: usize, fraction: f64) -> Jet {
        let (r, k) = (self.ramp, self.peak);
        let ramp = |u: f64| [k * u * u * u / (6.0 * r), k * u * u / (2.0 * r), k * u / r, k / r];
        if interval < self.ramp_intervals {
            return ramp((interval as f64 + fraction) * self.width(0));
        }
        if interval >= INTERVALS - self.ramp_intervals {
            let [s, slope, curvature, third] =
                ramp(((INTERVALS - interval) as f64 - fraction) * self.width(0));
            return [1.0 - s, slope, -curvature, third];
        }
        let from_ramp = (interval - self.ramp_intervals) as f64 + fraction;
        let rest = 0.5 - r;
        let v = from_ramp * self.width(interval) - rest;
        let third = -k / rest;
        [0.5 + v * (k / 4.0 + v * v * third / 6.0), k / 4.0 + v * v * third / 2.0, v * third, third]
    }
}

/// Squared rate x = u̇² over u (1/s²).
#[derive(Debug, Clone)]
pub(super) struct SquaredRate<'a> {
    pub(super) grid: &'a RateGrid,
    pub(super) coefficients: Coefficients,
}

impl SquaredRate<'_> {
    /// Rate ṡ (1/s) and acceleration s̈ (1/s²) of the path parameter at a fraction of an interval.
    fn motion(&self, interval: usize, fraction: f64) -> [f64; 2] {
        let coefficients = &self.coefficients[interval..];
        let basis = self.grid.basis(interval, fraction);
        let [x, slope, _] = basis.map(|weights| product(&weights, coefficients));
        let [_, first, second, _] = self.grid.path_parameter(interval, fraction);
        [first * x.sqrt(), second * x + 0.5 * first * slope]
    }

    /// Duration of an interval (s).
    pub(super) fn duration(&self, interval: usize) -> f64 {
        let coefficients = &self.coefficients[interval..];
        let at =
            |fraction: f64| product(&self.grid.basis(interval, fraction)[0], coefficients).sqrt();
        let width = self.grid.width(interval);
        QUADRATURE.iter().map(|&(fraction, weight)| weight * width / at(fraction)).sum()
    }

    /// The path parameter over time: two pieces of constant jerk for each interval.
    ///
    /// Rates and accelerations at both ends of an interval determine its two jerks:
    ///
    /// ```text
    ///    a₁ = a₀ + (j₁ + j₂) t / 2        v₁ = v₀ + a₀ t + (3 j₁ + j₂) t² / 8
    /// ```
    pub(super) fn profile(&self) -> JerkLimitedProfile {
        let mut pieces = Vec::with_capacity(2 * INTERVALS);
        let [mut rate, mut acceleration] = self.motion(0, 0.0);
        for interval in 0..INTERVALS {
            let duration = self.duration(interval);
            let [next_rate, next_acceleration] = self.motion(interval, 1.0);
            let sum = 2.0 * (next_acceleration - acceleration) / duration;
            let excess = (next_rate - rate - acceleration * duration) / (duration * duration);
            let first = 4.0 * excess - 0.5 * sum;
            pieces.extend([(0.5 * duration, first), (0.5 * duration, sum - first)]);
            [rate, acceleration] = [next_rate, next_acceleration];
        }
        JerkLimitedProfile::from_pieces(0.0, 1.0, &pieces)
    }
}
