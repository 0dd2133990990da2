//! Inverse kinematics of arms with an elbow and a slide behind it, checked by a forward kinematics of this file.

use crate::common;

use common::{A, arm, axis, joint, robot};
use jointplay_cell::robot::AxisKind::{Linear, Rotary};
use jointplay_cell::robot::{HybridRobot, Redundancy, WaferTarget};
use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::Tilt;
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;

/// An arm of two links and a slide, with a wrist between them or without.
fn slide_arm(
    wrist: bool,
    coupling: f64,
    [a, b, w]: [f64; 3],
    ranges: &[[f64; 2]; 4],
) -> HybridRobot {
    let range = |k: usize| ranges[k];
    let slide = if wrist { 6 } else { 5 };
    let mut joints = vec![
        joint(Rotary, 0.1, &[(3, 1.0)], a),
        joint(Rotary, -0.2, &[(4, 1.0), (3, coupling)], b),
        joint(Rotary, 0.05, &[(5, 1.0), (4, coupling)], 0.0),
        joint(Linear, 0.02, &[(slide, 1.0)], 0.0),
    ];
    joints[1].offset = 0.006;
    joints.iter_mut().for_each(|joint| joint.drives.retain(|&(_, ratio)| ratio != 0.0));
    let mut axes = vec![
        axis("S", Rotary, range(0)[0], range(0)[1]),
        axis("E", Rotary, range(1)[0], range(1)[1]),
        axis("W", Rotary, range(2)[0], range(2)[1]),
        axis("P", Linear, range(3)[0], range(3)[1]),
    ];
    if !wrist {
        joints.remove(2);
        axes.remove(2);
    }
    robot(axes, vec![arm("A", joints, [w, 0.003, 0.008])])
}

/// Centre of the wafer in the platform plane.
fn tip(robot: &HybridRobot, positions: &[f64]) -> Vector2<f64> {
    let arm = &robot.arms[0];
    let (mut at, mut angle) = (Vector2::new(arm.mount[0], arm.mount[1]), 0.0_f64);
    for (k, joint) in arm.joints.iter().enumerate() {
        let driven: f64 = joint.drives.iter().map(|&(axis, ratio)| ratio * positions[axis]).sum();
        let value = joint.zero + driven;
        let mut link = [joint.length, joint.offset];
        if k + 1 == arm.joints.len() {
            link = [arm.effectors[0].wafer_center[0], arm.effectors[0].wafer_center[1]];
        }
        if joint.kind == Rotary {
            angle += value;
        } else {
            link[0] += value;
        }
        let (sin, cos) = angle.sin_cos();
        at += Vector2::new(cos * link[0] - sin * link[1], sin * link[0] + cos * link[1]);
    }
    at
}

fn ranges() -> impl Strategy<Value = [[f64; 2]; 4]> {
    let angle = || (-4.0..-1.2_f64, 1.2..4.0_f64).prop_map(|(min, max)| [min, max]);
    let slide = (-0.1..0.0_f64, 0.05..0.2_f64).prop_map(|(min, max)| [min, max]);
    (angle(), angle(), angle(), slide).prop_map(|(s, e, w, p)| [s, e, w, p])
}

