//! Least-squares planes of taught points.

use jointplay_core::linalg::{Svd, svd};
use jointplay_core::spatial::{Pose, Tilt};
use nalgebra::{DMatrix, Vector3};

use super::error::{TeachError, check_noise};
use super::fit_result::{
    Agreement, Deviations, FALSE_ALARM, FitResult, NO_REDUNDANCY, PointDiagnostic, REDUNDANT,
};
use super::frame::frame;
use super::quantile::{TWO_SIDED, angle_95, f_95, student};
use super::uncertainty::coverage;

/// Multiple of the threshold below which points are on one line: the tilt about that line is undetermined.
pub(super) const SPREAD: f64 = 10.0;

/// Number of points from which on their distances from the plane estimate the noise to better than a factor of about three (95 %).
pub const MIN_POINTS_OF_UNKNOWN_NOISE: usize = 6;

/// Standardized deviation up to which no point counts as an outlier, whatever the number of points.
const LEAST_OUTLIER: f64 = 3.0;

/// Least-squares plane of taught points.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneFit {
    /// Centroid of the points, weighted by their accuracy, in the base frame (m).
    pub center: Vector3<f64>,
    /// Unit normal, upward, in the base frame.
    pub normal: Vector3<f64>,
    /// Tilt of the plane.
    pub tilt: Tilt,
    /// Distance of each point from the plane, above positive (m).
    pub distances: Vec<f64>,
    /// How well the points agree with the plane, by their distances from it.
    pub agreement: Agreement,
    /// Root mean square distance (m).
    pub residual: f64,
    /// The points, in the base frame (m).
    pub points: Vec<Vector3<f64>>,
    /// Root mean square distance of the points from the line that fits them best, within the plane: it determines the tilt about that line (m).
    pub spread: f64,
    /// Uncertainty of the plane; `None` for three points whose noise is not known.
    pub uncertainty: Option<Box<PlaneUncertainty>>,
}

/// Uncertainty of a fitted plane: the covariance of tilt and height along the principal directions of the points, where both slopes and the height at the centroid are uncorrelated.
///
/// ```text
///    var(slope_k)  =  1 / Σ w u_k²        var(height)  =  1/Σ w + Σ_k p_k² / Σ w u_k²        w = 1/σ²;  u_k: coordinates of the points from their centre, p_k: those of the place asked about
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneUncertainty {
    /// Standard deviation of a measured coordinate, given or estimated from the distances: the least of all points (m).
    pub noise: f64,
    /// Whether that is estimated from the distances, with [`Agreement::redundancy`] degrees of freedom.
    pub is_estimated: bool,
    /// Principal directions of the points in their plane, in the base frame.
    pub directions: [Vector3<f64>; 2],
    /// Standard deviation of the slope along each (rad).
    pub slopes: [f64; 2],
    /// Standard deviation of the height at the centre of the points (m).
    pub height: f64,
    /// Angle within which the true normal lies with 95 % confidence (rad).
    pub tilt_95: f64,
    /// Factor on a standard deviation of a height that gives 95 % confidence.
    factor: f64,
    /// Degrees of freedom of an estimated noise; `None` where it is given.
    pub degrees_of_freedom: Option<usize>,
    /// Centroid of the points, in the base frame (m).
    center: Vector3<f64>,
}

impl PlaneUncertainty {
    /// Root mean square angle between the fitted and the true normal (rad).
    #[must_use]
    pub fn tilt(&self) -> f64 {
        self.slopes[0].hypot(self.slopes[1])
    }

    /// Standard deviation of the tilt in its least certain direction, times a coverage factor (rad).
    #[must_use]
    pub fn expanded_tilt(&self, coverage_factor: f64) -> f64 {
        coverage(coverage_factor, self.degrees_of_freedom) * self.slopes[0].max(self.slopes[1])
    }

    /// Standard deviation of the height of the true plane over a position (m).
    ///
    /// # Arguments
    /// * `place` – position in the base frame (m)
    #[must_use]
    pub fn height_deviation(&self, place: &Vector3<f64>) -> f64 {
        let [first, second] = self.lever(place);
        self.height.hypot(first * self.slopes[0]).hypot(second * self.slopes[1])
    }

