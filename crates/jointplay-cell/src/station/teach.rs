//! Frames of stations from taught points.

use jointplay_core::linalg::svd;
use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use nalgebra::{DMatrix, Rotation3, Vector3};

/// Multiple of the threshold below which points are on one line: the tilt about that line is undetermined.
const SPREAD: f64 = 10.0;

/// Least-squares plane of taught points.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneFit {
    /// Centroid of the points, in the base frame (m).
    pub center: Vector3<f64>,
    /// Unit normal, upward, in the base frame.
    pub normal: Vector3<f64>,
    /// Tilt of the plane.
    pub tilt: Tilt,
    /// Distance of each point from the plane, above positive (m).
    pub distances: Vec<f64>,
    /// Root mean square distance (m).
    pub residual: f64,
    /// Largest distance (m).
    pub worst: f64,
    /// The points, in the base frame (m).
    pub points: Vec<Vector3<f64>>,
    /// Root mean square distance of the points from the line that fits them best, within the plane: it determines the tilt about that line (m).
    pub spread: f64,
    /// Largest allowed distance (m).
    pub threshold: f64,
    /// Standard deviation of each measured coordinate, if known (m).
    pub noise: Option<f64>,
    /// Uncertainty of the plane; `None` for three points whose noise is not known.
    pub uncertainty: Option<Box<Uncertainty>>,
    /// Number of points beyond three: degrees of freedom that test the noise.
    pub freedom: usize,
    /// Whether the points agree with one plane.
    pub verdict: Verdict,
}

/// Uncertainty of a fitted plane: the covariance of tilt and height along the principal directions of the points, where both slopes and the height at the centroid are uncorrelated.
///
/// ```text
///    var(slope_k)  =  σ² / Σ u_k²        var(height)  =  σ² (1/n + Σ_k p_k² / Σ u_k²)        u_k: coordinates of the points from their center, p_k: those of the place asked about
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Standard deviation of a measured coordinate, given or estimated from the distances (m).
    pub noise: f64,
    /// Whether that is estimated from the distances, with [`PlaneFit::freedom`] degrees of freedom.
    pub is_estimated: bool,
    /// Principal directions of the points in their plane, in the base frame.
    pub directions: [Vector3<f64>; 2],
    /// Standard deviation of the slope along each (rad).
    pub slopes: [f64; 2],
    /// Standard deviation of the height at the center of the points (m).
    pub height: f64,
    /// Angle within which the true normal lies with 95 % confidence (rad).
    pub tilt_95: f64,
    /// Factor on a standard deviation of a height that gives 95 % confidence.
    factor: f64,
    /// Centroid of the points, in the base frame (m).
    center: Vector3<f64>,
}

impl Uncertainty {
    /// Root mean square angle between the fitted and the true normal (rad).
    #[must_use]
    pub fn tilt(&self) -> f64 {
        self.slopes[0].hypot(self.slopes[1])
    }

    /// Half-width of the 95 % confidence interval of the height of the true plane over a position (m).
    ///
    /// # Arguments
    /// * `place` – position in the base frame (m)
    #[must_use]
    pub fn height_95(&self, place: &Vector3<f64>) -> f64 {
        let from_center = place - self.center;
        let [first, second] = [0, 1].map(|k| from_center.dot(&self.directions[k]) * self.slopes[k]);
        self.factor * self.height.hypot(first).hypot(second)
    }
}

/// Whether taught points agree with one plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All points lie within the threshold, and as near to the plane as their noise predicts.
    Fits,
    /// There are too few points to test them: three of any noise, or fewer than [`ENOUGH`] of unknown noise.
    Unproven,
    /// A point is farther from the plane than the threshold, or all of them are farther than their noise explains.
    Scattered,
}

/// Number of points from which on their distances from the plane estimate the noise to better than a factor of about three (95 %).
pub const ENOUGH: usize = 6;

/// Quantile of the false alarm rate at which points with given noise count as scattered.
const FALSE_ALARM_QUANTILE: f64 = 3.090_232;
/// Share outside the reported confidence bounds.
const BEYOND: f64 = 0.05;
/// Number of standard deviations that contain 95 % of a normal distribution.
const TWO_SIDED: f64 = 1.959_964;

