//! Every limit crossed once, each with its message; a wall that only a swept check sees; slip by hand.

use crate::common;

use std::collections::BTreeSet;

use common::{A, GRAVITY, step};
use jointplay_cell::EntityId;
use jointplay_cell::check::{CheckOptions, CheckResult, Report, ViolationKind, check};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::{Handoff, Path, Phase, Step};
use jointplay_cell::robot::{PlatformModel, WaferTarget};
use jointplay_cell::station::{SlotId, Station};
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::wafer::{Droop, DroopRow};
use jointplay_cell::workcell::{Body, Cell, ParentFrame, Zone, ZoneRule};
use jointplay_core::gpr::{AxisHeight, Gpr, Limits};
use jointplay_core::spatial::{Pose, Tilt};
use jointplay_core::virtualization::{BuiltIn, SolveOptions, Solver};
use nalgebra::{Rotation3, Translation3, Vector3};
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};

const T: usize = 3;

/// A radial arm with a wafer on it, and nothing around.
fn cell() -> Cell {
    let mut robot = common::kind(0, [0.25, 0.22, 0.2]);
    robot.arms[0].effectors[0].friction = 1.0;
    common::cell(robot)
}

/// Level, the arm bent, T from 0 to 1.2 rad; then back.
fn turn(cell: &Cell) -> Trajectory {
    let from = [0.5, 0.5, 0.5, 0.0, 0.9];
    let to = [0.5, 0.5, 0.5, 1.2, 0.9];
    let mut first = step(0, &from, &to);
    first.phase = Phase::Turn;
    plan_trajectory(cell, vec![first, step(1, &to, &from)], &TrajectoryOptions::default()).unwrap()
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_parts(Translation3::new(x, y, z), Rotation3::identity())
}

/// Names of entities.
fn names(cell: &Cell, entities: &[EntityId]) -> Vec<String> {
    entities.iter().map(|&entity| cell.entity_name(entity)).collect()
}

fn kinds(report: &Report) -> BTreeSet<ViolationKind> {
    report.violations.iter().map(|violation| violation.kind).collect()
}

/// Checks the turn in a cell that was changed since, and that just this is broken.
#[track_caller]
fn breaks(change: impl FnOnce(&mut Cell), kind: ViolationKind, message: &str) -> Report {
    let mut cell = cell();
    let motion = turn(&cell);
    change(&mut cell);
    let report = check(&cell, &motion, &CheckOptions::default());
    assert_eq!(kinds(&report), BTreeSet::from([kind]), "{:#?}", report.violations);
    assert_eq!(report.result, CheckResult::Failed);
    let description = report.violations[0].describe(&cell);
    assert!(description.contains(message) && description.starts_with("line 10,"), "{description}");
    assert!(report.violations.windows(2).all(|pair| pair[0].start <= pair[1].start));
    let counted: usize = report.by_instruction.iter().map(|row| row.violations).sum();
    assert_eq!(counted, report.violations.len());
    for violation in &report.violations {
        assert!(violation.start <= violation.worst_time && violation.worst_time <= violation.end);
    }
    report
}

#[test]
fn a_sound_motion_is_sound() {
    let cell = cell();
    let motion = turn(&cell);
    let report = check(&cell, &motion, &CheckOptions::default());
    assert_eq!((report.result, report.violations.len()), (CheckResult::Passed, 0));
    assert_eq!(report.by_instruction.len(), 2);
    let row = &report.by_instruction[0];
    assert_eq!((row.steps.clone(), row.start), (0..1, 0.0));
    assert!((row.duration - motion.times[1]).abs() < 1e-12);
    // Only T moves, all the time, and reaches a limit.
    assert!((row.moving_time[T] - row.duration).abs() < 1e-12);
    assert_eq!(row.moving_time.iter().filter(|time| **time == 0.0).count(), 4);
    assert!((row.jerk.unwrap().ratio - 1.0).abs() < 1e-9);
    assert!((report.moving_time[T] - report.duration).abs() < 1e-12);
    assert_eq!((report.wafers, report.wafers_per_hour), (0, None));
}

#[test]
fn every_limit_of_an_axis_has_its_message() {
    let report =
        breaks(|cell| cell.robot.axes[T].max = 0.9, ViolationKind::Position, "axis T reaches 1.2");
    assert_eq!(report.violations.len(), 2, "out in one instruction, back in the next");
    assert!((report.violations[0].worst - 1.2).abs() < 1e-12);
    breaks(
        |cell| cell.robot.axes[T].loaded.velocity = 1.0,
        ViolationKind::Velocity,
        "axis T moves at",
    );
    breaks(
        |cell| cell.robot.axes[T].loaded.acceleration = 5.0,
        ViolationKind::Acceleration,
        "axis T accelerates at",
    );
    let report = breaks(
        |cell| cell.robot.axes[T].loaded.jerk = 80.0,
        ViolationKind::Jerk,
        "axis T has a jerk of 100",
    );
    assert_eq!(report.violations[0].limit, 80.0);
    // The empty limits are not asked for while a wafer is carried.
    let mut cell = cell();
    let motion = turn(&cell);
    cell.robot.axes[T].empty.velocity = 0.1;
    assert_eq!(check(&cell, &motion, &CheckOptions::default()).result, CheckResult::Passed);
}

