//! Sag of a wafer on its supports under its own weight.

use nalgebra::{DMatrix, DVector};

use jointplay_core::linalg::svd;

use super::model::{Support, Wafer};
use super::plate::{self, SupportRing};

/// Number of points of half a rail; twice as many change the sag by less than a thousandth.
const RAIL_POINTS: usize = 16;

/// Number of circles on which the lowest and highest points of the plate are searched for.
const CIRCLES: usize = 48;

/// Number of directions on each circle, within a quarter revolution for rails and a third of a half revolution for points.
const DIRECTIONS: usize = 32;

/// Relative tolerance for supports at the very edge: round-off.
const TOLERANCE: f64 = 1e-9;

/// Shape of a wafer at rest, as heights above the plane of its supports.
#[derive(Debug, Clone, PartialEq)]
pub struct Sag {
    /// Height of the centre, negative below the supports (m).
    pub center: f64,
    /// Height of the lowest point (m).
    pub lowest: f64,
    /// Height of the highest point (m).
    pub highest: f64,
    /// Height of the plane that fits the wafer in the least-squares sense; parallel to that of the supports, because all supports are symmetric (m).
    pub plane_height: f64,
    /// Root mean square distance of the wafer from that plane (m).
    pub deviation: f64,
    /// Largest deflection as a fraction of the thickness: the linear theory holds up to about a fifth.
    pub share_of_thickness: f64,
}

/// Reason why a sag cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SagError {
    /// A dimension or property is not positive, or not finite.
    #[error("{what} is {value} {unit}, but has to be positive")]
    NotPositive {
        /// The dimension or property.
        what: &'static str,
        /// The value found, in `unit`.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// Poisson's ratio is outside the range of isotropic materials.
    #[error("Poisson's ratio is {found}, but lies between -1 and 0.5")]
    Poisson {
        /// The ratio found.
        found: f64,
    },
    /// The wafer does not reach its supports, or does not rest on them safely.
    #[error(
        "{what} of {found} m does not carry a wafer of {diameter} m: it has to be more than 0 and at most {max} m"
    )]
    Support {
        /// The support.
        what: &'static str,
        /// The dimension found (m).
        found: f64,
        /// Diameter of the wafer (m).
        diameter: f64,
        /// Largest allowed dimension (m).
        max: f64,
    },
    /// The forces on the rails cannot be computed.
    #[error(transparent)]
    Algebra(jointplay_core::Error),
}

/// Sag of a wafer under its own weight.
///
/// ```text
///    D ∇⁴w = q,    D = E h³ / (12 (1 − ν²)),    q = ρ g h        edge free of moment, and of force but at the supports
/// ```
/// On its whole edge w = q a⁴ (5 + ν) / (64 (1 + ν) D) at the centre.
/// On points and rails, w is the sum over the loaded points of exact solutions for the free plate, see docs/explanation/wafers.md; rails only push, so that the plate may lift off them.
///
/// # Errors
/// [`SagError`] for invalid dimensions, and for supports that the wafer would fall off.
///
/// # Assumptions
/// Thin, isotropic, small deflections; no friction in the plane.
///
/// # Source
/// \[Timoshenko\] for the edge; own derivation for the series, docs/explanation/wafers.md.
pub fn sag(wafer: &Wafer, support: &Support, gravity: f64) -> Result<Sag, SagError> {
    let poisson = checked(wafer, gravity)?;
    let a = wafer.diameter / 2.0;
    let unit = wafer.weight_per_area(gravity) * a.powi(4) / wafer.flexural_rigidity();
    let within = |what, found: f64, max: f64| {
        if found > 0.0 && found <= max * (1.0 + TOLERANCE) {
            return Ok((found / max).min(1.0));
        }
        Err(SagError::Support { what, found, diameter: wafer.diameter, max })
    };
    let shape = match *support {
        Support::Edge => Shape { poisson, reactions: Vec::new(), lift: plate::on_edge(poisson) },
        Support::ThreePoints { radius } => {
            let radius = within("a circle of three points with a radius", radius, a)?;
            let ring = SupportRing { radius, angle: 0.0, symmetry: 3 };
            Shape::on(poisson, vec![(ring, 1.0)])
        }
        Support::TwoRails { distance } => {
            let half = within("a distance of two rails", distance, wafer.diameter)?;
            Shape::on(poisson, rails(poisson, half).map_err(SagError::Algebra)?)
        }
    };
    Ok(shape.seen(unit, wafer.thickness))
}