/// Reason why taught points give no frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TeachError {
    /// Not enough points for a plane.
    #[error(
        "{found} taught points determine no plane; teach 3, and better 4, that are not on one line"
    )]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// The noise is not a positive number.
    #[error("the noise of taught points is {found} m, but has to be positive")]
    Noise {
        /// The value found (m).
        found: f64,
    },
    /// A coordinate is not finite.
    #[error("a taught point is not finite")]
    NotFinite,
    /// The points are on one line.
    #[error(
        "the taught points lie within {spread} m of one line, which leaves the tilt about it undetermined: teach a point at least {min} m from it"
    )]
    Collinear {
        /// Root mean square distance of the points from the line (m).
        spread: f64,
        /// Least allowed value (m).
        min: f64,
    },
    /// The plane is upright.
    #[error("the plane of the taught points is upright: its normal is {tilt} rad from vertical")]
    Upright {
        /// Angle of the normal from vertical (rad).
        tilt: f64,
    },
    /// The last slot is not above the first.
    #[error(
        "the last slot was taught {rise} m above the first; it has to be above it, by the slots between them"
    )]
    NotAbove {
        /// Height of the last slot above the first (m).
        rise: f64,
    },
    /// A drift of a station with one slot.
    #[error("a drift needs several slots, but there are {slots}")]
    OneSlot {
        /// Number of slots.
        slots: usize,
    },
}

/// Fits a plane to taught points, with its uncertainty.
///
/// # Arguments
/// * `points` – three or more, in the base frame (m)
/// * `threshold` – largest allowed distance of a point from the plane (m)
/// * `noise` – standard deviation of each measured coordinate; `None` where it is not known and is estimated from the distances (m)
///
/// # Errors
/// [`TeachError`] for too few points, points on a line, an upright plane, and noise that is not positive.
///
/// # Numerics
/// Singular values of the centred points: the last direction is the normal.
/// The 95 % bound of the tilt is exact for two independent normal slopes where the noise is given; where it is estimated, it is that of the F distribution of 2 and `freedom` for the larger of both slopes, which is conservative.
///
/// # Assumptions
/// The errors of the points are independent, normal and isotropic; errors within the plane have no first-order effect.
pub fn fit_plane(
    points: &[Vector3<f64>],
    threshold: f64,
    noise: Option<f64>,
) -> Result<PlaneFit, TeachError> {
    if let Some(found) = noise.filter(|noise| !(*noise > 0.0 && noise.is_finite())) {
        return Err(TeachError::Noise { found });
    }
    let count = points.len();
    if count < 3 {
        return Err(TeachError::TooFew { found: count });
    }
    let center = points.iter().sum::<Vector3<f64>>() / count as f64;
    let centered = DMatrix::from_fn(count, 3, |i, j| points[i][j] - center[j]);
    let Ok(found) = svd(&centered) else { return Err(TeachError::NotFinite) };
    let mean = |value: f64| value / (count as f64).sqrt();
    let spread = mean(found.singular_values[1]);
    // Round-off of the coordinates bounds the residual from below, however good the points are.
    let min = (SPREAD * threshold).max(1e-9 * center.norm().max(found.largest()));
    if spread <= min {
        return Err(TeachError::Collinear { spread, min });
    }
    let direction = Vector3::new(found.v[(0, 2)], found.v[(1, 2)], found.v[(2, 2)]);
    let normal = if direction.z < 0.0 { -direction } else { direction };
    let tilt = Tilt::from_normal(&normal);
    if normal.z < 0.1 {
        return Err(TeachError::Upright { tilt: tilt.pitch });
    }
    let distances: Vec<f64> = points.iter().map(|point| (point - center).dot(&normal)).collect();
    let worst = distances.iter().fold(0.0_f64, |worst, distance| worst.max(distance.abs()));
    let residual = mean(distances.iter().map(|d| d * d).sum::<f64>().sqrt());
    let freedom = count - 3;
    let squares = distances.iter().map(|d| d * d).sum::<f64>();
    let is_noisier = noise.is_some_and(|noise| {
        freedom > 0 && squares > noise * noise * chi_square(freedom, FALSE_ALARM_QUANTILE)
    });
    let verdict = if worst > threshold || is_noisier {
        Verdict::Scattered
    } else if freedom == 0 || (noise.is_none() && count < ENOUGH) {
        Verdict::Unproven
    } else {
        Verdict::Fits
    };
    let estimated = (freedom > 0).then(|| (squares / freedom as f64).sqrt());
    let uncertainty = noise.or(estimated).map(|sigma| {
        let slopes = [0, 1].map(|k| sigma / found.singular_values[k]);
        let [tilt_95, factor] = match noise {
            Some(_) => [angle_95(slopes), TWO_SIDED],
            None => {
                let [normals, planes] = [1, 2].map(|over| f_95(over, freedom).sqrt());
                [2.0_f64.sqrt() * planes * slopes[0].max(slopes[1]), normals]
            }
        };
        Box::new(Uncertainty {
            noise: sigma,
            is_estimated: noise.is_none(),
            directions: [0, 1].map(|k| Vector3::from_fn(|row, _| found.v[(row, k)])),
            slopes,
            height: mean(sigma),
            tilt_95,
            factor,
            center,
        })
    });
    let points = points.to_vec();
    Ok(PlaneFit {
        center,
        normal,
        tilt,
        distances,
        residual,
        worst,
        points,
        spread,
        threshold,
        noise,
        uncertainty,
        freedom,
        verdict,
    })
}