#[test]
fn tilt_play_and_droop_have_their_messages() {
    let tilted_program = |cell: &mut Cell| {
        let rods =
            cell.robot.gpr.inverse(Tilt { azimuth: 0.4, angle: 0.02 }, AxisHeight(0.5)).unwrap();
        let mut from = rods.to_vec();
        from.extend([0.0, 0.9]);
        let mut to = from.clone();
        to[T] = 1.0;
        plan_trajectory(cell, vec![step(0, &from, &to)], &TrajectoryOptions::default()).unwrap()
    };
    let mut tilted = cell();
    let motion = tilted_program(&mut tilted);
    assert_eq!(check(&tilted, &motion, &CheckOptions::default()).result, CheckResult::Passed);
    let gpr = tilted.robot.gpr.clone();
    let limits = Limits { tilt_max: 0.015, ..*gpr.limits() };
    tilted.robot.gpr =
        Gpr::new(gpr.limbs(), limits, gpr.working_height()).unwrap().without_limit_checks();
    let report = check(&tilted, &motion, &CheckOptions::default());
    assert_eq!(kinds(&report), BTreeSet::from([ViolationKind::Tilt]));
    assert!((report.violations[0].worst - 0.02).abs() < 1e-9);
    assert!((report.by_instruction[0].tilt - 0.02 / 0.015).abs() < 1e-9);
    breaks(|cell| cell.play_budget = 1e-4, ViolationKind::Play, "the play budget is 1.000e-4 m");
    let row = |reach| DroopRow {
        reach,
        empty_drop: 0.0,
        empty_slope: 0.0,
        loaded_drop: 0.0,
        loaded_slope: 0.0,
        load: 0.1,
    };
    let rows = vec![row(1.0), row(1.2)];
    breaks(|cell| cell.robot.arms[0].droop = Droop::Table { rows }, ViolationKind::Droop, "droop");
}

#[test]
fn a_platform_that_cannot_be_placed_has_its_message() {
    let hasty = SolveOptions { solver: Solver::Newton, max_iterations: 0, ..Default::default() };
    let model = PlatformModel { virtualization: BuiltIn::Polar, options: hasty };
    let message = "platform: the newton iteration did not converge in 0 steps: the sides are";
    let report = breaks(|cell| cell.robot.model = model, ViolationKind::Platform, message);
    // All the time, in both instructions, and nothing else is known meanwhile.
    assert_eq!(report.violations.len(), 2);
    assert_eq!((report.violations[0].start, report.violations[1].end), (0.0, report.duration));
    assert!(report.by_instruction.iter().all(|row| row.slip.is_none() && row.nearest.is_none()));
    assert_eq!(report.violations[0].symbol(), "");
}

#[test]
fn a_wafer_slips_as_computed_by_hand() {
    let mut cell = cell();
    for axis in &mut cell.robot.axes {
        axis.loaded.velocity = 3.0;
    }
    let motion = turn(&cell);
    let center =
        cell.wafer_pose(A, &motion.sample_at(0.0).positions, true).unwrap().translation.vector;
    // The wafer moves around the first joint, level: tangential and radial acceleration of its middle,
    // and the turning of a disc about it, borne by its edge, where the pressure has an offset of the height of its middle.
    let mount = cell.robot.arms[0].mount;
    let platform = cell.robot.forward(&motion.sample_at(0.0).positions).unwrap().platform;
    let joint = platform.base_from_platform * nalgebra::Point3::from(mount);
    let radius = (center - joint.coords).xy().norm();
    let push = |t: f64| {
        let sample = motion.sample_at(t);
        let straight = radius * sample.accelerations[T].hypot(sample.velocities[T].powi(2));
        let turning = 0.5 * 0.15 * 0.15 * sample.accelerations[T].abs();
        straight + turning / (0.15 - 0.5 * 775e-6 * straight / GRAVITY)
    };
    let worst = motion.samples(1000.0).map(|sample| push(sample.time)).fold(0.0, f64::max);
    cell.robot.arms[0].effectors[0].friction = 0.9 * worst / GRAVITY;
    let report = check(&cell, &motion, &CheckOptions::default());
    assert_eq!(kinds(&report), BTreeSet::from([ViolationKind::Slip]));
    let found = report.violations.iter().map(|one| one.worst).fold(0.0, f64::max);
    assert!((found - worst).abs() < 1e-5 * worst, "{found} {worst}");
    assert!((report.violations[0].limit - 0.9 * worst).abs() < 1e-9);
    assert!(report.violations[0].describe(&cell).contains("the wafer on A slips"));
    // It starts where the hand computation passes the limit, to a sample.
    let start = report.violations[0].start;
    assert!(push(start) > 0.9 * worst && push(start - 1e-3) <= 0.9 * worst);
    cell.robot.arms[0].effectors[0].friction = 1.01 * worst / GRAVITY;
    assert_eq!(check(&cell, &motion, &CheckOptions::default()).result, CheckResult::Passed);
    // Tilted at rest: g sin α against µ g cos α.
    let rods = cell.robot.gpr.inverse(Tilt { azimuth: 0.4, angle: 0.02 }, AxisHeight(0.5)).unwrap();
    let mut still = rods.to_vec();
    still.extend([0.0, 0.9]);
    let mut wait = step(0, &still, &still);
    wait.path = Path::Dwell(0.01);
    let motion = plan_trajectory(&cell, vec![wait], &TrajectoryOptions::default()).unwrap();
    for (friction, passes) in [(0.0199, false), (0.0201, true)] {
        cell.robot.arms[0].effectors[0].friction = friction;
        let report = check(&cell, &motion, &CheckOptions::default());
        let result = if passes { CheckResult::NoMotion } else { CheckResult::Failed };
        assert_eq!(report.result, result);
        let fraction = report.by_instruction[0].slip.unwrap().ratio;
        assert!((fraction - 0.02_f64.tan() / friction).abs() < 1e-6, "{fraction}");
    }
}

