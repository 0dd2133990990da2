//! Trajectories keep all limits at every sample, agree with their own differences, and end exactly at their goals.

use crate::common;

use common::A;
use jointplay_cell::program::{Path, Phase, SourceLocation, Step};
use jointplay_cell::robot::{AxesMotion, KinematicLimits, RODS, WaferTarget};
use jointplay_cell::trajectory::{
    MAX_DURATION, Sample, StepErrorKind, Trajectory, TrajectoryError, TrajectoryOptions,
    axis_limits, plan_trajectory,
};
use jointplay_cell::wafer::Droop;
use jointplay_cell::workcell::Cell;
use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;
use proptest::prelude::*;

fn cell(kind: usize, droop: Droop) -> Cell {
    let mut robot = common::kind(kind, [0.25, 0.22, 0.2]);
    for arm in &mut robot.arms {
        arm.droop = droop.clone();
    }
    for (place, axis) in robot.axes.iter_mut().enumerate() {
        // Unequal, so that each axis is the limiting one in some case.
        let fraction = [1.0, 0.6, 0.35, 0.8][place % 4];
        axis.empty.velocity *= fraction;
        axis.loaded.acceleration *= 0.5 * fraction;
        axis.loaded.jerk *= 0.7;
    }
    common::cell(robot)
}

fn step(from: &[f64], to: &[f64], path: Path, speed: f64, loaded: bool) -> Step {
    Step {
        instruction: 0,
        place: SourceLocation { line: 1, column: 1 },
        phase: Phase::Move,
        from: from.to_vec(),
        to: to.to_vec(),
        path,
        speed_scaling: speed,
        blend_radius: 0.0,
        postures: None,
        line_speed: None,
        loaded: if loaded { vec![A] } else { Vec::new() },
        handoff: None,
        slot: None,
    }
}

/// Checks limits at every sample, derivatives against differences, and exact ends.
fn keeps(cell: &Cell, motion: &Trajectory) {
    const RATE: f64 = 4000.0;
    let samples: Vec<Sample> = motion.samples(RATE).collect();
    let (first, last) = (&samples[0], &samples[samples.len() - 1]);
    assert_eq!(first.positions, motion.steps[0].from);
    assert_eq!(last.positions, motion.steps[motion.steps.len() - 1].to);
    assert_eq!(last.time, motion.duration());
    for (index, step) in motion.steps.iter().enumerate() {
        if motion.blend(index).is_some() {
            continue;
        }
        let end = motion.sample_at(motion.times[index + 1]);
        assert_eq!(end.positions, step.to);
        assert!(end.velocities.iter().chain(&end.accelerations).all(|value| value.abs() < 1e-9));
    }
    for triple in samples.windows(3) {
        let [before, now, after] = triple else { unreachable!() };
        let dt = 1.0 / RATE;
        if after.step != before.step || (after.time - now.time - dt).abs() > 1e-9 {
            continue;
        }
        for axis in 0..now.positions.len() {
            let limits = axis_limits(&cell.robot, axis, &motion.steps[now.step]);
            let fraction = motion.steps[now.step].speed_scaling;
            let (v, a, j) = (now.velocities[axis], now.accelerations[axis], now.jerks[axis]);
            let name = &cell.robot.axes[axis].name;
            assert!(
                v.abs() <= fraction * limits.velocity * (1.0 + 1e-9),
                "{name} {v} at {}",
                now.time
            );
            assert!(
                a.abs() <= fraction * limits.acceleration * (1.0 + 1e-9),
                "{name} {a} at {}",
                now.time
            );
            assert!(j.abs() <= fraction * limits.jerk * (1.0 + 1e-9), "{name} {j} at {}", now.time);
            let difference =
                |of: fn(&Sample) -> &Vec<f64>| (of(after)[axis] - of(before)[axis]) / (2.0 * dt);
            // Differences deviate by the change of acceleration in one interval.
            assert!((difference(|s| &s.positions) - v).abs() <= limits.jerk * dt * dt);
            assert!((difference(|s| &s.velocities) - a).abs() <= limits.jerk * dt);
            let jerk = difference(|s| &s.accelerations);
            assert!(
                jerk.abs() <= fraction * limits.jerk * 1.001 + 1e-6,
                "{name} {jerk} at {}",
                now.time
            );
        }
    }
}

