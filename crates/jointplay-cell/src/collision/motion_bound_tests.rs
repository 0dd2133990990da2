//! Motion bounds against motions: no point travels farther between two samples than its bound.

#[path = "../../tests/common/mod.rs"]
mod common;

use common::{A, KINDS, kind};
use jointplay_core::gpr::{AxisHeight, Gpr, Limits};
use jointplay_core::spatial::{Pose, Tilt};
use jointplay_core::virtualization::{BuiltIn, SolveOptions, Solver};
use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};

use super::deflection_coefficients::DeflectionCoefficients;
use super::link_poses::LinkPoses;
use super::motion_bound::{DisplacementBound, MotionBoundModel};
use super::motion_bound_coefficients::{MotionBoundCoefficients, common_ancestor};
use super::object::Parent;
use super::sample_windows::SampleWindows;
use super::sampled_step::SampledStep;
use super::scene::Scene;
use crate::EntityId;
use crate::geometry::{ColliderCache, Shape};
use crate::program::Step;
use crate::robot::{AxisKind, PlanarMotions, PlatformModel, RODS};
use crate::trajectory::{Sample, Trajectory, TrajectoryOptions, joint_space_line, plan_trajectory};
use crate::wafer::{Droop, DroopRow};
use crate::workcell::{Body, Cell, ParentFrame};

/// Parts of an interval of which the path of a point is added up.
const PARTS: u32 = 6;

fn vector(random: &mut TestRng, size: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.random_range(-size..size))
}

fn droop(random: &mut TestRng, which: usize) -> Droop {
    let row = |k: u32, random: &mut TestRng| DroopRow {
        reach: 0.15 * f64::from(k),
        empty_drop: random.random_range(-0.002..0.004),
        empty_slope: random.random_range(-0.004..0.008),
        loaded_drop: random.random_range(-0.002..0.006),
        loaded_slope: random.random_range(-0.004..0.01),
        load: 1.0,
    };
    match which % 3 {
        0 => Droop::Cantilever {
            stiffness: random.random_range(150.0..1500.0),
            mass_per_length: random.random_range(0.5..3.0),
        },
        1 => Droop::Table { rows: (0..14).map(|k| row(k, random)).collect() },
        _ => Droop::Rigid,
    }
}

/// A robot of any kind and model, with a body on every link, and how far it may tilt.
fn cell(random: &mut TestRng, round: usize) -> (Cell, f64) {
    let lengths = [0.0; 3].map(|_| random.random_range(0.15..0.3));
    let mut robot = kind(round % KINDS, lengths);
    let models = [BuiltIn::Planar, BuiltIn::Radial, BuiltIn::Polar, BuiltIn::Offset];
    let solver = [Solver::ClosedForm, Solver::Newton][round / 4 % 2];
    let options = SolveOptions { solver, ..SolveOptions::default() };
    let model = PlatformModel { virtualization: models[round % 4], options };
    let steep = if model.virtualization == BuiltIn::Planar { 0.9 } else { 0.15 };
    let tilt_max = random.random_range(0.01..steep);
    // Base points and sockets deviate at random from regular triangles.
    let mut limbs = robot.gpr.limbs();
    for limb in &mut limbs {
        limb.base_point.x += random.random_range(-0.003..0.003);
        limb.base_point.y += random.random_range(-0.003..0.003);
        limb.socket_radius += random.random_range(-0.001..0.001);
    }
    let limits = Limits { tilt_max, ..*robot.gpr.limits() };
    robot.gpr = Gpr::new(limbs, limits, robot.gpr.working_height()).unwrap();
    robot.model = model;
    for arm in &mut robot.arms {
        arm.droop = droop(random, round / 2);
    }
    let mut cell = common::cell(robot);
    if round.is_multiple_of(3) {
        cell.loaded_effectors.clear();
    }
    let parents = cell.robot.arms.iter().enumerate().flat_map(|(arm, described)| {
        (0..described.joints.len()).map(move |link| ParentFrame::Link { arm, link })
    });
    let parents: Vec<ParentFrame> = parents.chain([ParentFrame::Platform]).collect();
    for (k, parent) in parents.into_iter().enumerate() {
        let turn = Rotation3::new(vector(random, 2.0));
        cell.bodies.push(Body {
            name: format!("body {k}"),
            parent,
            parent_from_shape: Pose::from_parts(vector(random, 0.25).into(), turn),
            shape: Shape::Box { half: [0.0; 3].map(|_| random.random_range(0.01..0.1)) },
            station: None,
        });
    }
    (cell, tilt_max)
}