/// A thin upright wall across the path of the arm's tip, at an angle of T.
fn wall(name: &str, cell: &Cell, angle: f64, radius: f64, thickness: f64) -> Body {
    let positions = [0.5, 0.5, 0.5, angle, 0.9];
    let wafer = cell.wafer_pose(A, &positions, false).unwrap().translation.vector;
    let platform = cell.robot.forward(&positions).unwrap().platform;
    let joint =
        (platform.base_from_platform * nalgebra::Point3::from(cell.robot.arms[0].mount)).coords;
    let out = (wafer - joint).xy().normalize();
    let along = Rotation3::from_axis_angle(&Vector3::z_axis(), out.y.atan2(out.x));
    let center = joint + Vector3::new(out.x, out.y, 0.0) * radius;
    Body {
        name: name.into(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::from_parts(Translation3::new(center.x, center.y, wafer.z), along),
        shape: Shape::Box { half: [0.03, 0.5 * thickness, 0.05] },
        station: None,
    }
}

#[test]
fn a_wall_between_two_samples_is_seen() {
    let mut cell = cell();
    cell.loaded_effectors.clear();
    cell.clearance = 1e-6;
    // A pin on the first link, of a millimetre.
    cell.bodies.push(Body {
        name: "pin".into(),
        parent: ParentFrame::Link { arm: 0, link: 0 },
        parent_from_shape: Pose::identity(),
        shape: Shape::Capsule { ends: [[0.25, 0.0, -0.01], [0.25, 0.0, 0.01]], radius: 5e-4 },
        station: None,
    });
    let motion = turn(&cell);
    let link = |t: f64| {
        let chain = cell.robot.forward(&motion.sample_at(t).positions).unwrap();
        let link = chain.base_from_link[0][0];
        (link.translation.vector, link.rotation * Vector3::x())
    };
    // In the middle between the samples 0.40 s and 0.41 s of a hundred a second, where the pin moves millimetres a sample.
    let (joint, out) = link(0.405);
    let (_, before) = link(0.40);
    let (_, after) = link(0.41);
    let travel = 0.25 * before.angle(&after);
    assert!(travel > 4e-3, "{travel}");
    let along = Rotation3::from_axis_angle(&Vector3::z_axis(), out.y.atan2(out.x));
    let place = joint + out * 0.25;
    cell.bodies.push(Body {
        name: "sheet".into(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::from_parts(Translation3::from(place), along),
        shape: Shape::Box { half: [0.02, 2e-4, 0.05] },
        station: None,
    });
    let report = check(&cell, &motion, &CheckOptions { rate: 100.0, report_distance: 0.05 });
    let hit = &report.violations[0];
    assert_eq!(
        (hit.kind, names(&cell, &hit.entities)),
        (ViolationKind::Collision, vec!["pin".to_string(), "sheet".to_string()])
    );
    assert!(hit.start > 0.4 && hit.start < 0.41, "{}", hit.start);
    let text = hit.describe(&cell);
    assert!(text.contains("pin and sheet collide"), "{text}");
    assert_eq!(
        kinds(&report),
        BTreeSet::from([ViolationKind::Collision]),
        "no sample is near enough itself"
    );
    // Next to the path, nothing collides.
    cell.bodies[1].parent_from_shape.translation.vector += out * 0.03;
    let report = check(&cell, &motion, &CheckOptions { rate: 4000.0, report_distance: 0.05 });
    assert_eq!(report.result, CheckResult::Passed, "{:#?}", report.violations);
    let nearest = &report.distances[0];
    assert!((nearest.distance - 9.5e-3).abs() < 2e-4, "{}", nearest.distance);
}

/// In along a straight line, a turn, and down while tilting.
fn in_round_and_down(cell: &Cell) -> Trajectory {
    let from = vec![0.5, 0.5, 0.5, 0.3, 0.9];
    let mut target = WaferTarget::from_pose(&cell.wafer_pose(A, &from, true).unwrap());
    let out = (target.center.xy()).push(0.0).normalize();
    target.center -= out * 0.3;
    let reached = cell.compensated_inverse(A, &target, true, &from).unwrap().positions;
    let mut turned = reached.clone();
    turned[T] -= 0.8;
    let mut lower = turned.clone();
    for (rod, by) in [0.02, 0.022, 0.018].into_iter().enumerate() {
        lower[rod] -= by;
    }
    lower[T] += 0.1;
    let line = Step { path: Path::Line(A), ..step(0, &from, &reached) };
    let steps = vec![line, step(1, &reached, &turned), step(2, &turned, &lower)];
    plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap()
}

#[test]
fn least_distances_are_those_of_all_samples() {
    let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]);
    let mut random = || generator.random::<f64>();
    let mut cell = cell();
    cell.loaded_effectors.clear();
    cell.clearance = 0.0;
    let motion = in_round_and_down(&cell);
    // Of each step from its start on, and at its end.
    let times = motion.times.windows(2).flat_map(|step| {
        let whole = ((step[1] - step[0]) * 1000.0).floor() as usize;
        (0..=whole).map(|k| step[0] + 1e-3 * k as f64).chain([step[1]])
    });
    let samples: Vec<_> = times.map(|time| motion.sample_at(time)).collect();
    let chains: Vec<_> =
        samples.iter().map(|sample| cell.robot.forward(&sample.positions).unwrap()).collect();
    let (radius, place) = (0.01, [0.05, 0.08, 0.0]);
    let balls: Vec<Vector3<f64>> = chains
        .iter()
        .map(|chain| (chain.base_from_link[0][2] * nalgebra::Point3::from(place)).coords)
        .collect();
    let mut followed = [0; 3];
    for round in 0..600 {
        // Long and thin, as walls are, near a part of the path and often along it.
        let near = balls[(random() * balls.len() as f64) as usize % balls.len()];
        let half = [0.02 + 0.4 * random(), 0.002 + 0.05 * random(), 0.01 + 0.1 * random()];
        let spin = 6.3 * random();
        let tilt = if round % 2 == 0 { 0.0 } else { random() };
        let turn = Rotation3::from_euler_angles(tilt, 0.3 * tilt, spin);
        let off = turn * Vector3::new(0.0, half[1] + 0.06 * random(), 0.0);
        let base_from_wall = Pose::from_parts((near + off).into(), turn);
        let (parent, frames): (ParentFrame, Vec<Pose>) = match round % 3 {
            0 => (ParentFrame::World, vec![Pose::identity(); samples.len()]),
            1 => {
                let platforms = chains.iter().map(|chain| chain.platform.base_from_platform);
                (ParentFrame::Platform, platforms.collect())
            }
            _ => {
                let links = chains.iter().map(|chain| chain.base_from_link[0][0]);
                (ParentFrame::Link { arm: 0, link: 0 }, links.collect())
            }
        };
        let middle = (random() * samples.len() as f64) as usize % samples.len();
        let parent_from_shape = frames[middle].inverse() * base_from_wall;
        let ball = Shape::Capsule { ends: [place, place], radius };
        let body = |name: &str, parent, parent_from_shape, shape| Body {
            name: name.into(),
            station: None,
            parent,
            parent_from_shape,
            shape,
        };
        cell.bodies = vec![
            body("ball", ParentFrame::Link { arm: 0, link: 2 }, Pose::identity(), ball),
            body("wall", parent, parent_from_shape, Shape::Box { half }),
        ];
        // Of a point and a box.
        let apart = |(ball, frame): (&Vector3<f64>, &Pose)| {
            let at = (frame * parent_from_shape).inverse() * nalgebra::Point3::from(*ball);
            let beyond = |k: usize| (at[k].abs() - half[k]).max(0.0);
            (Vector3::new(beyond(0), beyond(1), beyond(2)).norm() - radius).max(0.0)
        };
        let least = balls.iter().zip(&frames).map(apart).fold(f64::INFINITY, f64::min);
        let report = check(&cell, &motion, &CheckOptions::default());
        let found = report
            .distances
            .iter()
            .find(|row| names(&cell, &row.entities).contains(&"wall".to_string()));
        let Some(found) = found else {
            assert!(
                least >= CheckOptions::default().report_distance - 1e-9,
                "{round}: {least} is not reported"
            );
            continue;
        };
        followed[round % 3] += usize::from(least > 1e-3);
        assert!(found.distance >= least - 1e-8, "{round}: {} below {least}", found.distance);
        assert!(
            found.distance - found.tolerance <= least + 1e-8,
            "{round}: {} within {}, but {least}",
            found.distance,
            found.tolerance
        );
    }
    assert!(followed.iter().all(|&count| count > 40), "{followed:?}");
}

