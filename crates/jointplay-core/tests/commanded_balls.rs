//! Balls with commanded coordinates: their rotation vectors have the values of the commands, all or some of them.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use crate::robot::{joint, names};

use jointplay_core::Error;
use jointplay_core::mechanism::{
    DrivePath, JointKind, Mechanism, MechanismSystem, SparseSystem, assemble, drive_from, guess,
};
use jointplay_core::nalgebra::{DVector, Rotation3, Vector3};
use proptest::prelude::*;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A ball and a body that floats behind it.
fn tree() -> Mechanism {
    let joints = vec![
        joint("ball", JointKind::Spherical, [0, 1], [0.1, 0.2, -0.3], Z),
        joint("body", JointKind::Floating, [1, 2], [0.4, -0.1, 0.2], Z),
    ];
    Mechanism::new("tree", names(3), joints).unwrap()
}

/// A platform on a ball at the base, held by a rod between two balls: a loop with five motions.
fn held_platform() -> Mechanism {
    let joints = vec![
        joint("pivot", JointKind::Spherical, [0, 1], [0.0, 0.0, 0.0], Z),
        joint("upper", JointKind::Spherical, [1, 2], [0.1, 0.0, 0.0], Z),
        joint("foot", JointKind::Cylindrical, [2, 3], [0.1, 0.0, 0.0], [0.0, 0.6, 0.8]),
        joint("hinge", JointKind::Spherical, [3, 0], [0.1, 0.06, 0.08], X),
    ];
    Mechanism::new("held platform", names(4), joints).unwrap()
}

/// Coordinates where the motion ends, of one step or of many; all waypoints have the values of the path.
fn end(mechanism: &Mechanism, path: &DrivePath, count: usize) -> DVector<f64> {
    let start = guess(mechanism);
    let motion =
        drive_from(mechanism, &start, path, &[], count, None, &mut |_| ControlFlow::Continue(()))
            .unwrap();
    assert_eq!(motion.stopped, None);
    check(&motion.waypoints, path)
}

fn check(waypoints: &[jointplay_core::mechanism::Waypoint], path: &DrivePath) -> DVector<f64> {
    for waypoint in waypoints {
        assert!(waypoint.residual < 1e-9, "{}", waypoint.residual);
        for (k, value) in path.values_at(waypoint.share) {
            let off = waypoint.coordinates[k] - value;
            assert!(off.abs() < 1e-13, "{k} at {}: {off:e}", waypoint.share);
        }
    }
    waypoints.last().unwrap().coordinates.clone()
}

fn points(coordinates: usize, largest: f64) -> impl Strategy<Value = Vec<Vec<f64>>> {
    let point = prop::collection::vec(-largest..largest, coordinates);
    prop::collection::vec(point, 1..4)
        .prop_map(move |points| std::iter::once(vec![0.0; coordinates]).chain(points).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn balls_that_are_driven_have_the_values_of_the_path(through in points(9, 2.0), steps in 1..4_usize) {
        let mechanism = tree();
        let path = DrivePath::through((0..9).collect(), through).unwrap();
        end(&mechanism, &path, steps * path.segments());
    }

    #[test]
    fn coordinates_of_balls_in_loops_have_the_values_of_the_path(
        through in points(3, 0.3), commanded in 0..7_usize,
    ) {
        let mechanism = held_platform();
        let driven: Vec<usize> = (0..3).filter(|k| (commanded + 1) & (1 << k) != 0).collect();
        let values = through.iter().map(|point| driven.iter().map(|&k| point[k]).collect());
        let path = DrivePath::through(driven.clone(), values.collect()).unwrap();
        end(&mechanism, &path, path.segments());

        // By sparse algebra, and at once.
        let system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
        let motion = system.drive_along(&path, &[], path.segments(), &mut |_| ControlFlow::Continue(())).unwrap();
        prop_assert_eq!(motion.stopped, None);
        check(&motion.waypoints, &path);
        let mut start = guess(&mechanism);
        path.values_at(1.0).for_each(|(k, value)| start[k] = value);
        let assembled = assemble(&mechanism, &start, &driven, 0).unwrap().coordinates;
        for (k, value) in path.values_at(1.0) {
            prop_assert_eq!(assembled[k], value);
        }
        let closed = MechanismSystem::new(&mechanism, assembled).unwrap();
        prop_assert!(closed.is_closed());
    }
}

#[test]
fn balls_turn_beyond_a_half_turn() {
    let mechanism = tree();
    for angle in [190.0_f64.to_radians(), -4.0 * PI + 0.5] {
        let path =
            DrivePath::through(vec![0, 1, 2], vec![vec![0.0; 3], vec![angle, 0.0, 0.0]]).unwrap();
        let reached = end(&mechanism, &path, 60);
        assert_eq!(reached[0], angle);
        let system = MechanismSystem::new(&mechanism, reached.clone()).unwrap();
        let pose = system.kinematics().link_poses(&reached).unwrap()[1];
        let expected = Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
        assert!((pose.rotation.matrix() - expected.matrix()).norm() < 1e-13);
    }
}

#[test]
fn a_motion_ends_where_the_caller_ends_it() {
    let mechanism = tree();
    let path = DrivePath::through(vec![0, 1, 2], vec![vec![0.0; 3], vec![1e6, 0.0, 0.0]]).unwrap();
    let mut asked = 0;
    let mut progress = |_| {
        asked += 1;
        if asked > 100 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let start = guess(&mechanism);
    let ended = drive_from(&mechanism, &start, &path, &[], 1, None, &mut progress);
    assert_eq!(ended, Err(Error::Interrupted));
}
