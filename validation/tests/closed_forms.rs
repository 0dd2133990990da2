//! Closed forms against the library, each by independent geometry.

use jointplay::gpr::Gpr;
use jointplay::virtualization::{Metric, Offset, Planar, Polar, Radial, Solver, Virtualization};
use jointplay_validation::cases::{HEIGHT, RADIUS, azimuths_deg, pose, tilt};
use jointplay_validation::centers::{Triangle, centroid, circumcenter, fermat_point};
use jointplay_validation::elastic::{equilibrium, weighted_fit};
use nalgebra::{Vector2, Vector3};

const UM: f64 = 1e-6;
const TILTS_DEG: [f64; 4] = [0.5, 1.0, 2.0, 5.0];

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "found {found:e}, expected {expected:e}, off by {off:e}");
}

fn balls(azimuth_deg: f64, tilt_deg: f64) -> Triangle {
    let gpr = Gpr::paper().without_limit_checks();
    gpr.ball_centers(&gpr.inverse(tilt(azimuth_deg, tilt_deg), HEIGHT).expect("a pose"))
}

fn origin(
    model: &dyn Virtualization,
    solver: Solver,
    azimuth_deg: f64,
    tilt_deg: f64,
) -> Vector3<f64> {
    pose(model, solver, Metric::Paper, azimuth_deg, tilt_deg).base_from_platform.translation.vector
}

#[test]
fn centres_are_what_they_are_called() {
    for azimuth in azimuths_deg() {
        let corners = balls(azimuth, 2.0);
        let fermat = fermat_point(&corners);
        for k in 0..3 {
            let (a, b) = (corners[k] - fermat, corners[(k + 1) % 3] - fermat);
            near(a.angle(&b).to_degrees(), 120.0, 1e-11);
        }
        let center = circumcenter(&corners);
        let radii = corners.map(|corner| (corner - center).norm());
        near(radii[1] / radii[0], 1.0, 1e-15);
        near(radii[2] / radii[0], 1.0, 1e-15);
    }
}

#[test]
fn radial_is_the_fermat_point() {
    for tilt_angle in TILTS_DEG {
        for azimuth in azimuths_deg() {
            for solver in [Solver::Newton, Solver::ClosedForm] {
                let off = origin(&Radial, solver, azimuth, tilt_angle)
                    - fermat_point(&balls(azimuth, tilt_angle));
                // Newton ends at 10⁻¹³ of a side, 2·10⁻¹⁴ m.
                assert!(off.norm() < 1e-13, "{:e}", off.norm());
            }
        }
    }
}

#[test]
fn planar_is_the_centroid_without_torsion() {
    for tilt_angle in TILTS_DEG {
        for azimuth in azimuths_deg() {
            let found = pose(&Planar, Solver::ClosedForm, Metric::Paper, azimuth, tilt_angle);
            let off =
                found.base_from_platform.translation.vector - centroid(&balls(azimuth, tilt_angle));
            assert!(off.norm() < 1e-15);
            near(found.torsion(), 0.0, 1e-15);
            // Balls on a circle over the axis: their centroid stays on it.
            assert!(found.center_shift().norm() < 1e-15);
        }
    }
}

#[test]
fn polar_is_near_the_circumcentre_or_the_centroid() {
    let off = |metric, center: fn(&Triangle) -> Vector3<f64>| {
        let found = pose(&Polar, Solver::Newton, metric, 0.0, 2.0);
        (found.base_from_platform.translation.vector - center(&balls(0.0, 2.0))).norm()
    };
    near(off(Metric::Paper, circumcenter), 6.5e-3 * UM, 0.1e-3 * UM);
    near(off(Metric::PlatformRadius, centroid), 1.1e-3 * UM, 0.1e-3 * UM);
    near(off(Metric::Length(1e3), fermat_point), 0.0, 1e-4 * UM);
}