/// Rows of a droop that varies with the reach, by drop or by slope.
fn waves(drop: f64, slope: f64) -> Droop {
    let row = |k: u32| {
        let up = f64::from(k % 2);
        let (reach, drop, slope) = (0.05 * f64::from(k), drop * up, slope * up);
        DroopRow {
            reach,
            empty_drop: drop,
            empty_slope: slope,
            loaded_drop: drop,
            loaded_slope: slope,
            load: 1.0,
        }
    };
    Droop::Table { rows: (0..20).map(row).collect() }
}

#[test]
fn least_distances_are_those_of_all_samples_however_steep_the_droop() {
    let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut random = || generator.random::<f64>();
    let mut cell = cell();
    cell.clearance = 0.0;
    let positions = [[-0.4, 1.1], [0.2, 0.25], [0.9, 0.6]].map(|[t, r]| [0.5, 0.5, 0.5, t, r]);
    let steps = positions.windows(2).map(|pair| step(0, &pair[0], &pair[1])).collect();
    let motion = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
    let times: Vec<f64> =
        (0..).map(|k| 4e-3 * f64::from(k)).take_while(|&t| t < motion.duration()).collect();
    let options = CheckOptions::default();
    // The same cell at each of these moments, with nothing between them.
    let still = |cell: &Cell, time: f64| {
        let at = motion.sample_at(time).positions;
        let wait = Step { path: Path::Dwell(0.0), ..step(0, &at, &at) };
        let motion = plan_trajectory(cell, vec![wait], &TrajectoryOptions::default()).unwrap();
        check(cell, &motion, &options).distances.first().map(|row| row.distance)
    };
    let mut followed = 0;
    for round in 0..40 {
        cell.robot.arms[0].droop =
            if round % 2 == 0 { waves(0.012, 0.0) } else { waves(0.0, 0.04) };
        let time = times[(random() * times.len() as f64) as usize % times.len()];
        let wafer = cell.wafer_pose(A, &motion.sample_at(time).positions, true).unwrap();
        let off = Vector3::new(0.28 * (random() - 0.5), 0.28 * (random() - 0.5), 0.0);
        let below = off - Vector3::z() * (0.001 + 0.03 * random());
        cell.bodies = vec![Body {
            name: "post".into(),
            parent: ParentFrame::World,
            parent_from_shape: Pose::from_parts(
                (wafer.translation.vector + below).into(),
                Rotation3::identity(),
            ),
            shape: Shape::Box { half: [0.005 + 0.05 * random(), 0.005, 2e-4] },
            station: None,
        }];
        let least =
            times.iter().filter_map(|&time| still(&cell, time)).fold(f64::INFINITY, f64::min);
        let report = check(&cell, &motion, &options);
        let Some(found) = report.distances.first() else {
            assert!(least >= options.report_distance - 1e-9, "{round}: {least} is not reported");
            continue;
        };
        followed += usize::from(least > 1e-3 && least < 0.9 * options.report_distance);
        let at_least = found.distance - found.tolerance;
        assert!(
            at_least <= least + 1e-8,
            "{round}: {} within {}, but {least}",
            found.distance,
            found.tolerance
        );
    }
    assert!(followed > 10, "{followed}");
}

