//! Steps that differ by a common height of all rods: one motion, as if each were planned alone.

use jointplay_cell::program::{Path, Phase, Step};
use jointplay_cell::robot::{RODS, WaferTarget};
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::wafer::Droop;
use jointplay_cell::workcell::{Cell, Zone, ZoneRule};
use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::spatial::{Pose, Tilt};
use nalgebra::Vector3;
use proptest::prelude::*;

use crate::common::{self, A};
use jointplay_cell::geometry::{AxisAlignedBox, Shape};

/// Positions with twelve decimals, as programs have them.
fn positions(cell: &Cell, tilt: Tilt, fraction: f64) -> Vec<f64> {
    let mut all = cell.robot.gpr.inverse(tilt, AxisHeight(0.45)).unwrap().to_vec();
    let motors = &cell.robot.axes[RODS..];
    all.extend(motors.iter().map(|axis| axis.min + fraction * (axis.max - axis.min)));
    rounded(&all)
}

fn rounded(positions: &[f64]) -> Vec<f64> {
    positions.iter().map(|position| (position * 1e12).round() / 1e12).collect()
}

/// Raised by whole micrometres.
fn raised(positions: &[f64], micrometres: i32) -> Vec<f64> {
    let height = f64::from(micrometres) * 1e-6;
    let rods = positions.iter().take(RODS).map(|rod| rod + height);
    rounded(&rods.chain(positions[RODS..].iter().copied()).collect::<Vec<f64>>())
}

fn step(from: &[f64], to: &[f64], path: Path, loaded: bool) -> Step {
    let loaded = if loaded { vec![A] } else { Vec::new() };
    Step { path, loaded, ..common::step(0, from, to) }
}

fn plan(cell: &Cell, steps: &[Step]) -> Trajectory {
    plan_trajectory(cell, steps.to_vec(), &TrajectoryOptions::default()).unwrap()
}

fn tilt() -> impl Strategy<Value = Tilt> {
    (-3.0..3.0, 0.0..0.02).prop_map(|(azimuth, angle)| Tilt { azimuth, angle })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn raised_steps_move_alike(
        kind in 0..common::KINDS,
        fractions in [0.2..0.8, 0.2..0.8],
        tilts in [tilt(), tilt()],
        displacement in [-0.06..0.06, -0.06..0.06, -0.02..0.02],
        micrometres in -150_000..200_000,
        droops: bool,
        loaded: bool,
    ) {
        let mut cell = common::cell(common::kind(kind, [0.25, 0.22, 0.2]));
        if droops {
            let droop = Droop::Cantilever { stiffness: 900.0, mass_per_length: 2.5 };
            cell.robot.arms.iter_mut().for_each(|arm| arm.droop = droop.clone());
        }
        let [a, b] = [0, 1].map(|k| positions(&cell, tilts[k], fractions[k]));
        let start = cell.wafer_pose(A, &b, loaded).unwrap().translation.vector;
        let target = WaferTarget {
            center: start + Vector3::from(displacement),
            normal: tilts[0].normal(),
            heading: None,
        };
        let reached = cell.compensated_inverse(A, &target, loaded, &b);
        prop_assume!(reached.is_ok());
        let c = rounded(&reached.unwrap().positions);
        let near = b.iter().zip(&c).all(|(a, b)| (a - b).abs() < 1.2);
        prop_assume!(near);
        let steps = |of: &dyn Fn(&[f64]) -> Vec<f64>| {
            let [a, b, c] = [&a, &b, &c].map(|positions| of(positions));
            [step(&a, &b, Path::PointToPoint, loaded), step(&b, &c, Path::Line(A), loaded)]
        };
        let low = steps(&<[f64]>::to_vec);
        let high = steps(&|positions| raised(positions, micrometres));
        // Not at multiples of the resolution: planned where it is.
        let off = steps(&|positions| positions.iter().map(|position| position + 3e-14).collect());
        let options = TrajectoryOptions::default();
        let found = plan_trajectory(&cell, low.to_vec(), &options);
        prop_assume!(found.is_ok());
        let (low, high, off) = (found.unwrap(), plan(&cell, &high), plan(&cell, &off));
        let height = f64::from(micrometres) * 1e-6;
        prop_assert_eq!(&low.times, &high.times);
        prop_assert_eq!(low.limiting_constraints(&cell), high.limiting_constraints(&cell));
        for (time, off) in low.times.iter().zip(&off.times) {
            // The margin of limits applies where one is exceeded, be it by round-off.
            prop_assert!((time - off).abs() <= 2e-3 * time, "{time} {off}");
        }
        for k in 0..=60 {
            let time = low.duration() * f64::from(k) / 60.0;
            let [low, high] = [&low, &high].map(|motion| motion.sample_at(time));
            for axis in 0..low.positions.len() {
                let lift = if axis < RODS { height } else { 0.0 };
                let error = high.positions[axis] - low.positions[axis] - lift;
                prop_assert!(error.abs() <= 2e-15, "{axis}: {error}");
            }
            prop_assert_eq!(low.velocities, high.velocities);
            prop_assert_eq!(low.accelerations, high.accelerations);
            prop_assert_eq!(low.jerks, high.jerks);
        }
        prop_assert_eq!(&high.sample_at(0.0).positions, &high.steps[0].from);
        // The line of the raised step is straight where it is.
        let wafer = |time: f64| {
            let positions = high.sample_at(time).positions;
            cell.wafer_pose(A, &positions, loaded).unwrap().translation.vector
        };
        let [start, end] = [high.times[1], high.times[2]];
        let along = (wafer(end) - wafer(start)).normalize();
        for k in 1..40 {
            let out = wafer(start + (end - start) * f64::from(k) / 40.0) - wafer(start);
            let distance = (out - along * out.dot(&along)).norm();
            prop_assert!(distance <= 1.3e-6, "{distance}");
        }
    }
}

