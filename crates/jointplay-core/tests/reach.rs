//! The reachable configuration nearest a wanted position of a point: closed forms, scans of coupler curves, limits, and laws of random rings.

use crate::planar;

use jointplay_core::Error;
use jointplay_core::mechanism::{
    Carrier, Joint, JointKind, Kinematics, Mechanism, MechanismSystem, PointTarget, VirtualJoint,
    VirtualMotion, reach_point,
};
use jointplay_core::nalgebra::{DVector, Rotation3, Translation3, Unit, Vector3};
use jointplay_core::spatial::Pose;
use planar::{closed_form, four_bar, hinge, joint};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;

const TURN: f64 = std::f64::consts::TAU;
const LENGTHS: [f64; 4] = [1.0, 0.4, 0.9, 0.7];

/// A point of the coupler for a crank angle, in closed form.
fn coupler_point(theta: f64, [u, v]: [f64; 2]) -> [f64; 2] {
    let [_, phi, ..] = closed_form(LENGTHS, theta)[0];
    let (sine, cosine) = (theta + phi).sin_cos();
    let crank = LENGTHS[1];
    [crank * theta.cos() + u * cosine - v * sine, crank * theta.sin() + u * sine + v * cosine]
}

fn target(link: usize, point: [f64; 2], to: [f64; 2]) -> PointTarget {
    PointTarget {
        link,
        point_in_link: Vector3::new(point[0], point[1], 0.0),
        position_in_base: Vector3::new(to[0], to[1], 0.0),
    }
}

#[test]
fn the_coupler_of_a_four_bar_ends_where_its_curve_is_nearest() {
    let mechanism = four_bar(LENGTHS);
    let mut runner = TestRunner::deterministic();
    let drawn =
        (0.0..TURN, prop::array::uniform2(-1.0..1.0_f64), prop::array::uniform2(-2.0..2.0_f64));
    for _ in 0..60 {
        let (theta, point, to) = drawn.new_tree(&mut runner).unwrap().current();
        let start = DVector::from_row_slice(&closed_form(LENGTHS, theta)[0]);
        let found = reach_point(&mechanism, &start, &target(2, point, to)).unwrap();
        let distance = |theta: f64| {
            let [x, y] = coupler_point(theta, point);
            (x - to[0]).hypot(y - to[1])
        };
        // On the curve, on the branch of the start, nearer than the start, and at a minimum of the closed form.
        let theta_found = found.closed.coordinates[0];
        assert!(found.is_stationary && found.at_limits.is_empty(), "{found:?}");
        assert!((distance(theta_found) - found.distance).abs() < 1e-9, "{found:?}");
        assert!(found.distance <= distance(theta) + 1e-12);
        for by in [1e-3, 1e-4] {
            let least = distance(theta_found + by).min(distance(theta_found - by));
            assert!(found.distance <= least + 1e-12, "{theta} {point:?} {to:?} {found:?} {least}");
        }
    }
}

#[test]
fn points_of_the_curve_are_reached_past_dead_points() {
    // A rocker mechanism, whose crank has dead points: dragged by the coupler, it passes them.
    let lengths = [1.0, 0.8, 0.5, 0.9];
    let mechanism = four_bar(lengths);
    let start = DVector::from_row_slice(&closed_form(lengths, 0.5)[0]);
    // The other closed configuration at the same crank angle, by small steps of the point between them.
    let joint_of = |q: &[f64]| {
        let (a, b) = (q[0], q[0] + q[1]);
        [0.8 * a.cos() + 0.5 * b.cos(), 0.8 * a.sin() + 0.5 * b.sin()]
    };
    let to = joint_of(&closed_form(lengths, 0.5)[1]);
    let mut here = start;
    let from = joint_of(here.as_slice());
    for step in 1..=40 {
        let share = f64::from(step) / 40.0;
        // Along the circle of the rocker about D.
        let angle = |[x, y]: [f64; 2]| y.atan2(x - 1.0);
        let arc = (angle(to) - angle(from) + TURN).rem_euclid(TURN);
        let arc = if arc > TURN / 2.0 { arc - TURN } else { arc };
        let at = angle(from) + share * arc;
        let found = reach_point(
            &mechanism,
            &here,
            &target(3, [0.9, 0.0], [1.0 + 0.9 * at.cos(), 0.9 * at.sin()]),
        )
        .unwrap();
        here = found.closed.coordinates;
    }
    let [x, y] = joint_of(here.as_slice());
    assert!((x - to[0]).hypot(y - to[1]) < 1e-9, "{here}");
}