#[test]
fn bodies_too_near_touching_allowed_and_zones() {
    let fixed = cell();
    let thick = |cell: &mut Cell| cell.bodies.push(wall("wall", &fixed, 0.9, 0.6, 0.01));
    let report = breaks(thick, ViolationKind::Collision, "wafer of A and wall collide");
    assert!(report.violations[0].worst < 0.0);
    assert!(report.by_instruction[0].nearest.as_ref().unwrap().distance == 0.0);
    // Above the wafer by half of the clearance.
    let above = |cell: &mut Cell| {
        let mut body = wall("lamp", &fixed, 0.9, 0.6, 0.01);
        body.parent_from_shape.translation.vector.z += 0.05 + 775e-6 + 5e-4;
        cell.bodies.push(body);
    };
    let report = breaks(above, ViolationKind::Clearance, "comes within 0.000500 m of lamp");
    assert!((report.distances[0].distance - 5e-4).abs() < 1e-7);
    let zone = |rule, name: &str, shape, pose| Zone {
        name: name.into(),
        rule,
        base_from_shape: pose,
        shape,
    };
    let body = wall("", &fixed, 0.9, 0.6, 0.01);
    let keep_out = zone(ZoneRule::KeepOut, "door", body.shape, body.parent_from_shape);
    breaks(|cell| cell.zones.push(keep_out), ViolationKind::KeepOut, "is in keep-out zone door");
    let safe = zone(ZoneRule::Safe, "yard", Shape::Box { half: [0.2; 3] }, at(0.0, 0.0, 0.6));
    let hall = zone(ZoneRule::Safe, "hall", Shape::Box { half: [5.0; 3] }, at(0.0, 0.0, 0.6));
    let one = |cell: &mut Cell| cell.zones.push(safe.clone());
    let report = breaks(one, ViolationKind::SafeZone, "outside safe zone yard");
    assert!(report.violations.iter().all(|one| one.instruction == 0), "only while it turns");
    // Each safe zone is a condition of its own: a larger one around it does not replace it.
    let both = |cell: &mut Cell| cell.zones.extend([hall, safe.clone()]);
    let report = breaks(both, ViolationKind::SafeZone, "outside safe zone yard");
    assert!(report.violations.iter().all(|one| one.entities.contains(&EntityId::Zone(1))));
    // Two bodies of the robot that may touch.
    let mut cell = cell();
    let block = |name: &str, parent| Body {
        name: name.into(),
        parent,
        parent_from_shape: Pose::identity(),
        shape: Shape::Cylinder { radius: 0.3, half_height: 0.2 },
        station: None,
    };
    cell.bodies.push(block("base", ParentFrame::Platform));
    cell.bodies.push(block("hand", ParentFrame::Link { arm: 0, link: 1 }));
    let motion = turn(&cell);
    let report = check(&cell, &motion, &CheckOptions::default());
    assert!(kinds(&report).contains(&ViolationKind::Collision));
    cell.allowed_pairs.push([1, 0]);
    cell.loaded_effectors.clear();
    let report = check(&cell, &motion, &CheckOptions::default());
    assert_eq!(report.result, CheckResult::Passed, "{:#?}", report.violations);
}

/// Into slot 2 of three, up with its wafer, and out.
fn get(cell: &mut Cell, pitch: f64) -> Trajectory {
    let from = vec![0.5, 0.5, 0.5, 0.3, 0.9];
    let start = cell.wafer_pose(A, &from, false).unwrap();
    let out = (start.rotation * Vector3::x()).xy().push(0.0).normalize();
    let place = start.translation.vector + out * 0.1 + Vector3::new(0.0, 0.0, 0.002);
    let base_from_station = Pose::from_parts(
        Translation3::from(place - Vector3::new(0.0, 0.0, pitch)),
        Rotation3::identity(),
    );
    let slot = SlotId { station: 0, slot: 2 };
    cell.loaded_effectors.clear();
    cell.stations = vec![Station {
        slots: 3,
        pitch,
        retract_reach: 0.3,
        ..common::station("port", base_from_station)
    }];
    cell.occupied = (1..=3).map(|slot| SlotId { station: 0, slot }).collect();
    let up = |height: f64, near: &[f64]| {
        let center = place + Vector3::new(0.0, 0.0, height);
        let target = WaferTarget { center, normal: Vector3::z(), heading: None };
        cell.compensated_inverse(A, &target, false, near).unwrap().positions
    };
    let below = up(-0.002, &from);
    let rest = up(0.0, &below);
    let above = up(0.002, &rest);
    let mut out = from.clone();
    for rod in 0..3 {
        out[rod] += above[rod] - below[rod];
    }
    let line = |from: &[f64], to: &[f64], phase, handoff, loaded: bool| Step {
        phase,
        path: Path::Line(A),
        handoff,
        loaded: if loaded { vec![A] } else { Vec::new() },
        slot: Some(slot),
        ..step(0, from, to)
    };
    let steps = vec![
        line(&from, &below, Phase::Extend, None, false),
        line(&below, &rest, Phase::Lift, Some(Handoff::Picked(A, slot)), false),
        line(&rest, &above, Phase::Lift, None, true),
        line(&above, &out, Phase::Retract, None, true),
    ];
    plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap()
}