#[test]
fn polar_shift_for_every_characteristic_length() {
    // (R/2)(1/cos α − 1)(R² − ρ²)/(R² + ρ²) toward −2γ, within the plane; the next term is smaller by the squared tilt.
    let angle = 2.0_f64.to_radians();
    let half = 0.5 * RADIUS * (1.0 / angle.cos() - 1.0);
    for exponent in -6..=6 {
        let rho = RADIUS * 10f64.powf(0.5 * f64::from(exponent));
        let share = (RADIUS * RADIUS - rho * rho) / (RADIUS * RADIUS + rho * rho);
        let found = pose(&Polar, Solver::Newton, Metric::Length(rho), 0.0, 2.0);
        near(found.center_shift().x / angle.cos(), half * share, 2.0 * angle * angle * half);
    }
}

#[test]
fn fermat_point_and_circumcentre_lie_on_opposite_sides_of_the_centroid() {
    for tilt_angle in TILTS_DEG {
        for azimuth in azimuths_deg() {
            let corners = balls(azimuth, tilt_angle);
            let middle = centroid(&corners);
            let (to_fermat, to_circumcenter) =
                (fermat_point(&corners) - middle, circumcenter(&corners) - middle);
            let cosine = to_fermat.normalize().dot(&to_circumcenter.normalize());
            // Opposite but for terms of the order of the squared tilt, 0.008 at 5°.
            assert!(cosine < -0.9999, "{cosine}");
            near(to_fermat.norm() / to_circumcenter.norm(), 1.0, 0.01);
        }
    }
}

#[test]
fn magnitude_and_turn_of_the_centre_shift() {
    for tilt_angle in [0.5, 1.0, 2.0] {
        let half = 0.5 * RADIUS * (1.0 - tilt(0.0, tilt_angle).angle.cos());
        for azimuth in azimuths_deg() {
            // Toward the azimuth for rod 1, against it and twice as fast from there on.
            let toward = |azimuth_deg: f64| {
                let (sin, cos) = azimuth_deg.to_radians().sin_cos();
                Vector2::new(cos, sin) * half
            };
            let shift = |model, solver| {
                pose(model, solver, Metric::Paper, azimuth, tilt_angle).center_shift()
            };
            // The next term is smaller by the squared tilt, 0.0012 at 2°, with a factor below 4.
            let tolerance = 4.0 * tilt(0.0, tilt_angle).angle.powi(2) * half;
            let radial = shift(&Radial, Solver::ClosedForm) - toward(180.0 - 2.0 * azimuth);
            assert!(radial.norm() < tolerance, "{:e} {tolerance:e}", radial.norm());
            let polar = shift(&Polar, Solver::Newton) - toward(-2.0 * azimuth);
            assert!(polar.norm() < tolerance, "{:e} {tolerance:e}", polar.norm());
            let offset = shift(&Offset, Solver::Newton) - toward(180.0 - 2.0 * azimuth);
            assert!(offset.norm() < tolerance, "{:e} {tolerance:e}", offset.norm());
        }
    }
    // Exactly (R/2)(1 − cos α) toward rod 1: there the triangle stays isosceles.
    let radial = pose(&Radial, Solver::ClosedForm, Metric::Paper, 0.0, 2.0).center_shift();
    near(radial.x, -28.392943467 * UM, 1e-9 * UM);
    // The same within the tilted plane, where O_p has moved along the slope.
    near(origin_in_plane(&Radial, Solver::ClosedForm), -28.4103 * UM, 1e-4 * UM);
    near(origin_in_plane(&Polar, Solver::Newton), 28.3951 * UM, 1e-4 * UM);
    near(origin_in_plane(&Polar, Solver::LeastNorm), 28.3778 * UM, 1e-4 * UM);
}

/// How far O_p is from the base axis within the platform plane, at 2° toward rod 1 (m).
fn origin_in_plane(model: &dyn Virtualization, solver: Solver) -> f64 {
    origin(model, solver, 0.0, 2.0).x / 2.0_f64.to_radians().cos()
}