    /// Half-width of the 95 % confidence interval of the height of the true plane over a position (m).
    ///
    /// # Arguments
    /// * `place` – position in the base frame (m)
    #[must_use]
    pub fn height_95(&self, place: &Vector3<f64>) -> f64 {
        self.factor * self.height_deviation(place)
    }

    /// Coordinates of a position along the principal directions, from the centre of the points (m).
    pub(super) fn lever(&self, place: &Vector3<f64>) -> [f64; 2] {
        self.directions.map(|direction| (place - self.center).dot(&direction))
    }
}

/// Fits a plane to taught points, with its uncertainty.
///
/// # Arguments
/// * `points` – three or more, in the base frame (m)
/// * `threshold` – largest allowed distance of a point from the plane (m)
/// * `noise` – standard deviation of the coordinates of each point; `None` where it is not known, equal for all, and estimated from the distances (m)
///
/// # Errors
/// [`TeachError`] for too few points, equal points, points on a line, an upright plane, and noise that is not positive.
///
/// # Numerics
/// Singular values of the centred points, weighted by the inverse of their noise: the last direction is the normal.
/// The 95 % bound of the tilt is exact for two independent normal slopes where the noise is given; where it is estimated, it is that of the F distribution of 2 and `freedom` for the larger of both slopes, which is conservative.
/// Points count as inconsistent where the chi-square test of all distances fails, or that of the largest standardized one, each with a false alarm rate of 10⁻³.
///
/// # Assumptions
/// The errors of the points are independent, normal and isotropic; errors within the plane have no first-order effect.
pub fn fit_plane(
    points: &[Vector3<f64>],
    threshold: f64,
    noise: Option<&[f64]>,
) -> Result<PlaneFit, TeachError> {
    check_noise(noise, points.len())?;
    if points.len() < 3 {
        return Err(TeachError::TooFew { found: points.len() });
    }
    let weighted = Weighted::new(points, noise)?;
    let Weighted { center, least, ref weights, total, ref found } = weighted;
    let mean = |value: f64| value / total.sqrt();
    let spread = mean(found.singular_values[1]);
    // Round-off of the coordinates bounds the residual from below, however good the points are.
    let min = (SPREAD * threshold).max(1e-9 * center.norm().max(found.largest()));
    if spread <= min {
        return Err(weighted.degenerate(points, spread, min));
    }
    let direction = Vector3::new(found.v[(0, 2)], found.v[(1, 2)], found.v[(2, 2)]);
    let normal = if direction.z < 0.0 { -direction } else { direction };
    let tilt = Tilt::from_normal(&normal);
    if normal.z < 0.1 {
        return Err(TeachError::Upright { tilt: tilt.angle });
    }
    let distances: Vec<f64> = points.iter().map(|point| (point - center).dot(&normal)).collect();
    let worst = distances.iter().fold(0.0_f64, |worst, distance| worst.max(distance.abs()));
    let residual = (distances.iter().map(|d| d * d).sum::<f64>() / points.len() as f64).sqrt();
    let freedom = points.len() - 3;
    let squares = distances.iter().zip(weights).map(|(d, w)| w * d * d).sum::<f64>();
    let chi = noise.map(|_| squares / (least * least));
    let estimated = (freedom > 0).then(|| (squares / freedom as f64).sqrt());
    let leverages = weighted.leverages(points);
    let standardized = |k: usize| {
        let redundancy = 1.0 - leverages[k];
        if redundancy < NO_REDUNDANCY {
            return None;
        }
        let deviation = match noise {
            Some(noise) => noise[k],
            // Without this point: its own error does not widen its own test.
            None if freedom > 1 => {
                let others = squares - distances[k] * distances[k] / redundancy;
                (others.max(0.0) / (freedom - 1) as f64).sqrt()
            }
            None => return None,
        };
        let expected = deviation * redundancy.sqrt();
        (expected > 0.0).then(|| distances[k] / expected)
    };
    let diagnostics: Vec<PointDiagnostic> = (0..points.len())
        .map(|k| PointDiagnostic { leverage: leverages[k], standardized: standardized(k) })
        .collect();
    let agreement = Deviations {
        diagnostics,
        worst,
        threshold,
        noise,
        chi_square: chi,
        redundancy: freedom,
        outlier: outlier(points.len()),
        is_testable: is_testable(noise.is_some(), points.len()),
    }
    .tested();
    let sigma = if noise.is_some() { Some(least) } else { estimated };
    let uncertainty = sigma.map(|sigma| {
        let slopes = [0, 1].map(|k| sigma / found.singular_values[k]);
        let [tilt_95, factor] = match noise {
            Some(_) => [angle_95(slopes), TWO_SIDED],
            None => {
                let [normals, planes] = [1, 2].map(|over| f_95(over, freedom).sqrt());
                [2.0_f64.sqrt() * planes * slopes[0].max(slopes[1]), normals]
            }
        };
        Box::new(PlaneUncertainty {
            noise: sigma,
            is_estimated: noise.is_none(),
            directions: [0, 1].map(|k| Vector3::from_fn(|row, _| found.v[(row, k)])),
            slopes,
            height: mean(sigma),
            tilt_95,
            factor,
            degrees_of_freedom: noise.is_none().then_some(freedom),
            center,
        })
    });
    Ok(PlaneFit {
        center,
        normal,
        tilt,
        distances,
        agreement,
        residual,
        points: points.to_vec(),
        spread,
        uncertainty,
    })
}

