//! Claims of the paper's text, one test for each; section and equation in the comment.
//!
//! Claims that do not hold are in `errata.rs`.

use jointplay::constraint::System;
use jointplay::gpr::Gpr;
use jointplay::linalg::svd;
use jointplay::mobility::{
    RANK_THRESHOLD, augmented_mobility, finite_mobility, instantaneous_mobility,
};
use jointplay::sensitivity::sensitivity;
use jointplay::virtualization::{
    Metric, Offset, Planar, Polar, Radial, Solver, VirtualJointKind, Virtualization,
};
use jointplay_validation::cases::{HEIGHT, MODELS, RADIUS, azimuths_deg, options, pose, tilt};

const MM: f64 = 1e-3;
/// Tilt angles of the study, −2° to 2° by 0.2°, level among them.
fn tilts_deg() -> impl Iterator<Item = f64> {
    (-10..=10).map(|i| 0.2 * f64::from(i))
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "found {found:e}, expected {expected:e}, off by {off:e}");
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-14
}

// IV.A: mobility.

#[test]
fn level_has_rank_9_and_mobility_3_all_other_poses_11_and_1() {
    let gpr = Gpr::paper().without_limit_checks();
    for azimuth in azimuths_deg() {
        for tilt_angle in [0.0, 1e-6, 0.01, 0.2, 2.0] {
            let found = pose(&Planar, Solver::ClosedForm, Metric::Paper, azimuth, tilt_angle);
            let system = gpr.system(&Planar);
            let at = system.configuration(&found);
            let first = instantaneous_mobility(&system, &at, RANK_THRESHOLD).unwrap();
            let expected = if tilt_angle == 0.0 { (9, 3) } else { (11, 1) };
            assert_eq!((first.rank, first.mobility), expected, "{azimuth}° {tilt_angle}°");
        }
    }
}

#[test]
fn a_micrometre_between_rods_is_enough_for_rank_11() {
    // "Even small differences … in the range of the normal deviations from the parallelism."
    let gpr = Gpr::paper().without_limit_checks();
    for rods in [[0.5, 0.500001, 0.5], [0.5, 0.500001, 0.499999]] {
        let found =
            gpr.forward(rods, &Planar, &options(Solver::ClosedForm, Metric::Paper)).unwrap();
        let system = gpr.system(&Planar);
        let at = system.configuration(&found);
        assert_eq!(instantaneous_mobility(&system, &at, RANK_THRESHOLD).unwrap().rank, 11);
    }
}

#[test]
fn the_three_freedoms_at_level_are_instantaneous_one_is_finite() {
    // The paper uses "instantaneous local mobility"; it does not state how much of it is finite.
    let gpr = Gpr::paper().without_limit_checks();
    let found = pose(&Planar, Solver::ClosedForm, Metric::Paper, 0.0, 0.0);
    let system = gpr.system(&Planar);
    let at = system.configuration(&found);
    let finite = finite_mobility(&system, &at, RANK_THRESHOLD).unwrap();
    assert_eq!((finite.instantaneous.mobility, finite.mobility), (3, Some(1)));
    assert_eq!(gpr.kutzbach_mobility(), 0);
}

#[test]
fn with_virtual_joints_rank_is_12_and_mobility_m_everywhere() {
    let gpr = Gpr::paper().without_limit_checks();
    for model in MODELS {
        for tilt_angle in [0.0, 1e-6, 0.2, 2.0] {
            let found = pose(model, Solver::Newton, Metric::Paper, 30.0, tilt_angle);
            let system = gpr.system(model);
            let at = system.configuration(&found);
            let all = augmented_mobility(&system, &at, RANK_THRESHOLD).unwrap();
            assert_eq!((all.rank, all.mobility), (12, model.joints().len()), "{}", model.name());
        }
    }
}

// IV.A: sensitivity.

