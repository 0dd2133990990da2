//! Properties of the inverse kinematics over random robots, positions and tilts.

use crate::common;

use std::f64::consts::TAU;

use common::{A, KINDS, kind};
use jointplay_cell::robot::{
    BranchSelection, EffectorId, HybridRobot, Inverse, LimitViolation, PlatformModel, WaferTarget,
};
use jointplay_core::gpr::AxisHeight;
use jointplay_core::linalg::svd;
use jointplay_core::spatial::{Pose, Tilt, rotation_vector, tilt_rotation};
use jointplay_core::virtualization::BuiltIn;
use nalgebra::{DMatrix, Vector3};
use proptest::prelude::*;

/// The kind of arm that has one motor more than a target with a heading needs.
const FOUR_LINKS: usize = 9;

fn target_of(pose: &Pose, with_heading: bool) -> WaferTarget {
    let normal = pose.rotation * Vector3::z();
    let x = tilt_rotation(&normal).inverse() * (pose.rotation * Vector3::x());
    WaferTarget {
        center: pose.translation.vector,
        normal,
        heading: with_heading.then(|| x.y.atan2(x.x)),
    }
}

/// A robot at positions within its limits.
fn positions(robot: &HybridRobot, tilt: Tilt, height: f64, fractions: [f64; 5]) -> Vec<f64> {
    let mut positions = robot.gpr.inverse(tilt, AxisHeight(height)).unwrap().to_vec();
    for (axis, fraction) in robot.axes[3..].iter().zip(fractions) {
        positions.push(axis.min + fraction * (axis.max - axis.min));
    }
    positions
}

fn fractions() -> impl Strategy<Value = [f64; 5]> {
    prop::array::uniform5(0.02..0.98_f64)
}

fn tilt() -> impl Strategy<Value = Tilt> {
    (-3.0..3.0_f64, 0.0..0.026_f64)
        .prop_map(|(azimuth, tilt_angle)| Tilt { azimuth, angle: tilt_angle })
}

fn model(number: usize) -> PlatformModel {
    let virtualization =
        [BuiltIn::Planar, BuiltIn::Radial, BuiltIn::Polar, BuiltIn::Offset][number];
    PlatformModel { virtualization, ..PlatformModel::default() }
}

fn alike(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-6)
}

fn check(robot: &HybridRobot, found: &Inverse, id: EffectorId, target: &WaferTarget) {
    for branch in &found.branches {
        assert!(branch.residual <= 1e-12, "{branch:?}");
        assert!(branch.normal_residual <= 1e-12, "{branch:?}");
        let pose = robot.effector_pose(&branch.positions, id).unwrap();
        assert!((pose.translation.vector - target.center).norm() <= 1e-12);
        assert_eq!(branch.violations, robot.limit_violations(&branch.positions).unwrap());
        assert_eq!(branch.violations.is_empty(), branch.selection != BranchSelection::BreaksLimits);
    }
    for (k, branch) in found.branches.iter().enumerate() {
        assert_eq!(branch.selection == BranchSelection::Chosen, found.chosen == Some(k));
        for other in &found.branches[..k] {
            assert!(!alike(&branch.positions, &other.positions), "{found:?}");
        }
    }
}

