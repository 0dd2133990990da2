//! Kinematics, mobility and sensitivity against an independent program at fifty digits.
//!
//! Provenance and the reason for each tolerance: `validation/golden/README.md`.

use jointplay::constraint::{Configuration, System};
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, instantaneous_mobility};
use jointplay::sensitivity::sensitivity;
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, SolveOptions, VirtualJointKind};
use jointplay_validation::{Row, golden, golden_robots};

fn near(what: &str, found: f64, expected: f64, tolerance: f64, row: &Row) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: found {found:e}, expected {expected:e}, off by {:e}, in {} {} {} at {}°, {}°",
        found - expected,
        row.text("robot"),
        row.text("model"),
        row.text("solver"),
        row.text("azimuth_deg"),
        row.text("tilt_deg"),
    );
}

fn tilt(row: &Row) -> Tilt {
    let angle = |column| row.number(column).expect("an angle in every row").to_radians();
    Tilt { azimuth: angle("azimuth_deg"), angle: angle("tilt_deg") }
}

fn options(row: &Row) -> SolveOptions {
    SolveOptions { solver: row.solver(), metric: row.metric(), ..SolveOptions::default() }
}

const X: [&str; 6] = ["x1", "x2", "x3", "x4", "x5", "x6"];
const Q: [&str; 3] = ["q1_mm", "q2_mm", "q3_mm"];

#[test]
fn poses_of_every_model_and_solver() {
    let robots = golden_robots();
    let rows = golden("gpr-forward.csv");
    assert!(rows.len() >= 300, "only {} rows", rows.len());
    for row in &rows {
        let gpr = &robots[row.text("robot")];
        let height = AxisHeight(row.number("axis_height_mm").unwrap() * 1e-3);
        let rods = gpr.inverse(tilt(row), height).unwrap();
        for (k, expected) in row.lengths(Q).into_iter().enumerate() {
            near(Q[k], rods[k], expected, 1e-14, row);
        }
        let pose = gpr.forward(rods, row.virtualization(), &options(row)).unwrap();
        for (k, expected) in row.lengths(["L12_mm", "L23_mm", "L31_mm"]).into_iter().enumerate() {
            near("side", pose.sides[k], expected, 1e-14, row);
        }
        let expected = row.numbers(&X);
        assert_eq!(expected.len(), pose.solution.virtual_joints.len());
        for (m, joint) in row.virtualization().joints().iter().enumerate() {
            let (scale, tolerance) = match joint.motion {
                VirtualJointKind::Linear => (1e-3, 1e-13),
                VirtualJointKind::Angular => (1.0, 1e-10),
            };
            near(X[m], pose.solution.virtual_joints[m], expected[m] * scale, tolerance, row);
        }
        let origin = pose.base_from_platform.translation.vector;
        for (k, expected) in row.lengths(["x_mm", "y_mm", "z_mm"]).into_iter().enumerate() {
            near("origin", origin[k], expected, 1e-13, row);
        }
        for (k, column) in ["nx", "ny", "nz"].into_iter().enumerate() {
            near(column, pose.normal()[k], row.number(column).unwrap(), 1e-13, row);
        }
        let torsion = row.number("torsion_deg").unwrap().to_radians();
        near("torsion", pose.torsion(), torsion, 1e-10_f64.to_radians(), row);
    }
}

#[test]
fn singular_values_and_ranks() {
    let robots = golden_robots();
    for row in golden("gpr-mobility.csv") {
        let gpr: &Gpr = &robots[row.text("robot")];
        let pose = gpr.forward(row.lengths(Q), &Planar, &SolveOptions::default()).unwrap();
        let system = gpr.system(&Planar);
        let at = system.configuration(&pose);
        let found = instantaneous_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        for k in 0..12 {
            let expected = row.number(&format!("s{}", k + 1)).unwrap();
            let off = (found.singular_values[k] - expected).abs();
            assert!(off <= 1e-13, "s{} off by {off:e} at {:?}", k + 1, pose.rods);
        }
        let rank: usize = row.text("rank").parse().unwrap();
        assert_eq!(found.rank, rank, "at {:?}: {:?}", pose.rods, found.singular_values);
        assert_eq!(found.mobility, 12 - rank);
        let augmented = augmented_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        assert_eq!((augmented.rank, augmented.mobility), (12, 6));
    }
}

#[test]
fn singular_values_of_the_sensitivity() {
    let robots = golden_robots();
    for row in golden("gpr-sensitivity.csv") {
        let gpr = &robots[row.text("robot")];
        let virtualization = row.virtualization();
        let system = gpr.system(virtualization);
        let balls = gpr.ball_centers(&row.lengths(Q));
        let coordinates: Vec<f64> = row
            .lengths(Q)
            .into_iter()
            .chain(balls.iter().flat_map(|ball| ball.iter().copied()))
            .collect();
        let in_si = |(x, joint): (f64, &jointplay::virtualization::VirtualJoint)| match joint.motion
        {
            VirtualJointKind::Linear => x * 1e-3,
            VirtualJointKind::Angular => x,
        };
        let virtual_joints: Vec<f64> =
            row.numbers(&X).into_iter().zip(virtualization.joints()).map(in_si).collect();
        let at = Configuration {
            coordinates: coordinates.into(),
            virtual_joints: virtual_joints.into(),
        };
        assert_eq!(at.virtual_joints.len(), system.virtual_joint_dimensions().len());
        let rho = row.metric().characteristic_length(gpr.platform()).unwrap();
        let found = sensitivity(&system, &at, rho, RANK_THRESHOLD).unwrap();
        assert_eq!(found.rank, 3);
        for k in 0..3 {
            let expected = row.number(&format!("s{}", k + 1)).unwrap();
            let found = found.singular_values()[k];
            assert!((found / expected - 1.0).abs() <= 1e-9, "s{}: {found} for {expected}", k + 1);
        }
    }
}