/// Non-zero singular values of ∂Φ/∂X in mm and rad, as the paper would have computed them (mm²/mm, mm²/rad).
fn singular_values_of_phi_by_x(
    model: &dyn Virtualization,
    azimuth: f64,
    tilt_angle: f64,
) -> [f64; 3] {
    let gpr = Gpr::paper().without_limit_checks();
    let found = pose(model, Solver::Newton, Metric::Paper, azimuth, tilt_angle);
    let system = gpr.system(model);
    let mut matrix = system.virtual_jacobian(&system.configuration(&found));
    for (mut column, joint) in matrix.column_iter_mut().zip(model.joints()) {
        column *= match joint.motion {
            VirtualJointKind::Linear => 1e3,
            VirtualJointKind::Angular => 1e6,
        };
    }
    let values = svd(&matrix).expect("finite").singular_values;
    [values[0], values[1], values[2]]
}

#[test]
fn singular_values_of_phi_by_x_vary_slightly_and_never_vanish() {
    for model in MODELS {
        let level = singular_values_of_phi_by_x(model, 0.0, 0.0);
        assert!(level[2] > 100.0, "{} {level:?}", model.name());
        for azimuth in azimuths_deg() {
            for tilt_angle in [0.2, 1.0, 2.0] {
                let here = singular_values_of_phi_by_x(model, azimuth, tilt_angle);
                for k in 0..3 {
                    // Slightly indeed: found are 0.03 % (radial, planar), 0.09 % (polar), 0.27 % (offset).
                    near(here[k] / level[k], 1.0, 2.8e-3);
                }
            }
        }
    }
}

#[test]
fn sensitivity_has_rank_3_and_known_singular_values_at_level() {
    let gpr = Gpr::paper().without_limit_checks();
    let root = 2.0_f64.sqrt();
    for (model, expected) in [
        (&Radial as &dyn Virtualization, [root, root, 1.0]),
        (&Offset, [root, root, 1.0]),
        (&Polar, [1.0, 0.0151702, 0.0151702]),
    ] {
        let system = gpr.system(model);
        let found = pose(model, Solver::Newton, Metric::Paper, 0.0, 0.0);
        let here = sensitivity(&system, &system.configuration(&found), MM, RANK_THRESHOLD).unwrap();
        assert_eq!(here.rank, 3);
        for (found, expected) in here.singular_values().iter().zip(expected) {
            near(*found, expected, 1e-7);
        }
    }
}

#[test]
fn bounds_4_and_5_agree_and_hold_for_the_chord() {
    let gpr = Gpr::paper().without_limit_checks();
    for model in MODELS {
        for azimuth in azimuths_deg() {
            let options = options(Solver::Newton, Metric::Paper);
            let play = gpr.tilt_play(tilt(azimuth, 2.0), HEIGHT, model, &options).unwrap();
            for bounded in [&play.at_start, &play.at_midpoint, &play.at_end] {
                let bounds = &bounded.bounds;
                // Eigenvalues are squares of singular values: half the digits of the smallest.
                near(bounds.eigenvalue_lower, bounds.lower, 1e-9 * bounds.coarse_upper);
                near(bounds.eigenvalue_upper, bounds.upper, 1e-9 * bounds.coarse_upper);
                assert!(bounds.upper <= bounds.coarse_upper);
            }
            assert!(play.at_midpoint.held, "{} {azimuth}°", model.name());
        }
    }
}

#[test]
fn bounds_at_the_end_are_twice_those_of_the_chord_and_zero_at_the_start() {
    let gpr = Gpr::paper().without_limit_checks();
    for model in MODELS {
        let options = options(Solver::Newton, Metric::Paper);
        let play = gpr.tilt_play(tilt(15.0, 2.0), HEIGHT, model, &options).unwrap();
        // Zero but for the round-off of a step of 5 mm.
        assert!(play.at_start.bounds.upper < 1e-15, "{:e}", play.at_start.bounds.upper);
        // The singular values change along the path by a share of the squared tilt.
        for (end, chord) in [
            (play.at_end.bounds.lower, play.at_midpoint.bounds.lower),
            (play.at_end.bounds.upper, play.at_midpoint.bounds.upper),
        ] {
            near(end / chord, 2.0, 0.01);
        }
        if model.name() == "radial" {
            // The chord is exact but for what Newton leaves of the sides.
            near(play.at_midpoint.bounds.linear, play.displacement, 1e-14);
        }
    }
}

