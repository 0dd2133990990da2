//! The three-rod robot and the mechanism that it is: conversion in both directions, and equal results.

use jointplay_core::gpr::{AxisHeight, Gpr, Limb, Limits, NotThreeRods};
use jointplay_core::mechanism::{
    CommandedJoints, Joint, JointKind, Mechanism, MechanismSystem, ReliefSolver, guess, relieve,
};
use jointplay_core::nalgebra::{Rotation3, Translation3, Vector2, Vector3};
use jointplay_core::spatial::{Pose, Tilt};
use jointplay_core::virtualization::{
    BuiltIn, Metric, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};
use proptest::prelude::*;

const TILT_MAX: f64 = 0.05;

/// A robot of three unequal limbs with rods next to their sockets, and the tilt of a pose.
fn robots() -> impl Strategy<Value = (Gpr, Tilt)> {
    let limb = (0.05..0.3_f64, -0.4..0.4_f64, -1e-4..1e-4_f64, -1e-4..1e-4_f64);
    let limbs = proptest::array::uniform3(limb);
    (limbs, 0.2..0.8_f64, 0.0..6.2_f64, 1e-4..0.03_f64, -3.0..3.0_f64).prop_map(
        |(limbs, height, azimuth, angle, turn)| {
            let limbs = [0, 1, 2].map(|k| {
                let (radius, off, x, y) = limbs[k];
                let socket_angle = turn + [0.0, 2.1, 4.2][k] + off;
                let mut limb = Limb::under_socket(radius, socket_angle);
                limb.base_point += Vector2::new(x, y);
                limb
            });
            let limits =
                Limits { rod_min: height - 0.1, rod_max: height + 0.1, tilt_max: TILT_MAX };
            (Gpr::new(limbs, limits, height).unwrap(), Tilt { azimuth, angle })
        },
    )
}

fn pose() -> impl Strategy<Value = Pose> {
    let vector = || proptest::array::uniform3(-2.0..2.0_f64).prop_map(Vector3::from);
    (vector(), vector())
        .prop_map(|(shift, turn)| Pose::from_parts(Translation3::from(shift), Rotation3::new(turn)))
}