fn checked(wafer: &Wafer, gravity: f64) -> Result<f64, SagError> {
    let material = &wafer.material;
    let positive = [
        ("the diameter of the wafer", wafer.diameter, "m"),
        ("the thickness of the wafer", wafer.thickness, "m"),
        ("Young's modulus", material.young, "Pa"),
        ("the density", material.density, "kg/m³"),
    ];
    for (what, value, unit) in positive {
        if !(value > 0.0 && value.is_finite()) {
            return Err(SagError::NotPositive { what, value, unit });
        }
    }
    if !(gravity >= 0.0 && gravity.is_finite()) {
        return Err(SagError::NotPositive { what: "gravity", value: gravity, unit: "m/s²" });
    }
    let poisson = material.poisson;
    if !(poisson > -1.0 && poisson < 0.5) {
        return Err(SagError::Poisson { found: poisson });
    }
    Ok(poisson)
}

/// Heights of a plate of radius 1, see [`plate`].
struct Shape {
    poisson: f64,
    /// The supports, each with its share of the weight.
    reactions: Vec<(SupportRing, f64)>,
    /// Added to all heights, so that the supports are at height 0.
    lift: f64,
}

impl Shape {
    /// The plate on points, its height relative to the first of them.
    fn on(poisson: f64, reactions: Vec<(SupportRing, f64)>) -> Self {
        let mut shape = Self { poisson, reactions, lift: 0.0 };
        let touching = shape.reactions.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        shape.lift =
            touching.map_or(0.0, |(ring, _)| -shape.circle(ring.radius).height(ring.angle));
        shape
    }

    /// Heights along a circle around the centre.
    fn circle(&self, radius: f64) -> Circle {
        let mut waves = vec![self.lift - plate::under_weight(self.poisson, radius)];
        for (ring, share) in &self.reactions {
            let by_orbit = ring.waves(self.poisson, radius);
            waves.resize(waves.len().max(by_orbit.len()), 0.0);
            waves.iter_mut().zip(by_orbit).for_each(|(wave, one)| *wave += share * one);
        }
        Circle { waves, symmetry: self.symmetry() }
    }

    /// Common factor of the wave numbers of all supports.
    fn symmetry(&self) -> f64 {
        self.reactions.first().map_or(1.0, |(ring, _)| ring.symmetry as f64)
    }

    fn seen(&self, unit: f64, thickness: f64) -> Sag {
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut mean, mut square) = (0.0, 0.0);
        for k in 0..=CIRCLES {
            let radius = k as f64 / CIRCLES as f64;
            let circle = self.circle(radius);
            // After half a wave the height repeats itself, mirrored.
            let sector = std::f64::consts::PI / self.symmetry();
            for direction in 0..=DIRECTIONS {
                let height = circle.height(sector * direction as f64 / DIRECTIONS as f64);
                lowest = lowest.min(height);
                highest = highest.max(height);
            }
            // Simpson's rule over the radius; over the direction the waves are orthogonal.
            let simpson = match k {
                0 | CIRCLES => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let weight = 2.0 * radius * simpson / (3.0 * CIRCLES as f64);
            mean += weight * circle.mean();
            square += weight * circle.mean_square();
        }
        let center = self.circle(0.0).height(0.0);
        Sag {
            center: center * unit,
            lowest: lowest * unit,
            highest: highest * unit,
            plane_height: mean * unit,
            deviation: (square - mean * mean).max(0.0).sqrt() * unit,
            share_of_thickness: lowest.abs().max(highest.abs()) * unit / thickness,
        }
    }
}

