//! A wafer on a drooping arm lies at its target, and what cannot be compensated is returned.

use crate::common;

use common::A;
use std::f64::consts::PI;

use jointplay_cell::robot::WaferTarget;
use jointplay_cell::wafer::{Droop, DroopRow, Unreachable};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::{Tilt, tilt_rotation};
use nalgebra::Vector3;
use proptest::prelude::*;

fn cell(kind: usize, droop: Droop) -> Cell {
    let mut robot = common::kind(kind, [0.25, 0.22, 0.2]);
    for arm in &mut robot.arms {
        arm.droop = droop.clone();
    }
    Cell { loaded_effectors: Vec::new(), play_budget: 1e-3, ..common::cell(robot) }
}

fn cantilever() -> Droop {
    Droop::Cantilever { stiffness: 900.0, mass_per_length: 2.5 }
}

fn table(reach: f64, drop: f64) -> DroopRow {
    DroopRow {
        reach,
        empty_drop: drop,
        empty_slope: 3.0 * drop,
        loaded_drop: 1.8 * drop,
        loaded_slope: 5.0 * drop,
        load: 0.2,
    }
}

fn droops() -> impl Strategy<Value = Droop> {
    prop_oneof![
        Just(Droop::Rigid),
        (300.0..3000.0, 0.5..4.0).prop_map(|(stiffness, mass_per_length)| Droop::Cantilever {
            stiffness,
            mass_per_length
        }),
        (1e-5..4e-4).prop_map(|drop| Droop::Table {
            rows: vec![table(0.0, 0.1 * drop), table(0.3, drop), table(1.2, 4.0 * drop)]
        }),
    ]
}

#[test]
fn unsorted_droop_table_is_rejected() {
    let refused = |rows: Vec<DroopRow>| {
        let mut robot = common::kind(0, [0.25, 0.22, 0.2]);
        robot.arms[0].droop = Droop::Table { rows };
        robot.checked().err().map(|error| error.to_string())
    };
    assert_eq!(refused(vec![table(0.2, 1e-4), table(0.6, 2e-4)]), None);
    for rows in [
        vec![table(0.6, 2e-4), table(0.2, 1e-4)],
        vec![table(0.2, 1e-4), table(0.2, 2e-4)],
        vec![table(0.1, 1e-4), table(f64::NAN, 2e-4)],
    ] {
        let why = refused(rows).unwrap();
        assert!(why.contains("the reach in row 2 of the droop of arm"), "{why}");
    }
    assert!(refused(vec![table(0.2, f64::NAN)]).unwrap().contains("the drop in row 1"));
}

proptest! {
    #[test]
    fn compensated_wafer_lies_at_the_target(
        kind in 0..common::KINDS,
        droop in droops(),
        (fraction, azimuth, tilt_angle) in (prop::array::uniform8(0.1..0.9), -PI..PI, 0.0_f64..1.3),
        loaded: bool,
    ) {
        let cell = cell(kind, droop);
        let axes = cell.robot.axes.iter().zip(fraction.iter().cycle());
        let mut near: Vec<f64> = axes.map(|(axis, fraction)| axis.min + fraction * (axis.max - axis.min)).collect();
        // A level platform, so that the target alone determines the tilt.
        let rod = near[0];
        near[..3].fill(rod.clamp(0.3, 0.7));
        let before = cell.robot.effector_pose(&near, A).unwrap();
        let normal = Tilt { azimuth, angle: tilt_angle.to_radians() }.normal();
        let target = WaferTarget { center: before.translation.vector, normal, heading: None };
        match cell.compensated_inverse(A, &target, loaded, &near) {
            Ok(reached) => {
                let found = cell.wafer_pose(A, &reached.positions, loaded).unwrap();
                prop_assert!((found.translation.vector - target.center).norm() < 1e-12);
                prop_assert!((found.rotation * Vector3::z() - normal).norm() < 1e-12);
                prop_assert!(reached.residual < 1e-12 && reached.residual_tilt < 1e-12);
            }
            // At the end of the range of arm or rods.
            Err(Unreachable::Limits(_) | Unreachable::OutOfReach(_) | Unreachable::NoBranch) => {
                prop_assume!(false);
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }
}

#[test]
fn compensation_keeps_a_free_heading() {
    let cell = cell(5, cantilever());
    let near = [0.5, 0.5, 0.5, 0.3, -0.9, 0.4];
    let pose = cell.robot.effector_pose(&near, A).unwrap();
    let normal = Tilt { azimuth: 0.7, angle: 0.01 }.normal();
    let along = tilt_rotation(&normal).inverse() * (pose.rotation * Vector3::x());
    let heading = along.y.atan2(along.x);
    let target = WaferTarget { center: pose.translation.vector, normal, heading: Some(heading) };
    let reached = cell.compensated_inverse(A, &target, true, &near).unwrap();
    assert!(reached.deflection.drop > 1e-5, "{reached:?}");
    let found = cell.wafer_pose(A, &reached.positions, true).unwrap();
    let found = tilt_rotation(&normal).inverse() * (found.rotation * Vector3::x());
    assert!((found.y.atan2(found.x) - heading).abs() < 1e-12);
}

#[test]
fn tilt_beyond_the_platform_limit_is_reported() {
    let mut cell = cell(0, cantilever());
    let near = [0.5, 0.5, 0.5, 0.3, 0.9];
    let pose = cell.robot.effector_pose(&near, A).unwrap();
    let limit = cell.robot.gpr.limits().tilt_max;
    // Outward, so that the droop adds its slope to the tilt.
    let out = pose.translation.vector;
    let azimuth = out.y.atan2(out.x) + PI;
    let target = |tilt_angle| WaferTarget {
        center: pose.translation.vector,
        normal: Tilt { azimuth, angle: tilt_angle }.normal(),
        heading: None,
    };
    let error = cell.compensated_inverse(A, &target(limit + 0.009), true, &near).unwrap_err();
    let Unreachable::Tilt { needed, allowed, residual: left, threshold } = error else {
        panic!("{error}")
    };
    assert!(needed > limit + 0.009 && allowed == limit && threshold == 1e-6);
    assert!((left - (needed - allowed)).abs() < 1e-5, "{needed} {left}");
    // With a threshold that is wide enough, the centre is met and the residual tilt returned.
    cell.plane_threshold = 0.02;
    let reached = cell.compensated_inverse(A, &target(limit + 0.009), true, &near).unwrap();
    assert!(reached.residual < 1e-12 && (reached.residual_tilt - left).abs() < 1e-12);
}

#[test]
fn out_of_reach_error_has_the_span() {
    let cell = cell(0, Droop::Table { rows: vec![table(0.2, 1e-4), table(0.6, 2e-4)] });
    let near = [0.5, 0.5, 0.5, 0.3, 0.9];
    let at = |x: f64| {
        let center = Vector3::new(x, 0.0, 0.7);
        let target = WaferTarget { center, normal: Vector3::z(), heading: None };
        cell.compensated_inverse(A, &target, true, &near).unwrap_err().to_string()
    };
    assert!(at(2.0).contains("but span 0 to 0.7 m"), "{}", at(2.0));
    assert!(at(0.66).contains("the table ranges from 0.2 to 0.6 m"), "{}", at(0.66));
}
