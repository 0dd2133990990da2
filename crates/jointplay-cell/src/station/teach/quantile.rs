//! Quantiles of the distributions that test taught points and bound their fit.

use std::f64::consts::FRAC_PI_2;

/// Share outside the reported confidence bounds.
const BEYOND: f64 = 0.05;
/// Number of standard deviations that contain 95 % of a normal distribution.
pub(super) const TWO_SIDED: f64 = 1.959_964;
/// Parts of numerical integrals.
const PARTS: usize = 200;
/// Halvings of a bisection.
const HALVINGS: usize = 44;

/// Integral from 0 by Simpson's rule.
fn integral(to: f64, density: impl Fn(f64) -> f64) -> f64 {
    let step = to / PARTS as f64;
    let part = |k: usize| {
        let from = k as f64 * step;
        density(from) + 4.0 * density(from + 0.5 * step) + density(from + step)
    };
    (0..PARTS).map(part).sum::<f64>() * step / 6.0
}

/// Largest argument up to `high` at which an increasing function is below a value.
fn bisect(high: f64, value: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, high);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if function(middle) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Share of a normal distribution that is farther from its mean than a multiple of its standard deviation, to either side.
pub(super) fn normal_beyond(multiple: f64) -> f64 {
    1.0 - integral(multiple, |z| (-0.5 * z * z).exp()) / FRAC_PI_2.sqrt()
}

/// The multiple of the standard deviation with a share beyond it, to either side: normal, or Student's t of an estimated deviation.
pub(super) fn student(beyond: f64, freedom: Option<usize>) -> f64 {
    match freedom {
        None => bisect(12.0, 1.0 - beyond, |z| 1.0 - normal_beyond(z)),
        Some(freedom) => {
            // By the substitution t = √ν tan θ the density is a power of cos θ.
            let freedom = freedom as f64;
            let density = |theta: f64| theta.cos().powf(freedom - 1.0);
            let whole = integral(FRAC_PI_2, density);
            let theta = bisect(FRAC_PI_2, 1.0 - beyond, |theta| integral(theta, density) / whole);
            freedom.sqrt() * theta.tan()
        }
    }
}

/// The 95 % quantile of an F distribution of 1 or 2 and the given degrees of freedom.
pub(super) fn f_95(over: usize, freedom: usize) -> f64 {
    if over == 2 {
        let freedom = freedom as f64;
        return 0.5 * freedom * (BEYOND.powf(-2.0 / freedom) - 1.0);
    }
    student(BEYOND, Some(freedom)).powi(2)
}

/// Quantile of a chi-square distribution, from the normal quantile.
///
/// # Source
/// \[WilsonHilferty\], within 4 % at 99.9 % from one degree of freedom on
pub(super) fn chi_square(freedom: usize, quantile: f64) -> f64 {
    let freedom = freedom as f64;
    let part = 2.0 / (9.0 * freedom);
    freedom * (1.0 - part + quantile * part.sqrt()).powi(3)
}

/// Bound on the angle of two independent normal slopes with 95 % confidence (rad).
///
/// ```text
///    P(angle > R)  =  mean over θ of exp(−R² / (2 (σ_1² cos² θ + σ_2² sin² θ)))
/// ```
pub(super) fn angle_95(slopes: [f64; 2]) -> f64 {
    const DIRECTIONS: usize = 64;
    let [one, other] = slopes.map(|slope| slope * slope);
    let largest = slopes[0].max(slopes[1]);
    let beyond = |angle: f64| {
        let share = |k: usize| {
            // By symmetry, a quarter revolution suffices.
            let theta = FRAC_PI_2 * (k as f64 + 0.5) / DIRECTIONS as f64;
            let variance = one * theta.cos().powi(2) + other * theta.sin().powi(2);
            (-angle * angle / (2.0 * variance)).exp()
        };
        (0..DIRECTIONS).map(share).sum::<f64>() / DIRECTIONS as f64
    };
    if largest == 0.0 {
        return 0.0;
    }
    bisect(3.0 * largest, 1.0 - BEYOND, |angle| 1.0 - beyond(angle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_published_tables() {
        for (freedom, expected) in [(1, 161.45), (2, 18.513), (3, 10.128), (10, 4.965)] {
            assert!((f_95(1, freedom) / expected - 1.0).abs() < 1e-3, "{}", f_95(1, freedom));
        }
        for (freedom, expected) in [(1, 199.5), (2, 19.0), (10, 4.103)] {
            assert!((f_95(2, freedom) / expected - 1.0).abs() < 1e-3, "{}", f_95(2, freedom));
        }
        for (freedom, expected) in [(1, 10.828), (3, 16.266), (10, 29.588)] {
            let found = chi_square(freedom, 3.090_232);
            assert!((found / expected - 1.0).abs() < 0.035, "{found}");
        }
        assert!((angle_95([1.0, 1.0]) - 2.447_75).abs() < 1e-4);
        assert!((angle_95([1.0, 0.0]) - TWO_SIDED).abs() < 1e-3, "{}", angle_95([1.0, 0.0]));
        // Two-sided quantiles of the normal distribution and of Student's t.
        for (beyond, freedom, expected) in [
            (0.05, None, 1.959_964),
            (0.001, None, 3.290_527),
            (0.000_1, None, 3.890_592),
            (0.001, Some(5), 6.8688),
            (0.05, Some(1), 12.7062),
            (0.01, Some(20), 2.845_34),
        ] {
            let found = student(beyond, freedom);
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
        assert!((normal_beyond(2.0) - 0.045_500_264).abs() < 1e-7);
    }
}
