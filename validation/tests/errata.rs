//! Errors of the paper: each printed form fails here, each correct one holds.
//!
//! The story to these tests, with figures: `docs/explanation/errata.md`.

use jointplay::gpr::{Gpr, ball_sides};
use jointplay::virtualization::{Metric, Offset, Planar, Polar, Radial, Sides, Solver};
use jointplay_validation::cases::{HEIGHT, RADIUS, azimuths_deg, options, pose, tilt};
use jointplay_validation::centers::circumcenter;
use jointplay_validation::paths::{least_rotation, torsion, turn, warm_started};
use jointplay_validation::printed::{
    ByL, ThirdColumn, X, iterate, offset_points_printed, offset_points_right, polar_by_x,
    polar_sides,
};
use nalgebra::Vector2;

/// The page that these tests prove.
const PAGE: &str = include_str!("../../docs/explanation/errata.md");

const MM: f64 = 1e-3;
const UM: f64 = 1e-6;
const RHO: f64 = MM;
const NOMINAL: X = [RADIUS, RADIUS, RADIUS, 0.0, 0.0, 0.0];

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "found {found:e}, expected {expected:e}, off by {off:e}");
}

/// Sides at a tilt of 2° toward rod 1.
fn sides_at_two_degrees() -> Sides {
    let gpr = Gpr::paper().without_limit_checks();
    ball_sides(&gpr.ball_centers(&gpr.inverse(tilt(0.0, 2.0), HEIGHT).expect("a pose")))
}

/// Largest difference between ∂F/∂X and central differences of F, as a share of its largest entry.
fn derivative_error(third: ThirdColumn) -> f64 {
    // Off the symmetric point, where all l are equal and an exchange of l's would not show.
    let x = [0.0921, 0.0934, 0.0950, 0.01, -0.02, 0.015];
    let rows = polar_by_x(&x, third);
    let largest = rows.iter().map(|row| row.amax()).fold(0.0, f64::max);
    let mut error = 0.0_f64;
    for m in 0..6 {
        let shifted = |step: f64| {
            let mut there = x;
            there[m] += step;
            polar_sides(&there).map(|side| side * side)
        };
        let (up, down) = (shifted(1e-6), shifted(-1e-6));
        for k in 0..3 {
            error = error.max((rows[m][k] - (up[k] - down[k]) / 2e-6).abs());
        }
    }
    error / largest
}

// Erratum 1: the third column of ∂F/∂X in V.A.

#[test]
fn third_column_of_v_a_is_no_derivative_as_printed() {
    // Central differences of squares are exact to round-off, 10⁻¹⁶ / 10⁻⁶.
    assert!(derivative_error(ThirdColumn::Right) < 1e-9);
    // The φ entries have the opposite sign: off by twice themselves, the largest entries but for the l entries.
    assert!(derivative_error(ThirdColumn::LengthsRight) > 0.05);
    // The l entries are exchanged: off by 2 (l_3 − l_1)(1 + cos), small because l_1 and l_3 nearly agree.
    assert!(derivative_error(ThirdColumn::SignsRight) > 1e-3);
    assert!(derivative_error(ThirdColumn::Printed) > 0.05);
}

#[test]
fn printed_signs_of_v_a_make_the_iteration_diverge() {
    let sides = sides_at_two_degrees();
    for third in [ThirdColumn::Printed, ThirdColumn::LengthsRight] {
        for by_l in [ByL::Letter, ByL::Midpoint] {
            let steps = iterate(third, by_l, NOMINAL, &sides, RHO, 8);
            near(steps[0].residual, 0.0738 * MM, 1e-3 * MM);
            // Each step changes φ by the correct amount in the opposite direction.
            for pair in steps[..6].windows(2) {
                near(pair[1].residual / pair[0].residual, 2.0, 0.1);
            }
            assert!(steps[8].residual > 20.0 * MM, "{}", steps[8].residual);
        }
    }
}