/// Bound on the angle of two independent normal slopes with 95 % confidence (rad).
///
/// ```text
///    P(angle > R)  =  mean over θ of exp(−R² / (2 (σ_1² cos² θ + σ_2² sin² θ)))
/// ```
fn angle_95(slopes: [f64; 2]) -> f64 {
    const DIRECTIONS: usize = 256;
    let [one, other] = slopes.map(|slope| slope * slope);
    let largest = slopes[0].max(slopes[1]);
    if largest == 0.0 {
        return 0.0;
    }
    let beyond = |angle: f64| {
        let share = |k: usize| {
            // By symmetry, a quarter revolution suffices.
            let theta = std::f64::consts::FRAC_PI_2 * (k as f64 + 0.5) / DIRECTIONS as f64;
            let variance = one * theta.cos().powi(2) + other * theta.sin().powi(2);
            (-angle * angle / (2.0 * variance)).exp()
        };
        (0..DIRECTIONS).map(share).sum::<f64>() / DIRECTIONS as f64
    };
    let (mut low, mut high) = (0.0, 3.0 * largest);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if beyond(middle) > BEYOND { low = middle } else { high = middle }
    }
    high
}

/// The 95 % quantile of an F distribution of 1 or 2 and the given degrees of freedom.
fn f_95(over: usize, freedom: usize) -> f64 {
    let freedom = freedom as f64;
    if over == 2 {
        return 0.5 * freedom * (BEYOND.powf(-2.0 / freedom) - 1.0);
    }
    // The square of Student's t: its distribution is integrated by the substitution t = √ν tan θ.
    let integral = |to: f64| {
        const PARTS: usize = 400;
        let step = to / PARTS as f64;
        let density = |theta: f64| theta.cos().powf(freedom - 1.0);
        (0..PARTS).map(|k| density((k as f64 + 0.5) * step)).sum::<f64>() * step
    };
    let whole = integral(std::f64::consts::FRAC_PI_2);
    let within = |t: f64| integral((t / freedom.sqrt()).atan()) / whole;
    let (mut low, mut high) = (0.0, 20.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if within(middle) < 1.0 - BEYOND { low = middle } else { high = middle }
    }
    high * high
}

/// Quantile of a chi-square distribution, from the normal quantile.
///
/// # Source
/// \[WilsonHilferty\], within 4 % at 99.9 % from one degree of freedom on
fn chi_square(freedom: usize, quantile: f64) -> f64 {
    let freedom = freedom as f64;
    let part = 2.0 / (9.0 * freedom);
    freedom * (1.0 - part + quantile * part.sqrt()).powi(3)
}