proptest! {
    #[test]
    fn inverse_of_forward_contains_the_positions(
        number in 0..KINDS,
        over in 0..4_usize,
        lengths in prop::array::uniform3(0.12..0.3_f64),
        tilt in tilt(),
        height in 0.3..0.7_f64,
        fractions in fractions(),
    ) {
        let mut robot = kind(number, lengths);
        robot.model = model(over);
        let at = positions(&robot, tilt, height, fractions);
        for id in robot.effectors() {
            let pose = robot.effector_pose(&at, id).unwrap();
            let target = target_of(&pose, true);
            let found = robot.inverse(id, &target, &at).unwrap();
            check(&robot, &found, id, &target);
            for branch in &found.branches {
                // Closed forms and height are exact without corrections.
                prop_assert!(branch.corrections == 0 || over > 1, "{branch:?}");
                prop_assert!(branch.heading_difference.abs() < 1e-9 || robot.axes_of(id).unwrap().len() == 5);
            }
            if number == FOUR_LINKS {
                prop_assert!(found.chosen.is_some(), "{number} {found:?}");
                continue;
            }
            let again = found.branches.iter().find(|branch| alike(&branch.positions, &at));
            let again = again.unwrap_or_else(|| panic!("{number} {at:?} not in {found:#?}"));
            prop_assert!(again.selection == BranchSelection::Chosen, "{number} {again:?}");
            prop_assert!(again.heading_difference.abs() < 1e-9);
        }
    }

    /// A free heading: away from limits, and unchanged when solved again from there.
    #[test]
    fn redundancy_resolution_avoids_limits(
        number in prop::sample::select(vec![5_usize, 6, 7, 8, FOUR_LINKS, 10]),
        with_heading in any::<bool>(),
        lengths in prop::array::uniform3(0.12..0.3_f64),
        tilt in tilt(),
        fractions in fractions(),
    ) {
        let robot = kind(number, lengths);
        let with_heading = with_heading && number == FOUR_LINKS;
        let at = positions(&robot, tilt, 0.5, fractions);
        let target = target_of(&robot.effector_pose(&at, A).unwrap(), with_heading);
        let found = robot.inverse(A, &target, &at).unwrap();
        check(&robot, &found, A, &target);
        prop_assert!(found.chosen.is_some(), "{found:?}");
        // No gradual path leads out of a stretched arm.
        prop_assume!(bend_cost(&robot, number, &at) < 400.0);
        let chosen = found.chosen().unwrap();
        prop_assert!(chosen.violations.is_empty());
        if number == 10 {
            return Ok(());
        }
        let cost = |positions: &[f64]| -> f64 {
            let fractions = robot.axes.iter().zip(positions).skip(3).map(|(axis, position)| {
                (2.0 * position - axis.min - axis.max) / (axis.max - axis.min)
            });
            fractions.map(|u| 1.0 / (1.0 - u * u)).sum::<f64>() + bend_cost(&robot, number, positions)
        };
        prop_assert!(cost(&chosen.positions) <= cost(&at) * (1.0 + 1e-9), "{} {}", cost(&chosen.positions), cost(&at));
        // No step along the free directions reduces the cost: its gradient is in the row space of the Jacobian.
        let step = 1e-4;
        for direction in free_directions(&robot, &chosen.positions, with_heading) {
            let moved = |sign: f64| {
                let mut moved = chosen.positions.to_vec();
                for (position, along) in moved[3..].iter_mut().zip(&direction) {
                    *position += sign * step * along;
                }
                cost(&moved)
            };
            let slope = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            prop_assert!(slope.abs() < 1e-3 * cost(&chosen.positions), "{slope} {chosen:?}");
        }
        let again = robot.inverse(A, &target, &chosen.positions).unwrap();
        prop_assert!(
            chosen.positions.iter().zip(again.chosen().unwrap().positions.iter())
                .all(|(one, other)| (one - other).abs() < 1e-4),
            "{chosen:?} {again:?}"
        );
    }

    #[test]
    fn jacobian_agrees_with_differences(
        number in 0..KINDS,
        over in 0..4_usize,
        lengths in prop::array::uniform3(0.12..0.3_f64),
        tilt in tilt(),
        fractions in fractions(),
    ) {
        let mut robot = kind(number, lengths);
        robot.model = model(over);
        let at = positions(&robot, tilt, 0.5, fractions);
        for id in robot.effectors() {
            let jacobian = robot.effector_jacobian(&at, id).unwrap();
            let moving = robot.axes_of(id).unwrap();
            let step = 1e-5;
            for axis in 0..robot.axes.len() {
                let pose = |by: f64| {
                    let mut positions = at.clone();
                    positions[axis] += by;
                    robot.effector_pose(&positions, id).unwrap()
                };
                let (before, after) = (pose(-step), pose(step));
                let shift = after.translation.vector - before.translation.vector;
                let turn = rotation_vector(&(after.rotation * before.rotation.inverse()));
                let (linear, angular) = (jacobian.linear[axis], jacobian.angular[axis]);
                prop_assert!((shift / (2.0 * step) - linear).norm() < 1e-6, "{axis} {linear}");
                prop_assert!((turn / (2.0 * step) - angular).norm() < 1e-6, "{axis} {angular}");
                let moves = linear.norm() + angular.norm() > 0.0;
                prop_assert!(!moves || moving.contains(&axis));
            }
        }
    }

    /// The same positions from the whole chain and from the platform's present pose.
    #[test]
    fn arm_inverse_agrees_with_whole_chain(
        number in 0..KINDS,
        lengths in prop::array::uniform3(0.12..0.3_f64),
        tilt in tilt(),
        fractions in fractions(),
    ) {
        let robot = kind(number, lengths);
        let at = positions(&robot, tilt, 0.5, fractions);
        let pose = robot.forward(&at).unwrap();
        for id in robot.effectors() {
            let wafer = pose.base_from_wafer[id.arm][id.effector];
            let within = pose.platform.base_from_platform.inverse() * wafer;
            let x = within.rotation * Vector3::x();
            let heading = Some(x.y.atan2(x.x));
            let point = within.translation.vector.xy();
            let found = robot.arm_inverse(id, point, heading, &at).unwrap();
            prop_assert!(found.chosen.is_some());
            for branch in &found.branches {
                prop_assert_eq!(&branch.positions[..3], &at[..3]);
                prop_assert!(branch.residual < 1e-12 && branch.heading_difference.abs() < 1e-9 || branch.heading_difference != 0.0);
            }
            let whole = robot.inverse(id, &target_of(&wafer, true), &at).unwrap();
            prop_assert_eq!(found.branches.len(), whole.branches.len());
        }
    }

    /// A radial step of the wafer keeps the configuration, and takes small steps of all axes.
    #[test]
    fn branches_are_continuous(
        number in prop::sample::select(vec![0_usize, 3, 5, 7, 8, FOUR_LINKS]),
        lengths in prop::array::uniform3(0.18..0.3_f64),
        fractions in prop::array::uniform5(0.2..0.8_f64),
        by in prop::array::uniform3(-1e-4..1e-4_f64),
    ) {
        let robot = kind(number, lengths);
        let at = positions(&robot, Tilt { azimuth: 0.4, angle: 0.01 }, 0.5, fractions);
        let mut target = target_of(&robot.effector_pose(&at, A).unwrap(), true);
        prop_assume!(bend_cost(&robot, number, &at) < 400.0);
        let start = robot.inverse(A, &target, &at).unwrap().chosen().unwrap().clone();
        // Near the stretched arm, and with the wafer over its first joint, small steps of the wafer take large steps of axes.
        prop_assume!(least_speed(&robot, &start.positions) > 0.05);
        target.center += Vector3::from(by);
        let Some(next) = robot.inverse(A, &target, &start.positions).unwrap().chosen().cloned()
        else {
            return Ok(());
        };
        prop_assert!(next.configuration.agrees_with(start.configuration));
        prop_assert!(next.travel_time < 0.05, "{start:?} {next:?}");
    }
}

