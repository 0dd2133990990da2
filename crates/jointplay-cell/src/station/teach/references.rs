//! Centre and heading of a station from reference points.

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation2, Vector2, Vector3};

use super::error::{TeachError, check_noise};
use super::fit_result::{
    Agreement, Deviations, FALSE_ALARM, NO_REDUNDANCY, PointDiagnostic, REDUNDANT,
};
use super::plane::SPREAD;

/// Number of redundant coordinates from which on the deviations estimate an unknown noise.
const MIN_REDUNDANCY: usize = 3;

/// A point whose position in the station is known, such as the centre of a wafer or a pin, and where it was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferencePoint {
    /// Nominal position across and inward, in the station frame (m).
    pub nominal: Vector2<f64>,
    /// Measured position, in the base frame (m).
    pub measured: Vector3<f64>,
}

/// Least-squares centre and heading of a station within its plane.
///
/// ```text
///    measured_i  =  shift + R(turn) nominal_i + error_i        in the station frame with its nominal centre and heading
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceFit {
    /// The reference points.
    pub references: Vec<ReferencePoint>,
    /// Displacement of the station's origin from its nominal position, in the station frame (m).
    pub shift: Vector2<f64>,
    /// Rotation of the station from its nominal heading (rad); `None` where all references are at one place, so that the heading remains nominal.
    pub turn: Option<f64>,
    /// Deviation of each reference point from the fit, in the station frame (m).
    pub deviations: Vec<Vector2<f64>>,
    /// How well the reference points agree, by their deviations.
    pub agreement: Agreement,
    /// Uncertainty; `None` where the noise is neither known nor can be estimated.
    pub uncertainty: Option<ReferenceUncertainty>,
}

/// Uncertainty of centre and heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceUncertainty {
    /// Standard deviation of a measured coordinate, given or estimated: the least of all references (m).
    pub noise: f64,
    /// Degrees of freedom of an estimated noise; `None` where it is given.
    pub degrees_of_freedom: Option<usize>,
    /// Standard deviation of the centroid of the references in each direction (m).
    pub center: f64,
    /// Standard deviation of the heading (rad); 0 where it is nominal.
    pub turn: f64,
    /// Nominal centroid of the references, in the station frame (m).
    pub nominal_center: Vector2<f64>,
    /// Change of the shift by a rotation of the plane about x and about y, from the heights at which the references were measured (m).
    pub shift_by_tilt: [Vector2<f64>; 2],
    /// Change of the heading by a rotation of the plane about x and about y.
    pub turn_by_tilt: [f64; 2],
}

impl ReferenceUncertainty {
    /// Standard deviation of the centre in its least certain direction (m).
    #[must_use]
    pub fn shift_deviation(&self) -> f64 {
        self.center.hypot(self.turn * self.nominal_center.norm())
    }
}