/// The mechanism with other frames of its links, some joints reversed, and its joints in another order.
fn described_otherwise(mechanism: &Mechanism, frames: &[Pose; 5], reversed: u8) -> Mechanism {
    let joint = |(index, joint): (usize, &Joint)| {
        let mut joint = joint.clone();
        for side in 0..2 {
            joint.frames[side] = frames[joint.links[side]] * joint.frames[side];
        }
        if reversed >> index & 1 == 1 {
            joint.links.swap(0, 1);
            joint.frames.swap(0, 1);
            for limit in &mut joint.limits {
                *limit = [-limit[1], -limit[0]];
            }
        }
        joint
    };
    let mut joints: Vec<Joint> = mechanism.joints().iter().enumerate().map(joint).collect();
    // Ball 1, rod 1, ball 2, …: coordinates have other numbers.
    joints = [3, 0, 4, 1, 5, 2].map(|index: usize| joints[index].clone()).to_vec();
    Mechanism::new("described otherwise", mechanism.links().to_vec(), joints).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_robot_made_a_mechanism_is_recognised_as_the_same((gpr, _) in robots()) {
        let gpr = gpr.with_ball_clearance(20e-6).unwrap();
        let found = Gpr::from_mechanism(&gpr.to_mechanism("m"), TILT_MAX).unwrap();
        let (a, b) = (found.gpr.limbs(), gpr.limbs());
        for k in 0..3 {
            prop_assert_eq!(a[k].base_point, b[k].base_point);
            prop_assert!((a[k].socket_radius - b[k].socket_radius).abs() < 1e-15);
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), a[k].socket_angle - b[k].socket_angle);
            prop_assert!(turned.angle() < 1e-14);
        }
        prop_assert!((found.gpr.limits().rod_min - gpr.limits().rod_min).abs() < 1e-15);
        prop_assert!((found.gpr.working_height() - gpr.working_height()).abs() < 1e-15);
        prop_assert_eq!(found.gpr.ball_clearance(), Some(20e-6));
        prop_assert_eq!(found.link_from_base, Pose::identity());
    }

    /// Rods, pose of the platform and displacements of the virtual joints, by the closed form and by the loops of the mechanism.
    #[test]
    fn both_descriptions_have_the_same_poses((gpr, tilt) in robots()) {
        let models: [(&dyn Virtualization, BuiltIn); 3] =
            [(&Radial, BuiltIn::Radial), (&Polar, BuiltIn::Polar), (&Planar, BuiltIn::Planar)];
        let rods = gpr.inverse(tilt, AxisHeight(gpr.working_height())).unwrap();
        let length = gpr.platform().mean_radius();
        let options = SolveOptions { metric: Metric::Length(length), solver: Solver::LeastNorm, ..SolveOptions::default() };
        for (model, built_in) in models {
            let mechanism = gpr.to_relieved_mechanism("m", built_in).unwrap();
            let found = Gpr::from_mechanism(&mechanism, TILT_MAX).unwrap();
            let expected = gpr.forward(rods, model, &options).unwrap();
            let coordinates = found.rods.map(|rod| rod.index);
            // Rods that are not below their sockets need play in any pose: the guess, at which all virtual joints are zero, is the start.
            let mut start = guess(&mechanism);
            let home = MechanismSystem::new(&mechanism, start.clone()).unwrap();
            for k in 0..3 {
                start[coordinates[k]] = found.rods[k].coordinate(rods[k]);
            }
            let system = MechanismSystem::new(&mechanism, start).unwrap();
            let commanded = CommandedJoints::new(&home, &coordinates).unwrap();
            let relief = relieve(&system, &commanded, ReliefSolver::LeastNorm).unwrap();
            let at = system.with_home(relief.coordinates).unwrap();
            let platform = at.kinematics().link_poses(at.home()).unwrap()[found.platform];
            let by_loops = found.link_from_base.inverse() * platform * found.link_from_platform;
            let off = (by_loops.to_homogeneous() - expected.base_from_platform.to_homogeneous()).amax();
            prop_assert!(off < 1e-10, "{built_in:?}: {off:e}");
        }
    }

    /// Frames of links, directions of joints and their order are of the description, not of the robot.
    #[test]
    fn a_robot_is_recognised_in_any_description(
        (gpr, tilt) in robots(),
        frames in proptest::array::uniform5(pose()),
        reversed in 0_u8..64,
    ) {
        let mechanism = described_otherwise(&gpr.to_mechanism("m"), &frames, reversed);
        let found = Gpr::from_mechanism(&mechanism, TILT_MAX).unwrap();
        // The height of the base plane depends on the base frame; the tilt and the platform on the differences of rods.
        let rods = gpr.inverse(tilt, AxisHeight(gpr.working_height())).unwrap();
        let [limits, described] = [gpr.limits(), found.gpr.limits()];
        prop_assert!((limits.rod_max - limits.rod_min - described.rod_max + described.rod_min).abs() < 1e-12);
        let at = |k: usize| {
            let rod = found.rods[k];
            // The coordinate in the first description, and its direction in the second.
            let coordinate = rods[k] - gpr.working_height();
            rod.length(if reversed >> k & 1 == 1 { -coordinate } else { coordinate })
        };
        let moved = [at(0), at(1), at(2)];
        let a = gpr.without_limit_checks().forward(rods, &Planar, &SolveOptions::default()).unwrap();
        let b = found.gpr.without_limit_checks().forward(moved, &Planar, &SolveOptions::default()).unwrap();
        // Angles between the platform and the rods, which no frame changes.
        let tilt_of = |pose: &Pose| (pose.rotation * Vector3::z()).z;
        prop_assert!((tilt_of(&a.base_from_platform) - tilt_of(&b.base_from_platform)).abs() < 1e-12);
        // The balls in the frame of the base link, by the closed form of either description.
        for k in 0..3 {
            let ball = |gpr: &Gpr, rods: &[f64; 3]| gpr.ball_centers(rods)[k];
            let first = frames[0] * Translation3::from(ball(&gpr, &rods));
            let second = found.link_from_base * Translation3::from(ball(&found.gpr, &moved));
            prop_assert!((first.translation.vector - second.translation.vector).norm() < 1e-12);
        }
    }
}