/// Cost of being near the end of a configuration, from the positions of the links.
fn bend_cost(robot: &HybridRobot, number: usize, positions: &[f64]) -> f64 {
    let links = &robot.forward(positions).unwrap().base_from_link[0];
    let at = |k: usize| links[k].translation.vector;
    let level = |vector: Vector3<f64>| {
        let within = links[0].rotation.inverse() * vector;
        Vector3::new(within.x, within.y, 0.0)
    };
    let sine = |one: Vector3<f64>, other: Vector3<f64>| {
        level(one).normalize().cross(&level(other).normalize()).norm()
    };
    match number {
        5 | 6 => sine(at(1) - at(0), at(2) - at(1)).powi(-2),
        FOUR_LINKS => sine(at(2) - at(1), at(3) - at(2)).powi(-2),
        // The belt rotates each link by half the angle between them.
        7 => {
            let (one, other) = (level(at(1) - at(0)), level(at(2) - at(1)));
            let cosine = one.normalize().dot(&other.normalize());
            let ahead = (links[2].rotation.inverse() * (at(3) - at(0))).x;
            let wafer = robot.arms[0].effectors[0].wafer_center;
            2.0 / (1.0 - cosine) + (0.1 * wafer[0].hypot(wafer[1]) / ahead).powi(2)
        }
        8 => {
            // The first link has 50 mm before the prismatic joint and 20 mm after it.
            let ahead = level(at(2) - at(0)).x;
            let wafer = robot.arms[0].effectors[0].wafer_center;
            (0.1 * wafer[0].hypot(wafer[1]) / ahead).powi(2)
        }
        _ => 0.0,
    }
}

/// Least speed of the wafer over all directions, the motors moving at one radian a second together (m/s).
fn least_speed(robot: &HybridRobot, at: &[f64]) -> f64 {
    let with_heading = robot.axes.len() > 5;
    let found = svd(&motor_jacobian(robot, at, with_heading)).unwrap();
    found.singular_values[if with_heading { 2 } else { 1 }]
}