/// Positions with the platform at a tilt and height and the motors at shares of their range.
fn positions(cell: &Cell, tilt: Tilt, height: f64, fractions: [f64; 5]) -> Vec<f64> {
    let robot = &cell.robot;
    let mut all = robot.gpr.inverse(tilt, AxisHeight(height)).unwrap().to_vec();
    for (axis, fraction) in robot.axes[RODS..].iter().zip(fractions) {
        all.push(axis.min + fraction * (axis.max - axis.min));
    }
    all
}

fn fractions() -> impl Strategy<Value = [f64; 5]> {
    prop::array::uniform5(0.15..0.85)
}

fn tilt() -> impl Strategy<Value = Tilt> {
    (-3.0..3.0, 0.0..0.02).prop_map(|(azimuth, tilt_angle)| Tilt { azimuth, angle: tilt_angle })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn axes_keep_their_limits(
        kind in 0..common::KINDS,
        first in fractions(), second in fractions(), third in fractions(),
        tilts in [tilt(), tilt(), tilt()],
        heights in [0.3..0.7, 0.3..0.7, 0.3..0.7],
        speed in 0.1..1.0,
        loaded: bool,
    ) {
        let cell = cell(kind, Droop::Rigid);
        let [a, b, c] = [(0, first), (1, second), (2, third)]
            .map(|(k, fractions)| positions(&cell, tilts[k], heights[k], fractions));
        let steps = vec![
            step(&a, &b, Path::PointToPoint, 1.0, loaded),
            step(&b, &b, Path::Dwell(0.1), 1.0, loaded),
            step(&b, &c, Path::PointToPoint, speed, !loaded),
        ];
        let motion = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
        keeps(&cell, &motion);
        // The limiting axis of a step uses its limits all the time, the others do not.
        prop_assert!((loaded || motion.limiting_axis(0).is_some()) && motion.limiting_axis(1).is_none());
    }

    #[test]
    fn cartesian_lines_are_straight_and_keep_limits(
        kind in 0..common::KINDS,
        fractions in fractions(),
        tilts in [tilt(), tilt()],
        displacement in [-0.06..0.06, -0.06..0.06, -0.02..0.02],
        droops: bool,
        loaded: bool,
    ) {
        let droop = Droop::Cantilever { stiffness: 900.0, mass_per_length: 2.5 };
        let cell = cell(kind, if droops { droop } else { Droop::Rigid });
        let from = positions(&cell, tilts[0], 0.5, fractions);
        let start = cell.wafer_pose(A, &from, loaded).unwrap();
        let target = WaferTarget {
            center: start.translation.vector + Vector3::from(displacement),
            normal: tilts[1].normal(),
            heading: None,
        };
        let reached = cell.compensated_inverse(A, &target, loaded, &from);
        prop_assume!(reached.is_ok());
        let to = reached.unwrap().positions;
        // The other elbow cannot be reached along a line.
        let near = from.iter().zip(&to).all(|(a, b)| (a - b).abs() < 1.2);
        prop_assume!(near);
        let steps = vec![step(&from, &to, Path::Line(A), 1.0, loaded)];
        let motion = match plan_trajectory(&cell, steps, &TrajectoryOptions::default()) {
            Ok(motion) => motion,
            // Past a singular position there may be no path; the error has the fraction of the line.
            Err(error) => {
                prop_assert!(error.to_string().contains("of the line"), "{error}");
                return Ok(());
            }
        };
        keeps(&cell, &motion);
        let straight = motion.line_deviation(0).unwrap();
        prop_assert!(straight.distance <= 1e-6);
        let end = cell.wafer_pose(A, &to, loaded).unwrap();
        let along = (end.translation.vector - start.translation.vector).normalize();
        let mut worst = 0.0_f64;
        let normal = |pose: &jointplay_core::spatial::Pose| pose.rotation * Vector3::z();
        let (first, last) = (normal(&start), normal(&end));
        for sample in motion.samples(2000.0) {
            let pose = cell.wafer_pose(A, &sample.positions, loaded).unwrap();
            let off = pose.translation.vector - start.translation.vector;
            worst = worst.max((off - along * off.dot(&along)).norm());
            // Between the planes of the ends, along the shortest rotation.
            let angle = normal(&pose).angle(&first) + normal(&pose).angle(&last);
            prop_assert!(angle <= first.angle(&last) + 1e-5, "{angle}");
        }
        prop_assert!(worst <= straight.distance * 1.3 + 1e-11, "{worst} {}", straight.distance);
    }

    #[test]
    fn blends_keep_the_limits_of_both_steps(
        kind in 0..common::KINDS,
        fractions in [fractions(), fractions(), fractions()],
        tilts in [tilt(), tilt(), tilt()],
        displacement in [-0.06..0.06, -0.06..0.06, -0.02..0.02],
        speeds in prop::array::uniform4(0.2..1.0),
        radii in prop::array::uniform4(0.0..0.03),
        loaded: bool,
    ) {
        let cell = cell(kind, Droop::Rigid);
        let [a, b, c] = [0, 1, 2].map(|k| positions(&cell, tilts[k], 0.5, fractions[k]));
        let start = cell.wafer_pose(A, &b, loaded).unwrap();
        let target = WaferTarget {
            center: start.translation.vector + Vector3::from(displacement),
            normal: tilts[2].normal(),
            heading: None,
        };
        let reached = cell.compensated_inverse(A, &target, loaded, &b);
        prop_assume!(reached.is_ok());
        let out = reached.unwrap().positions;
        let mut steps = vec![
            step(&a, &b, Path::PointToPoint, speeds[0], loaded),
            step(&b, &out, Path::Line(A), speeds[1], loaded),
            step(&out, &c, Path::PointToPoint, speeds[2], loaded),
            step(&c, &a, Path::PointToPoint, speeds[3], loaded),
        ];
        let Ok(apart) = plan_trajectory(&cell, steps.clone(), &TrajectoryOptions::default()) else {
            return Ok(());
        };
        steps.iter_mut().zip(radii).for_each(|(step, radius)| step.blend_radius = radius);
        let motion = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
        keeps(&cell, &motion);
        for k in 0..3 {
            let Some(blend) = motion.blend(k) else { continue };
            prop_assert!(blend.deviation <= radii[k].min(radii[k + 1]));
        }
        prop_assert!(motion.blend(3).is_none());
        prop_assert!(motion.duration() <= apart.duration() + 1e-12);
    }
}

