//! Laws of mechanisms in general, and the robot described as one.

use crate::robot;

use jointplay_core::Error;
use jointplay_core::constraint::{Configuration, System};
use jointplay_core::mechanism::{
    Carrier, CommandedJoints, DifferentialKinematics, Drive, Joint, JointKind, Kinematics,
    Mechanism, MechanismSystem, MobilityClass, PositionSolver, ReliefSolver, ScrewAxis, Stop,
    StressScrew, SuggestOptions, VirtualJoint, VirtualMotion, assemble, branches, close, drive,
    exaggerate_play, guess, link_motion, nearest_closure, relieve, self_stresses, suggest,
};
use jointplay_core::mobility::{
    RANK_THRESHOLD, augmented_mobility, finite_mobility, instantaneous_mobility,
};
use jointplay_core::nalgebra::{DVector, Unit, Vector3};

use robot::{RADIUS, frame, gpr, home, joint, names, planar, polar, radial};

/// A single loop of revolute joints, in a closed configuration.
fn ring(points: &[[f64; 3]], axes: &[[f64; 3]]) -> Mechanism {
    let count = points.len();
    let joints = (0..count)
        .map(|k| {
            let links = [k, (k + 1) % count];
            joint(&format!("j{k}"), JointKind::Revolute, links, points[k], axes[k])
        })
        .collect();
    Mechanism::new("ring", names(count), joints).unwrap()
}

const BRICARD: ([[f64; 3]; 6], [[f64; 3]; 6]) = (
    [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, -1.0, 1.0],
        [0.0, -1.0, 1.0],
        [0.0, 0.0, 1.0],
    ],
    [
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
    ],
);

#[track_caller]
fn check(
    mechanism: &Mechanism,
    rank: usize,
    instantaneous: usize,
    finite: usize,
    redundancy: usize,
) {
    let system = MechanismSystem::new(mechanism, home(mechanism)).unwrap();
    let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    let first = &found.instantaneous;
    assert_eq!(
        (first.rank, first.mobility, found.mobility, first.redundancy),
        (rank, instantaneous, Some(finite), redundancy),
        "{:?}",
        first.singular_values
    );
}

#[test]
fn known_linkages() {
    let planar = ring(
        &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.3], [2.0, 2.0, 0.0], [3.0, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    );
    check(&planar, 3, 1, 1, 3);
    check(&ring(&BRICARD.0, &BRICARD.1), 5, 1, 1, 1);
    let spherical = ring(
        &[[0.0; 3]; 4],
        &[[0.0, 0.0, 1.0], [0.3, 0.0, 1.0], [0.5, 0.6, 1.0], [-0.2, 0.7, 1.0]],
    );
    check(&spherical, 3, 1, 1, 3);
}