#[test]
fn a_slot_is_reached_into_with_the_clearance_of_slots() {
    let mut cell = cell();
    cell.clearance = 0.02;
    cell.slot_clearance = 0.001;
    // A thin blade under the wafer, on the last link.
    let blade = Shape::Box { half: [0.1, 0.02, 0.0002] };
    cell.bodies.push(Body {
        name: "blade".into(),
        parent: ParentFrame::Link { arm: 0, link: 2 },
        parent_from_shape: at(0.2, 0.0, 0.005 - 0.0002),
        shape: blade,
        station: None,
    });
    let motion = get(&mut cell, 0.01);
    let report = check(&cell, &motion, &CheckOptions::default());
    assert_eq!(report.result, CheckResult::Passed, "{:#?}", report.violations);
    let distance = |pair: [&str; 2]| {
        let row = report.distances.iter().find(|row| names(&cell, &row.entities) == pair);
        row.map(|row| row.distance).unwrap()
    };
    // Up by the stroke, the wafer is its own thickness nearer to the one above.
    let above = distance(["wafer of port 2", "wafer of port 3"]);
    assert!((above - (0.01 - 0.002 - 775e-6)).abs() < 1e-4, "{above}");
    let under = distance(["blade", "wafer of port 1"]);
    assert!((under - (0.01 - 0.002 - 0.0004 - 775e-6)).abs() < 1e-4, "{under}");
    // Slots that lie too close.
    let motion = get(&mut cell, 0.0037);
    let report = check(&cell, &motion, &CheckOptions::default());
    assert_eq!(
        kinds(&report),
        BTreeSet::from([ViolationKind::SlotClearance]),
        "{:#?}",
        report.violations
    );
    let concerned = report.violations.iter().flat_map(|one| names(&cell, &one.entities));
    let names: BTreeSet<String> = concerned.collect();
    assert!(names.contains("wafer of port 2") && names.contains("blade"), "{names:?}");
    assert!(
        report.violations[0].describe(&cell).contains("the required slot clearance is 0.001000 m")
    );
}

