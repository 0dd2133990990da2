//! Joints that are neither commanded nor determined by the commands: they move least.

use crate::robot;
use std::ops::ControlFlow;

use jointplay_core::constraint::System as _;
use jointplay_core::mechanism::{
    CommandedJoints, Drive, DrivePath, Mechanism, MechanismSystem, Relief, ReliefSolver,
    SuggestOptions, assemble, drive_relieved, relieve, suggest,
};
use jointplay_core::mobility::{near_mobility, near_tolerances};
use jointplay_core::nalgebra::{DVector, Rotation3, Vector3};

use robot::{RADIUS, gpr, home, legs, planar, radial};

/// Coordinates of a robot: rods 0, 4, 8, and the first ball from 1 on.
const RODS: [usize; 3] = [0, 4, 8];

fn relieved(mechanism: &Mechanism, coordinates: &[usize], values: &[f64]) -> Relief {
    let at_home = MechanismSystem::new(mechanism, home(mechanism)).unwrap();
    let commanded = CommandedJoints::new(&at_home, coordinates).unwrap();
    let start = commanded.start(values.iter().copied(), mechanism.virtual_joints().len());
    let system = MechanismSystem::new(mechanism, start).unwrap();
    relieve(&system, &commanded, ReliefSolver::LeastNorm).unwrap()
}

/// Of a ball that is commanded in part, the sensitivity is that to its rotation vector: differences of displacements, at any tilt.
#[test]
fn the_sensitivity_to_a_ball_is_that_to_its_rotation_vector() {
    let mechanism = gpr(radial);
    let step = 1e-4;
    for [x, y] in [[0.0, 0.01], [0.14, 0.17], [-0.3, 0.2]] {
        let at = |x: f64, y: f64| relieved(&mechanism, &[1, 2], &[x, y]);
        let here = at(x, y);
        let found = here.sensitivity(&mechanism, &[1, 2]).unwrap();
        let pairs = [[at(x - step, y), at(x + step, y)], [at(x, y - step), at(x, y + step)]];
        for (k, [before, after]) in pairs.iter().enumerate() {
            let change = (&after.virtual_joints - &before.virtual_joints) / (2.0 * step);
            let expected = change / here.characteristic_length;
            let off = (found.matrix.column(k) - expected).norm();
            assert!(off < 1e-7, "{x} {y} {k}: {off:e}");
        }
    }
}

/// A tilt commanded by a ball joint leaves the heave free: rods go ±R sin α about where they were, and not metres away.
#[test]
fn a_tilt_commanded_by_a_ball_joint_takes_the_least_motion() {
    let mechanism = gpr(radial);
    for degrees in [1e-3, 0.1, 0.5, 1.0, 2.0, 5.0] {
        for (x, y) in [(0.0, 1.0), (1.0, 0.0), (-0.6, 0.8)] {
            let tilt_angle = f64::to_radians(degrees);
            let found = relieved(&mechanism, &[1, 2], &[x * tilt_angle, y * tilt_angle]);
            let context = format!("{degrees} {x} {y}: {}", found.coordinates);
            let rods = RODS.map(|k| found.coordinates[k]);
            // The ball's turn against a rod that does not turn is the platform's.
            let turn = Rotation3::new(found.coordinates.fixed_rows::<3>(1).into_owned());
            let normal = turn * Vector3::z();
            let balls = [0.0, 120.0, 240.0].map(|degrees: f64| {
                let angle = degrees.to_radians();
                RADIUS * Vector3::new(angle.cos(), angle.sin(), 0.0)
            });
            // A common heave breaks nothing, so that the rods are nearest home where their mean is.
            let heights = balls.map(|ball| -(normal.x * ball.x + normal.y * ball.y) / normal.z);
            for k in 0..3 {
                assert!((rods[k] - heights[k]).abs() < 1e-9, "{context}");
            }
            // The virtual joints by the Fermat point of the triangle of balls.
            let points = [0, 1, 2].map(|k| balls[k] + Vector3::z() * heights[k]);
            let sides = [[0, 1], [1, 2], [2, 0]].map(|[a, b]| (points[a] - points[b]).norm());
            let area = (points[1] - points[0]).cross(&(points[2] - points[0])).norm() / 2.0;
            let squares = sides.map(|side| side * side);
            let sum = (squares.iter().sum::<f64>() / 2.0 + 2.0 * 3.0_f64.sqrt() * area).sqrt();
            let (d13, d21) = ((squares[0] - squares[1]) / sum, (squares[1] - squares[2]) / sum);
            // l1 − l3 = d13, l2 − l1 = d21, l1 + l2 + l3 = sum.
            let first = (sum + d13 - d21) / 3.0;
            let radii = [first, first + d21, first - d13];
            for (k, radius) in radii.into_iter().enumerate() {
                let off = found.virtual_joints[k] - (radius - RADIUS);
                assert!(off.abs() < 1e-10, "{context} {off:e}");
            }
        }
    }
}