#[test]
fn blended_wafer_stays_within_the_blend_radius() {
    let mut cell = cell(0, Droop::Rigid);
    // Slow enough that no segment has to be slowed for the wafer.
    cell.robot.arms[0].effectors[0].friction = 10.0;
    let from = positions(&cell, Tilt { azimuth: 0.0, angle: 0.0 }, 0.45, [0.5; 5]);
    let mut turned = from.clone();
    turned[3] += 1.0;
    let mut up = turned.clone();
    for rod in &mut up[..RODS] {
        *rod += 0.1;
    }
    let mut back = up.clone();
    back[3] -= 0.8;
    let steps = |radius: f64| {
        let mut steps = vec![
            step(&from, &turned, Path::PointToPoint, 1.0, true),
            step(&turned, &up, Path::PointToPoint, 1.0, true),
            step(&up, &back, Path::PointToPoint, 1.0, true),
            step(&back, &back, Path::Dwell(0.1), 1.0, true),
        ];
        steps.iter_mut().for_each(|step| step.blend_radius = radius);
        steps
    };
    let options = TrajectoryOptions::default();
    let apart = plan_trajectory(&cell, steps(0.0), &options).unwrap();
    let centers = |motion: &Trajectory| -> Vec<Vector3<f64>> {
        motion
            .samples(2000.0)
            .map(|s| cell.wafer_pose(A, &s.positions, true).unwrap().translation.vector)
            .collect()
    };
    let path = centers(&apart);
    let mut before = apart.duration();
    for radius in [0.002, 0.02] {
        let motion = plan_trajectory(&cell, steps(radius), &options).unwrap();
        keeps(&cell, &motion);
        assert!(motion.duration() < before - 1e-3, "{} {before}", motion.duration());
        before = motion.duration();
        let overlaps: f64 = (0..4).filter_map(|k| motion.blend(k)).map(|one| one.overlap).sum();
        assert!((apart.duration() - motion.duration() - overlaps).abs() < 1e-9);
        let stated =
            (0..4).filter_map(|k| motion.blend(k)).map(|one| one.deviation).fold(0.0, f64::max);
        assert!(stated <= radius && motion.blend(2).is_none());
        let deviation = centers(&motion)
            .iter()
            .map(|c| path.iter().map(|w| (w - c).norm()).fold(f64::INFINITY, f64::min))
            .fold(0.0, f64::max);
        // The unblended path is known at points a millimetre apart.
        assert!(deviation <= stated + 1e-3, "{deviation} {stated}");
        // Positions and velocities are continuous where one step ends and the next begins.
        let all: Vec<Sample> = motion.samples(4000.0).collect();
        for pair in all.windows(2) {
            for axis in 0..pair[0].positions.len() {
                let dt = pair[1].time - pair[0].time;
                let mean = 0.5 * (pair[0].velocities[axis] + pair[1].velocities[axis]);
                let moved = pair[1].positions[axis] - pair[0].positions[axis];
                assert!((moved - mean * dt).abs() < 1e-8, "{moved} {}", mean * dt);
            }
        }
    }
}