/// Velocities of the wafer's centre and of its heading by the motors.
fn motor_jacobian(robot: &HybridRobot, at: &[f64], with_heading: bool) -> DMatrix<f64> {
    let jacobian = robot.effector_jacobian(at, A).unwrap();
    let motors = 3..robot.axes.len();
    let normal = robot.effector_pose(at, A).unwrap().rotation * Vector3::z();
    let rows = if with_heading { 4 } else { 3 };
    let of = |row: usize, axis: usize| match row {
        3 => jacobian.angular[axis].dot(&normal),
        _ => jacobian.linear[axis][row],
    };
    DMatrix::from_fn(rows, motors.len(), |row, k| of(row, 3 + k))
}

/// An orthonormal basis of the motor velocities that keep the wafer in place.
fn free_directions(robot: &HybridRobot, at: &[f64], with_heading: bool) -> Vec<Vec<f64>> {
    let found = svd(&motor_jacobian(robot, at, with_heading)).unwrap();
    let free = found.null_space(found.rank(1e-9));
    free.column_iter().map(|column| column.iter().copied().collect()).collect()
}

#[test]
fn branch_selection_names_the_reason() {
    let robot = kind(5, [0.2, 0.2, 0.3]);
    let at = positions(&robot, Tilt::LEVEL, 0.5, [0.5, 0.75, 0.4, 0.0, 0.0]);
    let target = target_of(&robot.effector_pose(&at, A).unwrap(), true);
    let found = robot.inverse(A, &target, &at).unwrap();
    let selections: Vec<BranchSelection> =
        found.branches.iter().map(|branch| branch.selection).collect();
    assert_eq!(found.chosen().unwrap().configuration.to_string(), "elbow right");
    assert!(selections.contains(&BranchSelection::OtherConfiguration), "{found:#?}");

    // The other elbow from the other side; and once it violates a limit, this elbow with the limit.
    let other =
        found.branches.iter().find(|b| b.selection == BranchSelection::OtherConfiguration).unwrap();
    let from_there = robot.inverse(A, &target, &other.positions).unwrap();
    assert_eq!(from_there.chosen().unwrap().configuration.to_string(), "elbow left");
    let mut short = robot.clone();
    short.axes[4].min = -0.1;
    let from_there = short.inverse(A, &target, &other.positions).unwrap();
    assert_eq!(from_there.chosen().unwrap().configuration.to_string(), "elbow right");
    let stopped = from_there.branches.iter().find(|b| !b.violations.is_empty()).unwrap();
    let LimitViolation::Axis { axis: 4, position, min: -0.1, .. } = stopped.violations[0] else {
        panic!("{stopped:?}")
    };
    assert_eq!(position, stopped.positions[4]);

    // Too far, too near, too steep, too high.
    let mut far = target;
    far.center.x += 2.0;
    let out = robot.inverse(A, &far, &at).unwrap();
    let reach = out.out_of_reach.unwrap();
    assert!(out.branches.is_empty() && reach.missing() > 1.0 && reach.distance > reach.max);
    let steep = WaferTarget { normal: Tilt { azimuth: 1.0, angle: 0.04 }.normal(), ..target };
    let out = robot.inverse(A, &steep, &at).unwrap();
    let limit = LimitViolation::Tilt { angle: 0.04, max: 1.5_f64.to_radians() };
    assert!(out.chosen.is_none() && !out.branches.is_empty());
    let LimitViolation::Tilt { angle, max } = out.plane_violations[0] else { panic!("{limit:?}") };
    assert!((angle - 0.04).abs() < 1e-15 && max == 1.5_f64.to_radians());
    let mut high = target;
    high.center.z += 0.5;
    let out = robot.inverse(A, &high, &at).unwrap();
    assert_eq!((out.chosen, out.plane_violations.len()), (None, 3));
}

