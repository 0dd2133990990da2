//! Couplings of joints, compared with joints that move so by themselves and with closed forms.

use crate::robot;

use std::f64::consts::{FRAC_PI_2, PI};

use jointplay_core::Error;
use jointplay_core::constraint::System as _;
use jointplay_core::mechanism::{
    Carrier, ChangedDimension, Coupling, DifferentialKinematics, Drive, Joint, JointCoordinate,
    JointKind, Mechanism, MechanismError, MechanismSystem, MobilityClass, OpenLoops,
    PositionSolver, ReliefSolver, SparseSystem, StressScrew, SuggestOptions, VirtualJoint,
    VirtualMotion, assemble, blocks, drive, guess, mechanism_mobility, relieve_commanded,
    self_stresses, suggest,
};
use jointplay_core::mobility::RANK_THRESHOLD;
use jointplay_core::nalgebra::{DVector, Rotation2, Rotation3, Translation3, Vector2, Vector3};
use jointplay_core::spatial::Pose;
use proptest::prelude::*;

use robot::{joint, names};

fn of(joint: usize) -> JointCoordinate {
    JointCoordinate { joint, freedom: 0 }
}

/// q_follower = ratio · q_leader + offset.
fn gear(name: &str, follower: usize, leader: usize, ratio: f64, offset: f64) -> Coupling {
    let terms = vec![(of(leader), ratio)];
    Coupling { name: name.to_owned(), follower: of(follower), terms, offset }
}

/// A chain of hinges about z through points of a plane, closed to a loop.
fn planar(points: &[[f64; 2]]) -> Mechanism {
    let count = points.len();
    let hinge = |k: usize| {
        let [x, y] = points[k];
        let up = [0.0, 0.0, 1.0];
        joint(&format!("J{k}"), JointKind::Revolute, [k, (k + 1) % count], [x, y, 0.0], up)
    };
    Mechanism::new("planar", names(count), (0..count).map(hinge).collect()).unwrap()
}

/// A five-bar: cranks of 1 and 1.2 on a base of 3, rods of 2.5 and 2.2; the second crank turns by a ratio of the first.
fn geared(ratio: f64) -> Mechanism {
    let [a, b] = [Vector2::new(0.0, 0.0), Vector2::new(3.0, 0.0)];
    let [c, d] = [a + turned(1.0, 1.8), b + turned(1.2, 1.2)];
    let e = meeting(c, d, 2.5, 2.2);
    let points = [a, c, e, d, b].map(|p| [p.x, p.y]);
    // The last hinge leads from the crank to the base: its sense is the opposite.
    planar(&points).with_couplings(vec![gear("gear", 4, 0, -ratio, 0.0)]).unwrap()
}

fn turned(length: f64, angle: f64) -> Vector2<f64> {
    Vector2::new(length * angle.cos(), length * angle.sin())
}

/// The point above a line at these distances from its ends.
fn meeting(c: Vector2<f64>, d: Vector2<f64>, from_c: f64, from_d: f64) -> Vector2<f64> {
    let (along, apart) = ((d - c).normalize(), (d - c).norm());
    let x = (apart * apart + from_c * from_c - from_d * from_d) / (2.0 * apart);
    c + along * x + Vector2::new(-along.y, along.x) * (from_c * from_c - x * x).sqrt()
}

/// By dense algebra; sparse algebra has the same counts, and the same finite mobility where it has one.
#[track_caller]
fn mobility(mechanism: &Mechanism) -> jointplay_core::mechanism::MechanismMobility {
    let home = guess(mechanism);
    let sparse = SparseSystem::new(mechanism, home.clone()).unwrap().mobility(RANK_THRESHOLD);
    let system = MechanismSystem::new(mechanism, home).unwrap();
    let found = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused).unwrap();
    let (sparse, first) = (sparse.unwrap(), &found.finite.instantaneous);
    // Near a singular configuration, the two may take a small value for zero or not.
    if first.smallest_nonzero().is_none_or(|least| least > 1e-6) {
        assert_eq!(
            (sparse.mobility, sparse.rank, sparse.redundancy),
            (first.mobility, first.rank, first.redundancy)
        );
        assert!(sparse.finite.is_none() || sparse.finite == found.finite.mobility);
    }
    found
}

