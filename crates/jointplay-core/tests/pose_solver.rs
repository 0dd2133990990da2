//! Poses by prepared solvers equal those of the solver that they prepare.

use std::f64::consts::TAU;

use jointplay_core::bulk::{Column, PoseSolver, Quantity, Status};
use jointplay_core::gpr::{AxisHeight, Gpr, Limb, Limits};
use jointplay_core::nalgebra::Vector2;
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{BuiltIn, Metric, SolveOptions, Solver};
use proptest::prelude::*;

const MODELS: [BuiltIn; 4] = [BuiltIn::Radial, BuiltIn::Polar, BuiltIn::Offset, BuiltIn::Planar];

/// A robot whose sockets are up to 0.1 mm off their rods.
fn robot(radii: [f64; 3], angles: [f64; 3], off: [f64; 6], tilt_max: f64) -> Gpr {
    let limbs = [0, 1, 2].map(|k| {
        let limb = Limb::under_socket(radii[k], TAU * k as f64 / 3.0 + angles[k]);
        let base_point = limb.base_point + Vector2::new(off[2 * k], off[2 * k + 1]);
        Limb { base_point, ..limb }
    });
    Gpr::new(limbs, Limits { rod_min: 0.1, rod_max: 0.9, tilt_max }, 0.5).unwrap()
}