/// Standardized distance above which one of this many points counts as an outlier.
fn outlier(points: usize) -> f64 {
    student(FALSE_ALARM / points as f64, None).max(LEAST_OUTLIER)
}

/// Whether this many points of a plane test themselves.
pub(super) fn is_testable(is_noise_known: bool, points: usize) -> bool {
    if is_noise_known { points >= 3 + REDUNDANT } else { points >= MIN_POINTS_OF_UNKNOWN_NOISE }
}

/// Points weighted by their accuracy: 1 for the most accurate ones.
struct Weighted {
    center: Vector3<f64>,
    /// Least noise of all points; 1 where it is not known.
    least: f64,
    weights: Vec<f64>,
    /// Sum of the weights.
    total: f64,
    /// Singular values and directions of the weighted points from their centre.
    found: Svd,
}

impl Weighted {
    fn new(points: &[Vector3<f64>], noise: Option<&[f64]>) -> Result<Self, TeachError> {
        let least = noise.map_or(1.0, |noise| noise.iter().copied().fold(f64::INFINITY, f64::min));
        let weight = |k: usize| noise.map_or(1.0, |noise| (least / noise[k]).powi(2));
        let weights: Vec<f64> = (0..points.len()).map(weight).collect();
        let total: f64 = weights.iter().sum();
        let center = points.iter().zip(&weights).map(|(p, &w)| p * w).sum::<Vector3<f64>>() / total;
        let centered = DMatrix::from_fn(points.len(), 3, |i, j| {
            weights[i].sqrt() * (points[i][j] - center[j])
        });
        let found = svd(&centered).map_err(|_| TeachError::NotFinite)?;
        Ok(Self { center, least, weights, total, found })
    }

    /// Leverage of each point.
    fn leverages(&self, points: &[Vector3<f64>]) -> Vec<f64> {
        let of = |(point, weight): (&Vector3<f64>, &f64)| {
            let from_center = point - self.center;
            let along = (0..2).map(|k| {
                let direction = Vector3::from_fn(|row, _| self.found.v[(row, k)]);
                (from_center.dot(&direction) / self.found.singular_values[k]).powi(2)
            });
            weight * (1.0 / self.total + along.sum::<f64>())
        };
        points.iter().zip(&self.weights).map(of).collect()
    }

    /// The reason why points determine no plane.
    fn degenerate(&self, points: &[Vector3<f64>], spread: f64, min: f64) -> TeachError {
        let equal = |first: usize| {
            let second = (first + 1..points.len()).find(|&k| points[k] == points[first])?;
            Some((first, second))
        };
        let is_new = |&k: &usize| points[..k].iter().all(|before| *before != points[k]);
        let different = (0..points.len()).filter(is_new).count();
        if different < 3
            && let Some((first, second)) = (0..points.len()).find_map(equal)
        {
            return TeachError::Repeated { first, second };
        }
        let along = Vector3::new(self.found.v[(0, 0)], self.found.v[(1, 0)], 0.0);
        let across = Vector3::new(-along.y, along.x, 0.0)
            .try_normalize(f64::MIN_POSITIVE)
            .unwrap_or_else(Vector3::x);
        let from_center = points.iter().map(|point| (point - self.center).norm());
        let far = from_center.fold(min * (points.len() as f64).sqrt() * 2.0, f64::max);
        TeachError::Collinear { spread, min, best: self.center + across * far }
    }
}