impl PlaneFit {
    /// Whether the tilt of the plane is too uncertain: its 95 % bound exceeds an allowed angle, by points whose noise is given or enough to estimate it.
    ///
    /// # Arguments
    /// * `allowed` – largest allowed error of the tilt (rad)
    #[must_use]
    pub fn is_uncertain(&self, allowed: f64) -> bool {
        let is_tested = self.noise.is_some() || self.points.len() >= ENOUGH;
        let tilt = self.uncertainty.as_ref().map_or(f64::INFINITY, |known| known.tilt_95);
        self.verdict != Verdict::Scattered && is_tested && tilt > allowed
    }

    /// The nominal frame laid into the plane: its origin moved vertically, its yaw unchanged.
    #[must_use]
    pub fn frame(&self, origin: &Vector3<f64>, yaw: f64) -> Pose {
        let offset = origin - self.center;
        let rise = -(self.normal.x * offset.x + self.normal.y * offset.y) / self.normal.z;
        let in_plane = Vector3::new(origin.x, origin.y, self.center.z + rise);
        frame(in_plane, &self.normal, yaw)
    }
}

/// The frame at an origin with a given normal: a yaw about the vertical, then the tilt.
#[must_use]
pub fn frame(origin: Vector3<f64>, normal: &Vector3<f64>, yaw: f64) -> Pose {
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
    Pose::from_parts(origin.into(), tilt_rotation(normal) * turned)
}

/// Yaw about the vertical of a frame before its tilt: the argument of [`frame`] (rad).
#[must_use]
pub fn yaw(frame: &Pose) -> f64 {
    let normal = frame.rotation * Vector3::z();
    let along = tilt_rotation(&normal).inverse() * (frame.rotation * Vector3::x());
    along.y.atan2(along.x)
}

/// Frame of a station from its first and last slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Resting position of the wafer in the first slot, in the base frame (m).
    pub first: Vector3<f64>,
    /// Distance between slots along the line from first to last (m).
    pub pitch: f64,
    /// Horizontal distance of the last slot from the vertical through the first (m).
    pub drift: f64,
    /// Tilt of the station.
    pub tilt: Tilt,
}