/// A slider crank: crank 0.4, rod 1.2, the slider along x, with a limit of the crank.
fn slider_crank(limits: [f64; 2]) -> Mechanism {
    let mut slide = joint("D", JointKind::Prismatic, [0, 3], [Pose::identity(); 2]);
    let along = Rotation3::rotation_between(&Vector3::z(), &Vector3::x()).unwrap();
    slide.frames = [Pose::from_parts(Translation3::identity(), along); 2];
    let joints = vec![
        Joint { limits: vec![limits], ..hinge("A", [0, 1], [0.0, 0.0]) },
        hinge("B", [1, 2], [0.4, 0.0]),
        hinge("C", [2, 3], [1.2, 0.0]),
        slide,
    ];
    let links = ["ground", "crank", "rod", "slider"].map(str::to_owned).to_vec();
    Mechanism::new("slider crank", links, joints).unwrap().with_characteristic_length(1.0).unwrap()
}

/// The closed configuration at a crank angle.
fn at_crank(theta: f64) -> DVector<f64> {
    let rod = (-0.4 * theta.sin() / 1.2).asin();
    DVector::from_row_slice(&[theta, rod - theta, -rod, 0.4 * theta.cos() + 1.2 * rod.cos()])
}

#[test]
fn a_crank_points_at_distant_positions_unless_its_limit_holds_it() {
    let free = slider_crank([-9.0, 9.0]);
    let bounded = slider_crank([-0.7, 0.7]);
    for radius in [0.05, 0.3, 0.4, 0.41, 3.0, 100.0] {
        for angle in [-2.5_f64, -0.6, 0.1, 0.69, 1.4] {
            let to = [radius * angle.cos(), radius * angle.sin()];
            let tip = target(1, [0.4, 0.0], to);
            let found = reach_point(&free, &at_crank(0.2), &tip).unwrap();
            // The nearest point of the circle.
            assert!(
                (found.closed.coordinates[0] - angle).abs() < 1e-6,
                "{radius} {angle} {found:?}"
            );
            assert!((found.distance - (radius - 0.4_f64).abs()).abs() < 1e-9, "{found:?}");
            assert!((found.closed.coordinates - at_crank(angle)).amax() < 1e-6);
            let found = reach_point(&bounded, &at_crank(0.2), &tip).unwrap();
            let clamped = angle.clamp(-0.7, 0.7);
            assert!(
                (found.closed.coordinates[0] - clamped).abs() < 1e-6,
                "{radius} {angle} {found:?}"
            );
            assert!(bounded.beyond_limits(&found.closed.coordinates).is_empty());
            assert_eq!(
                found.at_limits,
                if angle.abs() > 0.7 { vec![0] } else { vec![] },
                "{angle}"
            );
            assert!(found.is_stationary);
        }
    }
    // A coordinate that begins beyond its limits comes back, and does not get farther beyond.
    let outside = at_crank(1.0);
    let outward = target(1, [0.4, 0.0], [0.0, 1.0]);
    let found = reach_point(&bounded, &outside, &outward).unwrap();
    assert_eq!((found.closed.coordinates[0], found.at_limits.as_slice()), (1.0, [0].as_slice()));
    let inward = target(1, [0.4, 0.0], [1.0, 0.0]);
    let found = reach_point(&bounded, &outside, &inward).unwrap();
    assert!(found.closed.coordinates[0].abs() < 1e-6, "{found:?}");
}

#[test]
fn the_limit_of_a_passive_joint_holds_the_point_and_is_left_again() {
    // The slider may not pass 1.4; the crank angle there by the law of cosines.
    let mut mechanism = slider_crank([-9.0, 9.0]);
    let mut joints = mechanism.joints().to_vec();
    joints[3].limits = vec![[0.0, 1.4]];
    mechanism = mechanism.with_joints(joints).unwrap();
    let most = ((0.4_f64.powi(2) + 1.4 * 1.4 - 1.2 * 1.2) / (2.0 * 0.4 * 1.4)).acos();
    let tip = target(1, [0.4, 0.0], [1.0, 0.0]);
    let found = reach_point(&mechanism, &at_crank(1.5), &tip).unwrap();
    assert!((found.closed.coordinates[0] - most).abs() < 1e-7, "{found:?} {most}");
    assert_eq!(found.at_limits, [3]);
    let back = target(1, [0.4, 0.0], [-1.0, 0.1]);
    let found = reach_point(&mechanism, &found.closed.coordinates, &back).unwrap();
    assert!(found.at_limits.is_empty() && found.closed.coordinates[0] > 2.9, "{found:?}");
}