fn positions(random: &mut TestRng, cell: &Cell, tilt_max: f64) -> Vec<f64> {
    let axes = &cell.robot.axes;
    let mut all: Vec<f64> =
        axes.iter().map(|axis| random.random_range(0.9 * axis.min..0.9 * axis.max)).collect();
    let tilt =
        Tilt { azimuth: random.random_range(-3.0..3.0), angle: random.random_range(0.0..tilt_max) };
    let height = AxisHeight(random.random_range(0.45..0.55));
    all[..RODS].copy_from_slice(&cell.robot.gpr.inverse(tilt, height).unwrap());
    all
}

fn motion(random: &mut TestRng, cell: &Cell, tilt_max: f64, round: usize) -> Trajectory {
    let from = positions(random, cell, tilt_max);
    let mut to = positions(random, cell, tilt_max);
    // Rods, motors, or all; a little or far.
    let fraction = [1.0, 0.1][round % 2];
    for (axis, (from, to)) in from.iter().zip(&mut to).enumerate() {
        let stays = [false, axis < RODS, axis >= RODS][round / 2 % 3];
        *to = if stays { *from } else { from + fraction * (*to - from) };
    }
    let step = Step { loaded: cell.loaded_effectors.clone(), ..common::step(0, &from, &to) };
    if round.is_multiple_of(5) {
        joint_space_line(step)
    } else {
        plan_trajectory(cell, vec![step], &TrajectoryOptions::default()).unwrap()
    }
}