/// A loaded step of axes and its duration (s).
fn loaded_move(cell: &Cell, from: &[f64], to: &[f64]) -> (Trajectory, f64) {
    let steps = vec![step(from, to, Path::PointToPoint, 1.0, true)];
    let motion = plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap();
    let duration = motion.duration();
    (motion, duration)
}

/// A rigid robot with one coefficient of friction, and its axes level in the middle of their ranges.
fn on_friction(kind: usize, friction: f64) -> (Cell, Vec<f64>) {
    let mut cell = common::cell(common::kind(kind, [0.25, 0.22, 0.2]));
    cell.robot.arms[0].effectors[0].friction = friction;
    let from = positions(&cell, Tilt { azimuth: 0.0, angle: 0.0 }, 0.5, [0.5; 5]);
    (cell, from)
}

/// Largest utilization of friction, by samples.
fn peak_utilization(cell: &Cell, motion: &Trajectory) -> f64 {
    let utilization = |sample: Sample| {
        let Sample { positions, velocities, accelerations, .. } = &sample;
        let motion = AxesMotion { positions, velocities, accelerations };
        cell.friction_demand(A, &motion).unwrap().utilization()
    };
    motion.samples(2000.0).map(utilization).fold(0.0, f64::max)
}

#[test]
fn a_radial_move_on_little_friction_is_that_of_its_acceleration_limit() {
    // The prismatic joint of a robot of kind 3 moves the wafer straight, and the wafer needs its acceleration as friction.
    for friction in [0.05, 0.1, 0.2, 0.5] {
        let (cell, from) = on_friction(3, friction);
        let mut to = from.clone();
        to[RODS + 1] = 0.45;
        let far = to[RODS + 1] - from[RODS + 1];
        let limits =
            axis_limits(&cell.robot, RODS + 1, &step(&from, &to, Path::PointToPoint, 1.0, true));
        let (jerk, acceleration) = (limits.jerk, friction * common::GRAVITY);
        // The speed limit is not reached: d = v²/a + v a/j with the peak speed v, and twice v/a + a/j.
        let ramp = acceleration / jerk;
        let speed = 0.5 * acceleration * ((ramp * ramp + 4.0 * far / acceleration).sqrt() - ramp);
        assert!(speed < limits.velocity && speed > acceleration * ramp);
        let expected = 2.0 * (speed / acceleration + ramp);

        let (motion, duration) = loaded_move(&cell, &from, &to);

        keeps(&cell, &motion);
        let excess = duration / expected - 1.0;
        assert!((0.0..0.03).contains(&excess), "{friction}: {duration} {expected}");
        assert!((0.9..1.0).contains(&peak_utilization(&cell, &motion)));
    }
}