#[test]
fn polar_displacements_have_no_virtual_joint_in_a_mechanism() {
    assert_eq!(Gpr::paper().to_relieved_mechanism("m", BuiltIn::Offset), None);
}

fn changed(change: impl Fn(&mut Vec<Joint>)) -> Result<(), NotThreeRods> {
    let paper = Gpr::paper().to_mechanism("GPR");
    let mut joints = paper.joints().to_vec();
    change(&mut joints);
    let mechanism = Mechanism::new("changed", paper.links().to_vec(), joints).unwrap();
    Gpr::from_mechanism(&mechanism, TILT_MAX).map(|_| ())
}

#[test]
fn other_mechanisms_are_not_three_rod_robots() {
    use NotThreeRods as N;
    let inclined = changed(|joints| {
        let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), 1e-3);
        for frame in &mut joints[1].frames {
            frame.rotation = turned;
        }
    });
    assert!(
        matches!(&inclined, Err(N::NotParallel { joint, angle }) if joint == "rod 2" && (angle - 1e-3).abs() < 1e-12),
        "{inclined:?}"
    );
    let perpendicular = changed(|joints| {
        let turned = Rotation3::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
        joints[2].frames.iter_mut().for_each(|frame| frame.rotation = turned);
    });
    assert!(matches!(perpendicular, Err(N::NotParallel { .. })), "{perpendicular:?}");
    let kind = changed(|joints| joints[4].kind = JointKind::Universal);
    assert_eq!(kind, Err(N::Joints { prismatic: 3, spherical: 2, other: 1 }));
    let links = changed(|joints| joints[3].links = [1, 2]);
    assert!(matches!(links, Err(N::Links { .. })), "{links:?}");
    assert_eq!(
        changed(|joints| joints[1].limits.clear()),
        Err(N::NoLimits { joint: "rod 2".to_owned() })
    );
    let unequal = changed(|joints| joints[2].limits = vec![[-0.2, 0.254]]);
    assert!(matches!(unequal, Err(N::UnequalLimits { .. })), "{unequal:?}");
    let ball = changed(|joints| joints[3].limits = vec![[-0.1, 0.1]; 3]);
    assert_eq!(ball, Err(N::BallLimits { joint: "S1".to_owned() }));
    let clearance = changed(|joints| joints[5].clearance.linear = Some(1e-5));
    assert_eq!(clearance, Err(N::UnequalClearances { joint: "S3".to_owned() }));
    let one_line = changed(|joints| joints[5].frames[1] = joints[4].frames[1]);
    assert!(matches!(one_line, Err(N::Dimensions(_))), "{one_line:?}");
    assert_eq!(changed(|_| ()), Ok(()));
}

/// A platform whose frame is at a ball has no radius there: the centroid is the middle.
#[test]
fn a_platform_frame_in_a_socket_is_moved_to_the_centroid() {
    let gpr = Gpr::paper();
    let mut frames = [Pose::identity(); 5];
    frames[4].translation = Translation3::from(-gpr.platform().sockets()[1].push(0.0));
    let mechanism = described_otherwise(&gpr.to_mechanism("m"), &frames, 0);
    let found = Gpr::from_mechanism(&mechanism, TILT_MAX).unwrap();
    for radius in found.gpr.platform().radii() {
        assert!((radius - 0.093_218).abs() < 1e-15, "{radius}");
    }
}