#[test]
fn right_signs_of_v_a_converge_in_three_steps() {
    let sides = sides_at_two_degrees();
    let expected = pose(&Polar, Solver::Newton, Metric::Paper, 0.0, 2.0).solution.virtual_joints;
    for third in [ThirdColumn::SignsRight, ThirdColumn::Right] {
        let steps = iterate(third, ByL::Midpoint, NOMINAL, &sides, RHO, 3);
        // 10⁻¹³ m is a thousand times round-off of a side, and 10⁻⁷ of the play.
        assert!(steps[3].residual < 1e-13);
        for (found, expected) in steps[3].x.iter().zip(expected.iter()) {
            near(*found, *expected, 1e-11);
        }
    }
}

#[test]
fn printed_signs_end_on_an_incorrect_point_with_the_radius_as_metric() {
    // Angles count more, so that the linear part compensates the incorrect angles: F = 0, but elsewhere.
    let steps =
        iterate(ThirdColumn::Printed, ByL::Midpoint, NOMINAL, &sides_at_two_degrees(), RADIUS, 60);
    let last = steps.last().unwrap();
    assert!(last.residual < 1e-13);
    let metric = Metric::PlatformRadius;
    let expected = pose(&Polar, Solver::Newton, metric, 0.0, 2.0).solution.virtual_joints;
    let weight = |m: usize| if m < 3 { 1.0 } else { RADIUS };
    let off = (0..6).map(|m| (weight(m) * (last.x[m] - expected[m])).powi(2)).sum::<f64>().sqrt();
    near(off, 99.0 * UM, 1.0 * UM);
}

// Erratum 2: r_3 in V.B.

#[test]
fn printed_r_3_of_v_b_is_not_displaced_by_dr() {
    let x = [1e-4, 1e-4, 1e-4, 0.0, -0.5, 0.7];
    let nominal = offset_points_right(RADIUS, &[0.0; 6]);
    let distance = |points: [Vector2<f64>; 3]| (points[2] - nominal[2]).norm();
    near(distance(offset_points_right(RADIUS, &x)), 0.1 * MM, 1e-16);
    near(distance(offset_points_printed(RADIUS, &x)), 0.130 * MM, 1e-3 * MM);
}

#[test]
fn printed_r_3_of_v_b_breaks_the_symmetry_of_the_robot() {
    // Equal displacements of all limbs leave an equilateral triangle, whatever their common value.
    let spread = |points: [Vector2<f64>; 3]| {
        let sides = [0, 1, 2].map(|k| (points[(k + 1) % 3] - points[k]).norm());
        sides.iter().copied().fold(0.0, f64::max) - sides.iter().copied().fold(f64::MAX, f64::min)
    };
    // With unequal angles the points of the three limbs have to follow one rule: turn limb 2's displacement onto limb 3.
    let of_limb_2 = [0.0, 1e-4, 0.0, 0.0, 0.7, 0.0];
    let of_limb_3 = [0.0, 0.0, 1e-4, 0.0, 0.0, 0.7];
    let turned = nalgebra::Rotation2::new(std::f64::consts::TAU / 3.0);
    let mismatch = |points: fn(f64, &X) -> [Vector2<f64>; 3]| {
        (turned * points(RADIUS, &of_limb_2)[1] - points(RADIUS, &of_limb_3)[2]).norm()
    };
    assert!(spread(offset_points_right(RADIUS, &[1e-4, 1e-4, 1e-4, 0.7, 0.7, 0.7])) < 1e-16);
    assert!(mismatch(offset_points_right) < 1e-16);
    // 2 · 0.1 mm · sin(0.35) · |sin(240° + 0.35)|, the difference of two cosines.
    let difference = 2e-4 * 0.35_f64.sin() * (2.0 * std::f64::consts::TAU / 3.0 + 0.35).sin();
    near(mismatch(offset_points_printed), difference.abs(), 1e-9 * MM);
    assert!(PAGE.contains(&format!("at 0.7 rad is {:.4} mm off", difference.abs() / MM)));
    // Its derivative by dφ_3 lacks the first component, and so is not at right angles to the displacement.
    let by_dphi_3 = |points: fn(f64, &X) -> [Vector2<f64>; 3]| {
        let (mut up, mut down) = (of_limb_3, of_limb_3);
        up[5] += 1e-4;
        down[5] -= 1e-4;
        (points(RADIUS, &up)[2] - points(RADIUS, &down)[2]) / 2e-4
    };
    near(by_dphi_3(offset_points_right).norm(), 1e-4, 1e-12);
    assert!(by_dphi_3(offset_points_printed).norm() < 0.45e-4);
}