proptest! {
    #[test]
    fn postures_within_limits_are_found_for_arms_with_an_elbow_and_a_slide(
        wrist in any::<bool>(),
        with_heading in any::<bool>(),
        coupling in prop::sample::select(vec![0.0, -1.0, 0.5]),
        lengths in prop::array::uniform3(0.12..0.3_f64),
        ranges in ranges(),
        at in prop::array::uniform4(0.1..0.9_f64),
        seed in prop::array::uniform4(0.0..1.0_f64),
    ) {
        let robot = slide_arm(wrist, coupling, lengths, &ranges);
        let rods = robot.gpr.inverse(Tilt::LEVEL, AxisHeight(0.5)).unwrap();
        let place = |fractions: [f64; 4]| {
            let motors = robot.axes[3..].iter().zip(fractions);
            let motors = motors.map(|(axis, f)| axis.min + f * (axis.max - axis.min));
            rods.into_iter().chain(motors).collect::<Vec<f64>>()
        };
        let (at, seed): (Vec<f64>, Vec<f64>) = (place(at), place(seed));
        let pose = robot.effector_pose(&at, A).unwrap();
        let mut target = WaferTarget::from_pose(&pose);
        if !with_heading {
            target.heading = None;
        }
        for redundancy in [Redundancy::AwayFromLimits, Redundancy::NearestToPresent] {
            let found = robot.inverse_by(A, &target, &seed, redundancy).unwrap();
            let Some(chosen) = found.chosen() else {
                return Err(TestCaseError::fail(format!("{at:?} {found:#?}")));
            };
            for (axis, position) in robot.axes.iter().zip(chosen.positions.iter()) {
                prop_assert!(*position >= axis.min - 1e-9 && *position <= axis.max + 1e-9);
            }
            let difference = tip(&robot, &chosen.positions) - tip(&robot, &at);
            prop_assert!(difference.norm() < 1e-11, "{difference:?} {chosen:?}");
            if with_heading {
                let turned = |positions: &[f64]| -> f64 {
                    let joints = robot.arms[0].joints.iter().filter(|it| it.kind == Rotary);
                    let drives = joints.flat_map(|joint| &joint.drives);
                    drives.map(|&(axis, ratio)| ratio * positions[axis]).sum()
                };
                let turn = turned(&chosen.positions) - turned(&at);
                prop_assert!((0.5 * turn).sin().abs() < 1e-9, "{turn}");
            }
        }
    }

    /// From the positions themselves, nothing moves; from near them, the axes move little.
    #[test]
    fn nearest_positions_of_redundant_arms_are_near(
        number in prop::sample::select(vec![5_usize, 9]),
        with_slide in any::<bool>(),
        lengths in prop::array::uniform3(0.15..0.3_f64),
        at in prop::array::uniform4(0.2..0.8_f64),
        by in prop::array::uniform3(-1e-3..1e-3_f64),
    ) {
        let ranges = [[-3.0, 3.0], [-2.5, 2.5], [-3.0, 3.0], [-0.1, 0.2]];
        let robot = if with_slide {
            slide_arm(true, 0.0, lengths, &ranges)
        } else {
            common::kind(number, lengths)
        };
        let rods = robot.gpr.inverse(Tilt::LEVEL, AxisHeight(0.5)).unwrap();
        let motors = robot.axes[3..].iter().zip(at);
        let motors = motors.map(|(axis, f)| axis.min + f * (axis.max - axis.min));
        let at: Vec<f64> = rods.into_iter().chain(motors).collect();
        let mut target = WaferTarget::from_pose(&robot.effector_pose(&at, A).unwrap());
        let nearest = |target: &WaferTarget| {
            robot.inverse_by(A, target, &at, Redundancy::NearestToPresent).unwrap()
        };
        let same = nearest(&target).chosen().unwrap().clone();
        for (found, start) in same.positions.iter().zip(&at) {
            prop_assert!((found - start).abs() < 1e-9, "{same:?} {at:?}");
        }
        // A change of height alone moves no motor.
        target.center.z += by[2];
        let raised = nearest(&target).chosen().unwrap().clone();
        for (found, start) in raised.positions.iter().zip(&at).skip(3) {
            prop_assert!((found - start).abs() < 1e-6, "{raised:?} {at:?}");
        }
        // Of the positions along the null space of the chain, none is nearer: the displacement is in the row space of its Jacobian.
        target.center += Vector3::new(by[0], by[1], 0.0);
        let moved = nearest(&target).chosen().cloned();
        let Some(moved) = moved else { return Ok(()) };
        let weights: Vec<f64> = robot.axes[3..].iter().map(|it| 0.5 * (it.max - it.min)).collect();
        let distance = |positions: &[f64]| -> f64 {
            let pairs = positions[3..].iter().zip(&at[3..]).zip(&weights);
            pairs.map(|((a, b), weight)| ((a - b) / weight).powi(2)).sum()
        };
        let kept = robot
            .inverse_by(A, &target, &at, Redundancy::KeepRedundantAngles)
            .unwrap();
        for branch in &kept.branches {
            prop_assert!(distance(&moved.positions) <= distance(&branch.positions) + 1e-12);
        }
    }
}