/// No small motion of the joints that are free lessens their distance from home.
#[test]
fn nothing_nearer_home_closes_the_loops() {
    let mechanism = gpr(planar);
    let found = relieved(&mechanism, &[1, 2], &[0.01, -0.02]);
    let system = MechanismSystem::new(&mechanism, found.coordinates.clone()).unwrap();
    let distance = |at: &DVector<f64>| RODS.iter().map(|&k| at[k] * at[k]).sum::<f64>().sqrt();
    for heave in [-1e-2, -1e-4, -1e-6, 1e-6, 1e-4, 1e-2] {
        let mut at = found.coordinates.clone();
        RODS.iter().for_each(|&k| at[k] += heave);
        let there = system.with_home(at.clone()).unwrap();
        assert!(there.mismatch(&there.at_home()) < 1e-12);
        assert!(distance(&at) > distance(&found.coordinates), "{heave}");
    }
}

/// The same command with a rod held, or by rods, asks for the same play.
#[test]
fn suggestions_for_a_ball_joint_are_those_for_its_tilt() {
    let bare = gpr(|_, _| Vec::new());
    let tilt_angle = 1.0_f64.to_radians();
    let by_ball = suggest(
        &bare,
        &home(&bare),
        &[1, 2],
        &[DVector::from_vec(vec![0.0, tilt_angle])],
        &SuggestOptions::default(),
    )
    .unwrap();
    let held = suggest(
        &bare,
        &home(&bare),
        &[1, 2, 0],
        &[DVector::from_vec(vec![0.0, tilt_angle, 0.0])],
        &SuggestOptions::default(),
    )
    .unwrap();
    // The play of the textbook: one ball has to go by 3/2 R (1 − cos α), about.
    let expected = 1.5 * RADIUS * (1.0 - tilt_angle.cos());
    for found in [&by_ball, &held] {
        let best = &found.sets[0];
        assert!((best.size / expected - 1.0).abs() < 0.01, "{} {expected}", best.size);
        for configuration in best.configurations.iter() {
            assert!(RODS.iter().all(|&k| configuration[k].abs() < 2.1 * RADIUS * tilt_angle));
        }
    }
    assert!((by_ball.sets[0].size / held.sets[0].size - 1.0).abs() < 1e-3);
}

/// A path by a ball joint stays near home throughout.
#[test]
fn driving_a_ball_joint_stays_near_home() {
    let mechanism = gpr(radial);
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let tilt_angle = 1.0_f64.to_radians();
    let free: Vec<usize> = (0..12).filter(|&k| k != 2).collect();
    let drives = [Drive { coordinate: 2, to: tilt_angle }];
    let path = DrivePath::line(system.home(), &drives).unwrap();
    let motion =
        drive_relieved(&system, &system, &path, &free, 5, &mut |_| ControlFlow::Continue(()))
            .unwrap();
    assert_eq!((motion.stopped, motion.waypoints.len()), (None, 6));
    for point in &motion.waypoints {
        assert!(RODS.iter().all(|&k| point.coordinates[k].abs() < 1.1 * RADIUS * tilt_angle));
    }
}

fn triangle() -> Vec<[f64; 2]> {
    [0.0_f64, 120.0, 240.0]
        .map(|a| [0.1 * a.to_radians().cos(), 0.1 * a.to_radians().sin()])
        .to_vec()
}

/// A tilt of a ten-thousandth of a degree closes to round-off next to level, and does not drift along the heave.
#[test]
fn closing_to_round_off_does_not_drift() {
    let points = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]];
    let mechanism = legs(&points, 0.0);
    let mut start = home(&mechanism);
    start[4] = 1e-4_f64.to_radians();
    let closed = assemble(&mechanism, &start, &[4], 0).unwrap();
    for k in 0..4 {
        assert!(closed.coordinates[k].abs() < 1e-6, "{}", closed.coordinates);
    }
}