/// A cell in which no wafer slips, and positions on either side of a corner, and at it in the middle.
fn corner() -> (Cell, [Vec<f64>; 3]) {
    let mut cell = common::cell(common::kind(0, [0.25, 0.22, 0.2]));
    cell.robot.arms[0].effectors[0].friction = 10.0;
    let a = positions(&cell, Tilt::LEVEL, 0.4);
    let (mut b, mut c) = (a.clone(), a.clone());
    b[3] += 0.8;
    (c[3], c[4]) = (b[3], a[4] + 0.5);
    let [b, c] = [rounded(&b), rounded(&c)];
    (cell, [a, b, c])
}

/// A safe zone has a height: blends of congruent steps at two heights are those of either one alone.
#[test]
fn blends_of_raised_steps_keep_safe_zones_where_they_are() {
    let (mut cell, [a, b, c]) = corner();
    let turn = |from: &[f64], to: &[f64]| Step {
        phase: Phase::Turn,
        blend_radius: 0.05,
        ..step(from, to, Path::PointToPoint, false)
    };
    let [a2, b2, c2] = [&a, &b, &c].map(|positions| raised(positions, 120_000));
    let corner = cell.wafer_pose(A, &b, false).unwrap().translation.vector;
    // The whole lower path is in a slab; of the upper one, the corner alone is in a small box.
    let slab = AxisAlignedBox { min: [-1.0, -1.0, -0.03], max: [1.0, 1.0, 0.03] };
    let small = AxisAlignedBox { min: [-0.01, -0.01, 0.11], max: [0.01, 0.01, 0.13] };
    cell.zones.push(Zone {
        name: "safe".into(),
        rule: ZoneRule::Safe,
        base_from_shape: Pose::from_parts(corner.into(), Default::default()),
        shape: Shape::Boxes { boxes: vec![slab, small] },
    });
    let [low, high] = [[&a, &b, &c], [&a2, &b2, &c2]].map(|[a, b, c]| [turn(a, b), turn(b, c)]);
    let between = step(&c, &a2, Path::PointToPoint, false);
    let alone = [plan(&cell, &low), plan(&cell, &high)];
    let both = [&low[..], &[between], &high[..]].concat();
    let both = plan(&cell, &both);
    assert_eq!(both.blend(0), alone[0].blend(0));
    assert_eq!(both.blend(3), alone[1].blend(0));
    assert!(alone[0].blend(0).is_some());
    assert_ne!(alone[0].blend(0), alone[1].blend(0));
}

/// Whether a safe zone applies to a step is an input of its blends.
#[test]
fn blends_of_equal_moves_in_and_outside_of_safe_zones_differ() {
    let (mut cell, [a, b, c]) = corner();
    let corner = cell.wafer_pose(A, &b, false).unwrap().translation.vector;
    // So small that a blend leaves it.
    cell.zones.push(Zone {
        name: "safe".into(),
        rule: ZoneRule::Safe,
        base_from_shape: Pose::from_parts((corner + Vector3::z()).into(), Default::default()),
        shape: Shape::Box { half: [0.01; 3] },
    });
    let moves = |phase: Phase| {
        let step = |from: &[f64], to: &[f64]| Step {
            phase,
            blend_radius: 0.05,
            ..step(from, to, Path::PointToPoint, false)
        };
        [step(&a, &b), step(&b, &c)]
    };
    let back = step(&c, &a, Path::PointToPoint, false);
    let (turns, others) = (moves(Phase::Turn), moves(Phase::Move));
    let both = plan(&cell, &[&turns[..], &[back], &others[..]].concat());
    assert_eq!(both.blend(0), plan(&cell, &turns).blend(0));
    assert_eq!(both.blend(3), plan(&cell, &others).blend(0));
    assert_ne!(both.blend(0), both.blend(3));
}

/// A robot that checks limits has no pose far below them.
#[test]
fn robots_that_check_limits_are_planned_where_they_are() {
    let (mut cell, [a, b, _]) = corner();
    let steps = |height: i32| {
        let up = raised(&b, height);
        [step(&a, &b, Path::PointToPoint, true), step(&b, &up, Path::Line(A), true)]
    };
    let expected = plan(&cell, &steps(20_000)).duration();
    let limits = *cell.robot.gpr.limits();
    let gpr = &cell.robot.gpr;
    cell.robot.gpr = Gpr::new(gpr.limbs(), limits, gpr.working_height()).unwrap();
    assert!(cell.robot.gpr.checks_limits());
    let found = plan(&cell, &steps(20_000)).duration();
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
}