#[test]
fn the_robot_as_a_mechanism() {
    let robot = gpr(radial);
    let mut at = home(&robot);
    for k in 0..3 {
        at[4 * k] = 0.5;
    }
    let system = MechanismSystem::new(&robot, at).unwrap();
    let level = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!(level.instantaneous.rank, 9);
    assert_eq!(level.instantaneous.mobility, 3);
    assert_eq!(level.mobility, Some(1));
    let relieved = augmented_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!((relieved.rank, relieved.mobility), (12, 3));

    let mut tilted = system.home().clone();
    for (k, q) in [0.49674475571, 0.501627622145, 0.501627622145].into_iter().enumerate() {
        tilted[4 * k] = q;
    }
    let free: Vec<usize> = (0..tilted.len()).filter(|k| ![0, 4, 8].contains(k)).collect();
    let closed = close(&system.with_home(tilted).unwrap(), &free, 50).unwrap();
    assert!(closed.is_closed(), "{closed:?}");
    for (k, expected) in [93.303230751, 93.218, 93.218].into_iter().enumerate() {
        let l = (RADIUS + closed.coordinates[12 + k]) * 1e3;
        assert!((l - expected).abs() < 1e-8, "{l} {expected}");
    }
    let there = system.with_home(closed.coordinates).unwrap();
    let found = finite_mobility(&there, &there.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!((found.instantaneous.rank, found.instantaneous.mobility), (11, 1));
    assert_eq!(found.mobility, Some(1));
}

/// Jacobians and second derivative against differences, at a displaced and open configuration.
#[test]
fn derivatives_are_those_of_the_residual() {
    let kinds = [
        JointKind::Universal,
        JointKind::Spherical,
        JointKind::Helical { lead: 0.3 },
        JointKind::Planar,
        JointKind::Cylindrical,
        JointKind::Revolute,
        JointKind::Floating,
        JointKind::Prismatic,
    ];
    // Two loops, joints in both senses.
    let links = [[0, 1], [2, 1], [2, 3], [3, 0], [4, 2], [0, 4], [3, 5], [5, 4]];
    let joints = kinds.iter().zip(links).enumerate().map(|(k, (&kind, links))| {
        let s = k as f64;
        let point = [s.sin(), (2.0 * s).cos(), 0.3 * s];
        joint(&format!("j{k}"), kind, links, point, [0.3 + (3.0 * s).sin(), 0.5, s.cos()])
    });
    let turn = VirtualMotion::Turn { axis: Vector3::y_axis(), point: Vector3::new(0.1, 0.2, 0.3) };
    let slide = VirtualMotion::Slide(Vector3::x_axis());
    let relief =
        [(0, turn, Carrier::First), (3, slide, Carrier::Second), (5, turn, Carrier::Second)]
            .into_iter()
            .enumerate()
            .map(|(m, (joint, motion, carrier))| VirtualJoint {
                name: format!("x{m}"),
                joint,
                carrier,
                motion,
                clearance: None,
                stiffness: None,
            });
    let mechanism = Mechanism::new("all kinds", names(6), joints.collect())
        .unwrap()
        .with_virtual_joints(relief.collect())
        .unwrap();
    let f = mechanism.joint_freedoms();
    let home = DVector::from_fn(f + 3, |k, _| 0.3 * (k as f64 * 1.7).sin());
    let system = MechanismSystem::new(&mechanism, home).unwrap();
    let mut at = system.at_home();
    at.coordinates = DVector::from_fn(f, |k, _| 0.2 * (k as f64).cos());
    let direction = DVector::from_fn(f, |k, _| (k as f64 * 0.7).sin());
    let shifted = |t: f64, m: Option<usize>| {
        let mut there = at.clone();
        match m {
            None => there.coordinates += &direction * t,
            Some(m) => there.virtual_joints[m] += t,
        }
        system.residual(&there)
    };
    let h = 1e-6;
    let along = (shifted(h, None) - shifted(-h, None)) / (2.0 * h);
    assert!((along - system.constraint_jacobian(&at) * &direction).amax() < 1e-8);
    for m in 0..3 {
        let along = (shifted(h, Some(m)) - shifted(-h, Some(m))) / (2.0 * h);
        assert!((along - system.virtual_jacobian(&at).column(m)).amax() < 1e-8);
    }
    let there = |t: f64| Configuration {
        coordinates: &at.coordinates + &direction * t,
        virtual_joints: at.virtual_joints.clone(),
    };
    let second = (system.constraint_jacobian(&there(h)) - system.constraint_jacobian(&there(-h)))
        * &direction
        / (2.0 * h);
    let off = (second - system.second_derivative(&at, &direction)).amax();
    assert!(off < 1e-7, "{off}");
    assert_eq!(Kinematics::new(&mechanism).closing_joints().len(), 3);
}

#[test]
fn the_count_of_loops() {
    let robot = gpr(radial);
    assert_eq!((robot.loops(), robot.joint_freedoms()), (2, 12));
    let found = instantaneous_mobility(
        &MechanismSystem::new(&robot, home(&robot)).unwrap(),
        &MechanismSystem::new(&robot, home(&robot)).unwrap().at_home(),
        RANK_THRESHOLD,
    )
    .unwrap();
    assert_eq!(found.rank + found.redundancy, 12);
}

fn four_bar() -> Mechanism {
    ring(
        &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.3], [3.0, 2.0, 0.0], [3.5, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    )
}

#[test]
fn crank_turns_a_full_revolution_and_returns() {
    let mechanism = four_bar();
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let drives = [Drive { coordinate: 0, to: std::f64::consts::TAU }];
    let motion = drive(&system, &drives, &[1, 2, 3], 72).unwrap();
    assert_eq!(motion.stopped, None);
    assert_eq!(motion.waypoints.len(), 73);
    assert!(motion.singular.is_empty(), "{:?}", motion.singular);
    assert!(motion.waypoints.iter().all(|point| point.residual < 1e-11));
    // Distances that two pins keep, for any angles.
    for point in &motion.waypoints {
        let links = system.kinematics().link_poses(&point.coordinates).unwrap();
        let pin = |link: usize, p: [f64; 3]| links[link] * nalgebra_point(p);
        let coupler = (pin(1, [0.0, 1.0, 0.0]) - pin(3, [3.0, 2.0, 0.0])).norm();
        assert!((coupler - 10.0_f64.sqrt()).abs() < 1e-11);
    }
    let last = &motion.waypoints[72].coordinates;
    let turns = last[1] / std::f64::consts::TAU;
    assert!((turns - turns.round()).abs() < 1e-9, "{turns}");
}

fn nalgebra_point(p: [f64; 3]) -> jointplay_core::nalgebra::Point3<f64> {
    p.into()
}

#[test]
fn a_rocker_locks_at_its_dead_point() {
    let mechanism = four_bar();
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    // The last pin is the rocker's: it cannot go round.
    let drives = [Drive { coordinate: 3, to: 3.0 }];
    let motion = drive(&system, &drives, &[0, 1, 2], 60).unwrap();
    assert_eq!(motion.stopped, Some(Stop::Locked));
    let last = motion.waypoints.last().unwrap();
    assert!(last.residual < 1e-11);
    // Crank and coupler are in line there: the rocker's pin is as far from the crank's as both are long.
    let pins = system.kinematics().link_poses(&last.coordinates).unwrap();
    let rocker_pin = (pins[3] * nalgebra_point([3.0, 2.0, 0.0])).coords;
    let far = 1.0 + 10.0_f64.sqrt();
    assert!((rocker_pin.norm() - far).abs() < 1e-12, "{}", rocker_pin.norm() - far);
    let [there] = &motion.singular[..] else { panic!("{:?}", motion.singular) };
    assert_eq!((there.share, &there.coordinates), (last.share, &last.coordinates));
    assert_eq!((there.instantaneous_mobility, there.branches), (1, Some(1)));
    assert_eq!(there.drives_reverse, Some(true));
}

#[test]
fn motion_from_a_dead_point_starts_in_one_direction_only() {
    let mechanism = four_bar();
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let drives = [Drive { coordinate: 3, to: 3.0 }];
    let dead =
        drive(&system, &drives, &[0, 1, 2], 60).unwrap().waypoints.pop().unwrap().coordinates;
    let there = system.with_home(dead).unwrap();
    let on = [Drive { coordinate: 3, to: there.home()[3] + 0.1 }];
    let stuck = drive(&there, &on, &[0, 1, 2], 5).unwrap();
    assert_eq!(stuck.stopped, Some(Stop::SingularStart { free_mobility: 1 }));
    assert_eq!((stuck.waypoints.len(), stuck.singular.len()), (1, 1));
    let back = [Drive { coordinate: 3, to: 0.0 }];
    let free = drive(&there, &back, &[0, 1, 2], 5).unwrap();
    assert_eq!(free.stopped, None);
    assert_eq!((free.singular[0].share, free.singular[0].branches), (0.0, Some(1)));
    assert!(free.waypoints.iter().all(|point| point.residual < 1e-11));
}

#[test]
fn a_step_may_end_in_a_crossing_and_a_motion_may_start_there() {
    let flat = ring(
        &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    );
    let system = MechanismSystem::new(&flat, home(&flat)).unwrap();
    let motion = drive(&system, &[Drive { coordinate: 0, to: 1.0 }], &[1, 2, 3], 10).unwrap();
    assert_eq!(motion.stopped, None);
    assert_eq!((motion.singular[0].share, motion.singular[0].branches), (0.0, Some(2)));
    // From one side to the other, with a step that ends in the crossing.
    let side = system.with_home(motion.waypoints[10].coordinates.clone()).unwrap();
    let across = drive(&side, &[Drive { coordinate: 0, to: -1.0 }], &[1, 2, 3], 10).unwrap();
    assert_eq!(across.stopped, None);
    assert_eq!(across.singular.len(), 1, "{:?}", across.singular);
    assert_eq!(across.singular[0].branches, Some(2));
    let [from, to] = [&across.waypoints[0], &across.waypoints[10]].map(|point| &point.coordinates);
    assert!((from + to).amax() < 1e-6, "{from} {to}");
    let ends = drive(&side, &[Drive { coordinate: 0, to: 0.0 }], &[1, 2, 3], 10).unwrap();
    assert_eq!((ends.stopped, ends.singular.len()), (None, 1));
    assert_eq!(ends.singular[0].share, 1.0);
}

#[test]
fn a_parallelogram_passes_through_its_flat_bifurcation_in_any_number_of_steps() {
    let mechanism = ring(
        &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    );
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    for count in 4..=60 {
        let drives = [Drive { coordinate: 0, to: -3.0 }];
        let motion = drive(&system, &drives, &[1, 2, 3], count).unwrap();
        assert_eq!(motion.stopped, None);
        assert_eq!(motion.singular.len(), 1, "{count} steps: {:?}", motion.singular);
        let flat = &motion.singular[0];
        assert!((flat.share * 3.0 - std::f64::consts::FRAC_PI_2).abs() < 1e-4);
        assert_eq!(flat.instantaneous_mobility, 2);
        assert_eq!((flat.branches, flat.drives_reverse), (Some(2), None));
        // Still a parallelogram beyond.
        let last = motion.waypoints.last().unwrap();
        assert!((last.coordinates[0] + last.coordinates[1]).abs() < 1e-9, "{}", last.coordinates);
    }
}

/// The angle is measured from the upright crank: flat at −90°.
#[test]
fn a_crossing_within_the_only_step_or_an_outer_one_is_found() {
    let mechanism = ring(
        &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    );
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let degrees = |from: f64, to: f64, count: usize| {
        let start =
            drive(&system, &[Drive { coordinate: 0, to: from.to_radians() }], &[1, 2, 3], 10);
        let start = start.unwrap().waypoints.pop().unwrap().coordinates;
        let there = system.with_home(start).unwrap();
        let drives = [Drive { coordinate: 0, to: to.to_radians() }];
        let motion = drive(&there, &drives, &[1, 2, 3], count).unwrap();
        assert_eq!((motion.stopped, motion.steps), (None, count), "{from} to {to}");
        let found = motion.singular.iter();
        found.map(|one| one.coordinates[0].to_degrees()).collect::<Vec<f64>>()
    };
    // Nearer to either end, and at equal distances from both.
    for (from, to, count) in [
        (-84.0, -96.0, 1),
        (-88.0, -101.0, 1),
        (-79.0, -92.0, 1),
        (-88.0, -112.0, 2),
        (-68.0, -92.0, 2),
        (-56.0, -92.0, 3),
        (-101.0, -88.0, 1),
    ] {
        let found = degrees(from, to, count);
        let [flat] = found[..] else { panic!("{from} to {to} in {count}: {found:?}") };
        assert!((flat + 90.0).abs() < 1e-3, "{from} to {to} in {count}: {flat}");
    }
    for (from, to, count) in [(-72.0, -85.0, 1), (-61.0, -85.0, 2), (-95.0, -108.0, 1)] {
        assert_eq!(degrees(from, to, count), [0.0; 0], "{from} to {to} in {count}");
    }
}

/// The third crank excludes the antiparallelogram: one branch continues where the constraints become dependent.
#[test]
fn drives_continue_through_the_flat_parallelogram_with_three_cranks() {
    let (a, b) = (0.3, 0.7);
    let [x, y] = [5.0_f64.to_radians().cos(), 5.0_f64.to_radians().sin()];
    let [ground, first, second, third, coupler] = [0, 1, 2, 3, 4];
    let z = [0.0, 0.0, 1.0];
    let pin = |name: &str, links: [usize; 2], at: [f64; 3]| {
        joint(name, JointKind::Revolute, links, at, z)
    };
    let joints = vec![
        pin("A1", [ground, first], [0.0, 0.0, 0.0]),
        pin("A2", [ground, second], [a, 0.0, 0.0]),
        pin("A3", [ground, third], [b, 0.0, 0.0]),
        pin("B1", [first, coupler], [x, y, 0.0]),
        pin("B2", [second, coupler], [a + x, y, 0.0]),
        pin("B3", [third, coupler], [b + x, y, 0.0]),
    ];
    let mechanism = Mechanism::new("three cranks", names(5), joints).unwrap();
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let drives = [Drive { coordinate: 0, to: -0.4 }];
    let motion = drive(&system, &drives, &[1, 2, 3, 4, 5], 7).unwrap();
    assert_eq!(motion.stopped, None);
    let [flat] = &motion.singular[..] else { panic!("{:?}", motion.singular) };
    assert!((flat.coordinates[0] + 5.0_f64.to_radians()).abs() < 1e-6);
    assert_eq!((flat.branches, flat.drives_reverse), (Some(1), Some(false)));
}

/// Cranks of length 1 in a row along x, each joined to the next by a coupler of its own, or all by one.
#[expect(clippy::cast_precision_loss, reason = "small counts")]
fn flat_row(loops: usize, gap: f64, has_one_coupler: bool) -> Mechanism {
    let z = [0.0, 0.0, 1.0];
    let mut joints = Vec::new();
    let mut pin = |links: [usize; 2], x: f64| {
        let name = format!("j{}", joints.len());
        joints.push(joint(&name, JointKind::Revolute, links, [x, 0.0, 0.0], z));
    };
    let crank = |k: usize| 1 + k;
    for k in 0..=loops {
        pin([0, crank(k)], gap * k as f64);
    }
    for k in 0..loops {
        let coupler = 2 + loops + if has_one_coupler { 0 } else { k };
        if k == 0 || !has_one_coupler {
            pin([crank(k), coupler], 1.0 + gap * k as f64);
        }
        pin([crank(k + 1), coupler], 1.0 + gap * (k + 1) as f64);
    }
    let links = 2 + loops + if has_one_coupler { 1 } else { loops };
    Mechanism::new("row", names(links), joints).unwrap()
}

/// Off the branches, loops count as closed only because the start is so near.
#[test]
fn motions_from_several_flat_parallelograms_lead_on_along_a_branch() {
    for (loops, gap, has_one_coupler) in [
        (1, 2.0, false),
        (2, 2.0, false),
        (2, 0.6, false),
        (3, 2.0, false),
        (4, 0.6, false),
        (2, 2.0, true),
        (3, 2.0, true),
        (5, 0.6, true),
    ] {
        let case = format!("{loops} loops, gap {gap}, one coupler: {has_one_coupler}");
        let mechanism = flat_row(loops, gap, has_one_coupler);
        let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
        let free: Vec<usize> = (1..mechanism.joints().len()).collect();
        for to in [0.3, -0.3, 1e-4] {
            let motion = drive(&system, &[Drive { coordinate: 0, to }], &free, 6).unwrap();
            assert_eq!(motion.stopped, None, "{case}, to {to}: {:?}", motion.waypoints.last());
            assert_eq!(motion.singular[0].share, 0.0, "{case}");
            let last = motion.waypoints.last().unwrap();
            assert!(last.residual < 1e-13, "{case}, to {to}: {:e}", last.residual);
            // With one coupler, all cranks stay parallel; with several, each pair is parallel or crossed, in closed form.
            let angles = &last.coordinates.as_slice()[..=loops];
            let is_parallel = |pair: &[f64]| (pair[1] - pair[0]).abs() < 1e-9;
            let is_crossed = |pair: &[f64]| {
                let [one, other] = [0, 1].map(|k: usize| (0.5 * pair[k]).tan());
                (other - one * (1.0 + gap) / (1.0 - gap)).abs() < 1e-9 * (1.0 + other.abs())
            };
            let mut pairs = angles.windows(2);
            assert!(
                pairs.all(|pair| is_parallel(pair) || (!has_one_coupler && is_crossed(pair))),
                "{case}, to {to}: {angles:?}"
            );
        }
    }
}

/// A triangle of pins, which is rigid, with two sides of 1 and 1.2.
fn triangle(third: f64) -> Vec<Joint> {
    let place = |x: f64| frame([x, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let joints = [(1.0, 0), (1.0, 1), (third, 2)].map(|(length, k)| Joint {
        frames: [place(if k == 0 { 0.0 } else { length }), place(0.0)],
        guess: vec![2.0],
        ..joint(&format!("j{k}"), JointKind::Revolute, [k, (k + 1) % 3], [0.0; 3], [0.0, 0.0, 1.0])
    });
    let mut joints = joints.to_vec();
    joints[2].frames[1] = place(1.2);
    joints
}

#[test]
fn links_that_do_not_fit_are_distinguished_from_a_bad_guess() {
    // One side too long for the other two cannot close.
    let triangle = |third| Mechanism::new("triangle", names(3), triangle(third)).unwrap();
    let good = triangle(1.0);
    assert!(assemble(&good, &guess(&good), &[], 8).unwrap().is_closed());
    assert_eq!(branches(&good, &guess(&good), &[], 40).unwrap().closures.len(), 2);
    let bad = triangle(5.0);
    let Err(Error::NotAssembled(found)) = assemble(&bad, &guess(&bad), &[], 8) else {
        panic!("a side of 5 between sides of 1 and 1.2");
    };
    assert!(found.branches.is_empty() && found.best.residual > 0.1);
    assert_eq!(found.loops.len(), 1);
}

#[test]
fn indices_of_no_coordinate_are_refused() {
    let mechanism = Mechanism::new("triangle", names(3), triangle(1.0)).unwrap();
    let start = guess(&mechanism);
    let closed = assemble(&mechanism, &start, &[], 8).unwrap().coordinates;
    let system = MechanismSystem::new(&mechanism, closed).unwrap();
    let drives = [Drive { coordinate: 0, to: 0.1 }];
    let errors = [
        assemble(&mechanism, &start, &[3], 8).err(),
        branches(&mechanism, &start, &[3], 8).err(),
        nearest_closure(&mechanism, &start, &[3], 8).err(),
        close(&system, &[3], 8).err(),
        drive(&system, &drives, &[1, 3], 8).err(),
        PositionSolver::new(&system, &[3]).err(),
        DifferentialKinematics::new(&system, &[3]).err(),
        CommandedJoints::new(&system, &[3]).err(),
    ];
    for (k, error) in errors.into_iter().enumerate() {
        assert!(matches!(error, Some(Error::NoSuchQuantity { index: 3, count: 3, .. })), "{k}");
    }
}

#[test]
fn configurations_that_differ_off_the_loops_only_are_one() {
    let mut joints = triangle(1.0);
    joints.push(joint("arm", JointKind::Cylindrical, [2, 3], [0.3, 0.1, 0.0], [0.0, 0.0, 1.0]));
    let mechanism = Mechanism::new("triangle with an arm", names(4), joints).unwrap();
    let found = branches(&mechanism, &guess(&mechanism), &[], 40).unwrap();
    assert_eq!((found.closures.len(), found.is_limited), (2, false));
    for closed in &found.closures {
        assert_eq!(&closed.coordinates.as_slice()[3..], [0.0, 0.0], "the arm is at its guess");
    }
}

/// The struts of a hexapod keep their lengths in every configuration, by the distances of their ends.
#[test]
fn hexapod_with_its_struts_held_has_other_assembly_modes() {
    let on_circle = |radius: f64, angles: [f64; 6], middle: Vector3<f64>| {
        angles.map(|angle| {
            let (sine, cosine) = angle.to_radians().sin_cos();
            middle + radius * Vector3::new(cosine, sine, 0.0)
        })
    };
    let feet = on_circle(0.41, [5.0, 50.0, 131.0, 169.0, 248.0, 296.0], Vector3::zeros());
    let middle = Vector3::new(0.01, -0.007, 0.52);
    let heads = on_circle(0.21, [40.0, 44.0, 160.0, 165.0, 279.0, 281.0], middle);
    let mut joints = Vec::new();
    for (k, (foot, head)) in feet.iter().zip(&heads).enumerate() {
        let [lower, upper] = [2 * k + 2, 2 * k + 3];
        let strut = head - foot;
        let across = strut.cross(&Vector3::z()).into();
        let part = |name: &str, kind, links, point: &Vector3<f64>, axis| {
            joint(&format!("{name} {k}"), kind, links, (*point).into(), axis)
        };
        joints.extend([
            part("foot", JointKind::Universal, [0, lower], foot, across),
            part("strut", JointKind::Prismatic, [lower, upper], foot, strut.into()),
            part("head", JointKind::Spherical, [upper, 1], head, [0.0, 0.0, 1.0]),
        ]);
    }
    let hexapod = Mechanism::new("hexapod", names(14), joints).unwrap();
    let held: Vec<usize> = (0..6).map(|k| 6 * k + 2).collect();
    let found = branches(&hexapod, &guess(&hexapod), &held, 40).unwrap();
    let kinematics = Kinematics::new(&hexapod);
    let mut others = 0;
    for closed in &found.closures {
        let platform = kinematics.link_poses(&closed.coordinates).unwrap()[1];
        for (foot, head) in feet.iter().zip(&heads) {
            let reached = platform.rotation * head + platform.translation.vector;
            assert!(((reached - foot).norm() - (head - foot).norm()).abs() < 1e-12);
        }
        others += usize::from(platform.translation.vector.norm() > 0.1);
    }
    assert!(others >= 4, "{others} of {}", found.closures.len());
}

/// Polar virtual joints of a ball: about the platform's middle, then along the turned radius.
/// The closed-form robot and the general engine: rods, virtual joints, centre, to round-off.
#[test]
fn closed_form_and_general_mechanism_agree_on_the_robot() {
    use jointplay_core::gpr::{AxisHeight, Gpr};
    use jointplay_core::sensitivity::{commanded_sensitivity, sensitivity};
    use jointplay_core::spatial::Tilt;
    use jointplay_core::virtualization::{
        Metric, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
    };
    let closed_form = Gpr::paper().without_limit_checks();
    let models: [(&dyn Virtualization, Mechanism, f64); 4] = [
        (&Radial, gpr(radial), RADIUS),
        (&Polar, gpr(polar), RADIUS),
        (&Polar, gpr(polar), 1e-3),
        (&Planar, gpr(planar), RADIUS),
    ];
    for (model, mechanism, length) in models {
        let mechanism = mechanism.with_characteristic_length(length).unwrap();
        for (azimuth, tilt_angle) in [(0.0, 0.0), (0.0, 0.035), (1.1, 0.02), (-2.5, 0.03)] {
            let rods =
                closed_form.inverse(Tilt { azimuth, angle: tilt_angle }, AxisHeight(0.5)).unwrap();
            let options = SolveOptions {
                metric: Metric::Length(length),
                solver: Solver::LeastNorm,
                ..SolveOptions::default()
            };
            let expected = closed_form.forward(rods, model, &options).unwrap();
            let mut start = home(&mechanism);
            (0..3).for_each(|k| start[4 * k] = rods[k]);
            let system = MechanismSystem::new(&mechanism, start).unwrap();
            let at_home = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
            let commanded = CommandedJoints::new(&at_home, &[0, 4, 8]).unwrap();
            let found = relieve(&system, &commanded, ReliefSolver::LeastNorm).unwrap();
            let context = format!("{} {length} {azimuth} {tilt_angle}", model.name());
            // The fast solver, which opens the loops elsewhere, finds the same.
            let mut solver = PositionSolver::new(&system, &[0, 4, 8]).unwrap();
            let mut by_solver = system.home().clone();
            solver.solve(by_solver.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
            let off = (&by_solver - &found.coordinates).amax();
            assert!(off < 1e-11, "{context}: {off:e}");
            // What the closed form calls l and φ: the radius itself, and angles, by joint kind.
            let x: Vec<f64> = expected.solution.virtual_joints.to_vec();
            for k in 0..3 {
                let (from_general, from_closed): (Vec<f64>, Vec<f64>) = match model.name() {
                    "radial" => (vec![found.virtual_joints[k]], vec![x[k] - RADIUS]),
                    "polar" => (
                        vec![found.virtual_joints[2 * k + 1], found.virtual_joints[2 * k]],
                        vec![x[k] - RADIUS, x[3 + k]],
                    ),
                    _ => (
                        vec![found.virtual_joints[2 * k], found.virtual_joints[2 * k + 1]],
                        vec![x[k], x[3 + k]],
                    ),
                };
                for (a, b) in from_general.iter().zip(&from_closed) {
                    assert!((a - b).abs() < 2e-12, "{context}: {x:?} {}", found.virtual_joints);
                }
            }
            let at = system.with_home(found.coordinates).unwrap();
            let platform = at.kinematics().link_poses(at.home()).unwrap()[4];
            let off = platform.to_homogeneous() - expected.base_from_platform.to_homogeneous();
            assert!(off.amax() < 1e-11, "{context} {off}");
            // Ranks, and how sensitive the virtual joints are to the rods.
            let by_formula = closed_form.system(model);
            let there = by_formula.configuration(&expected);
            let first = instantaneous_mobility(&by_formula, &there, RANK_THRESHOLD).unwrap();
            let general = instantaneous_mobility(&at, &at.at_home(), RANK_THRESHOLD).unwrap();
            assert_eq!(
                (general.rank, general.mobility, general.redundancy),
                (first.rank, first.mobility, first.redundancy),
                "{context}"
            );
            let a = commanded_sensitivity(&by_formula, &there, &[0, 1, 2], length, RANK_THRESHOLD)
                .unwrap();
            let b = commanded_sensitivity(&at, &at.at_home(), &[0, 4, 8], length, RANK_THRESHOLD)
                .unwrap();
            assert!(
                (a.singular_values() - b.singular_values()).amax() < 1e-11,
                "{context} {} {}",
                a.singular_values(),
                b.singular_values()
            );
            let _ = sensitivity(&at, &at.at_home(), length, RANK_THRESHOLD).unwrap();
        }
    }
}

/// Rods for tilts of 2° toward four sides.
fn tilts(robot: &jointplay_core::gpr::Gpr) -> Vec<DVector<f64>> {
    use jointplay_core::gpr::AxisHeight;
    use jointplay_core::spatial::Tilt;
    [0.0, 0.7, 1.9, 4.0]
        .map(|azimuth| {
            let tilt = Tilt { azimuth, angle: 2.0_f64.to_radians() };
            DVector::from_row_slice(&robot.inverse(tilt, AxisHeight(0.5)).unwrap())
        })
        .to_vec()
}

#[test]
fn where_the_robot_needs_play() {
    let closed_form = jointplay_core::gpr::Gpr::paper().without_limit_checks();
    let mechanism = gpr(|_, _| Vec::new());
    let mut start = home(&mechanism);
    (0..3).for_each(|k| start[4 * k] = 0.5);
    let found =
        suggest(&mechanism, &start, &[0, 4, 8], &tilts(&closed_form), &SuggestOptions::default())
            .unwrap();
    let names = |n: usize| -> Vec<&str> {
        found.sets[n].virtual_joints.iter().map(|joint| joint.name.as_str()).collect()
    };
    let radial = (0..found.sets.len()).find(|&n| {
        names(n) == ["s0", "s1", "s2"].map(|ball| format!("radial slide of platform at {ball}"))
    });
    let radial = &found.sets[radial.expect("the paper's three radial slides")];
    assert!(radial.symmetric);
    // R (1 − cos α) / 2 … 3/2 of it, by the closed form.
    let most = 1.5 * RADIUS * (1.0 - 2.0_f64.to_radians().cos());
    assert!(radial.largest.iter().all(|x| *x > 0.3 * most && *x < 1.01 * most));
    assert!(found.sets.iter().all(|set| set.virtual_joints.len() >= 3));
}

#[test]
fn redundancy_in_words() {
    let mechanism = four_bar();
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    assert_eq!(MobilityClass::classify(&found), MobilityClass::OverconstrainedMovable);
    let stresses = self_stresses(&system, &found.instantaneous).unwrap();
    // A planar loop: a force along the axes of its hinges, and moments about the two other axes.
    let along = |axis: usize, direction: &Unit<Vector3<f64>>| direction[axis].abs() > 1.0 - 1e-9;
    let has = |what: &dyn Fn(&StressScrew) -> bool| {
        stresses.stresses.iter().any(|one| one.single_loop && what(&one.screw))
    };
    assert!(has(
        &|screw| matches!(screw, StressScrew::Moment { direction } if along(0, direction))
    ));
    assert!(has(
        &|screw| matches!(screw, StressScrew::Moment { direction } if along(1, direction))
    ));
    assert!(has(
        &|screw| matches!(screw, StressScrew::Force { direction, .. } if along(2, direction))
    ));
    assert!(stresses.stresses.iter().all(|one| one.independent && one.wrenches.len() == 4));
    assert!(stresses.sparsest && stresses.in_all == [0, 1, 2, 3]);
    let coupler = link_motion(&system, &found.instantaneous, 2).unwrap();
    assert_eq!((coupler.dimension, coupler.translations), (1, 0));
    let ScrewAxis { pitch, point: center } = coupler.screw.unwrap();
    // The coupler turns about where the lines of crank and rocker meet: x = 0 and 4 (x − 3.5) + y = 0.
    assert!(pitch.abs() < 1e-12);
    assert!((center.xy() - jointplay_core::nalgebra::Vector2::new(0.0, 14.0)).norm() < 1e-9);
    let mechanism = ring(
        &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 0.0]],
        &[[0.0, 0.0, 1.0]; 4],
    );
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let first = instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    let coupler = link_motion(&system, &first, 2).unwrap();
    assert_eq!((coupler.dimension, coupler.translations, coupler.screw), (1, 1, None));
}

#[test]
fn what_dense_algebra_cannot_do_is_refused() {
    let count = 700;
    let points: Vec<[f64; 3]> = (0..count).map(|k| [f64::from(k), f64::from(k % 7), 0.0]).collect();
    let mechanism = ring(&points, &vec![[0.0, 0.0, 1.0]; points.len()]);
    let error = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap_err();
    assert_eq!(error, Error::TooLarge { what: "coordinates", found: 700, allowed: 240 });
}

/// Play shown larger: the truth at 1, none at 0, and in proportion between for slides.
#[test]
fn exaggerated_play_grows_from_the_truth() {
    for give in [radial, polar, planar] {
        let mechanism = gpr(give);
        let mut start = home(&mechanism);
        (0..3).for_each(|k| start[4 * k] = [0.505, 0.5, 0.498][k]);
        let system = MechanismSystem::new(&mechanism, start).unwrap();
        let at_home = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
        let commanded = CommandedJoints::new(&at_home, &[0, 4, 8]).unwrap();
        let found = relieve(&system, &commanded, ReliefSolver::LeastNorm).unwrap();
        let links = system.kinematics().link_poses(&found.coordinates).unwrap();
        let apart = |factor: f64| -> Vec<f64> {
            let shown = exaggerate_play(&mechanism, &found.coordinates, factor).unwrap();
            assert_eq!(shown.factor, factor);
            for (j, joint) in mechanism.joints().iter().enumerate() {
                for side in 0..2 {
                    let seat = (links[joint.links[side]] * joint.frames[side]).to_homogeneous();
                    let off = (shown.seats[j][side].to_homogeneous() - seat).amax();
                    assert!(factor != 1.0 || off < 1e-15, "{off:e}");
                }
            }
            let gap = |(seat, joint): (&[_; 2], &[_; 2])| {
                let [seat, joint]: [&jointplay_core::spatial::Pose; 2] = [&seat[1], &joint[1]];
                (seat.translation.vector - joint.translation.vector).norm()
            };
            shown.seats.iter().zip(&shown.joints).map(gap).collect()
        };
        let truth = apart(1.0);
        assert!(truth.iter().copied().fold(0.0, f64::max) > 1e-5);
        assert!(apart(0.0).iter().all(|&gap| gap < 1e-15));
        for factor in [1.0 + 1e-9, 500.0] {
            for (large, small) in apart(factor).iter().zip(&truth) {
                // Turns grow by their chord, which a small one all but is.
                let off = (large - factor * small).abs();
                assert!(off < 0.05 * factor * small + 1e-14, "{factor} {large:e} {small:e}");
            }
        }
        assert!(exaggerate_play(&mechanism, &found.coordinates, f64::NAN).is_err());
    }
}
