//! The fastest parameterization of a path under jerk limits, as a nonlinear program in the squared rate.
//!
//! The path q(s) is reparameterized by s = σ(u), where σ has zero slope and curvature at both ends.
//! The squared rate x(u) = u̇² is then positive everywhere, also at rest, and bounds the axes by
//!
//! ```text
//!    |Q' √x| ≤ v        |Q'' x + Q' x' / 2| ≤ a        |Q''' x + 3/2 Q'' x' + 1/2 Q' x''|  ≤  j / √x        Q(u) = q(σ(u))
//! ```
//! x is a quadratic spline over equal intervals of u; the constraints hold at collocation points.
//! All left sides are linear in x, and so is everything but the right side of the jerk, which is convex: its tangents are inner approximations.

use super::profile::JerkLimitedProfile;
use super::spline::Jet;

/// Number of intervals of the spline.
pub(super) const INTERVALS: usize = 48;
/// Width of an interval of the reparameterization.
const WIDTH: f64 = 1.0 / INTERVALS as f64;
/// Number of coefficients of the spline.
pub(super) const COEFFICIENTS: usize = INTERVALS + 2;
/// Positions and weights of the Gauss–Legendre quadrature with three points on an interval from 0 to 1.
const QUADRATURE: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Coefficients of three consecutive basis splines in x, x' and x'' at one place of their interval.
pub(super) type Basis = [[f64; 3]; 3];

/// Basis splines at a share of an interval.
pub(super) fn basis(share: f64) -> Basis {
    let rest = 1.0 - share;
    let second = 1.0 / (WIDTH * WIDTH);
    [
        [0.5 * rest * rest, 0.5 + share * rest, 0.5 * share * share],
        [-rest / WIDTH, (rest - share) / WIDTH, share / WIDTH],
        [second, -2.0 * second, second],
    ]
}

/// Product of basis splines and their coefficients.
pub(super) fn product(weights: &[f64; 3], coefficients: &[f64]) -> f64 {
    weights[0] * coefficients[0] + weights[1] * coefficients[1] + weights[2] * coefficients[2]
}

/// Path parameter σ(u) with its first three derivatives.
pub(super) fn path_parameter(u: f64) -> Jet {
    let w = 1.0 - u;
    [
        u * u * u * (10.0 + u * (6.0 * u - 15.0)),
        30.0 * (u * w) * (u * w),
        60.0 * u * w * (w - u),
        60.0 - 360.0 * u * w,
    ]
}

/// Squared rate x = u̇² over u (1/s²).
#[derive(Debug, Clone)]
pub(super) struct SquaredRate {
    pub(super) coefficients: Vec<f64>,
}

impl SquaredRate {
    /// Rate ṡ (1/s) and acceleration s̈ (1/s²) of the path parameter at a share of an interval.
    fn motion(&self, interval: usize, share: f64) -> [f64; 2] {
        let coefficients = &self.coefficients[interval..];
        let [x, slope, _] = basis(share).map(|weights| product(&weights, coefficients));
        let [_, first, second, _] = path_parameter((interval as f64 + share) * WIDTH);
        [first * x.sqrt(), second * x + 0.5 * first * slope]
    }

    /// Duration of an interval (s).
    pub(super) fn duration(&self, interval: usize) -> f64 {
        let coefficients = &self.coefficients[interval..];
        let at = |share: f64| product(&basis(share)[0], coefficients).sqrt();
        QUADRATURE.iter().map(|&(share, weight)| weight * WIDTH / at(share)).sum()
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
