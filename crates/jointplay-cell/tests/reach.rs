//! The range of distances that effectors reach, against many positions of their motors.
#![expect(clippy::unwrap_used, reason = "a failing test may panic")]

#[expect(dead_code, reason = "robots are enough here")]
mod common;

use common::{KINDS, kind};
use jointplay_cell::robot::{EffectorId, RODS};

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