// Reference values, and how (8) is read.

#[test]
fn reference_tilt() {
    // Printed digits of the independent program: half a unit of the last one.
    let rods = Gpr::paper().without_limit_checks().inverse(tilt(0.0, 2.0), HEIGHT).unwrap();
    for (rod, expected) in rods.iter().zip([496.74475571, 501.627622145, 501.627622145]) {
        near(*rod, expected * MM, 5e-9 * MM);
    }
    let radial = pose(&Radial, Solver::Newton, Metric::Paper, 0.0, 2.0).solution.virtual_joints;
    for (l, expected) in radial.iter().zip([93.303230751, 93.218, 93.218]) {
        near(*l, expected * MM, 1e-9 * MM);
    }
    for (metric, lengths, phi) in [
        (Metric::Paper, [93.246425437, 93.246415634, 93.246415634], 5.27578962e-4),
        (Metric::PlatformRadius, [93.27481942, 93.232208912, 93.232208912], 2.63910241e-4),
    ] {
        let x = pose(&Polar, Solver::Newton, metric, 0.0, 2.0).solution.virtual_joints;
        for (l, expected) in x.iter().zip(lengths) {
            near(*l, expected * MM, 1e-9 * MM);
        }
        near(x[3], 0.0, 1e-12);
        near(x[4], phi, 1e-12);
        near(x[5], -phi, 1e-12);
    }
}

#[test]
fn equation_8_to_the_letter_ends_a_few_picometres_aside() {
    let sides = sides_at_two_degrees();
    let end = |by_l| iterate(ThirdColumn::Right, by_l, NOMINAL, &sides, RHO, 6)[6].x;
    let (letter, midpoint) = (end(ByL::Letter), end(ByL::Midpoint));
    near(letter[0] - midpoint[0], 3.96e-9 * MM, 1e-11 * MM);
}

// Remark 3: the answer depends on the unit of length.

#[test]
fn characteristic_length_decides_the_centre_shift() {
    let shift = |rho: f64| {
        pose(&Polar, Solver::Newton, Metric::Length(rho), 0.0, 2.0).center_shift().x / UM
    };
    let radial = pose(&Radial, Solver::Newton, Metric::Paper, 0.0, 2.0).center_shift().x / UM;
    // From one side of the axis to the other as ρ grows, to the last digit of the page.
    let table = [
        (1e-5, 28.38),
        (1e-3, 28.38),
        (0.01, 27.74),
        (0.03, 23.06),
        (0.093218, 0.00),
        (1.0, -27.90),
        (1e3, radial),
    ];
    for (rho, expected) in table {
        near(shift(rho), expected, 0.005);
    }
    for pair in table.windows(2) {
        assert!(shift(pair[1].0) < shift(pair[0].0));
    }
    for (shown, rho) in [("1 mm", 1e-3), ("10 mm", 0.01), ("30 mm", 0.03), ("1 m", 1.0)] {
        let row = format!("| {shown} | {:+.2} µm |", shift(rho)).replace('-', "−");
        assert!(PAGE.contains(&row), "{row}");
    }
}

#[test]
fn the_paper_metric_puts_the_platform_at_the_circumcentre() {
    let off = |rho| {
        let found = pose(&Polar, Solver::Newton, Metric::Length(rho), 0.0, 2.0);
        let balls = Gpr::paper().ball_centers(&found.rods);
        (found.base_from_platform.translation.vector - circumcenter(&balls)).norm()
    };
    near(off(RHO), 6.53e-6 * MM, 0.01e-6 * MM);
    // As ρ shrinks, so does the rest: it is proportional to ρ².
    near(off(RHO) / off(0.1 * RHO), 100.0, 1.0);
}