impl PlaneFit {
    /// Result of the fit, where the expanded uncertainty of the tilt must not exceed an allowed angle.
    ///
    /// # Arguments
    /// * `allowed` – largest allowed error of the tilt (rad)
    /// * `coverage_factor` – multiple of the standard deviation that has to be allowed
    #[must_use]
    pub fn result_for(&self, allowed: f64, coverage_factor: f64) -> FitResult {
        match self.agreement.result {
            FitResult::Fits if self.is_uncertain(allowed, coverage_factor) => FitResult::Uncertain,
            result => result,
        }
    }

    /// Whether the expanded uncertainty of the tilt exceeds an allowed angle, for points whose noise is given or enough to estimate it.
    pub(super) fn is_uncertain(&self, allowed: f64, coverage_factor: f64) -> bool {
        let is_tested =
            self.agreement.noise.is_some() || self.points.len() >= MIN_POINTS_OF_UNKNOWN_NOISE;
        let tilt = self.uncertainty.as_ref();
        let tilt = tilt.map_or(f64::INFINITY, |known| known.expanded_tilt(coverage_factor));
        self.agreement.result != FitResult::Inconsistent && is_tested && tilt > allowed
    }

    /// Index of the point to be measured again, where the points are inconsistent: the one with the largest deviation relative to its noise.
    ///
    /// `None` where the points agree, and where one redundant point does not determine which of them deviates.
    #[must_use]
    pub fn suspect(&self) -> Option<usize> {
        self.agreement.suspect()
    }