/// Fits centre and heading to reference points within the plane of a station.
///
/// # Arguments
/// * `base_from_nominal` – frame of the station with its nominal centre and heading, in its taught plane
/// * `references` – one or more; two or more at different places determine the heading
/// * `threshold` – largest allowed deviation of a reference point (m)
/// * `noise` – standard deviation of each coordinate of each reference point; `None` where it is not known, and assumed equal for all (m)
///
/// # Errors
/// [`TeachError`] without references, for coordinates that are not finite, and for noise that is not positive.
///
/// # Numerics
/// Closed form: weighted centroids, and the rotation that aligns the vectors from them \[Umeyama\].
///
/// # Assumptions
/// The errors of the references are independent, normal and isotropic; those along the normal of the plane have no effect.
pub fn fit_references(
    base_from_nominal: &Pose,
    references: &[ReferencePoint],
    threshold: f64,
    noise: Option<&[f64]>,
) -> Result<ReferenceFit, TeachError> {
    if references.is_empty() {
        return Err(TeachError::NoReferences);
    }
    check_noise(noise, references.len())?;
    let is_finite =
        |one: &ReferencePoint| one.nominal.iter().chain(&one.measured).all(|x| x.is_finite());
    if !references.iter().all(is_finite) {
        return Err(TeachError::NotFinite);
    }
    let count = references.len();
    let least = noise.map_or(1.0, |noise| noise.iter().copied().fold(f64::INFINITY, f64::min));
    let weights: Vec<f64> =
        (0..count).map(|k| noise.map_or(1.0, |noise| (least / noise[k]).powi(2))).collect();
    let total: f64 = weights.iter().sum();
    let mean = |of: &dyn Fn(usize) -> Vector2<f64>| {
        (0..count).map(|k| of(k) * weights[k]).sum::<Vector2<f64>>() / total
    };
    let station: Vec<Vector3<f64>> = references
        .iter()
        .map(|one| base_from_nominal.inverse_transform_point(&one.measured.into()).coords)
        .collect();
    let nominal_center = mean(&|k| references[k].nominal);
    let measured_center = mean(&|k| station[k].xy());
    let nominal = |k: usize| references[k].nominal - nominal_center;
    let measured = |k: usize| station[k].xy() - measured_center;
    let squares: f64 = (0..count).map(|k| weights[k] * nominal(k).norm_squared()).sum();
    let has_heading = (squares / total).sqrt() > SPREAD * threshold;
    let (cos, sin) = (0..count).fold((0.0, 0.0), |(cos, sin), k| {
        let (a, b) = (nominal(k), measured(k));
        (cos + weights[k] * a.dot(&b), sin + weights[k] * a.perp(&b))
    });
    let turn = has_heading.then(|| sin.atan2(cos));
    let rotation = Rotation2::new(turn.unwrap_or(0.0));
    let shift = measured_center - rotation * nominal_center;
    let deviations: Vec<Vector2<f64>> =
        (0..count).map(|k| station[k].xy() - shift - rotation * references[k].nominal).collect();
    let worst = deviations.iter().map(|one| one.norm()).fold(0.0, f64::max);
    let freedom = 2 * count - if has_heading { 3 } else { 2 };
    let sum: f64 = deviations.iter().zip(&weights).map(|(d, w)| w * d.norm_squared()).sum();
    let chi = noise.map(|_| sum / (least * least));
    let estimated = (freedom > 0).then(|| (sum / freedom as f64).sqrt());
    let sigma = if noise.is_some() { Some(least) } else { estimated };
    let diagnostic = |k: usize| {
        let from_center = nominal(k);
        let lever =
            if has_heading { weights[k] * from_center.norm_squared() / squares } else { 0.0 };
        let share = weights[k] / total;
        let sigma = match noise {
            Some(noise) => noise[k],
            None => sigma.unwrap_or(0.0),
        };
        // The fit follows errors around the centroid more than those away from it.
        let outward = (rotation * from_center).try_normalize(0.0).unwrap_or_else(Vector2::x);
        let parts = [
            (deviations[k].dot(&outward), 1.0 - share),
            (outward.perp(&deviations[k]), 1.0 - share - lever),
        ];
        let shown = parts.iter().filter(|(_, redundancy)| *redundancy > NO_REDUNDANCY);
        let sum: f64 = shown.clone().map(|(d, r)| d * d / (r * sigma * sigma)).sum();
        let is_shown = sigma > 0.0 && shown.count() > 0;
        PointDiagnostic {
            leverage: share + 0.5 * lever,
            standardized: is_shown.then(|| sum.sqrt()),
        }
    };
    let diagnostics: Vec<PointDiagnostic> = (0..count).map(diagnostic).collect();
    let needed = if noise.is_some() { REDUNDANT } else { MIN_REDUNDANCY };
    let agreement = Deviations {
        diagnostics,
        worst,
        threshold,
        noise,
        chi_square: chi,
        redundancy: freedom,
        // The length of two independent normal errors exceeds R with the probability exp(−R²/2).
        outlier: (-2.0 * (FALSE_ALARM / count as f64).ln()).sqrt(),
        is_testable: freedom >= needed,
    }
    .tested();
    let uncertainty = sigma.map(|sigma| {
        // A rotation of the plane moves what was measured at a height over it.
        let by_tilt = |tilt: Vector2<f64>| {
            let moved = |k: usize| -Vector2::new(tilt.y, -tilt.x) * station[k].z;
            let turned: f64 =
                (0..count).map(|k| weights[k] * nominal(k).perp(&moved(k))).sum::<f64>();
            let turn = if has_heading { turned / squares } else { 0.0 };
            let around = Vector2::new(-nominal_center.y, nominal_center.x) * turn;
            (mean(&moved) - around, turn)
        };
        let by_tilt = [by_tilt(Vector2::x()), by_tilt(Vector2::y())];
        ReferenceUncertainty {
            noise: sigma,
            degrees_of_freedom: noise.is_none().then_some(freedom),
            center: sigma / total.sqrt(),
            turn: if has_heading { sigma / squares.sqrt() } else { 0.0 },
            nominal_center,
            shift_by_tilt: by_tilt.map(|one| one.0),
            turn_by_tilt: by_tilt.map(|one| one.1),
        }
    });
    Ok(ReferenceFit {
        references: references.to_vec(),
        shift,
        turn,
        deviations,
        agreement,
        uncertainty,
    })
}

impl ReferenceFit {
    /// Index of the reference point to be measured again, where they are inconsistent; `None` where they agree, and where they do not determine which one deviates.
    #[must_use]
    pub fn suspect(&self) -> Option<usize> {
        self.agreement.suspect().filter(|_| self.references.len() >= 3)
    }

    /// Number of further reference points with which the fit can be judged.
    #[must_use]
    pub fn missing(&self) -> usize {
        let needed = if self.agreement.noise.is_some() { REDUNDANT } else { MIN_REDUNDANCY };
        needed.saturating_sub(self.agreement.redundancy).div_ceil(2)
    }
}