/// Three legs with equal tilt: a heave misses by 0.3 sin(tilt) at most, tilts by far more, for any tilt and for nearly equal singular values.
#[test]
fn motions_next_to_clusters_of_singular_values_are_found() {
    let mut before = 0.0;
    for exponent in -9..=0 {
        let degrees = 10.0_f64.powi(exponent);
        let tilt = degrees.to_radians();
        let mechanism = legs(&triangle(), tilt);
        let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
        let at = system.at_home();
        let all = near_tolerances(&system, &at).unwrap();
        // A heave h of every leg moves every ball out by h sin(tilt), which the loops miss by.
        let least = 0.3 / 3.0_f64.sqrt() * tilt.sin();
        let share = all[0] / least;
        assert!((0.3..3.5).contains(&share), "{degrees}: {all:?}, {least:e}");
        assert!(all[0] > before, "{degrees}: {all:?} after {before:e}");
        before = all[0];
        // Tilts by θ, of which 0.3 in all coordinates make about 0.14, miss by the order of 1 − cos θ.
        assert!(all.get(1).is_none_or(|&second| second > 2e-3), "{degrees}: {all:?}");
        for tolerance in [1e-10, 1e-8, 1e-6, 1e-4, 1e-3] {
            let found = near_mobility(&system, &at, tolerance).unwrap();
            assert_eq!(found.mobility, usize::from(tolerance >= all[0]), "{degrees} {tolerance}");
        }
    }
}

/// Sets are symmetric only where a symmetry of the mechanism maps them onto themselves: whichever corner is named, the same is in the set.
#[test]
fn symmetric_sets_have_the_same_at_every_joint() {
    let tilt = |points: &[[f64; 2]]| -> Vec<DVector<f64>> {
        let along = |n: [f64; 2]| points.iter().map(move |p| 0.01 * (n[0] * p[0] + n[1] * p[1]));
        [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            .map(|n| DVector::from_iterator(points.len(), along(n)))
            .to_vec()
    };
    for (points, alike) in
        [(triangle(), true), (vec![[0.1, 0.0], [-0.04, 0.07], [-0.07, -0.05]], false)]
    {
        let mechanism = legs(&points, 0.0);
        let found = suggest(
            &mechanism,
            &home(&mechanism),
            &[0, 1, 2],
            &tilt(&points),
            &SuggestOptions::default(),
        )
        .unwrap();
        assert!(!found.sets.is_empty());
        let mut symmetric = 0;
        for set in &found.sets {
            // Count of each motion, without the numbers of the joints.
            let mut counts = std::collections::BTreeMap::new();
            for one in &set.virtual_joints {
                let words: String = one.name.chars().filter(|c| !c.is_ascii_digit()).collect();
                *counts.entry(words).or_insert(0) += 1;
            }
            let same_everywhere = counts.values().all(|&count| count == 3);
            assert_eq!(set.symmetric, alike && same_everywhere, "{counts:?}");
            symmetric += usize::from(set.symmetric);
        }
        assert_eq!(symmetric > 0, alike);
    }
}

/// Table on four vertical legs, tilted by 1° about x: each ball is displaced along y by d (1/cos 1° − 1)/2, and no set needs less.
#[test]
fn a_table_on_four_legs_needs_the_symmetric_slides() {
    let [width, depth] = [0.2, 0.3];
    let points = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
        .map(|[x, y]: [f64; 2]| [x * width / 2.0, y * depth / 2.0]);
    let mechanism = legs(&points, 0.0);
    let tilt_angle = 1.0_f64.to_radians();
    let shift = |size: f64| size / 2.0 * (1.0 / tilt_angle.cos() - 1.0);
    for (axis, size, expected) in [([0.0, 1.0], depth, 45.698e-6), ([1.0, 0.0], width, 30.466e-6)] {
        let rods = points.map(|p| tilt_angle.tan() * (axis[0] * p[0] + axis[1] * p[1]));
        let command = DVector::from_row_slice(&rods);
        let options = SuggestOptions::default();
        let found =
            suggest(&mechanism, &home(&mechanism), &[0, 1, 2, 3], &[command], &options).unwrap();
        let best = &found.sets[0];
        assert!(
            (best.size - expected).abs() < 2e-9,
            "{axis:?} {} {:?}",
            best.size,
            found.lower_bound
        );
        // Along the principal directions four slides do; along the radial and tangential ones eight, by the same amount.
        assert!(best.symmetric && best.virtual_joints.len() == 4, "{best:?}");
        assert!((best.size - 2.0 * shift(size)).abs() < 1e-9);
        let eight = found.sets.iter().find(|set| set.symmetric && set.virtual_joints.len() == 8);
        assert!((eight.unwrap().size / best.size - 1.0).abs() < 1e-6);
        assert!((found.lower_bound - expected).abs() < 2e-8, "{}", found.lower_bound);
        for set in &found.sets {
            assert!(set.size > found.lower_bound * (1.0 - 1e-3), "{set:?}");
        }
        // A slide of the base at the same leg does the same.
        assert!(best.alternatives.iter().all(|others| others.len() == 1));
    }
}