#[test]
fn actuators_with_virtual_joints_reach_points_by_the_least_displacement() {
    // Two sliders that carry one bar: at different heights the bar is longer, which a virtual slide allows.
    let vertical = |x: f64| {
        Pose::from_parts(
            Translation3::new(x, 0.0, 0.0),
            Rotation3::from_axis_angle(&Vector3::x_axis(), -TURN / 4.0),
        )
    };
    let slide = |name: &str, link: usize, x: f64| Joint {
        actuated: true,
        limits: vec![[-0.3, 0.3]],
        ..joint(name, JointKind::Prismatic, [0, link], [vertical(x), vertical(0.0)])
    };
    let joints = vec![
        slide("left", 1, 0.0),
        slide("right", 2, 1.0),
        hinge("L", [1, 3], [0.0, 0.0]),
        hinge("R", [2, 3], [0.0, 1.0]),
    ];
    let links = ["base", "a", "b", "bar"].map(str::to_owned).to_vec();
    let play = VirtualJoint {
        name: "play".to_owned(),
        joint: 3,
        carrier: Carrier::First,
        motion: VirtualMotion::Slide(Unit::new_unchecked(Vector3::x())),
        stiffness: None,
        clearance: None,
    };
    let mechanism =
        Mechanism::new("lift", links, joints).unwrap().with_virtual_joints(vec![play]).unwrap();
    let start = DVector::zeros(mechanism.joint_freedoms() + 1);
    // The end of the bar to a height: one equation for two sliders, the other is that of its middle.
    let to = Vector3::new(1.0, 0.2, 0.0);
    let wanted = PointTarget { link: 3, point_in_link: Vector3::x(), position_in_base: to };
    let found = reach_point(&mechanism, &start, &wanted).unwrap();
    assert!(found.distance < 1e-6 && found.is_stationary, "{found:?}");
    let system = MechanismSystem::new(&mechanism, found.closed.coordinates.clone()).unwrap();
    assert!(system.is_closed());
    // Beyond the reach, the limits of the sliders hold the bar.
    let wanted = PointTarget { position_in_base: Vector3::new(1.0, 2.0, 0.0), ..wanted };
    let found = reach_point(&mechanism, &start, &wanted).unwrap();
    assert!((found.closed.coordinates[1] - 0.3).abs() < 1e-9, "{found:?}");
    assert!(found.at_limits.contains(&1), "{found:?}");
}

#[test]
fn random_rings_stay_closed_and_within_limits_and_get_nearer() {
    let mut runner = TestRunner::deterministic();
    let wanted =
        (1..6_usize, prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-2.0..2.0_f64));
    let (mut moved, count) = (0, 40);
    for _ in 0..count {
        let joints = planar::rings().new_tree(&mut runner).unwrap().current();
        let names = (0..6).map(|k| format!("l{k}")).collect();
        let mechanism = Mechanism::new("rings", names, joints).unwrap();
        let (link, point, to) = wanted.new_tree(&mut runner).unwrap().current();
        let start = DVector::zeros(mechanism.joint_freedoms());
        let position = |q: &DVector<f64>| {
            let pose = Kinematics::new(&mechanism).link_poses(q).unwrap()[link];
            pose.rotation * Vector3::from(point) + pose.translation.vector
        };
        let target = PointTarget {
            link,
            point_in_link: Vector3::from(point),
            position_in_base: position(&start) + Vector3::from(to) * 0.3,
        };
        let found = reach_point(&mechanism, &start, &target).unwrap();
        let q = &found.closed.coordinates;
        let system = MechanismSystem::new(&mechanism, q.clone()).unwrap();
        assert!(system.is_closed() && mechanism.beyond_limits(q).is_empty(), "{q}");
        let off = |at: Vector3<f64>| (at - target.position_in_base).norm();
        assert!((off(position(q)) - found.distance).abs() < 1e-9);
        assert!(found.distance <= off(position(&start)) + 1e-12);
        moved += i32::from(found.distance < off(position(&start)) - 1e-6);
        assert!(found.is_stationary || found.steps > 0, "{found:?}");
    }
    assert!(moved > count / 2, "{moved}");
}

#[test]
fn bad_input_is_an_error() {
    let mechanism = four_bar(LENGTHS);
    let start = DVector::from_row_slice(&closed_form(LENGTHS, 1.0)[0]);
    let good = target(2, [0.0, 0.0], [1.0, 1.0]);
    let unknown = reach_point(&mechanism, &start, &PointTarget { link: 4, ..good });
    assert!(matches!(unknown, Err(Error::NoSuchQuantity { index: 4, count: 4, .. })));
    for value in [f64::NAN, f64::INFINITY] {
        let bad = target(2, [value, 0.0], [1.0, 1.0]);
        assert!(matches!(reach_point(&mechanism, &start, &bad), Err(Error::NotFinite { .. })));
    }
    assert!(matches!(reach_point(&mechanism, &(start * 1.1), &good), Err(Error::NotClosed { .. })));
    let few = DVector::zeros(3);
    assert!(matches!(reach_point(&mechanism, &few, &good), Err(Error::LengthMismatch { .. })));
    // The base does not move.
    let start = DVector::from_row_slice(&closed_form(LENGTHS, 1.0)[0]);
    let found = reach_point(&mechanism, &start, &target(0, [0.0, 0.0], [3.0, 4.0])).unwrap();
    assert_eq!((found.closed.coordinates, found.distance), (start, 5.0));
}