/// A blade on the last link, and a bar under it that reaches so deep into it where the loaded arm deflects (m).
fn blade_and_bar(cell: &mut Cell, positions: &[f64], deep: f64) {
    cell.robot.arms[0].droop = Droop::Cantilever { stiffness: 500.0, mass_per_length: 2.5 };
    cell.clearance = 1e-4;
    let half = [0.1, 0.02, 0.001];
    // Under the wafer, which rests on its upper face.
    let center = cell.robot.arms[0].effectors[0].wafer_center;
    let blade = at(center[0], center[1], center[2] - half[2]);
    cell.bodies.push(Body {
        name: "blade".into(),
        parent: ParentFrame::Link { arm: 0, link: 2 },
        parent_from_shape: blade,
        shape: Shape::Box { half },
        station: None,
    });
    // The droop by its formulas, about the horizontal across the reach; the platform is level.
    let rigid = cell.robot.forward(positions).unwrap();
    let wafer = rigid.base_from_wafer[0][0];
    let mount = cell.robot.arms[0].mount;
    let joint = (rigid.platform.base_from_platform * nalgebra::Point3::from(mount)).coords;
    let out = (wafer.translation.vector - joint).xy();
    let (l, own, tip) = (out.norm(), 2.5 * GRAVITY, cell.wafer.mass() * GRAVITY);
    let drop = (own * l.powi(4) / 8.0 + tip * l.powi(3) / 3.0) / 500.0;
    let slope = (own * l.powi(3) / 6.0 + tip * l.powi(2) / 2.0) / 500.0;
    assert!(drop > 2.0 * deep, "{drop}");
    // Its underside is at 2 mm below the wafer's centre, the bar across the reach there.
    let along = Rotation3::from_axis_angle(&Vector3::z_axis(), out.y.atan2(out.x));
    let turn = along * Rotation3::from_axis_angle(&Vector3::y_axis(), slope);
    let below = wafer.translation.vector - Vector3::z() * drop;
    let thick = 0.004;
    let center = below + turn * Vector3::new(0.0, 0.0, -2.0 * half[2] + deep - thick);
    cell.bodies.push(Body {
        name: "bar".into(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::from_parts(center.into(), turn),
        shape: Shape::Box { half: [0.005, 0.3, thick] },
        station: None,
    });
}

#[test]
fn a_body_on_the_last_link_deflects_with_its_arm() {
    let positions = [0.5, 0.5, 0.5, 0.4, 0.9];
    for (deep, kind) in [(3e-4, Some(ViolationKind::Collision)), (-3e-4, None)] {
        let mut cell = cell();
        blade_and_bar(&mut cell, &positions, deep);
        let mut wait = step(0, &positions, &positions);
        wait.path = Path::Dwell(0.1);
        let motion = plan_trajectory(&cell, vec![wait], &TrajectoryOptions::default()).unwrap();
        let report = check(&cell, &motion, &CheckOptions::default());
        assert_eq!(kinds(&report), kind.into_iter().collect(), "{:#?}", report.violations);
        let found = report
            .distances
            .iter()
            .find(|row| names(&cell, &row.entities).contains(&"blade".to_owned()));
        let expected = (-deep).max(0.0);
        assert!((found.unwrap().distance - expected).abs() < 1e-6, "{found:?}");
    }
}

/// The turn, so slowly that it takes many windows of samples.
fn slow_turn(factor: f64) -> (Cell, Trajectory) {
    let mut cell = cell();
    for axis in &mut cell.robot.axes {
        for limits in [&mut axis.empty, &mut axis.loaded] {
            limits.velocity /= factor;
            limits.acceleration /= factor * factor;
            limits.jerk /= factor.powi(3);
        }
    }
    let motion = turn(&cell);
    (cell, motion)
}

#[test]
fn windows_of_samples_change_nothing() {
    // 44 s in each direction: three windows at 1000 samples a second, one at 100.
    let (mut cell, motion) = slow_turn(50.0);
    let length = motion.times[1];
    assert!(length > 35.0 && length < 60.0, "{length}");
    let wall = Shape::Box { half: [0.02, 0.02, 0.4] };
    let turned = |angle: f64| at(0.45 * angle.cos(), 0.45 * angle.sin(), 0.5);
    cell.bodies.push(Body {
        name: "post".into(),
        parent: ParentFrame::World,
        parent_from_shape: turned(0.6),
        shape: wall,
        station: None,
    });
    cell.zones.push(Zone {
        name: "zone".into(),
        rule: ZoneRule::KeepOut,
        base_from_shape: turned(0.5),
        shape: Shape::Box { half: [0.01, 0.01, 0.4] },
    });
    let [fine, coarse] = [1000.0, 100.0]
        .map(|rate| check(&cell, &motion, &CheckOptions { rate, ..CheckOptions::default() }));
    let samples = motion.times[1..].windows(2).map(|pair| pair[1] - pair[0]).chain([length]);
    let expected: usize = samples.map(|length| (1000.0 * length - 1e-3).ceil() as usize + 1).sum();
    assert_eq!(fine.samples, expected);
    assert!(!fine.violations.is_empty());
    // None is cut in two where windows meet, and none is lost.
    assert_eq!(fine.violations.len(), coarse.violations.len(), "{:#?}", fine.violations);
    let closely = |a: f64, b: f64, by: f64| assert!((a - b).abs() <= by, "{a} {b}");
    for (one, other) in fine.violations.iter().zip(&coarse.violations) {
        assert_eq!(
            (one.kind, &one.entities, one.instruction),
            (other.kind, &other.entities, other.instruction)
        );
        closely(one.start, other.start, 0.011);
        closely(one.end, other.end, 0.011);
        closely(one.worst, other.worst, 1e-4);
        assert!(one.worst < 0.0, "{one:?}");
        // Longer than a window, so that it spans a border.
    }
    for (one, other) in fine.distances.iter().zip(&coarse.distances) {
        closely(one.distance, other.distance, one.tolerance + other.tolerance + 1e-6);
    }
    let peaks = |report: &Report| {
        let row = &report.by_instruction[0];
        [row.velocity, row.acceleration, row.jerk].map(|fraction| fraction.unwrap().ratio)
    };
    for (one, other) in peaks(&fine).into_iter().zip(peaks(&coarse)) {
        closely(one, other, 1e-4);
    }
}

#[test]
fn a_distance_is_compared_with_a_resolution() {
    let positions = [0.5, 0.5, 0.5, 0.4, 0.9];
    let of = |missing: f64| {
        let mut cell = cell();
        cell.clearance = 3e-3;
        let wafer = cell.wafer_pose(A, &positions, true).unwrap().translation.vector;
        let above = 775e-6 + 3e-3 - missing + 0.01;
        cell.bodies.push(Body {
            name: "lamp".into(),
            parent: ParentFrame::World,
            parent_from_shape: at(wafer.x, wafer.y, wafer.z + above),
            shape: Shape::Box { half: [0.02, 0.02, 0.01] },
            station: None,
        });
        let mut wait = step(0, &positions, &positions);
        wait.path = Path::Dwell(0.1);
        let motion = plan_trajectory(&cell, vec![wait], &TrajectoryOptions::default()).unwrap();
        let report = check(&cell, &motion, &CheckOptions::default());
        (cell, report)
    };
    for missing in [-1e-7, 0.0, 1e-10, 5e-9] {
        let (_, report) = of(missing);
        assert_eq!(report.result, CheckResult::NoMotion, "{missing}: {:#?}", report.violations);
    }
    for missing in [2e-8, 1e-7, 1e-5] {
        let (cell, report) = of(missing);
        let [violation] = &report.violations[..] else { panic!("{missing}: {report:#?}") };
        assert_eq!(violation.kind, ViolationKind::Clearance);
        // The two numbers of the message differ.
        let message = violation.message(&cell);
        let numbers: Vec<&str> =
            message.split(' ').filter(|word| word.starts_with("0.00")).collect();
        assert!(numbers.len() == 2 && numbers[0] != numbers[1], "{message}");
    }
}

#[test]
fn a_pose_that_is_lost_between_two_samples_is_reported() {
    let mut cell = cell();
    cell.clearance = 1e-3;
    let half = std::f64::consts::FRAC_PI_2;
    let from = [0.5, 0.5, 0.5, 0.0, half - 0.031];
    let to = [0.5, 0.5, 0.5, 0.0, half + 0.05];
    let motion =
        plan_trajectory(&cell, vec![step(0, &from, &to)], &TrajectoryOptions::default()).unwrap();
    let mount = cell.robot.arms[0].mount;
    let wafer = |positions: &[f64]| {
        let pose = cell.robot.forward(positions).unwrap();
        let joint = pose.platform.base_from_platform * nalgebra::Point3::from(mount);
        (joint.coords, pose.base_from_wafer[0][0].translation.vector)
    };
    let reach = |positions: &[f64]| {
        let (joint, center) = wafer(positions);
        (center - joint).xy().norm()
    };
    // A droop that is known for all samples, but not for the farthest reach between two of them.
    let options = CheckOptions { rate: 100.0, report_distance: 0.05 };
    let known = motion.samples(options.rate).map(|sample| reach(&sample.positions));
    let known = known.fold(0.0, f64::max);
    let mut farthest = from;
    farthest[4] = half;
    let (joint, center) = wafer(&farthest);
    assert!(reach(&farthest) > known + 5e-9, "{} {known}", reach(&farthest));
    let row = |reach: f64| DroopRow {
        reach,
        empty_drop: 0.0,
        empty_slope: 0.0,
        loaded_drop: 0.0,
        loaded_slope: 0.0,
        load: 1.0,
    };
    // Ahead of the wafer by hardly more than is asked for.
    let out = (center - joint).xy().normalize();
    let wall = center + Vector3::new(out.x, out.y, 0.0) * (0.15 + cell.clearance + 1e-8 + 0.01);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), out.y.atan2(out.x));
    cell.bodies.push(Body {
        name: "wall".into(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::from_parts(wall.into(), turn),
        shape: Shape::Box { half: [0.01, 0.2, 0.1] },
        station: None,
    });
    let report = check(&cell, &motion, &options);
    assert_eq!(report.result, CheckResult::Passed, "{:#?}", report.violations);
    cell.robot.arms[0].droop = Droop::Table { rows: vec![row(0.0), row(known)] };
    let report = check(&cell, &motion, &options);
    assert_eq!(kinds(&report), BTreeSet::from([ViolationKind::Droop]), "{:#?}", report.violations);
    assert!(report.violations[0].describe(&cell).contains("droop at a reach of"));
}