#[test]
fn the_same_robot_in_metres_would_give_another_answer() {
    // ρ = 1 m is what the paper's formulas give in metres.
    let x = pose(&Polar, Solver::Newton, Metric::Length(1.0), 0.0, 2.0);
    let mm = pose(&Polar, Solver::Newton, Metric::Paper, 0.0, 2.0);
    assert!(x.center_shift().x < -27.0 * UM);
    assert!(mm.center_shift().x > 28.0 * UM);
}

// Remark 4: small angles without information.

/// Largest X over all azimuths at 2°, linear and angular ((m), (rad)).
fn largest(model: &dyn jointplay::virtualization::Virtualization, solver: Solver) -> (f64, f64) {
    let mut nominal = [0.0; 6];
    model.nominal(Gpr::paper().platform(), &mut nominal);
    azimuths_deg().fold((0.0, 0.0), |(linear, angular): (f64, f64), azimuth| {
        let x = pose(model, solver, Metric::Paper, azimuth, 2.0).solution.virtual_joints;
        let part = |m: usize| (x[m] - nominal[m]).abs();
        ((0..3).map(part).fold(linear, f64::max), (3..6).map(part).fold(angular, f64::max))
    })
}

#[test]
fn offset_angles_stay_at_zero_whatever_the_robot_does() {
    let (linear, angular) = largest(&Offset, Solver::Newton);
    assert!(linear > 80.0 * UM);
    // The largest is between the azimuths of the study, at 93°.
    assert!(angular < 8.6e-7);
    let angle = |azimuth: f64| {
        let x = pose(&Offset, Solver::Newton, Metric::Paper, azimuth, 2.0).solution.virtual_joints;
        (3..6).map(|m| x[m].abs()).fold(0.0, f64::max)
    };
    let angular = (0..720).map(|k| angle(0.5 * f64::from(k))).fold(0.0, f64::max);
    assert!(PAGE.contains(&format!(
        "at most {:.2}·10⁻⁷ rad over all tilt directions at 2°",
        angular * 1e7
    )));
    near(angular, 8.632e-7, 0.001e-7);
    // The centre moves as in the radial model, since only dr moves.
    for azimuth in azimuths_deg() {
        let offset = pose(&Offset, Solver::Newton, Metric::Paper, azimuth, 2.0).center_shift();
        let radial = pose(&Radial, Solver::Newton, Metric::Paper, azimuth, 2.0).center_shift();
        assert!((offset - radial).norm() < 1e-3 * UM, "{}", (offset - radial).norm());
    }
}

#[test]
fn offset_angles_are_used_where_the_norm_is_really_least() {
    // Same sides, same coordinates, less displacement: the zeros belong to the iteration, not to the bearings.
    let (_, angular) = largest(&Offset, Solver::LeastNorm);
    near(angular, 2.8e-3, 0.1e-3);
}

#[test]
fn planar_sees_the_sideways_play_that_offset_hides() {
    let mut sideways = 0.0_f64;
    for azimuth in azimuths_deg() {
        let found = pose(&Planar, Solver::ClosedForm, Metric::Paper, azimuth, 2.0);
        let x = found.solution.virtual_joints;
        for k in 0..3 {
            let out = Gpr::paper().platform().directions()[k];
            sideways = sideways.max(out.perp(&Vector2::new(x[k], x[3 + k])).abs());
        }
    }
    // (R/2)(1/cos α − 1) = 28.4 µm but for the raster, half of the largest radial displacement.
    near(sideways, 28.0 * UM, 0.1 * UM);
}

#[test]
fn polar_angles_carry_more_play_than_the_lengths() {
    let (linear, angular) = largest(&Polar, Solver::Newton);
    near(linear, 28.4 * UM, 0.1 * UM);
    near(angular, 6.1e-4, 0.1e-4);
    let arc = angular * RADIUS;
    assert!(arc > 1.7 * linear, "arc {arc:e}, linear {linear:e}");
    // At the reference tilt: 49 µm of arc and 28 µm of length.
    let x = pose(&Polar, Solver::Newton, Metric::Paper, 0.0, 2.0).solution.virtual_joints;
    near(x[1] * x[4], 49.2 * UM, 0.1 * UM);
    near(x[0] - RADIUS, 28.4 * UM, 0.1 * UM);
}

