//! The range of distances that effectors reach, against many positions of their motors.

use crate::common;

use common::{KINDS, kind};
use jointplay_cell::robot::{EffectorId, RODS};
use jointplay_core::spatial::Pose;

/// Evenly distributed numbers from 0 to 1, the same in each run.
fn spread(index: usize, base: usize) -> f64 {
    let (mut rest, mut fraction, mut value) = (index, 1.0, 0.0);
    while rest > 0 {
        fraction /= base as f64;
        value += fraction * (rest % base) as f64;
        rest /= base;
    }
    value
}

#[test]
fn reach_range_is_a_tight_bound() {
    const BASES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
    for number in 0..KINDS {
        let robot = kind(number, [0.2, 0.22, 0.15]);
        let id = EffectorId { arm: 0, effector: 0 };
        let [least, most] = robot.reach_range(id).unwrap();
        let (mut nearest, mut farthest) = (f64::MAX, 0.0_f64);
        for index in 0..20_000 {
            let positions: Vec<f64> = robot
                .axes
                .iter()
                .enumerate()
                .map(|(k, axis)| match k.checked_sub(RODS) {
                    Some(motor) => axis.min + spread(index, BASES[motor]) * (axis.max - axis.min),
                    None => axis.home,
                })
                .collect();
            let center = robot.effector_pose(&positions, id).unwrap().translation.vector;
            let distance = center.x.hypot(center.y);
            nearest = nearest.min(distance);
            farthest = farthest.max(distance);
        }
        assert!(
            least <= nearest + 1e-9 && farthest <= most + 1e-9,
            "{number}: {least} {nearest} {farthest} {most}"
        );
        assert!(
            nearest - least < 0.02 && most - farthest < 0.02,
            "{number}: {least} {nearest} {farthest} {most}"
        );
    }
}

#[test]
fn retract_distances_are_measured_from_the_first_joint_of_the_arm() {
    let mut robot = kind(0, [0.2, 0.22, 0.15]);
    let mut station = common::station("port", Pose::translation(0.7, 0.0, 0.5));
    // The arm is mounted 0.3 m in front of the base axis, then behind it.
    for (x, distance) in [(0.3, 0.4), (-0.3, 1.0), (0.0, 0.7)] {
        robot.arms[0].mount = [x, 0.0, 0.06];
        for (retract_reach, is_less) in [(distance - 1e-6, true), (distance + 1e-6, false)] {
            station.retract_reach = retract_reach;
            let checked = station.check_retract_reach(&robot);
            assert_eq!(checked.is_ok(), is_less, "{x} {retract_reach}: {checked:?}");
        }
    }
}