#[test]
fn magnitude_of_rods_and_radial_slides() {
    for tilt_angle in TILTS_DEG {
        let angle = tilt(0.0, tilt_angle).angle;
        let unit = RADIUS * (1.0 - angle.cos());
        let (mut longest, mut least, mut most) = (0.0_f64, f64::MAX, f64::MIN);
        for azimuth in azimuths_deg() {
            let found = pose(&Radial, Solver::ClosedForm, Metric::Paper, azimuth, tilt_angle);
            for k in 0..3 {
                longest = longest.max((found.rods[k] - HEIGHT.0).abs());
                least = least.min(found.solution.virtual_joints[k] - RADIUS);
                most = most.max(found.solution.virtual_joints[k] - RADIUS);
            }
        }
        near(longest, RADIUS * angle.tan(), 1e-16);
        // To leading order; the next is smaller by the squared tilt.
        near(least / unit, -0.5, angle * angle);
        near(most / unit, 1.5, 2.0 * angle * angle);
    }
}

#[test]
fn approximate_gaps_are_the_stretch() {
    for tilt_angle in TILTS_DEG {
        let stretch = 1.0 / tilt(0.0, tilt_angle).angle.cos() - 1.0;
        let mut widest = 0.0_f64;
        for azimuth in azimuths_deg() {
            let found = Gpr::paper()
                .without_limit_checks()
                .approximate(tilt(azimuth, tilt_angle), HEIGHT)
                .expect("a pose");
            widest = found.gaps.iter().map(Vector3::norm).fold(widest, f64::max);
        }
        near(widest, RADIUS * stretch, 1e-15);
    }
    near(RADIUS * (1.0 / 2.0_f64.to_radians().cos() - 1.0), 56.8 * UM, 0.05 * UM);
}

#[test]
fn elastic_rods_hold_the_platform_near_the_planar_model() {
    let gpr = Gpr::paper().without_limit_checks();
    let sockets = gpr.platform().sockets();
    let mut farthest = 0.0_f64;
    for azimuth in azimuths_deg() {
        let corners = balls(azimuth, 2.0);
        let fit = weighted_fit(sockets, &corners, &tilt(azimuth, 2.0).normal());
        let rest = equilibrium(sockets, &corners);
        let planar = origin(&Planar, Solver::ClosedForm, azimuth, 2.0);
        let off = (rest.origin - planar).xy();
        farthest = farthest.max(off.norm());
        // (3/2)(R²/H) tan α (1/cos α − 1) toward the tilt, to leading order in R α / H, 0.7 %.
        let angle = 2.0_f64.to_radians();
        let length = 1.5 * RADIUS * RADIUS / HEIGHT.0 * angle.tan() * (1.0 / angle.cos() - 1.0);
        let (sin, cos) = azimuth.to_radians().sin_cos();
        assert!((off - Vector2::new(cos, sin) * length).norm() < 0.02 * length);
        // Bending within the plane or sideways: the difference is of the squared tilt.
        assert!((fit.origin - rest.origin).xy().norm() < 1e-3 * UM);
        near(fit.torsion, rest.torsion, 1e-8);
        // The two others are fifty times as far.
        let radial = origin(&Radial, Solver::ClosedForm, azimuth, 2.0);
        let polar = origin(&Polar, Solver::Newton, azimuth, 2.0);
        assert!((rest.origin - radial).xy().norm() > 27.0 * UM);
        assert!((rest.origin - polar).xy().norm() > 27.0 * UM);
    }
    near(farthest, 0.559 * UM, 0.002 * UM);
}

#[test]
fn equal_stiffness_would_be_the_planar_model() {
    // With the balls' heights taken from the weights, the weighted fit is Procrustes' own.
    let gpr = Gpr::paper().without_limit_checks();
    let corners = balls(20.0, 2.0);
    let (normal, planar) =
        (tilt(20.0, 2.0).normal(), origin(&Planar, Solver::ClosedForm, 20.0, 2.0));
    // Far up, all rods are equally soft.
    let raised = corners.map(|ball| ball + Vector3::z() * 1e6);
    let fit = weighted_fit(gpr.platform().sockets(), &raised, &normal);
    assert!((fit.origin - planar).xy().norm() < 1e-9);
}