/// Shortest time of a turn on friction, without a jerk limit: the acceleration that friction and centripetal acceleration leave, integrated up to the middle (s).
///
/// # Arguments
/// * `lever` – distance of the wafer's centre from the axis (m)
/// * `wafer_radius` – of a wafer that is supported at its edge (m)
fn fastest_turn(
    angle: f64,
    limits: KinematicLimits,
    friction: f64,
    lever: f64,
    wafer_radius: f64,
) -> f64 {
    let available = friction * common::GRAVITY;
    let acceleration = |speed: f64| {
        let remaining = |value: f64| {
            available - lever * value.hypot(speed * speed) - 0.5 * wafer_radius * value
        };
        let (mut low, mut high) = (0.0, limits.acceleration);
        if remaining(high) >= 0.0 {
            return high;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if remaining(middle) >= 0.0 { low = middle } else { high = middle }
        }
        low
    };
    let (mut time, mut turned, mut speed) = (0.0, 0.0, 0.0);
    let dt = 2e-5;
    while turned < 0.5 * angle {
        speed = limits.velocity.min(speed + dt * acceleration(speed));
        turned += dt * speed;
        time += dt;
    }
    2.0 * time
}

#[test]
fn turns_on_little_friction_are_slow_only_where_it_binds() {
    for (angle, friction) in [(0.6, 0.1), (2.0, 0.1), (2.5, 0.05), (2.5, 0.3)] {
        let (mut cell, from) = on_friction(3, friction);
        for axis in &mut cell.robot.axes {
            axis.loaded.jerk *= 100.0;
        }
        let mut to = from.clone();
        to[RODS] += angle;
        let limits =
            axis_limits(&cell.robot, RODS, &step(&from, &to, Path::PointToPoint, 1.0, true));
        let center = |turned: f64| {
            let mut at = from.clone();
            at[RODS] += turned;
            cell.wafer_pose(A, &at, true).unwrap().translation.vector
        };
        let lever = (center(1e-4) - center(-1e-4)).norm() / 2e-4;

        let (motion, duration) = loaded_move(&cell, &from, &to);

        keeps(&cell, &motion);
        assert!(peak_utilization(&cell, &motion) < 1.0);
        let optimum = fastest_turn(angle, limits, friction, lever, 0.5 * cell.wafer.diameter);
        let excess = duration / optimum - 1.0;
        assert!((0.0..0.03).contains(&excess), "{angle} {friction}: {duration} {optimum}");
        // Slowed as a whole, by the largest acceleration: a short turn is nearly that, a long one keeps its speed.
        let unlimited = angle / limits.velocity + limits.velocity / limits.acceleration;
        let demand = (lever + 0.25 * cell.wafer.diameter) * limits.acceleration;
        let slowed = unlimited * (demand / (friction * common::GRAVITY)).sqrt();
        let most = if angle < 1.0 { slowed } else { 0.95 * slowed };
        assert!(duration < most, "{angle} {friction}: {duration} {slowed}");
    }
}