#[test]
fn a_geared_five_bar_has_one_freedom_and_moves_as_two_circles_meet() {
    for ratio in [-1.0, -0.5, 2.0, 0.75] {
        let mechanism = geared(ratio);
        let found = mobility(&mechanism);
        assert_eq!(mechanism.kutzbach_mobility(), -2);
        let first = &found.finite.instantaneous;
        assert_eq!((found.finite.mobility, first.redundancy, first.rank), (Some(1), 3, 4));
        assert_eq!(found.class(), MobilityClass::OverconstrainedMovable);
        let home = guess(&mechanism);
        let system = MechanismSystem::new(&mechanism, home.clone()).unwrap();
        let drives = [Drive { coordinate: 0, to: 0.3 }];
        let motion = drive(&system, &drives, &[1, 2, 3, 4], 10).unwrap();
        assert_eq!(motion.stopped, None);
        let mut solver = PositionSolver::new(&system, &[0]).unwrap();
        for waypoint in &motion.waypoints {
            let q = &waypoint.coordinates;
            assert!((q[4] + ratio * q[0]).abs() < 1e-12, "{q}");
            let links = system.kinematics().link_poses(q).unwrap();
            let [c, d] =
                [turned(1.0, 1.8 + q[0]), Vector2::new(3.0, 0.0) + turned(1.2, 1.2 + ratio * q[0])];
            let expected = meeting(c, d, 2.5, 2.2);
            let at_home =
                meeting(turned(1.0, 1.8), Vector2::new(3.0, 0.0) + turned(1.2, 1.2), 2.5, 2.2);
            let point =
                links[2] * Vector3::new(at_home.x, at_home.y, 0.0) + links[2].translation.vector;
            assert!((point.xy() - expected).norm() < 1e-11, "{ratio}: {point} {expected}");
            let mut fast = home.clone();
            fast[0] = q[0];
            solver.solve(fast.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
            assert!((&fast - q).amax() < 1e-10, "{fast} {q}");
        }
    }
}

#[test]
fn velocities_and_accelerations_are_derivatives_of_coupled_positions() {
    let mechanism = geared(-0.7);
    let system = MechanismSystem::new(&mechanism, guess(&mechanism)).unwrap();
    // Driven by the follower, by the leader, and by a joint that is not coupled.
    for driven in [0, 4, 2] {
        let mut solver = PositionSolver::new(&system, &[driven]).unwrap();
        let mut at = |value: f64| {
            let mut q = guess(&mechanism);
            q[driven] = value;
            solver.solve(q.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
            q
        };
        let step = 1e-4;
        let [less, here, more] = [0.1 - step, 0.1, 0.1 + step].map(&mut at);
        let mut rates = DifferentialKinematics::new(&system, &[driven]).unwrap();
        rates.linearize(here.as_slice()).unwrap();
        let (mut velocities, mut accelerations) = (DVector::zeros(5), DVector::zeros(5));
        rates.velocities(&[1.0], velocities.as_mut_slice()).unwrap();
        rates.accelerations(&[0.0], accelerations.as_mut_slice()).unwrap();
        let first = (&more - &less) / (2.0 * step);
        let second = (&more + &less - &here * 2.0) / (step * step);
        assert!((&first - &velocities).amax() < 1e-6, "{driven}: {first} {velocities}");
        assert!((&second - &accelerations).amax() < 1e-5, "{driven}: {second} {accelerations}");
        assert_eq!(rates.singular_values().unwrap().len(), 5 - 1 - 1);
    }
}

#[test]
fn the_ratio_is_a_dimension() {
    let ratio = -0.7;
    let mechanism = geared(ratio);
    let at = |ratio: f64| {
        let mechanism = geared(ratio);
        let mut q = guess(&mechanism);
        q[0] = 0.2;
        let system = MechanismSystem::new(&mechanism, q.clone()).unwrap();
        let mut solver = PositionSolver::new(&system, &[0]).unwrap();
        solver.solve(q.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
        q
    };
    let here = at(ratio);
    let system = MechanismSystem::new(&mechanism, here.clone()).unwrap();
    let mut rates = DifferentialKinematics::new(&system, &[0]).unwrap();
    rates.linearize(here.as_slice()).unwrap();
    let step = 1e-4;
    let mechanisms = [-2.0, -1.0, 1.0, 2.0].map(|steps| geared(ratio + steps * step));
    let changed = ChangedDimension { mechanisms, step };
    let found = rates.dimension_derivatives(here.as_slice(), &changed).unwrap();
    let expected = (at(ratio + step) - at(ratio - step)) / (2.0 * step);
    assert!((&found.coordinates - &expected).amax() < 1e-6, "{} {expected}", found.coordinates);
}

#[test]
fn a_coupling_that_a_loop_imposes_already_is_redundant() {
    // In a parallelogram the cranks turn alike; the last hinge leads from a crank to the base.
    let free = planar(&[[0.0, 0.0], [0.5, 1.0], [2.5, 1.0], [2.0, 0.0]]);
    let coupled =
        |ratio: f64| free.clone().with_couplings(vec![gear("belt", 3, 0, ratio, 0.0)]).unwrap();
    let belt = coupled(-1.0);
    let found = mobility(&belt);
    let first = &found.finite.instantaneous;
    assert_eq!((found.finite.mobility, first.redundancy), (Some(1), 4));
    let system = MechanismSystem::new(&belt, guess(&belt)).unwrap();
    let stresses = self_stresses(&system, first).unwrap();
    let with_belt: Vec<_> =
        stresses.stresses.iter().filter(|one| !one.couplings.is_empty()).collect();
    let [stress] = with_belt[..] else { panic!("{stresses:?}") };
    assert!(!stress.wrenches.is_empty() && stress.couplings[0].coupling == 0);
    // Another ratio locks it, though not against the first order at all ratios.
    let locked = mobility(&coupled(-0.5));
    assert_eq!(locked.finite.mobility, Some(0));
    assert_eq!(locked.finite.instantaneous.redundancy, 3);
}

#[test]
fn equal_couplings_are_redundant_without_any_wrench() {
    let hinge = |k: usize, link: usize| {
        let x = [0.0, 1.0][k];
        joint(["A", "B"][k], JointKind::Revolute, [0, link], [x, 0.0, 0.0], [0.0, 0.0, 1.0])
    };
    let wheels = Mechanism::new("wheels", names(3), vec![hinge(0, 1), hinge(1, 2)]).unwrap();
    let twice = vec![gear("one", 1, 0, -2.0, 0.0), gear("other", 0, 1, -0.5, 0.0)];
    let wheels = wheels.with_couplings(twice).unwrap();
    let found = mobility(&wheels);
    let first = &found.finite.instantaneous;
    assert_eq!((wheels.kutzbach_mobility(), found.finite.mobility), (0, Some(1)));
    assert_eq!((first.rank, first.redundancy), (1, 1));
    let system = MechanismSystem::new(&wheels, guess(&wheels)).unwrap();
    let stresses = self_stresses(&system, first).unwrap();
    let [only] = &stresses.stresses[..] else { panic!("{stresses:?}") };
    assert_eq!((&only.screw, only.couplings.len()), (&StressScrew::Couplings, 2));
    assert_eq!((stresses.in_all, stresses.couplings_in_all), (vec![], vec![0, 1]));
}

#[test]
fn a_differential_and_a_fixed_coordinate() {
    let hinge = |k: usize| {
        joint(["A", "B", "C"][k], JointKind::Revolute, [0, k + 1], [0.0; 3], [0.0, 0.0, 1.0])
    };
    let arms = Mechanism::new("arms", names(4), (0..3).map(hinge).collect()).unwrap();
    let mean = Coupling {
        name: "differential".to_owned(),
        follower: of(2),
        terms: vec![(of(0), 0.5), (of(1), 0.5)],
        offset: 0.1,
    };
    let held = Coupling { name: "brake".to_owned(), follower: of(1), terms: vec![], offset: 0.4 };
    let arms = arms.with_couplings(vec![mean, held]).unwrap();
    let mut start = guess(&arms);
    start[0] = 0.6;
    let closed = assemble(&arms, &start, &[0], 10).unwrap();
    assert!((closed.coordinates - DVector::from_vec(vec![0.6, 0.4, 0.6])).amax() < 1e-11);
    let at = MechanismSystem::new(&arms, DVector::from_vec(vec![0.6, 0.4, 0.6])).unwrap();
    let found = mechanism_mobility(&at, RANK_THRESHOLD, OpenLoops::Refused).unwrap();
    assert_eq!((found.finite.mobility, found.finite.instantaneous.redundancy), (Some(1), 0));
}

#[test]
fn couplings_merge_the_blocks_that_they_connect() {
    // Two four-bars on the base, one of them behind a hinge, and a hinge at its end.
    let up = [0.0, 0.0, 1.0];
    let hinge = |name: &str, links: [usize; 2], x: f64, y: f64| {
        joint(name, JointKind::Revolute, links, [x, y, 0.0], up)
    };
    let joints = vec![
        hinge("a0", [0, 1], 0.0, 0.0),
        hinge("a1", [1, 2], 0.3, 1.0),
        hinge("a2", [2, 3], 2.2, 1.2),
        hinge("a3", [3, 0], 2.0, 0.0),
        hinge("b", [0, 4], 5.0, 0.0),
        hinge("c0", [4, 5], 6.0, 0.0),
        hinge("c1", [5, 6], 6.3, 1.0),
        hinge("c2", [6, 7], 8.2, 1.2),
        hinge("c3", [7, 4], 8.0, 0.0),
        hinge("d", [6, 8], 7.0, 2.0),
        hinge("e", [0, 9], 9.0, 9.0),
    ];
    let free = Mechanism::new("blocks", names(10), joints).unwrap();
    assert_eq!(blocks(&free).len(), 5);
    assert_eq!(mobility(&free).finite.mobility, Some(5));
    for (couplings, count, moves) in [
        (vec![gear("g", 5, 0, 1.5, 0.0)], 3, 4),
        (vec![gear("g", 9, 4, 1.0, 0.0)], 3, 4),
        (vec![gear("g", 10, 9, 1.0, 0.0)], 2, 4),
        (vec![gear("g", 10, 9, 1.0, 0.0), gear("h", 0, 4, 2.0, 0.0)], 1, 3),
        (vec![gear("g", 6, 5, 0.1, 0.0)], 5, 4),
    ] {
        let mechanism = free.clone().with_couplings(couplings.clone()).unwrap();
        let found = blocks(&mechanism);
        assert_eq!(found.len(), count, "{couplings:?} {found:?}");
        let mut joints: Vec<usize> = found.iter().flat_map(|one| one.joints.clone()).collect();
        joints.sort_unstable();
        assert_eq!(joints, (0..11).collect::<Vec<_>>());
        let all: usize = found.iter().map(|one| one.couplings.len()).sum();
        assert_eq!(all, couplings.len());
        assert_eq!(mobility(&mechanism).finite.instantaneous.mobility, moves, "{couplings:?}");
    }
}

#[test]
fn couplings_of_nothing_are_refused() {
    let balls = Mechanism::new(
        "ball",
        names(3),
        vec![
            joint("S", JointKind::Spherical, [0, 1], [0.0; 3], [0.0, 0.0, 1.0]),
            joint("R", JointKind::Revolute, [1, 2], [0.0; 3], [0.0, 0.0, 1.0]),
        ],
    )
    .unwrap();
    let refused = |coupling: Coupling| balls.clone().with_couplings(vec![coupling]).unwrap_err();
    type E = MechanismError;
    assert!(matches!(refused(gear("g", 0, 1, 1.0, 0.0)), E::CoupledRotation { .. }));
    assert!(matches!(refused(gear("g", 1, 1, 1.0, 0.0)), E::CoupledTwice { .. }));
    assert!(matches!(refused(gear("g", 1, 7, 1.0, 0.0)), E::NoSuchCoordinate { joint: 7, .. }));
    let missing = JointCoordinate { joint: 1, freedom: 1 };
    let beyond = Coupling { follower: missing, ..gear("g", 1, 1, 1.0, 0.0) };
    assert!(matches!(refused(beyond), E::NoSuchCoordinate { freedom: 1, .. }));
    let many = vec![gear("g", 1, 1, 1.0, 0.0).terms[0]; 64];
    let many = Coupling { terms: many, ..gear("g", 1, 1, 1.0, 0.0) };
    assert!(matches!(refused(many), E::CoupledMany { found: 65, allowed: 64, .. }));
    let fixed = |offset| Coupling { terms: vec![], offset, ..gear("g", 1, 1, 1.0, 0.0) };
    assert!(matches!(refused(fixed(f64::NAN)), E::NotFinite { .. }));
    assert!(matches!(
        refused(Coupling { name: "S".to_owned(), ..fixed(0.0) }),
        E::NameTwice { .. }
    ));
    let kept = balls.with_couplings(vec![fixed(0.0)]).unwrap();
    assert_eq!(kept.couplings().len(), 1);
}

/// Parallelograms on the base, each crank of which a gear drives from the crank before, or all of which one differential joins.
fn row_of_parallelograms(count: usize, couplings: Vec<Coupling>) -> Mechanism {
    let up = [0.0, 0.0, 1.0];
    let loops = (0..count).flat_map(|k| {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let x = 3.0 * k as f64;
        let links = [0, 3 * k + 1, 3 * k + 2, 3 * k + 3, 0];
        let points = [[0.0, 0.0], [0.5, 1.0], [2.5, 1.0], [2.0, 0.0]];
        (0..4).map(move |side| {
            let [along, above] = points[side];
            let ends = [links[side], links[side + 1]];
            let name = format!("{k}-{side}");
            joint(&name, JointKind::Revolute, ends, [x + along, above, 0.0], up)
        })
    });
    let row = Mechanism::new("row", names(3 * count + 1), loops.collect()).unwrap();
    row.with_couplings(couplings).unwrap()
}

#[test]
fn hundreds_of_geared_loops_move_by_the_product_of_the_ratios() {
    let count = 200;
    let ratio = |k: usize| if k.is_multiple_of(3) { -0.5 } else { -1.25 };
    let gears = (1..count).map(|k| gear(&format!("gear {k}"), 4 * k, 4 * (k - 1), ratio(k), 0.0));
    let row = row_of_parallelograms(count, gears.collect());
    assert!(!MechanismSystem::fits(&row));
    let system = SparseSystem::new(&row, guess(&row)).unwrap();
    let found = system.mobility(RANK_THRESHOLD).unwrap();
    assert_eq!((found.mobility, found.finite, found.redundancy), (1, Some(1), 3 * count));
    let motion = system.drive(&[Drive { coordinate: 0, to: 0.4 }], &[], 2).unwrap();
    assert_eq!((motion.stopped, motion.waypoints[2].free_mobility), (None, 0));
    let mut expected = 0.4;
    for k in 0..count {
        expected *= if k == 0 { 1.0 } else { ratio(k) };
        let found = motion.waypoints[2].coordinates[4 * k];
        assert!((found - expected).abs() < 1e-9, "{k}: {found} {expected}");
    }
    // Two cranks at other values than their gear allows are brought together.
    let mut apart = guess(&row);
    apart[4 * 7] = 0.2;
    let mut system = SparseSystem::new(&row, apart).unwrap();
    assert!(system.residual() > 0.05);
    system.close(&[4 * 7], 100).unwrap();
    assert!((system.coordinates()[4 * 8] - 0.2 * ratio(8)).abs() < 1e-9);
    let mut against = guess(&row);
    against[0] = 0.2;
    let mut system = SparseSystem::new(&row, against).unwrap();
    assert!(matches!(system.close(&[0, 4], 100), Err(Error::NotReached { .. })));
}

#[test]
fn a_differential_of_many_cranks_and_a_brake() {
    let count = 45;
    let terms = (1..count).map(|k| (of(4 * k), 0.25)).collect();
    let sum = Coupling { name: "sum".to_owned(), follower: of(0), terms, offset: 0.0 };
    let brake = Coupling { name: "brake".to_owned(), follower: of(4), terms: vec![], offset: 0.1 };
    let alike = (3..count).map(|k| gear(&format!("gear {k}"), 4 * k, 4 * (k - 1), 1.0, 0.0));
    let row = row_of_parallelograms(count, [vec![sum, brake], alike.collect()].concat());
    assert!(!MechanismSystem::fits(&row));
    let mut system = SparseSystem::new(&row, guess(&row)).unwrap();
    system.close(&[], 100).unwrap();
    let found = system.mobility(RANK_THRESHOLD).unwrap();
    assert_eq!((found.mobility, found.finite), (1, Some(1)));
    let q = system.coordinates();
    let sum: f64 = (1..count).map(|k| 0.25 * q[4 * k]).sum();
    assert!((q[0] - sum).abs() < 1e-9 && (q[4] - 0.1).abs() < 1e-9);
    // Both coordinates of a gear driven against it: the motion stops where it starts.
    let gears = (1..count).map(|k| gear(&format!("gear {k}"), 4 * k, 4 * (k - 1), 1.0, 0.0));
    let row = row_of_parallelograms(count, gears.collect());
    let system = SparseSystem::new(&row, guess(&row)).unwrap();
    let against = [Drive { coordinate: 0, to: 0.1 }, Drive { coordinate: 4, to: -0.1 }];
    let motion = system.drive(&against, &[], 2).unwrap();
    assert!(motion.stopped.is_some());
}

#[test]
fn contradictory_couplings_are_named() {
    let hinge = joint("A", JointKind::Revolute, [0, 1], [0.0; 3], [0.0, 0.0, 1.0]);
    let door = Mechanism::new("door", names(2), vec![hinge]).unwrap();
    let held = |name: &str, offset| Coupling { terms: vec![], ..gear(name, 0, 0, 1.0, offset) };
    let door = door.with_couplings(vec![held("open", 1.0), held("shut", 0.0)]).unwrap();
    let error = assemble(&door, &guess(&door), &[], 5).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("the couplings contradict each other"), "{message}");
    assert!(message.contains("; coupling \"") && !message.contains("loop"), "{message}");
}

/// The worst violation is named alone, and a loop that is closed to round-off is not.
#[test]
fn the_worse_of_an_open_loop_and_a_violated_coupling_is_named() {
    // A parallelogram cannot close if its coupler is too long; two brakes hold one crank.
    let message = |coupler: f64, offset: f64| {
        let free = planar(&[[0.0, 0.0], [0.5, 1.0], [2.5, 1.0], [2.0, 0.0]]);
        let mut joints = free.joints().to_vec();
        joints[2].frames[0].translation.x += coupler;
        let held = |name: &str, offset| Coupling { terms: vec![], ..gear(name, 0, 0, 1.0, offset) };
        let free = free.with_joints(joints).unwrap();
        let both = free.with_couplings(vec![held("one", 0.0), held("two", offset)]).unwrap();
        assemble(&both, &guess(&both), &[], 3).unwrap_err().to_string()
    };
    let loop_only = message(40.0, 0.0);
    assert!(loop_only.starts_with("the loops cannot be closed"), "{loop_only}");
    assert!(loop_only.contains("stays open by") && !loop_only.contains("coupling"), "{loop_only}");
    let coupling_only = message(0.0, 0.2);
    assert!(coupling_only.contains("is violated by"), "{coupling_only}");
    assert!(!coupling_only.contains("e0 m and"), "{coupling_only}");
}

#[test]
fn commands_that_contradict_couplings_name_them_and_advise_no_play() {
    let hinge = |k: usize| {
        joint(["A", "B", "C"][k], JointKind::Revolute, [0, k + 1], [0.0; 3], [0.0, 0.0, 1.0])
    };
    let wheels = Mechanism::new("wheels", names(4), (0..3).map(hinge).collect()).unwrap();
    let train = vec![gear("AC", 2, 0, -2.0, 0.0), gear("CB", 1, 2, -0.5, 0.0)];
    let wheels = wheels.with_couplings(train).unwrap();
    let options = SuggestOptions::default();
    let commands = [DVector::from_vec(vec![0.1, 0.3])];
    let error = suggest(&wheels, &guess(&wheels), &[0, 1], &commands, &options).unwrap_err();
    let Error::NotRelieved { couplings, .. } = &error else { panic!("{error}") };
    // C follows from A and from B, and either value may be the unintended one.
    let mut names = couplings.clone();
    names.sort();
    assert_eq!(names, ["AC", "CB"]);
    let message = error.to_string();
    assert!(
        message.contains("contradict couplings") && !message.contains("add virtual"),
        "{message}"
    );
    // Values that satisfy the train need no play.
    let commands = [DVector::from_vec(vec![0.1, 0.1])];
    assert!(!suggest(&wheels, &guess(&wheels), &[0, 1], &commands, &options).unwrap().needed);
    // An obstructing loop is none of the couplings.
    let bars = planar(&[[0.0, 0.0], [0.5, 1.0], [2.5, 1.0], [2.0, 0.0]]);
    let bars = bars.with_couplings(vec![gear("belt", 3, 0, -1.0, 0.0)]).unwrap();
    let error = relieve_commanded(&bars, &[(0, 0.1), (1, 0.7)], None).unwrap_err();
    let Error::NotRelieved { couplings, .. } = &error else { panic!("{error}") };
    assert!(couplings.is_empty(), "{error}");
}

/// Three wheels with many couplings: without a bound, the basis of 200 self-stresses takes minutes.
#[test]
fn many_redundant_couplings_have_a_basis_soon() {
    let hinge = |k: usize| {
        joint(["A", "B", "C"][k], JointKind::Revolute, [0, k + 1], [0.0; 3], [0.0, 0.0, 1.0])
    };
    let wheels = Mechanism::new("wheels", names(4), (0..3).map(hinge).collect()).unwrap();
    for (count, is_sparsest) in [(4, true), (200, false)] {
        let all = (0..count).map(|k| gear(&format!("x{k}"), 1, 0, -2.0, 0.0));
        let ring = [gear("BC", 2, 1, -0.5, 0.0), gear("CA", 0, 2, 1.0, 0.0)];
        let coupled = wheels.clone().with_couplings(all.chain(ring).collect()).unwrap();
        let system = MechanismSystem::new(&coupled, guess(&coupled)).unwrap();
        let found = mobility(&coupled);
        let first = &found.finite.instantaneous;
        assert_eq!((first.mobility, first.redundancy), (1, count));
        let stresses = self_stresses(&system, first).unwrap();
        assert_eq!(stresses.sparsest, is_sparsest);
        assert_eq!(stresses.stresses.iter().filter(|one| one.independent).count(), count);
        assert!(stresses.couplings_in_all.is_empty() && stresses.in_all.is_empty());
        let home = guess(&coupled);
        for stress in &stresses.stresses {
            // In equilibrium on every wheel; pairs of equal couplings, or one ring of three.
            let mut torque = home.clone();
            for one in &stress.couplings {
                let coupling = &coupled.couplings()[one.coupling];
                let (leader, ratio) = coupling.terms[0];
                let force = one.force / 1.0_f64.hypot(ratio);
                torque[coupling.follower.joint] += force;
                torque[leader.joint] -= ratio * force;
            }
            assert!(torque.amax() < 1e-9, "{torque}");
            assert!((2..=3).contains(&stress.couplings.len()), "{stress:?}");
        }
    }
}

/// Loops of four to seven joints with a screw among them.
fn screwed() -> impl Strategy<Value = (Vec<Joint>, f64)> {
    let kind = prop_oneof![
        4 => Just(JointKind::Revolute),
        1 => Just(JointKind::Prismatic),
        1 => Just(JointKind::Universal),
        1 => Just(JointKind::Spherical),
    ];
    let place = (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.5..1.5_f64));
    let flat = any::<bool>();
    (prop::collection::vec((kind, place, flat), 4..8), 0.05..1.0_f64).prop_map(|(made, lead)| {
        let count = made.len();
        let joints = made.into_iter().enumerate().map(|(k, (kind, (point, turn), flat))| {
            let turn = if flat { Rotation3::identity() } else { Rotation3::new(turn.into()) };
            let frame = Pose::from_parts(Translation3::from(Vector3::from(point)), turn);
            let kind = if k == 1 { JointKind::Helical { lead } } else { kind };
            let one =
                joint(&format!("j{k}"), kind, [k, (k + 1) % count], [0.0; 3], [0.0, 0.0, 1.0]);
            Joint { frames: [frame; 2], ..one }
        });
        (joints.collect(), lead)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// A screw is a cylindrical joint whose slide follows its turn.
    #[test]
    fn a_coupled_coordinate_is_one_that_was_substituted((joints, lead) in screwed()) {
        let count = joints.len();
        let screw = Mechanism::new("screw", names(count), joints.clone()).unwrap();
        let mut joints = joints;
        joints[1].kind = JointKind::Cylindrical;
        let [slide, turn] = [0, 1].map(|freedom| JointCoordinate { joint: 1, freedom });
        let thread = Coupling {
            name: "thread".to_owned(),
            follower: slide,
            terms: vec![(turn, lead)],
            offset: 0.0,
        };
        let coupled = Mechanism::new("screw", names(count), joints)
            .unwrap()
            .with_couplings(vec![thread])
            .unwrap();
        prop_assert_eq!(screw.kutzbach_mobility(), coupled.kutzbach_mobility());
        let (one, other) = (mobility(&screw), mobility(&coupled));
        let (a, b) = (&one.finite.instantaneous, &other.finite.instantaneous);
        let clear = |found: &jointplay_core::mobility::InstantaneousMobility| {
            found.smallest_nonzero().is_none_or(|least| least > 1e-6)
        };
        prop_assume!(clear(a) && clear(b));
        prop_assert_eq!((a.mobility, a.redundancy), (b.mobility, b.redundancy));
        prop_assert_eq!(a.rank + 1, b.rank);
        prop_assert_eq!(one.finite.mobility, other.finite.mobility);
        // Jacobian against differences, away from home.
        let system = MechanismSystem::new(&coupled, guess(&coupled)).unwrap();
        let mut at = system.at_home();
        at.coordinates.iter_mut().enumerate().for_each(|(k, q)| *q = [0.1, -0.2, 0.15, 0.05][k % 4]);
        let (jacobian, step) = (system.constraint_jacobian(&at), 1e-6);
        for k in 0..at.coordinates.len() {
            let moved = |by: f64| {
                let mut there = at.clone();
                there.coordinates[k] += by;
                system.residual(&there)
            };
            let difference = (moved(step) - moved(-step)) / (2.0 * step);
            prop_assert!((difference - jacobian.column(k)).amax() < 1e-8);
        }
        // The same positions for the same turn of the thread, where the loop can follow.
        if a.mobility == 1 && one.finite.mobility == Some(1) {
            let positions = |mechanism: &Mechanism, turn: usize| {
                let mut start = guess(mechanism);
                start[turn] = 0.05;
                let held = [turn];
                let system = MechanismSystem::new(mechanism, start).unwrap();
                let free: Vec<usize> =
                    (0..system.home().len()).filter(|k| !held.contains(k)).collect();
                jointplay_core::mechanism::close(&system, &free, 100).unwrap()
            };
            let freedoms = screw.joints()[0].kind.freedoms();
            let found = [positions(&screw, freedoms), positions(&coupled, freedoms + 1)];
            if found.iter().all(|one| one.is_closed()) {
                let [a, b] = found.map(|one| one.coordinates);
                prop_assert!((b[freedoms] - lead * b[freedoms + 1]).abs() < 1e-10);
                let far = a.amax().max(b.amax()) > 0.6;
                let rest = b.clone().remove_row(freedoms);
                prop_assert!(far || (&a - &rest).amax() < 1e-8, "{} {}", a, rest);
            }
        }
    }
}

#[test]
fn a_whole_turn_of_a_coupled_hinge_is_not_removed() {
    // The guess of the follower is far from what the leader requires.
    let mut gears = planar(&[[0.0, 0.0], [0.5, 1.0], [2.5, 1.0], [2.0, 0.0]]);
    let mut joints = gears.joints().to_vec();
    joints[0].guess = vec![FRAC_PI_2 / 3.0];
    joints[3].guess = vec![0.0];
    gears = gears.with_joints(joints).unwrap();
    let turns = gear("belt", 3, 0, -1.0, 2.0 * PI);
    let gears = gears.with_couplings(vec![turns]).unwrap();
    let found = match assemble(&gears, &guess(&gears), &[], 60) {
        Ok(closed) => closed,
        Err(Error::NotAssembled(found)) => found.nearest.unwrap(),
        Err(error) => panic!("{error}"),
    };
    assert!(found.is_closed());
    let q = found.coordinates;
    assert!((q[3] + q[0] - 2.0 * PI).abs() < 1e-10, "{q}");
}

/// Cranks on a base, joined by a coupler; the hinges of the cranks are coupled, so that no motion is left.
fn locked(points: [[f64; 2]; 4], ratio: f64) -> Mechanism {
    planar(&points).with_couplings(vec![gear("belt", 3, 0, ratio, 0.0)]).unwrap()
}

const TRAPEZOID: [[f64; 2]; 4] = [[0.0, 0.0], [0.5, 1.0], [2.0, 1.0], [2.5, 0.0]];

#[test]
fn a_slide_relieves_a_belt_of_another_ratio_by_the_distance_of_the_crank_pins() {
    let slide = VirtualJoint {
        name: "slide".to_owned(),
        joint: 2,
        carrier: Carrier::First,
        motion: VirtualMotion::Slide(Vector3::x_axis()),
        clearance: None,
        stiffness: None,
    };
    for (ratio, command) in [(1.0, 0.05), (-0.5, 0.1), (2.0, -0.04)] {
        let mechanism = locked(TRAPEZOID, ratio).with_virtual_joints(vec![slide.clone()]).unwrap();
        let found = relieve_commanded(&mechanism, &[(0, command)], None).unwrap();
        // The last hinge leads from the crank to the base.
        let [a, b] = [Vector2::new(0.0, 0.0), Vector2::new(2.5, 0.0)];
        let c = a + Rotation2::new(command) * Vector2::new(0.5, 1.0);
        let d = b + Rotation2::new(-ratio * command) * Vector2::new(-0.5, 1.0);
        let expected = (d - c).norm() - 1.5;
        let off = found.virtual_joints[0].abs() - expected.abs();
        assert!(off.abs() < 1e-9, "{ratio}: {:?} {expected}", found.virtual_joints);
        assert!(mechanism.couplings_hold(&found.coordinates, 1e-10));
    }
}

#[test]
fn suggested_joints_keep_the_couplings_and_their_symmetry() {
    for (ratio, is_symmetric) in [(1.0, true), (0.5, false)] {
        let mechanism = locked(TRAPEZOID, ratio);
        let home = guess(&mechanism);
        let commands = [0.05, -0.05].map(|by| DVector::from_element(1, by));
        let found =
            suggest(&mechanism, &home, &[0], &commands, &SuggestOptions::default()).unwrap();
        assert!(found.needed && !found.sets.is_empty());
        for set in found.sets.iter().take(6) {
            let relieved =
                mechanism.clone().with_virtual_joints(set.virtual_joints.clone()).unwrap();
            for (command, at) in commands.iter().zip(&set.configurations) {
                assert!(mechanism.couplings_hold(at, 1e-9), "{set:?}");
                assert!((at[0] - command[0]).abs() < 1e-12);
                let again = relieve_commanded(&relieved, &[(0, command[0])], None).unwrap();
                assert!(relieved.couplings_hold(&again.coordinates, 1e-9), "{set:?}");
            }
            assert!(set.size >= found.lower_bound * (1.0 - 1e-9));
        }
        // No smaller displacement than that of a slide along the coupler.
        let slide = (Rotation2::new(-ratio * 0.05) * Vector2::new(-0.5, 1.0)
            + Vector2::new(2.5, 0.0)
            - Rotation2::new(0.05) * Vector2::new(0.5, 1.0))
        .norm()
            - 1.5;
        assert!(found.sets[0].size <= slide.abs() + 1e-9, "{} {slide}", found.sets[0].size);
        // The mirror maps the hinges onto each other, and a belt of another ratio onto none that is there.
        let only = SuggestOptions { symmetric_only: true, ..SuggestOptions::default() };
        let symmetric = suggest(&mechanism, &home, &[0], &commands, &only).unwrap();
        assert_eq!(symmetric.in_class > 0.0, is_symmetric, "{ratio}: {}", symmetric.in_class);
    }
}
