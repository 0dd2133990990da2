//! Laws of the whole chain over random robots, positions and tilts.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod common;

use common::{KINDS, kind};
use jointplay_cell::robot::{
    Configuration, EffectorId, HybridRobot, Inverse, Standing, WaferTarget,
};
use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Pose, Tilt, leaning};
use nalgebra::Vector3;
use proptest::prelude::*;

fn target_of(pose: &Pose, with_heading: bool) -> WaferTarget {
    let normal = pose.rotation * Vector3::z();
    let x = leaning(&normal).inverse() * (pose.rotation * Vector3::x());
    WaferTarget {
        center: pose.translation.vector,
        normal,
        heading: with_heading.then(|| x.y.atan2(x.x)),
    }
}

/// A robot at positions within its limits.
fn positions(robot: &HybridRobot, tilt: Tilt, height: f64, shares: [f64; 5]) -> Vec<f64> {
    let mut positions = robot.gpr.inverse(tilt, AxisHeight(height)).unwrap().to_vec();
    for (axis, share) in robot.axes[3..].iter().zip(shares) {
        positions.push(axis.min + share * (axis.max - axis.min));
    }
    positions
}

fn shares() -> impl Strategy<Value = [f64; 5]> {
    prop::array::uniform5(0.02..0.98_f64)
}

fn tilt() -> impl Strategy<Value = Tilt> {
    (-3.0..3.0_f64, 0.0..0.026_f64).prop_map(|(yaw, pitch)| Tilt { yaw, pitch })
}

/// The same angles but for whole turns.
fn alike(robot: &HybridRobot, one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).zip(&robot.axes).all(|((one, other), axis)| {
        let apart = one - other;
        let _ = axis;
        apart.abs() < 1e-6
    })
}

fn check(robot: &HybridRobot, found: &Inverse, id: EffectorId, target: &WaferTarget) {
    for branch in &found.branches {
        assert!(branch.residual <= 1e-12, "{branch:?}");
        assert!(branch.normal_residual <= 1e-12, "{branch:?}");
        let pose = robot.effector_pose(&branch.positions, id).unwrap();
        assert!((pose.translation.vector - target.center).norm() <= 1e-12);
        assert_eq!(branch.broken, robot.broken_limits(&branch.positions).unwrap());
        assert_eq!(branch.broken.is_empty(), branch.standing != Standing::BreaksLimits);
    }
    for (k, branch) in found.branches.iter().enumerate() {
        assert_eq!(branch.standing == Standing::Chosen, found.chosen == Some(k));
        for other in &found.branches[..k] {
            assert!(!alike(robot, &branch.positions, &other.positions), "{found:?}");
        }
    }
}

proptest! {
    #[test]
    fn positions_are_found_again(
        number in 0..KINDS,
        lengths in prop::array::uniform3(0.12..0.3_f64),
        tilt in tilt(),
        height in 0.3..0.7_f64,
        shares in shares(),
    ) {
        let robot = kind(number, lengths);
        let at = positions(&robot, tilt, height, shares);
        for id in robot.effectors() {
            let pose = robot.effector_pose(&at, id).unwrap();
            let target = target_of(&pose, true);
            let found = robot.inverse(id, &target, &at).unwrap();
            check(&robot, &found, id, &target);
            let closed = found.branches.iter().all(|branch| branch.corrections == 0);
            prop_assert!(closed, "{found:?}");
            if number == 9 {
                prop_assert!(found.chosen.is_some(), "{number} {found:?}");
                continue;
            }
            let again = found.branches.iter().find(|branch| alike(&robot, &branch.positions, &at));
            let again = again.unwrap_or_else(|| panic!("{number} {at:?} not in {found:#?}"));
            prop_assert!(again.standing == Standing::Chosen, "{number} {again:?}");
            prop_assert!(again.heading_off.abs() < 1e-9);
        }
    }
}

#[test]
fn bends_have_names() {
    assert_eq!(Configuration::default().to_string(), "no elbow");
}