fn options() -> impl Strategy<Value = SolveOptions> {
    let solver =
        prop_oneof![Just(Solver::Newton), Just(Solver::LeastNorm), Just(Solver::ClosedForm)];
    let metric = prop_oneof![Just(Metric::Paper), Just(Metric::PlatformRadius)];
    (solver, metric).prop_map(|(solver, metric)| SolveOptions {
        solver,
        metric,
        ..SolveOptions::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn prepared_poses_are_those_of_the_robot(
        radii in [0.05..0.2_f64, 0.05..0.2, 0.05..0.2],
        angles in [-0.3..0.3_f64, -0.3..0.3, -0.3..0.3],
        off in [-1e-4..1e-4_f64, -1e-4..1e-4, -1e-4..1e-4, -1e-4..1e-4, -1e-4..1e-4, -1e-4..1e-4],
        tilt_max in 0.01..0.12_f64,
        options in options(),
        azimuths in proptest::collection::vec(0.0..TAU, 21),
    ) {
        let gpr = robot(radii, angles, off, tilt_max);
        for model in MODELS {
            let solver = PoseSolver::new(&gpr, model, &options).unwrap();
            let tilts = azimuths.iter().enumerate().map(|(i, &azimuth)| Tilt {
                azimuth,
                angle: 0.99 * tilt_max * i as f64 / azimuths.len() as f64,
            });
            let rods: Vec<[f64; 3]> =
                tilts.map(|tilt| gpr.inverse(tilt, AxisHeight(0.5)).unwrap()).collect();
            let count = rods.len();
            let columns: Vec<Vec<f64>> =
                (0..3).map(|k| rods.iter().map(|rods| rods[k]).collect()).collect();
            let mut status = vec![Status::NotFinite; count];
            let joints = model.model().joints().len();
            let mut many = vec![vec![0.0; count]; joints];
            let mut wanted: Vec<_> = many
                .iter_mut()
                .enumerate()
                .map(|(joint, column)| (Quantity::VirtualJoint(joint), &mut column[..]))
                .collect();
            let given = [0, 1, 2].map(|k| Column::from(&columns[k][..]));
            solver.forward_many(given, &mut status, &mut wanted).unwrap();
            for (i, &rods) in rods.iter().enumerate() {
                match (gpr.forward(rods, model.model(), &options), solver.forward(rods)) {
                    (Ok(expected), Ok(found)) => {
                        prop_assert_eq!(status[i], Status::Solved);
                        let (a, b) = (found.base_from_platform, expected.base_from_platform);
                        let apart = (a.to_homogeneous() - b.to_homogeneous()).amax();
                        prop_assert!(apart < 1e-12, "{:?} {}: {}", model, i, apart);
                        let joints = solver.virtual_joints(rods).unwrap();
                        prop_assert_eq!(&joints, &found.solution);
                        for (joint, column) in many.iter().enumerate() {
                            let expected = expected.solution.virtual_joints[joint];
                            let weight = if joint < 3 { 1.0 } else { 0.1 };
                            let apart = weight * (column[i] - expected).abs();
                            prop_assert!(apart < 1e-13, "{:?} {} many: {}", model, i, apart);
                            let apart = weight * (joints.virtual_joints[joint] - expected).abs();
                            prop_assert!(apart < 1e-13, "{:?} {} one: {}", model, i, apart);
                        }
                    }
                    (Err(expected), Err(found)) => {
                        prop_assert_eq!(expected.to_string(), found.to_string());
                        prop_assert!(status[i] != Status::Solved);
                    }
                    (expected, found) => prop_assert!(false, "{expected:?}, {found:?}"),
                }
            }
        }
    }
}

/// Poses of all tilts in one column, also those without polynomials and without an answer, and quantities that are wanted twice.
#[test]
fn many_poses_of_all_tilts_and_none() {
    let gpr = Gpr::paper().without_limit_checks();
    let mut rods: Vec<[f64; 3]> = Vec::new();
    for i in 0..500 {
        let tilt_angle = if i % 3 == 0 { 0.02 } else { 0.08 + 0.2 * f64::from(i % 7) };
        let tilt = Tilt { azimuth: f64::from(i), angle: tilt_angle };
        rods.push(gpr.inverse(tilt, AxisHeight(0.5)).unwrap());
    }
    rods[7] = [f64::NAN, 0.5, 0.5];
    rods[10] = [0.5, 0.5, 1e60];
    rods[12] = [0.5; 3];
    let columns = [0, 1, 2].map(|k| rods.iter().map(|rods| rods[k]).collect::<Vec<_>>());
    let quantities = [
        Quantity::Torsion,
        Quantity::VirtualJoint(1),
        Quantity::Residual,
        Quantity::VirtualJoint(1),
        Quantity::Origin(2),
        Quantity::Torsion,
        Quantity::Torsion,
    ];
    for (model, solver) in pairs() {
        let options = SolveOptions { solver, ..SolveOptions::default() };
        let prepared = PoseSolver::new(&gpr, model, &options).unwrap();
        for count in [500, 5, 1] {
            let given = [0, 1, 2].map(|k| Column::from(&columns[k][..count]));
            let compute = |prepared: Option<&PoseSolver>| {
                let mut status = vec![Status::NotFinite; count];
                let mut found = vec![vec![0.0; count]; quantities.len()];
                let mut wanted: Vec<_> = quantities
                    .iter()
                    .zip(&mut found)
                    .map(|(quantity, column)| (*quantity, &mut column[..]))
                    .collect();
                match prepared {
                    Some(prepared) => prepared.forward_many(given, &mut status, &mut wanted),
                    None => {
                        gpr.forward_many(given, model.model(), &options, &mut status, &mut wanted)
                    }
                }
                .unwrap();
                (status, found)
            };
            let (status, found) = compute(Some(&prepared));
            let (expected_status, expected) = compute(None);
            assert_eq!(status, expected_status, "{model:?} {solver}");
            for (column, expected) in found.iter().zip(&expected) {
                for (i, (found, expected)) in column.iter().zip(expected).enumerate() {
                    let same = found.to_bits() == expected.to_bits()
                        || found.is_nan() && expected.is_nan();
                    assert!(same || i % 3 == 0, "{model:?} {solver} {i}");
                    let near = (found - expected).abs() < 1e-12 || expected.is_nan();
                    assert!(near && found.is_nan() == expected.is_nan(), "{model:?} {solver} {i}");
                }
            }
            assert_eq!(format!("{:?}", found[0]), format!("{:?}", found[5]));
            assert_eq!(format!("{:?}", found[0]), format!("{:?}", found[6]));
            assert_eq!(format!("{:?}", found[1]), format!("{:?}", found[3]));
        }
    }
}

const SOLVERS: [Solver; 3] = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm];

/// Beyond the tilts for which it has polynomials, a solver computes as the robot does.
#[test]
fn steep_poses_are_those_of_the_robot_to_the_bit() {
    let gpr = Gpr::paper().without_limit_checks();
    for (model, solver) in pairs() {
        let options = SolveOptions { solver, ..SolveOptions::default() };
        let prepared = PoseSolver::new(&gpr, model, &options).unwrap();
        for azimuth in 0..12 {
            let tilt = Tilt { azimuth: f64::from(azimuth), angle: 0.15 };
            let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
            assert_eq!(prepared.forward(rods), gpr.forward(rods, model.model(), &options));
            let joints = gpr.virtual_joints(rods, model.model(), &options);
            assert_eq!(prepared.virtual_joints(rods), joints);
        }
    }
}

/// Near level, polynomials answer for one pose: without a step; the offset model does not converge to round-off, and has none.
#[test]
fn single_poses_within_the_limits_take_no_step() {
    let gpr = Gpr::paper();
    for (model, solver) in pairs() {
        let options = SolveOptions { solver, ..SolveOptions::default() };
        let prepared = PoseSolver::new(&gpr, model, &options).unwrap();
        for azimuth in 0..12 {
            for share in [0.1, 0.5, 0.99] {
                let angle = share * gpr.limits().tilt_max;
                let tilt = Tilt { azimuth: f64::from(azimuth), angle };
                let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
                let found = prepared.forward(rods).unwrap().solution;
                assert_eq!(found.iterations, 0, "{model:?} {solver}");
                assert_eq!(
                    found.solver,
                    gpr.forward(rods, model.model(), &options).unwrap().solution.solver
                );
            }
        }
    }
}

/// Polynomials answer only where the solver would: not without iterations.
#[test]
fn without_iterations_there_is_no_pose() {
    let gpr = Gpr::paper();
    for model in MODELS {
        let options =
            SolveOptions { solver: Solver::Newton, max_iterations: 0, ..SolveOptions::default() };
        let prepared = PoseSolver::new(&gpr, model, &options).unwrap();
        let rods = gpr.inverse(Tilt { azimuth: 0.3, angle: 0.01 }, AxisHeight(0.5)).unwrap();
        let expected = gpr.forward(rods, model.model(), &options);
        assert!(expected.is_err());
        assert_eq!(prepared.forward(rods), expected);
    }
}

/// Virtualizations that have polynomials, with each solver.
fn pairs() -> impl Iterator<Item = (BuiltIn, Solver)> {
    let models = [BuiltIn::Radial, BuiltIn::Polar, BuiltIn::Planar];
    models.into_iter().flat_map(|model| SOLVERS.map(|solver| (model, solver)))
}
