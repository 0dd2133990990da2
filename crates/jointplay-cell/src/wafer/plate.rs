//! A free round plate on point supports in a symmetric pattern.
//!
//! All quantities are dimensionless: radii in radii of the plate, forces in its weight, deflections in q a⁴/D with the weight per area q and the flexural rigidity D.

/// Fraction of the sum of a series below which its terms are neglected.
const THRESHOLD: f64 = 1e-10;

/// Largest number of terms of a series; terms near a point of the edge fall as 1/m³, so that the rest is below 10⁻⁶.
const MOST_TERMS: usize = 400;

/// Supports at one radius with equal forces, which together carry the weight of the plate.
///
/// ```text
///    p(θ)  =  1/(2πb) + 1/(πb) Σ_m cos(m φ) cos(m θ),     m = s, 2s, 3s, …
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SupportRing {
    /// Distance b from the centre.
    pub(super) radius: f64,
    /// Direction φ of one of the points from the x axis (rad).
    pub(super) angle: f64,
    /// Common factor of the wave numbers: 3 for three points, 2 for four points mirrored at both axes.
    pub(super) symmetry: usize,
}

/// Deflection under the plate's own weight without reactions, down positive; up to a constant.
pub(super) fn under_weight(poisson: f64, radius: f64) -> f64 {
    let square = radius * radius;
    square * square / 64.0 - (3.0 + poisson) / (32.0 * (1.0 + poisson)) * square
}

impl SupportRing {
    /// Fourier coefficients of the height at a radius, the mean first: the factors of cos mθ.
    ///
    /// Each is a biharmonic function inside and outside the circle of the points, joined by the jump of the shear force there, and a function regular in the whole plate that frees the edge of moment and force.
    pub(super) fn waves(&self, poisson: f64, radius: f64) -> Vec<f64> {
        let mut waves = vec![self.mean(poisson, radius)];
        let (mut sum, mut was_small) = (0.0_f64, false);
        for k in 1..=MOST_TERMS {
            let wave = self.wave(poisson, radius, k * self.symmetry);
            waves.push(wave * ((k * self.symmetry) as f64 * self.angle).cos());
            sum += wave.abs();
            // Coefficients near the points fall slowly, all others as powers: two small ones in a row end the series.
            let is_small = wave.abs() <= THRESHOLD * sum / (k as f64);
            if k > 8 && is_small && was_small {
                break;
            }
            was_small = is_small;
        }
        waves
    }

    fn mean(&self, poisson: f64, radius: f64) -> f64 {
        let b = self.radius;
        let edge = 2.0 * (1.0 + poisson) * (1.0 / b).ln() + (1.0 - poisson) * (1.0 - b * b);
        let bowl = edge / (2.0 * (1.0 + poisson)) * radius * radius;
        let beyond = if radius > b {
            let log = (radius / b).ln();
            (radius * radius + b * b) * log - radius * radius + b * b
        } else {
            0.0
        };
        (beyond - bowl) / 8.0
    }

    fn wave(&self, poisson: f64, radius: f64, m: usize) -> f64 {
        let (b, power) = (self.radius, m as i32);
        let m = m as f64;
        let free = if radius <= b {
            let within = (radius / b).powi(power);
            within / (m - 1.0) - within * (radius / b).powi(2) / (m + 1.0)
        } else {
            let beyond = (b / radius).powi(power - 2);
            beyond / (m - 1.0) - beyond * (b / radius).powi(2) / (m + 1.0)
        };
        let ratio = (3.0 + poisson) / (1.0 - poisson);
        let toward = b.powi(power - 2);
        let second = -(toward - m * toward * b * b / (m + 1.0)) / ratio;
        let first = (ratio * toward / (m - 1.0) - (m + 1.0) * second) / m;
        let edge = radius.powi(power) * (first + second * radius * radius);
        b * b / (8.0 * m) * (free + edge)
    }
}

/// Height of the edge above the supports, to be subtracted.
pub(super) fn on_edge(poisson: f64) -> f64 {
    under_weight(poisson, 1.0)
}

/// Σ_k waves_k cos k x, by the recurrence of the cosines.
pub(super) fn height(waves: &[f64], x: f64) -> f64 {
    let twice = 2.0 * x.cos();
    let (mut cosine, mut before) = (1.0, 0.5 * twice);
    let mut sum = 0.0;
    for wave in waves {
        sum += wave * cosine;
        (cosine, before) = (twice * cosine - before, cosine);
    }
    sum
}