    /// The nominal frame laid into the plane: its origin moved vertically, its heading unchanged.
    #[must_use]
    pub fn frame(&self, origin: &Vector3<f64>, heading: f64) -> Pose {
        let offset = origin - self.center;
        let rise = -(self.normal.x * offset.x + self.normal.y * offset.y) / self.normal.z;
        let in_plane = Vector3::new(origin.x, origin.y, self.center.z + rise);
        frame(in_plane, &self.normal, heading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointplay_core::spatial::heading;

    fn plane(tilt: Tilt, places: &[(f64, f64)]) -> Vec<Vector3<f64>> {
        let frame = frame(Vector3::new(0.7, -0.2, 0.9), &tilt.normal(), 0.4);
        places
            .iter()
            .map(|&(x, y)| frame.rotation * Vector3::new(x, y, 0.0))
            .map(|p| p + frame.translation.vector)
            .collect()
    }

    const SQUARE: [(f64, f64); 4] = [(0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)];
    const SEVEN: [(f64, f64); 7] = [
        (0.1, 0.1),
        (-0.1, 0.1),
        (-0.1, -0.1),
        (0.1, -0.1),
        (0.14, 0.0),
        (0.0, 0.14),
        (-0.14, 0.0),
    ];

    #[test]
    fn plane_fit_reproduces_a_plane() {
        let tilt = Tilt { azimuth: 2.0, angle: 0.0139 };
        let fit = fit_plane(&plane(tilt, &SEVEN), 1e-4, Some(&[1e-6; 7])).unwrap();
        assert_eq!(fit.agreement.result, FitResult::Fits);
        assert!(
            (fit.normal - tilt.normal()).norm() < 1e-14 && fit.agreement.worst < 1e-15,
            "{fit:?}"
        );
        let frame = fit.frame(&Vector3::new(0.7, -0.2, 0.0), 0.4);
        assert!((heading(&frame) - 0.4).abs() < 1e-14);
        assert!((frame.translation.vector.z - 0.9).abs() < 1e-14);
        assert!((frame.rotation * Vector3::z() - tilt.normal()).norm() < 1e-14);
        for (count, noise) in [(3, None), (3, Some(1e-6)), (4, None), (4, Some(1e-6)), (5, None)] {
            let noise = noise.map(|noise| vec![noise; count]);
            let fit = fit_plane(&plane(tilt, &SEVEN[..count]), 1e-4, noise.as_deref()).unwrap();
            assert_eq!(fit.agreement.result, FitResult::Untested);
            assert_eq!(fit.uncertainty.is_some(), count > 3 || noise.is_some());
        }
    }

    #[test]
    fn outlier_exceeds_the_threshold() {
        let mut points = plane(Tilt::LEVEL, &SQUARE);
        points[2].z += 4e-4;
        let fit = fit_plane(&points, 5e-5, None).unwrap();
        // The fit distributes the deviation over all four: a quarter each.
        assert_eq!(fit.agreement.result, FitResult::Inconsistent);
        assert!(
            (fit.agreement.worst - 1e-4).abs() < 1e-8 && (fit.residual - 1e-4).abs() < 1e-8,
            "{fit:?}"
        );
        // One redundant point does not determine which of the four deviates.
        assert_eq!(fit.suspect(), None);
        let explained = fit_plane(&points, 2e-4, Some(&[1e-4; 4])).unwrap();
        assert_eq!(explained.agreement.result, FitResult::Untested);
        // Within the threshold, but not for points that are known to a micrometre.
        let fit = fit_plane(&points, 2e-4, Some(&[1e-6; 4])).unwrap();
        assert_eq!(fit.agreement.result, FitResult::Inconsistent);
    }

    #[test]
    fn point_with_the_error_is_named() {
        for deviating in 0..7 {
            let mut points = plane(Tilt { azimuth: 0.2, angle: 0.01 }, &SEVEN);
            points[deviating].z += 3e-4;
            for noise in [None, Some([1e-5; 7])] {
                let fit = fit_plane(&points, 5e-5, noise.as_ref().map(<[f64; 7]>::as_slice));
                assert_eq!(fit.unwrap().suspect(), Some(deviating));
            }
            // The largest distance alone would be misled by a point that is known to be poor.
            let noise: Vec<f64> =
                (0..7).map(|k| if k == deviating { 1e-3 } else { 1e-5 }).collect();
            let fit = fit_plane(&points, 5e-4, Some(&noise)).unwrap();
            assert_eq!(fit.agreement.result, FitResult::Fits, "{fit:?}");
        }
    }

    #[test]
    fn leverages_add_up_to_the_three_parameters() {
        let noise = [1e-6, 2e-6, 5e-6, 1e-6, 4e-6, 1e-6, 3e-6];
        let points = plane(Tilt { azimuth: 0.2, angle: 0.01 }, &SEVEN);
        let fit = fit_plane(&points, 1e-4, Some(&noise)).unwrap();
        let sum: f64 = fit.agreement.diagnostics.iter().map(|point| point.leverage).sum();
        assert!((sum - 3.0).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn degenerate_points_are_rejected() {
        let tilt = Tilt { azimuth: 0.3, angle: 0.01 };
        let refused =
            |places: &[(f64, f64)]| fit_plane(&plane(tilt, places), 1e-4, None).unwrap_err();
        assert_eq!(refused(&SQUARE[..2]), TeachError::TooFew { found: 2 });
        let repeated = TeachError::Repeated { first: 0, second: 2 };
        assert_eq!(refused(&[(0.0, 0.0), (0.1, 0.0), (0.0, 0.0)]), repeated);
        let line = [(0.0, 0.0), (0.1, 0.1), (0.2, 0.2), (0.3, 0.3)];
        let collinear = refused(&line);
        // The point that the error names makes the plane.
        let TeachError::Collinear { best, .. } = collinear else { panic!("{collinear:?}") };
        let mut more = plane(tilt, &line);
        more.push(best);
        assert!(fit_plane(&more, 1e-4, None).is_ok());
        let nearly = refused(&[(0.0, 0.0), (0.1, 1e-5), (0.2, 0.0)]);
        assert!(nearly.to_string().contains("of one line"), "{nearly}");
        let upright = [Vector3::zeros(), Vector3::z(), Vector3::x(), Vector3::new(1.0, 0.0, 1.0)];
        assert!(matches!(fit_plane(&upright, 1e-4, None), Err(TeachError::Upright { .. })));
        let nan = [Vector3::repeat(f64::NAN), Vector3::z(), Vector3::x()];
        assert_eq!(fit_plane(&nan, 1e-4, None), Err(TeachError::NotFinite));
        let three = plane(tilt, &SQUARE[..3]);
        for (noise, error) in [
            (&[0.0, 1e-6, 1e-6][..], TeachError::Noise { found: 0.0 }),
            (&[1e-6; 2], TeachError::NoiseCount { found: 2, points: 3 }),
        ] {
            assert_eq!(fit_plane(&three, 1e-4, Some(noise)), Err(error));
        }
    }
}