#[test]
fn durations_of_moves_on_little_friction_are_continuous() {
    let spike = |durations: &[f64]| {
        let deviation = |three: &[f64]| (three[1] - 0.5 * (three[0] + three[2])).abs() / three[1];
        durations.windows(3).map(deviation).fold(0.0, f64::max)
    };
    for (kind, others) in [(0, 0.0), (3, 0.0), (3, 0.3), (6, 0.6)] {
        let duration = |angle: f64, friction: f64| {
            let (cell, from) = on_friction(kind, friction);
            let mut to = from.clone();
            to[RODS] += angle;
            to[RODS + 1] -= others * angle / 2.0;
            loaded_move(&cell, &from, &to).1
        };
        let over_angles: Vec<f64> = (50..90).map(|k| duration(0.02 * f64::from(k), 0.08)).collect();
        assert!(spike(&over_angles) < 0.01, "{kind}: {over_angles:?}");
        let over_friction: Vec<f64> =
            (10..60).map(|k| duration(1.2, 0.02 * f64::from(k))).collect();
        assert!(spike(&over_friction) < 0.01, "{kind}: {over_friction:?}");
        assert!(over_friction.is_sorted_by(|one, next| *next <= 1.001 * one), "{over_friction:?}");
    }
}

#[test]
fn line_speed_is_limited_separately() {
    let cell = cell(0, Droop::Rigid);
    let from = positions(&cell, Tilt { azimuth: 0.0, angle: 0.0 }, 0.5, [0.5; 5]);
    let to: Vec<f64> =
        from.iter().enumerate().map(|(k, q)| if k < RODS { q + 0.02 } else { *q }).collect();
    let mut lift = step(&from, &to, Path::Line(A), 1.0, false);
    lift.line_speed = Some(0.05);
    let motion = plan_trajectory(&cell, vec![lift], &TrajectoryOptions::default()).unwrap();
    let fastest =
        motion.samples(1000.0).map(|sample| sample.velocities[0].abs()).fold(0.0, f64::max);
    assert!((fastest - 0.05).abs() < 2e-4, "{fastest}");
    assert!((motion.line_deviation(0).unwrap().length - 0.02).abs() < 1e-12);
}

#[test]
fn process_dwell_counts_from_the_placing_of_the_wafer() {
    let cell = cell(0, Droop::Rigid);
    let from = positions(&cell, Tilt { azimuth: 0.0, angle: 0.0 }, 0.5, [0.5; 5]);
    let mut to = from.clone();
    to[3] += 0.5;
    let wait = |placed_at_step, seconds| {
        step(&to, &to, Path::ProcessDwell { placed_at_step, seconds }, 1.0, false)
    };
    let go = || step(&from, &to, Path::PointToPoint, 1.0, false);
    let still = step(&to, &to, Path::Dwell(2.0), 1.0, false);
    let motion = plan_trajectory(
        &cell,
        vec![go(), still, wait(0, 5.0), wait(0, 1.0)],
        &TrajectoryOptions::default(),
    )
    .unwrap();
    assert!((motion.step_duration(2) - 3.0).abs() < 1e-12);
    assert_eq!(motion.step_duration(3), 0.0);
    assert_eq!([0, 1, 2, 3].map(|step| motion.has_duration(step)), [true, true, true, false]);
}

#[test]
fn trajectory_error_lists_all_invalid_steps() {
    let cell = cell(0, Droop::Rigid);
    let from = positions(&cell, Tilt { azimuth: 0.0, angle: 0.0 }, 0.5, [0.5; 5]);
    let mut to = from.clone();
    to[3] += 0.5;
    let steps = vec![
        step(&from, &to, Path::PointToPoint, 0.0, false),
        step(&from, &to, Path::PointToPoint, 1.0, false),
        step(&to, &from, Path::Dwell(1.0), 1.0, false),
        // A dwell without a finite duration.
        step(&from, &from, Path::Dwell(f64::NAN), 1.0, false),
    ];
    let error = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap_err();
    let messages: Vec<String> = error.steps.iter().map(ToString::to_string).collect();
    assert_eq!(messages.len(), 4, "{messages:#?}");
    assert!(messages[0].contains("speed scaling must be above 0"), "{}", messages[0]);
    assert!(messages[1].contains("axis 3 starts at"), "{}", messages[1]);
    assert!(
        messages[2].contains("start and end positions of a dwell must be equal"),
        "{}",
        messages[2]
    );
    assert!(messages[3].contains("got NaN s"), "{}", messages[3]);
}