// Remark 5: the iteration ends near, not at, the least norm.

#[test]
fn newton_is_not_the_least_norm() {
    let gap = |tilt_angle| {
        let end = |solver| pose(&Polar, solver, Metric::Paper, 0.0, tilt_angle);
        let (newton, least) = (end(Solver::Newton), end(Solver::LeastNorm));
        let x = (newton.solution.virtual_joints, least.solution.virtual_joints);
        let norm = |x: &[f64]| {
            let part = |m: usize| if m < 3 { x[m] - RADIUS } else { RHO * x[m] };
            (0..6).map(|m| part(m).powi(2)).sum::<f64>().sqrt()
        };
        assert!(norm(&x.1) < norm(&x.0));
        (0..3).map(|k| (x.0[k] - x.1[k]).abs()).fold(0.0, f64::max)
    };
    near(gap(2.0), 1.73e-5 * MM, 0.01e-5 * MM);
    near(gap(5.0), 6.75e-4 * MM, 0.05e-4 * MM);
    // Doubling the tilt multiplies the gap by 2⁴, to leading order.
    near(gap(2.0) / gap(1.0), 16.0, 0.1);
}

// Remark 6: a start at the last pose makes the answer depend on the path.

const SAMPLES: u32 = 360;

fn three_turns() -> Vec<jointplay::spatial::Tilt> {
    (0..3).flat_map(|_| turn(2.0_f64.to_radians(), SAMPLES)).collect()
}

/// Index of the sample that ends each turn.
fn ends() -> [usize; 3] {
    [1, 2, 3].map(|n| n * (SAMPLES as usize + 1) - 1)
}

#[test]
fn least_rotation_from_the_last_pose_gains_torsion_at_every_turn() {
    let rotations = least_rotation(&three_turns());
    // The solid angle that the normal runs round.
    let gain = std::f64::consts::TAU * (1.0 - 2.0_f64.to_radians().cos());
    near(gain, 3.8275e-3, 1e-7);
    for (n, end) in ends().into_iter().enumerate() {
        let turns = f64::from(u32::try_from(n + 1).unwrap());
        // A polygon of 360 corners encloses less than its circle, by 5·10⁻⁵.
        near(torsion(&rotations[end]), turns * gain, 1e-4 * turns * gain);
    }
}

#[test]
fn a_warm_start_depends_on_the_path() {
    let gpr = Gpr::paper().without_limit_checks();
    let tilts = three_turns();
    for (model, rho, gain, moved) in [
        (&Planar as &dyn jointplay::virtualization::Virtualization, RHO, 1.166e-6, 0.0),
        (&Offset, RHO, -6.15e-6, 1.146 * UM),
        (&Polar, RHO, 0.0, 0.0),
    ] {
        let poses = warm_started(&gpr, model, rho, &tilts);
        for (n, end) in ends().into_iter().enumerate() {
            let turns = f64::from(u32::try_from(n + 1).unwrap());
            near(torsion(&poses[end].rotation), turns * gain, 1e-8 * turns);
            let off = poses[end].translation.vector - poses[0].translation.vector;
            near(off.norm(), turns * moved, 0.01 * UM * turns);
        }
    }
}

#[test]
fn a_start_at_nominal_does_not() {
    let gpr = Gpr::paper().without_limit_checks();
    for model in jointplay_validation::cases::MODELS {
        let solve = |tilt| {
            let options = options(Solver::Newton, Metric::Paper);
            gpr.forward(gpr.inverse(tilt, HEIGHT).unwrap(), model, &options).unwrap()
        };
        let tilts = three_turns();
        let (first, last) = (solve(tilts[0]), solve(tilts[ends()[2]]));
        // The azimuths 0 and 2π differ by round-off only.
        let off = last.base_from_platform.translation.vector
            - first.base_from_platform.translation.vector;
        assert!(off.norm() < 1e-15);
        near(last.torsion(), first.torsion(), 1e-15);
    }
}