#[test]
fn revolutions_within_limits_are_branches() {
    let mut robot = kind(0, [0.2, 0.2, 0.3]);
    robot.axes[3].min = -7.0;
    robot.axes[3].max = 7.0;
    let mut at = positions(&robot, Tilt::LEVEL, 0.5, [0.5, 0.8, 0.0, 0.0, 0.0]);
    at[3] = 1.0;
    let target = target_of(&robot.effector_pose(&at, A).unwrap(), false);
    let found = robot.inverse(A, &target, &at).unwrap();
    let forward = found
        .branches
        .iter()
        .filter(|branch| branch.configuration == found.chosen().unwrap().configuration);
    let mut turns: Vec<f64> = forward.map(|branch| branch.positions[3]).collect();
    turns.sort_by(f64::total_cmp);
    let expected = [1.0 - TAU, 1.0];
    assert!(
        turns.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-12),
        "{turns:?}"
    );
    assert_eq!(turns.len(), 2);
    // From the other side of the range the other branch is nearer.
    at[3] = -6.0;
    let found = robot.inverse(A, &target, &at).unwrap();
    assert!((found.chosen().unwrap().positions[3] - (1.0 - TAU)).abs() < 1e-12);
}

/// The nearest revolutions may violate a limit that others keep.
#[test]
fn free_heading_uses_other_revolutions_within_limits() {
    for number in [5, 7, 8, FOUR_LINKS] {
        let robot = kind(number, [0.2, 0.2, 0.3]);
        let at = positions(&robot, Tilt::LEVEL, 0.5, [0.35, 0.6, 0.55, 0.45, 0.0]);
        let target = target_of(&robot.effector_pose(&at, A).unwrap(), false);
        let last = robot.axes.len() - 1;
        for (first, other) in [(0.05, 0.05), (0.05, 0.95), (0.95, 0.05), (0.95, 0.95)] {
            let mut near = at.clone();
            for (axis, fraction) in [(3, first), (last, other)] {
                let (min, max) = (robot.axes[axis].min, robot.axes[axis].max);
                near[axis] = min + fraction * (max - min);
            }
            let found = robot.inverse(A, &target, &near).unwrap();
            assert!(found.chosen.is_some(), "{number} {near:?} {found:?}");
        }
    }
}

/// The station of one arm tilts the platform under the other arm, and a shared motor turns it.
#[test]
fn displacements_of_other_effectors_are_returned() {
    let robot = kind(2, [0.2, 0.22, 0.3]);
    let at = positions(&robot, Tilt::LEVEL, 0.5, [0.5, 0.7, 0.6, 0.0, 0.0]);
    let mut target = target_of(&robot.effector_pose(&at, A).unwrap(), false);
    target.normal = Tilt { azimuth: 0.7, angle: 0.014 }.normal();
    let to = robot.inverse(A, &target, &at).unwrap().chosen().unwrap().positions;
    let effects = robot.effects_on_others(A, &at, &to).unwrap();
    let [effect] = effects.as_slice() else { panic!("{effects:?}") };
    let other = EffectorId { arm: 1, effector: 0 };
    assert_eq!(effect.effector, other);
    assert!((effect.tilting() - 0.014).abs() < 1e-12);
    assert_eq!(effect.after, robot.effector_pose(&to, other).unwrap());
    assert!(effect.shift().norm() > 1e-3);
    assert_eq!(to[5], at[5], "its own motor does not move");
}

#[test]
fn invalid_targets_are_rejected() {
    let robot = kind(0, [0.2, 0.2, 0.3]);
    let at = positions(&robot, Tilt::LEVEL, 0.5, [0.5; 5]);
    let good = target_of(&robot.effector_pose(&at, A).unwrap(), false);
    let refusal = |target: WaferTarget| robot.inverse(A, &target, &at).unwrap_err().to_string();
    let down = WaferTarget { normal: -Vector3::z(), ..good };
    assert!(refusal(down).contains("does not point up"));
    assert!(
        refusal(WaferTarget { normal: Vector3::zeros(), ..good }).contains("does not point up")
    );
    let nan = WaferTarget { center: Vector3::repeat(f64::NAN), ..good };
    assert_eq!(refusal(nan), "the wafer's centre is NaN, but has to be a finite number");
    let nan = WaferTarget { heading: Some(f64::INFINITY), ..good };
    assert_eq!(refusal(nan), "the heading is inf, but has to be a finite number");
    let missing = EffectorId { arm: 0, effector: 1 };
    assert!(robot.inverse(missing, &good, &at).unwrap_err().to_string().contains("no effector 1"));
    let short = robot.inverse(A, &good, &at[..4]).unwrap_err().to_string();
    assert_eq!(short, "4 positions are given, but the robot has 5 axes");
    assert!(robot.forward(&[f64::NAN; 5]).unwrap_err().to_string().contains("axis q1 is NaN"));
}