// IV.B: the iteration.

#[test]
fn two_or_three_iterations_solve_every_sample_of_the_study() {
    for model in MODELS {
        for azimuth in azimuths_deg() {
            for tilt_angle in tilts_deg() {
                let found =
                    pose(model, Solver::Newton, Metric::Paper, azimuth, tilt_angle).solution;
                assert!(found.iterations <= 3, "{} {azimuth}° {tilt_angle}°", model.name());
                assert!(found.residual <= 1e-13 * RADIUS * 3.0_f64.sqrt() * 1.01);
            }
        }
    }
}

// VI: the study.

#[test]
fn every_pass_through_level_finds_the_nominal_robot() {
    for model in MODELS {
        let mut nominal = vec![0.0; model.joints().len()];
        model.nominal(Gpr::paper().platform(), &mut nominal);
        for azimuth in azimuths_deg() {
            let found = pose(model, Solver::Newton, Metric::Paper, azimuth, 0.0);
            assert_eq!(found.rods, [0.5; 3]);
            for (x, expected) in found.solution.virtual_joints.iter().zip(&nominal) {
                near(*x, *expected, 1e-16);
            }
            for side in found.sides {
                near(side, 93.218 * MM * 3.0_f64.sqrt(), 1e-16);
            }
        }
    }
}

#[test]
fn x_and_l_have_their_extremum_at_every_pass() {
    // Each series is even in the tilt angle, so that its slope is zero at level; and it turns back there.
    for model in MODELS {
        for azimuth in azimuths_deg() {
            let series = |tilt_angle| {
                let found = pose(model, Solver::Newton, Metric::Paper, azimuth, tilt_angle);
                let joints = found.solution.virtual_joints;
                (joints.to_vec(), found.sides)
            };
            let level = series(0.0);
            for tilt_angle in tilts_deg().filter(|tilt_angle| *tilt_angle > 0.1) {
                let (up, down) = (series(tilt_angle), series(-tilt_angle));
                for m in 0..level.0.len() {
                    assert!(close(up.0[m], down.0[m]), "{} {azimuth}° {tilt_angle}°", model.name());
                }
                for k in 0..3 {
                    assert!(close(up.1[k], down.1[k]));
                    // A side can only grow: its ends move apart in height.
                    assert!(up.1[k] >= level.1[k] - 1e-16);
                }
            }
        }
    }
}

#[test]
fn an_extremum_of_l_is_a_minimum_or_a_maximum_depending_on_the_azimuth() {
    let change = |azimuth| {
        let x = pose(&Radial, Solver::Newton, Metric::Paper, azimuth, 2.0).solution.virtual_joints;
        x[0] - RADIUS
    };
    // +3/2 R(1 − cos α) toward the rod, −1/2 R(1 − cos α) across.
    assert!(change(0.0) > 85e-6);
    assert!(change(90.0) < -28e-6);
}

#[test]
fn q_has_no_extremum_at_a_pass() {
    // The rods go straight through; only the six series above turn back.
    for azimuth in azimuths_deg() {
        let rods = |tilt_angle| {
            Gpr::paper().without_limit_checks().inverse(tilt(azimuth, tilt_angle), HEIGHT).unwrap()
        };
        let (before, after) = (rods(-0.2), rods(0.2));
        for k in 0..3 {
            near(before[k] - 0.5, 0.5 - after[k], 1e-15);
        }
        assert!((0..3).any(|k| (after[k] - before[k]).abs() > 3e-4));
    }
}

#[test]
fn play_of_the_study_is_some_tens_of_micrometres() {
    // "Very small and within the range of the inherent imperfections"; the paper prints no number.
    let mut most = 0.0_f64;
    for azimuth in azimuths_deg() {
        let x = pose(&Radial, Solver::Newton, Metric::Paper, azimuth, 2.0).solution.virtual_joints;
        most = x.iter().map(|l| (l - RADIUS).abs()).fold(most, f64::max);
    }
    near(most, 85.2e-6, 0.1e-6);
}