#[test]
fn no_point_travels_farther_than_its_bound() {
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[11; 32]);
    let mut tightest = 0.0_f64;
    let (mut intervals, mut steepest) = (0, 0.0_f64);
    for round in 0..240 {
        let (cell, tilt_max) = cell(&mut random, round);
        let motion = motion(&mut random, &cell, tilt_max, round);
        let mut cache = ColliderCache::default();
        cache.begin();
        let scene = Scene::new(&cell, &mut cache);
        let bounds = MotionBoundModel::new(&cell.robot);
        let mut sampled = SampledStep::default();
        let samples = SampleWindows::new(&motion, 0, 200.0);
        sampled.begin(&motion, 0, 0, &samples, &bounds);
        let count = sampled.times().len();
        if count < 2 {
            continue;
        }
        // Corners of the bodies, and edges of the wafer, each on its parent.
        let points: Vec<(usize, Vector3<f64>)> = (0..scene.objects.len())
            .map(|object| {
                let corner = match scene.objects[object].entity {
                    EntityId::Body(body) => Some(&cell.bodies[body]),
                    _ => None,
                };
                let point = match corner {
                    Some(body) => {
                        let Shape::Box { half } = body.shape else { unreachable!() };
                        let corner =
                            half.map(|half| if random.random::<bool>() { half } else { -half });
                        (body.parent_from_shape * Point3::from(corner)).coords
                    }
                    None => {
                        let angle = random.random_range(0.0..6.3_f64);
                        Vector3::new(0.15 * angle.cos(), 0.15 * angle.sin(), 0.0)
                    }
                };
                (object, point)
            })
            .collect();
        for _ in 0..6 {
            let from = random.random_range(0..count - 1);
            let to = (from + random.random_range(1..6)).min(count - 1);
            let [start, end] = [from, to].map(|sample| sampled.times()[sample]);
            let states = (0..=PARTS * (to - from) as u32).map(|part| {
                let fraction = f64::from(part) / f64::from(PARTS * (to - from) as u32);
                let mut sample = Sample::default();
                motion.write_sample_in_step(0, start + fraction * (end - start), &mut sample);
                scene.link_poses(&sample.positions, Vec::new())
            });
            // A model that does not converge somewhere has no pose there, which the check reports.
            let states: Result<Vec<_>, _> = states.collect();
            let Ok(states) = states else { continue };
            let travel = sampled.axis_travel(&(from..to));
            intervals += 1;
            let turned: f64 =
                states.windows(2).map(|two| (two[1].normal - two[0].normal).norm()).sum();
            assert!(turned <= travel.normal_rotation * (1.0 + 1e-9) + 1e-12, "{round}: {turned}");
            steepest = states.iter().map(|it| it.normal.z.acos()).fold(steepest, f64::max);
            let world = |object: usize, point: &Vector3<f64>, state: &LinkPoses| {
                let pose = scene.collider_at(object, state).base_from_parent;
                (pose * Point3::from(*point)).coords
            };
            let path = |at: &dyn Fn(&LinkPoses) -> Vector3<f64>| -> f64 {
                states.windows(2).map(|two| (at(&two[1]) - at(&two[0])).norm()).sum()
            };
            let ends = [&states[0], &states[states.len() - 1]];
            // By the reaches of the arms in the interval.
            let deflection_of = |coefficients: &MotionBoundCoefficients| -> f64 {
                let of_arm = |of_arm: &DeflectionCoefficients| {
                    let [first, last] = ends.map(|state| scene.reach(of_arm.effector(), state));
                    of_arm.in_interval(&cell, first.max(last), travel.paths()).total
                };
                coefficients.deflections.iter().flatten().map(of_arm).sum()
            };
            for (object, point) in &points {
                let one = &scene.objects[*object];
                let coefficients =
                    MotionBoundCoefficients::new(&cell, one, one.collider.bounding_radius());
                let deflection = deflection_of(&coefficients);
                let largest = bounds.displacement(&coefficients, &travel);
                assert!(deflection <= largest.deflection * (1.0 + 1e-12), "{round}");
                let bound = largest.total() - largest.deflection + deflection;
                let travelled = path(&|state| world(*object, point, state));
                assert!(
                    travelled <= bound * (1.0 + 1e-9) + 1e-12,
                    "{round}, {:?}: {travelled} above {bound}",
                    scene.objects[*object].entity
                );
                tightest = tightest.max(travelled / bound.max(1e-12));
                // Relative to the common ancestor.
                for (other, with) in &points {
                    let [one, two] = [*object, *other].map(|object| &scene.objects[object]);
                    if one.parent == two.parent {
                        continue;
                    }
                    let parent = common_ancestor(&cell.robot, one, two);
                    if parent == Parent::World {
                        continue;
                    }
                    let both =
                        [one, two].map(|object| (&**object, object.collider.bounding_radius()));
                    let coefficients = MotionBoundCoefficients::relative(&cell, both, parent);
                    let DisplacementBound { arms, platform_deflection, .. } =
                        bounds.displacement(&coefficients, &travel);
                    let deflection = deflection_of(&coefficients);
                    let bound = arms + deflection + platform_deflection;
                    let travelled = path(&|state| {
                        let apart = world(*other, with, state) - world(*object, point, state);
                        scene.rotation_of(parent, state).inverse() * apart
                    });
                    assert!(
                        travelled <= bound * (1.0 + 1e-9) + 1e-12,
                        "{round}, {:?} and {:?}: {travelled} above {bound}",
                        one.entity,
                        two.entity
                    );
                }
            }
        }
    }
    assert!(intervals > 1000 && steepest > 0.5, "{intervals} {steepest}");
    // The bounds are of some use.
    assert!(tightest > 0.9, "{tightest}");
}