#[test]
fn a_keep_out_zone_reports_the_penetration_depth() {
    // The wafer's flat disc over a box that ends 3 mm above its lower face: up is the shortest separation.
    let mut cell = cell();
    cell.wafer.thickness = 1e-3;
    let motion = turn(&cell);
    let from = motion.steps[0].from.clone();
    let pose = cell.wafer_pose(A, &from, true).unwrap();
    let place = pose.translation.vector;
    cell.zones.push(Zone {
        name: "low".into(),
        rule: ZoneRule::KeepOut,
        base_from_shape: at(place.x, place.y, place.z + 3e-3 - 0.2),
        shape: Shape::Box { half: [0.4, 0.4, 0.2] },
    });
    cell.loaded_effectors = vec![A];
    let report = check(&cell, &motion, &CheckOptions::default());
    let found = report.violations.iter().find(|one| one.kind == ViolationKind::KeepOut).unwrap();
    // Its thickness adds to the separation downwards; it has no tilt.
    assert!((found.worst + 3e-3).abs() < 2e-5, "{found:?}");
    assert!(found.message(&cell).contains("penetration depth"), "{}", found.message(&cell));
}

#[test]
fn the_far_end_of_a_long_body_changes_no_distance() {
    // A bar from a joint outward past a post: 100 m of it are as near to the post as 3 m.
    let bar = |length: f64| {
        let mut cell = cell();
        let motion = turn(&cell);
        cell.clearance = 0.002;
        cell.bodies.push(Body {
            name: "bar".into(),
            parent: ParentFrame::Link { arm: 0, link: 2 },
            parent_from_shape: at(0.5 * length, 0.0, 0.0),
            shape: Shape::Box { half: [0.5 * length, 0.005, 0.005] },
            station: None,
        });
        for (name, angle, z) in [("post", 0.6_f64, 0.0), ("low", 0.9, 0.03)] {
            let pose = cell.robot.forward(&motion.steps[0].from).unwrap();
            let height = pose.base_from_link[0][2].translation.vector.z;
            cell.bodies.push(Body {
                name: name.into(),
                parent: ParentFrame::World,
                parent_from_shape: at(1.2 * angle.cos(), 1.2 * angle.sin(), height - 0.1 - z),
                shape: Shape::Box { half: [0.02, 0.02, 0.1] },
                station: None,
            });
        }
        check(&cell, &motion, &CheckOptions::default())
    };
    let [long, short] = [100.0, 3.0].map(bar);
    assert!(!short.violations.is_empty() && !short.distances.is_empty());
    let listed = |report: &Report| -> Vec<(ViolationKind, Vec<EntityId>, usize)> {
        let one =
            |v: &jointplay_cell::check::Violation| (v.kind, v.entities.clone(), v.instruction);
        report.violations.iter().map(one).collect()
    };
    assert_eq!(listed(&long), listed(&short));
    for (one, other) in long.violations.iter().zip(&short.violations) {
        assert!((one.start - other.start).abs() < 2e-3 && (one.end - other.end).abs() < 2e-3);
        assert!((one.worst - other.worst).abs() < 1e-4, "{one:?} {other:?}");
    }
    for one in &short.distances {
        let other = long.distances.iter().find(|other| other.entities == one.entities).unwrap();
        assert!((one.distance - other.distance).abs() <= one.tolerance + other.tolerance + 1e-9);
    }
}