/// Trajectory of a level line of an arm with redundant joints, its end farthest from limits.
fn redundant_line(fractions: [f64; 5], [x, y]: [f64; 2]) -> Result<Trajectory, TrajectoryError> {
    let cell = cell(9, Droop::Rigid);
    let level = Tilt { azimuth: 0.0, angle: 0.0 };
    let from = positions(&cell, level, 0.5, fractions);
    let start = cell.wafer_pose(A, &from, false).unwrap();
    let target = WaferTarget {
        center: start.translation.vector + Vector3::new(x, y, 0.0),
        normal: level.normal(),
        heading: None,
    };
    let to = cell.compensated_inverse(A, &target, false, &from).unwrap().positions;
    let steps = vec![step(&from, &to, Path::Line(A), 1.0, false)];
    plan_trajectory(&cell, steps, &TrajectoryOptions::default())
}

#[test]
fn line_with_a_branch_jump_is_rejected() {
    // The branches continued from either end do not meet.
    let fractions = [
        0.34646284245881437,
        0.677682324773474,
        0.44938697705771924,
        0.7493541011547549,
        0.23821173178073835,
    ];
    let found = redundant_line(fractions, [0.05841545386837504, 0.13762178282428034]);
    let error = found.unwrap_err().to_string();
    for words in ["at 54.2 % of the line (x ", "they change to another branch"] {
        assert!(error.contains(words), "{words}: {error}");
    }
}

#[test]
fn points_of_a_line_do_not_depend_on_their_initial_guess() {
    // A point that was stationary by the Jacobian of its initial guess was apart from its neighbours: a jump at 25 % of the line.
    let fractions =
        [0.6986754123647267, 0.38714119678890774, 0.5765603575934801, 0.6386828982446656, 0.15];
    let displacement = [0.01986070640874278, -0.05178173816321386];
    let trajectory = redundant_line(fractions, displacement).unwrap();
    let deviation = trajectory.line_deviation(0).unwrap();
    assert!(deviation.distance < 1e-6, "{deviation:?}");
}

#[test]
fn trajectory_longer_than_a_day_is_rejected() {
    let mut cell = cell(0, Droop::Rigid);
    let from = vec![0.5, 0.5, 0.5, 0.0, 0.9];
    let to = vec![0.5, 0.5, 0.5, 1.2, 0.9];
    let there_and_back = || {
        vec![
            step(&from, &to, Path::PointToPoint, 1.0, false),
            step(&to, &from, Path::PointToPoint, 1.0, false),
        ]
    };
    // Triangular velocity profiles: t = 2 √(d / a) where the jerk limit has no effect.
    for (hours, problem) in [(11.0_f64, None), (13.0, Some(1)), (25.0, Some(0)), (1e3, Some(0))] {
        let acceleration = 1.2 * (2.0 / (3600.0 * hours)).powi(2);
        cell.robot.axes[3].empty = KinematicLimits { velocity: 1e3, acceleration, jerk: 1e3 };
        let found = plan_trajectory(&cell, there_and_back(), &TrajectoryOptions::default());
        match (found, problem) {
            (Ok(motion), None) => {
                let expected = 2.0 * 3600.0 * hours;
                assert!((motion.duration() / expected - 1.0).abs() < 1e-3);
                assert!(motion.duration() <= MAX_DURATION);
            }
            (Err(error), Some(step)) => {
                assert_eq!((error.steps.len(), error.steps[0].step), (1, step), "{error}");
                let kind = &error.steps[0].kind;
                assert!(matches!(kind, StepErrorKind::TooLong { .. }), "{error}");
            }
            (found, _) => panic!("{hours}: {found:?}"),
        }
    }
}