/// The tilt of a station from the resting positions of wafers in its first and last slot.
///
/// # Errors
/// [`TeachError`] where there is only one slot, or the last is not above the first.
///
/// # Assumptions
/// The slots are perpendicular to the line through them.
pub fn drift(first: Vector3<f64>, last: Vector3<f64>, slots: usize) -> Result<Drift, TeachError> {
    if slots < 2 {
        return Err(TeachError::OneSlot { slots });
    }
    let up = last - first;
    if up.z.is_nan() || up.z <= 0.1 * up.norm() {
        return Err(TeachError::NotAbove { rise: up.z });
    }
    Ok(Drift {
        first,
        pitch: up.norm() / (slots as f64 - 1.0),
        drift: up.x.hypot(up.y),
        tilt: Tilt::from_normal(&up),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(tilt: Tilt, places: &[(f64, f64)]) -> Vec<Vector3<f64>> {
        let frame = frame(Vector3::new(0.7, -0.2, 0.9), &tilt.normal(), 0.4);
        places
            .iter()
            .map(|&(x, y)| frame.rotation * Vector3::new(x, y, 0.0))
            .map(|p| p + frame.translation.vector)
            .collect()
    }

    const SQUARE: [(f64, f64); 4] = [(0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)];

    #[test]
    fn plane_fit_reproduces_a_plane() {
        let tilt = Tilt { yaw: 2.0, pitch: 0.0139 };
        let fit = fit_plane(&plane(tilt, &SQUARE), 1e-4, Some(1e-6)).unwrap();
        assert_eq!(fit.verdict, Verdict::Fits);
        assert!((fit.normal - tilt.normal()).norm() < 1e-14 && fit.worst < 1e-15, "{fit:?}");
        let frame = fit.frame(&Vector3::new(0.7, -0.2, 0.0), 0.4);
        assert!((yaw(&frame) - 0.4).abs() < 1e-14);
        assert!((frame.translation.vector.z - 0.9).abs() < 1e-14);
        assert!((frame.rotation * Vector3::z() - tilt.normal()).norm() < 1e-14);
        for (count, noise) in [(3, None), (3, Some(1e-6)), (4, None)] {
            let fit = fit_plane(&plane(tilt, &SQUARE[..count]), 1e-4, noise).unwrap();
            assert_eq!(fit.verdict, Verdict::Unproven);
            assert_eq!(fit.uncertainty.is_some(), count > 3 || noise.is_some());
        }
    }

    #[test]
    fn outlier_exceeds_the_threshold() {
        let mut points = plane(Tilt::LEVEL, &SQUARE);
        points[2].z += 4e-4;
        let fit = fit_plane(&points, 5e-5, None).unwrap();
        // The fit distributes the deviation over all four: a quarter each.
        assert_eq!(fit.verdict, Verdict::Scattered);
        assert!((fit.worst - 1e-4).abs() < 1e-8 && (fit.residual - 1e-4).abs() < 1e-8, "{fit:?}");
        assert_eq!(fit_plane(&points, 2e-4, Some(1e-4)).unwrap().verdict, Verdict::Fits);
        // Within the threshold, but not for points that are known to a micrometre.
        let fit = fit_plane(&points, 2e-4, Some(1e-6)).unwrap();
        assert_eq!(fit.verdict, Verdict::Scattered);
    }

    #[test]
    fn degenerate_points_are_rejected() {
        let tilt = Tilt { yaw: 0.3, pitch: 0.01 };
        let refused =
            |places: &[(f64, f64)]| fit_plane(&plane(tilt, places), 1e-4, None).unwrap_err();
        assert_eq!(refused(&SQUARE[..2]), TeachError::TooFew { found: 2 });
        assert!(matches!(refused(&[(0.0, 0.0); 3]), TeachError::Collinear { .. }));
        let line = [(0.0, 0.0), (0.1, 0.1), (0.2, 0.2), (0.3, 0.3)];
        assert!(matches!(refused(&line), TeachError::Collinear { .. }));
        let nearly = refused(&[(0.0, 0.0), (0.1, 1e-5), (0.2, 0.0)]);
        assert!(nearly.to_string().contains("of one line"), "{nearly}");
        let upright = [Vector3::zeros(), Vector3::z(), Vector3::x(), Vector3::new(1.0, 0.0, 1.0)];
        assert!(matches!(fit_plane(&upright, 1e-4, None), Err(TeachError::Upright { .. })));
        let nan = [Vector3::repeat(f64::NAN), Vector3::z(), Vector3::x()];
        assert_eq!(fit_plane(&nan, 1e-4, None), Err(TeachError::NotFinite));
    }

    #[test]
    fn quantiles_agree_with_published_tables() {
        for (freedom, expected) in [(1, 161.45), (2, 18.513), (3, 10.128), (10, 4.965)] {
            assert!((f_95(1, freedom) / expected - 1.0).abs() < 1e-3, "{}", f_95(1, freedom));
        }
        for (freedom, expected) in [(1, 199.5), (2, 19.0), (10, 4.103)] {
            assert!((f_95(2, freedom) / expected - 1.0).abs() < 1e-3, "{}", f_95(2, freedom));
        }
        for (freedom, expected) in [(1, 10.828), (3, 16.266), (10, 29.588)] {
            let found = chi_square(freedom, FALSE_ALARM_QUANTILE);
            assert!((found / expected - 1.0).abs() < 0.035, "{found}");
        }
        assert!((angle_95([1.0, 1.0]) - 2.447_75).abs() < 1e-4);
        assert!((angle_95([1.0, 0.0]) - TWO_SIDED).abs() < 1e-3, "{}", angle_95([1.0, 0.0]));
    }

    #[test]
    fn drift_of_slots_determines_the_tilt() {
        let tilt = Tilt { yaw: -1.0, pitch: 0.8_f64.to_radians() };
        let first = Vector3::new(0.6, 0.1, 0.5);
        let found = drift(first, first + 0.24 * tilt.normal(), 25).unwrap();
        assert!((found.pitch - 0.01).abs() < 1e-15);
        assert!((found.tilt.normal() - tilt.normal()).norm() < 1e-14);
        assert!((found.drift - 0.24 * tilt.pitch.sin()).abs() < 1e-15);
        assert_eq!(drift(first, first, 25), Err(TeachError::NotAbove { rise: 0.0 }));
        assert_eq!(drift(first, first + Vector3::z(), 1), Err(TeachError::OneSlot { slots: 1 }));
    }
}