/// Heights along a circle around the centre, as a Fourier series in the direction.
struct Circle {
    waves: Vec<f64>,
    symmetry: f64,
}

impl Circle {
    fn height(&self, angle: f64) -> f64 {
        plate::height(&self.waves, self.symmetry * angle)
    }

    /// Mean height along the circle.
    fn mean(&self) -> f64 {
        self.waves[0]
    }

    /// Mean squared height along the circle.
    fn mean_square(&self) -> f64 {
        let waves: f64 = self.waves[1..].iter().map(|wave| wave * wave).sum();
        self.mean().powi(2) + waves / 2.0
    }
}

/// Forces of two rails at ±`half`: never negative, and positive only where the plate touches them.
///
/// ```text
///    least  ½ fᵀ G f − wᵀ f     with  Σ f = 1,  f ≥ 0        G: height at one point by a force at another
/// ```
/// An active-set method: points are released while they pull, and added while the plate would sink into them.
fn rails(poisson: f64, half: f64) -> Result<Vec<(SupportRing, f64)>, jointplay_core::Error> {
    let chord = (1.0 - half * half).max(0.0).sqrt();
    let points: Vec<SupportRing> = (0..=RAIL_POINTS)
        .map(|k| {
            let along = chord * k as f64 / RAIL_POINTS as f64;
            let radius = half.hypot(along).min(1.0);
            SupportRing { radius, angle: along.atan2(half), symmetry: 2 }
        })
        .collect();
    // All points of rails that touch the edge coincide there.
    let points = if chord < TOLERANCE { points[..1].to_vec() } else { points };
    let n = points.len();
    let mut lifted = DMatrix::zeros(n, n);
    for (i, at) in points.iter().enumerate() {
        for (j, by) in points.iter().enumerate() {
            let waves = by.waves(poisson, at.radius);
            lifted[(i, j)] = plate::height(&waves, by.symmetry as f64 * at.angle);
        }
    }
    let weight = DVector::from_fn(n, |i, _| plate::under_weight(poisson, points[i].radius));
    let mut in_contact: Vec<usize> = (0..n).collect();
    // Each set of points has less energy than the one before, so that no set recurs; the bound is for round-off.
    for _ in 0..4 * n {
        let m = in_contact.len();
        let system = DMatrix::from_fn(m + 1, m + 1, |i, j| match (i < m, j < m) {
            (true, true) => lifted[(in_contact[i], in_contact[j])],
            (false, false) => 0.0,
            _ => 1.0,
        });
        let right = DVector::from_fn(m + 1, |i, _| if i < m { weight[in_contact[i]] } else { 1.0 });
        let solved = svd(&system)?.solve(&right, m + 1);
        let weakest = (0..m).min_by(|&i, &j| solved[i].total_cmp(&solved[j])).unwrap_or(0);
        if m > 1 && solved[weakest] < 0.0 {
            in_contact.remove(weakest);
            continue;
        }
        let height = |i: usize| {
            let lift: f64 = (0..m).map(|k| lifted[(i, in_contact[k])] * solved[k]).sum();
            lift - weight[i] + solved[m]
        };
        let deepest = (0..n).min_by(|&i, &j| height(i).total_cmp(&height(j))).unwrap_or(0);
        if in_contact.contains(&deepest) || height(deepest) > -TOLERANCE {
            return Ok(in_contact
                .iter()
                .enumerate()
                .map(|(k, &i)| (points[i], solved[k]))
                .collect());
        }
        in_contact.push(deepest);
        in_contact.sort_unstable();
    }
    Err(jointplay_core::linalg::LinalgError::SvdNotConverged { rows: n, columns: n }.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wafer::Material;

    /// A plate with q a⁴/D = 1.
    fn unit(poisson: f64) -> Wafer {
        let material = Material {
            name: "unit".into(),
            young: 12.0 * (1.0 - poisson * poisson),
            poisson,
            density: 1.0,
        };
        Wafer { diameter: 2.0, thickness: 1.0, material }
    }

    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    #[test]
    fn sag_on_the_edge_has_the_closed_form() {
        for poisson in [0.0_f64, 0.17, 0.28, 0.4] {
            let found = sag(&unit(poisson), &Support::Edge, 1.0).unwrap();
            near(-found.center, (5.0 + poisson) / (64.0 * (1.0 + poisson)), 1e-15);
            assert_eq!(found.lowest, found.center);
            near(found.highest, 0.0, 1e-16);
            // The integrals of w and of w² over the plate, w = ((1 − r²)(c − r²))/64 with c = (5 + ν)/(1 + ν).
            let c = (5.0 + poisson) / (1.0 + poisson);
            near(-found.plane_height, (c / 2.0 - 1.0 / 6.0) / 64.0, 1e-6);
            let square = (c * c / 3.0 - c / 6.0 + 1.0 / 30.0) / 4096.0;
            let mean = (c / 2.0 - 1.0 / 6.0) / 64.0;
            near(found.deviation, (square - mean * mean).sqrt(), 1e-6);
        }
    }

    #[test]
    fn sag_on_edge_points_has_published_values() {
        // Printed for ν = 0.25: three points 0.0362 P a²/D with P = π q a²; two points 0.269 q a⁴/D at the centre and 0.371 q a⁴/D at the free end of the diameter across.
        let three = sag(&unit(0.25), &Support::ThreePoints { radius: 1.0 }, 1.0).unwrap();
        near(-three.center / std::f64::consts::PI, 0.0362, 5e-5);
        let two = sag(&unit(0.25), &Support::TwoRails { distance: 2.0 }, 1.0).unwrap();
        near(-two.center, 0.269, 1e-3);
        near(-two.lowest, 0.371, 5e-4);
    }

    #[test]
    fn plate_touches_its_supports_in_equilibrium() {
        for half in [0.3, 0.5, 0.75, 0.9, 0.97] {
            let reactions = rails(0.28, half).unwrap();
            near(reactions.iter().map(|(_, share)| share).sum(), 1.0, 1e-9);
            assert!(reactions.iter().all(|(_, share)| *share > -1e-9));
            let shape = Shape::on(0.28, reactions.clone());
            for (ring, _) in &reactions {
                near(shape.circle(ring.radius).height(ring.angle), 0.0, 2e-6);
            }
            // Along the rest of the rails the plate may lift, and does not sink.
            let chord = (1.0 - half * half).sqrt();
            for k in 0..=10 {
                let along = chord * f64::from(k) / 10.0;
                let circle = shape.circle(half.hypot(along).min(1.0));
                assert!(circle.height(along.atan2(half)) > -2e-5);
            }
        }
    }

    #[test]
    fn free_edge_has_no_moment_and_force() {
        // Of one wave of one ring: w'' + ν (w' − m² w) and (Δw)' − (1 − ν) m² (w' − w), by differences at the edge.
        let (poisson, h) = (0.28, 1e-3);
        let ring = SupportRing { radius: 0.6, angle: 0.0, symmetry: 3 };
        for k in 1..4 {
            let m2 = (3.0 * k as f64).powi(2);
            let w = |r: f64| ring.waves(poisson, r)[k];
            let first = |r: f64| (w(r + h) - w(r - h)) / (2.0 * h);
            let second = |r: f64| (w(r + h) - 2.0 * w(r) + w(r - h)) / (h * h);
            let laplacian = |r: f64| second(r) + first(r) / r - m2 * w(r) / (r * r);
            let scale = m2 * w(1.0).abs() + second(1.0).abs();
            near(second(1.0) + poisson * (first(1.0) - m2 * w(1.0)), 0.0, 1e-4 * scale);
            let shear = (laplacian(1.0 + h) - laplacian(1.0 - h)) / (2.0 * h);
            let twist = (1.0 - poisson) * m2 * (first(1.0) - w(1.0));
            near(shear - twist, 0.0, 1e-3 * (shear.abs() + twist.abs()).max(scale));
        }
    }

    /// Value and first three derivatives on one side of a place, by eight values there.
    fn one_sided(f: impl Fn(f64) -> f64, at: f64, step: f64) -> [f64; 4] {
        let mut row: Vec<f64> = (0..8).map(|k| f(at + step * f64::from(k))).collect();
        let mut differences = Vec::new();
        while let Some(&first) = row.first() {
            differences.push(first);
            row = row.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        // Coefficients of the powers of ln(1 + Δ).
        let series: [&[f64]; 3] = [
            &[1.0, -1.0 / 2.0, 1.0 / 3.0, -1.0 / 4.0, 1.0 / 5.0, -1.0 / 6.0, 1.0 / 7.0],
            &[1.0, -1.0, 11.0 / 12.0, -5.0 / 6.0, 137.0 / 180.0, -7.0 / 10.0],
            &[1.0, -3.0 / 2.0, 7.0 / 4.0, -15.0 / 8.0, 29.0 / 15.0],
        ];
        let derivative = |order: usize| {
            let terms = series[order - 1].iter().zip(&differences[order..]);
            terms.map(|(a, b)| a * b).sum::<f64>() / step.powi(order as i32)
        };
        [differences[0], derivative(1), derivative(2), derivative(3)]
    }

    #[test]
    fn only_the_shear_force_is_discontinuous_at_supports() {
        let b = 0.6;
        let ring = SupportRing { radius: b, angle: 0.0, symmetry: 3 };
        for k in 0..4 {
            let wave = |r: f64| ring.waves(0.28, r)[k];
            let (below, above) = (one_sided(wave, b, -0.01), one_sided(wave, b, 0.01));
            // Of the force π spread over the circle: its mean, and twice that in each wave.
            let push = if k == 0 { 0.5 / b } else { 1.0 / b };
            let scale = above[3].abs() + below[3].abs();
            for (order, jump) in [0.0, 0.0, 0.0, push].into_iter().enumerate() {
                near(above[order] - below[order], jump, 1e-3 * scale.max(1.0));
            }
        }
    }

    #[test]
    fn best_support_circle_minimizes_the_sag() {
        let depth = |radius| {
            let found = sag(&unit(0.28), &Support::ThreePoints { radius }, 1.0).unwrap();
            found.highest - found.lowest
        };
        let best =
            (30..=100).map(|k| f64::from(k) / 100.0).min_by(|a, b| depth(*a).total_cmp(&depth(*b)));
        assert!((0.6..0.75).contains(&best.unwrap()), "{best:?}");
    }

    #[test]
    fn invalid_supports_are_rejected() {
        let refused = |support| sag(&unit(0.28), &support, 1.0).unwrap_err();
        for radius in [0.0, -1.0, 1.01, f64::NAN] {
            let error = refused(Support::ThreePoints { radius });
            assert!(error.to_string().contains("does not carry"), "{error}");
        }
        assert_eq!(
            refused(Support::ThreePoints { radius: 1.01 }).to_string(),
            "a circle of three points with a radius of 1.01 m does not carry a wafer of 2 m: it has to be more than 0 and at most 1 m"
        );
        assert!(matches!(refused(Support::TwoRails { distance: 2.1 }), SagError::Support { .. }));
        let mut wafer = unit(0.28);
        wafer.material.poisson = 0.5;
        assert_eq!(sag(&wafer, &Support::Edge, 1.0), Err(SagError::Poisson { found: 0.5 }));
        wafer.thickness = 0.0;
        assert!(matches!(sag(&wafer, &Support::Edge, 1.0), Err(SagError::NotPositive { .. })));
    }
}