#[test]
fn columns_hold_the_states_of_all_axes_and_the_motions_of_all_wafers() {
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let (mut blended, mut compared) = (0, 0);
    for round in 0..120 {
        let (cell, tilt_max) = cell(&mut random, round);
        let stops: Vec<Vec<f64>> =
            (0..3).map(|_| positions(&mut random, &cell, tilt_max)).collect();
        let moves = |(k, ends): (usize, &[Vec<f64>])| Step {
            blend_radius: [0.0, 0.05][round % 2],
            ..common::step(k, &ends[0], &ends[1])
        };
        let steps: Vec<Step> = stops.windows(2).enumerate().map(moves).collect();
        let Ok(motion) = plan_trajectory(&cell, steps, &TrajectoryOptions::default()) else {
            continue;
        };
        blended += usize::from(motion.blend(0).is_some());
        let mut cache = ColliderCache::default();
        cache.begin();
        let scene = Scene::new(&cell, &mut cache);
        let bounds = MotionBoundModel::new(&cell.robot);
        let mut sampled = SampledStep::default();
        for step in 0..2 {
            let samples = SampleWindows::new(&motion, step, 70.0);
            sampled.begin(&motion, step, 0, &samples, &bounds);
            let axes = sampled.moving_axes();
            let states: Vec<_> = (0..cell.robot.axes.len())
                .map(|axis| axes.states_or_at_rest(axis, motion.steps[step].from[axis]))
                .collect();
            for (k, &time) in sampled.times().iter().enumerate() {
                let expected = motion.sample_in_step(step, time);
                for (axis, states) in states.iter().enumerate() {
                    let [position, velocity, acceleration, _] = states.at(k);
                    let found = [position, velocity, acceleration];
                    let expected = [
                        expected.positions[axis],
                        expected.velocities[axis],
                        expected.accelerations[axis],
                    ];
                    for (found, expected) in found.into_iter().zip(expected) {
                        assert!((found - expected).abs() < 1e-9, "{round}: {found} {expected}");
                    }
                }
                compared += 1;
            }
            for id in cell.robot.effectors() {
                let chain = scene.chain(id);
                let columns: Vec<[&[f64]; 3]> = chain
                    .axes()
                    .iter()
                    .map(|&axis| {
                        let [positions, velocities, accelerations, _] = states[axis].columns();
                        [positions, velocities, accelerations]
                    })
                    .collect();
                let PlanarMotions(motions) = chain.motions_in_wafer_frame(&columns);
                let heading = |pose: &Pose| pose.rotation[(1, 0)].atan2(pose.rotation[(0, 0)]);
                let nominal = heading(&chain.wafer_motion(&Default::default()).base_from_frame);
                for k in 0..sampled.times().len() {
                    let mut at = <[[f64; 4]; 3]>::default();
                    for (axis, columns) in columns.iter().enumerate() {
                        for order in 0..3 {
                            at[order][axis] = columns[order][k];
                        }
                    }
                    let expected = chain.wafer_motion(&at);
                    let turn = heading(&expected.base_from_frame) - nominal;
                    let to_wafer = Rotation3::new(-Vector3::z() * turn);
                    let vectors = [
                        expected.base_from_frame.translation.vector,
                        expected.velocity,
                        expected.acceleration,
                    ];
                    for (order, vector) in vectors.into_iter().enumerate() {
                        let expected = to_wafer * vector;
                        let found = [motions[2 * order][k], motions[2 * order + 1][k]];
                        let error = (found[0] - expected.x).hypot(found[1] - expected.y);
                        assert!(error < 1e-10 * (1.0 + vector.norm()), "{round}: {error}");
                    }
                    let turned = (motions[6][k] - turn).rem_euclid(std::f64::consts::TAU);
                    assert!(turned.min(std::f64::consts::TAU - turned) < 1e-10, "{round}");
                    assert!((motions[7][k] - expected.angular_velocity.z).abs() < 1e-12);
                    assert!((motions[8][k] - expected.angular_acceleration.z).abs() < 1e-10);
                }
            }
        }
    }
    assert!(blended > 20 && compared > 2000, "{blended} {compared}");
}

#[test]
fn an_arm_over_its_own_joint_deflects_without_a_jump() {
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]);
    let (mut cell, _) = cell(&mut random, 0);
    cell.robot = kind(3, [0.2; 3]);
    cell.robot.arms[0].droop = droop(&mut random, 1);
    let slide = cell.robot.axes.iter().position(|axis| axis.name == "R").unwrap();
    assert_eq!(cell.robot.axes[slide].kind, AxisKind::Linear);
    let mut at: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
    let mut before: Option<Pose> = None;
    for k in 0..4000 {
        at[slide] = -0.45 + 1e-4 * f64::from(k);
        let wafer = cell.wafer_pose(A, &at, true);
        let Ok(wafer) = wafer else { continue };
        if let Some(before) = before.replace(wafer) {
            let turned = before.rotation.angle_to(&wafer.rotation);
            assert!(turned < 1e-4, "{k}: {turned}");
        }
    }
}
