//! Sparse algebra against dense, and mechanisms too large for dense.

use crate::families;
use crate::robot;
use std::ops::ControlFlow;

use families::{bennett_row, scissor_lift};
use jointplay_core::Error;
use jointplay_core::constraint::System as _;
use jointplay_core::gpr::Gpr;
use jointplay_core::mechanism::{
    Coupling, Drive, DrivePath, JointCoordinate, JointKind, Mechanism, MechanismError,
    MechanismSystem, SparseMobility, SparseSystem, assemble, guess,
};
use jointplay_core::mobility::{RANK_THRESHOLD, finite_mobility};
use jointplay_core::nalgebra::{DVector, Vector3};
use proptest::prelude::*;

fn mobility(mechanism: &Mechanism) -> SparseMobility {
    let mut system = SparseSystem::new(mechanism, guess(mechanism)).unwrap();
    system.close(&[], 100).unwrap();
    system.mobility(RANK_THRESHOLD).unwrap()
}

/// By dense algebra and by sparse: the same counts, and the same answer where sparse algebra has one.
#[track_caller]
fn check(mechanism: &Mechanism) {
    let closed = assemble(mechanism, &guess(mechanism), &[], 0).unwrap();
    let dense = MechanismSystem::new(mechanism, closed.coordinates).unwrap();
    let expected = finite_mobility(&dense, &dense.at_home(), RANK_THRESHOLD).unwrap();
    let found = mobility(mechanism);
    let first = &expected.instantaneous;
    assert_eq!(
        (found.mobility, found.rank, found.redundancy, found.finite),
        (first.mobility, first.rank, first.redundancy, expected.mobility)
    );
    let null_space = found.null_space().unwrap();
    assert_eq!(null_space.shape(), (mechanism.joint_freedoms(), found.mobility));
}

#[test]
fn both_algebras_agree() {
    check(&scissor_lift(3));
    check(&bennett_row(2));
    // Level, the robot is infinitesimally mobile: instantaneous mobility 3, finite mobility 1.
    let robot = robot::gpr(|_, _| Vec::new());
    let mut level = robot::home(&robot);
    (0..3).for_each(|k| level[4 * k] = 0.5);
    let found = SparseSystem::new(&robot, level).unwrap().mobility(RANK_THRESHOLD).unwrap();
    assert_eq!((found.mobility, found.rank, found.redundancy), (3, 9, 3));
    assert_eq!((found.lower_bound, found.upper_bound, found.finite), (1, 1, Some(1)));
}

#[test]
fn many_motions_of_one_block_are_refused_in_time() {
    let hinge = |k: usize| {
        let point = [k as f64 * 0.1, 0.0, 0.0];
        robot::joint(&format!("j{k}"), JointKind::Revolute, [k, k + 1], point, [0.0, 0.0, 1.0])
    };
    let chain = |hinges: usize| {
        let first = JointCoordinate { joint: 0, freedom: 0 };
        let follower = JointCoordinate { joint: hinges - 1, freedom: 0 };
        let coupling =
            Coupling { name: "gear".into(), follower, terms: vec![(first, -1.0)], offset: 0.0 };
        Mechanism::new("chain", robot::names(hinges + 1), (0..hinges).map(hinge).collect())
            .and_then(|chain| chain.with_couplings(vec![coupling]))
            .unwrap()
    };
    assert_eq!(mobility(&chain(40)).finite, Some(39));
    let long = chain(200);
    let system = SparseSystem::new(&long, guess(&long)).unwrap();
    assert!(matches!(
        system.mobility(RANK_THRESHOLD),
        Err(Error::TooConnected { found: 101.., allowed: 100, .. })
    ));
}

#[test]
fn what_cannot_move_at_all() {
    let fixed = |count: usize| {
        let joint = |k: usize| {
            robot::joint(
                &format!("j{k}"),
                JointKind::Fixed,
                [0, 1],
                [1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0],
            )
        };
        Mechanism::new("fixed", robot::names(2), (0..count).map(joint).collect()).unwrap()
    };
    check(&fixed(1));
    check(&fixed(2));
    let still = fixed(2);
    let system = SparseSystem::new(&still, guess(&still)).unwrap();
    // Nowhere to go is no obstacle.
    let mut reported = Vec::new();
    let motion = system
        .drive_along(&DrivePath::through(vec![], vec![vec![]; 2]).unwrap(), &[], 3, &mut |done| {
            reported.push(done);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!((motion.waypoints.len(), motion.stopped), (4, None));
    assert_eq!(reported, [1, 2, 3]);
    // Of the base alone there is no mechanism, so that no system has to be ready for it.
    let alone = Mechanism::new("alone", robot::names(1), Vec::new());
    assert_eq!(alone, Err(MechanismError::NoJoints));
}

#[test]
fn a_thousand_loops() {
    // A lift turns about its foot, and folds.
    let lift = mobility(&scissor_lift(1001));
    assert_eq!((lift.mobility, lift.redundancy, lift.finite), (2, 3000, Some(2)));
    // So high that what bends it is as small as what damping hides.
    let higher = mobility(&scissor_lift(4200));
    assert_eq!((higher.mobility, higher.redundancy, higher.finite), (2, 12_597, Some(2)));
    let row = mobility(&bennett_row(1000));
    assert_eq!((row.mobility, row.redundancy, row.finite), (1, 3000, Some(1)));
    for found in [lift, row] {
        // What counts as zero and what does not are far from the threshold.
        assert!(found.largest_zero.unwrap() < 0.3 * found.threshold);
        assert!(found.smallest_nonzero.unwrap() > 1e4 * found.threshold);
    }
}

#[test]
fn a_tall_lift_folds() {
    let stages = 200;
    let mechanism = scissor_lift(stages);
    let [foot, middle] = ["foot", "middle 0"].map(|name| mechanism.joint(name).unwrap());
    let system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
    let coordinate = |joint| system.kinematics().coordinates_of(joint).start;
    // The first bar stays, the other folds onto it by half a radian and more.
    let drives = [
        Drive { coordinate: coordinate(foot), to: 0.0 },
        Drive { coordinate: coordinate(middle), to: 0.6 },
    ];
    let motion = system.clone().drive(&drives, &[], 4).unwrap();
    assert_eq!((motion.stopped, motion.waypoints.len()), (None, 5));
    for waypoint in &motion.waypoints {
        assert!(waypoint.residual < 1e-11 && waypoint.free_mobility == 0);
        // Bars of odd stages stay parallel to the first, and each stage shifts the next by the other bar's rise.
        let angle = std::f64::consts::PI - 1.0 + waypoint.coordinates[coordinate(middle)];
        let poses = {
            let mut there = SparseSystem::new(&mechanism, waypoint.coordinates.clone()).unwrap();
            there.close(&drives.map(|drive| drive.coordinate), 10).unwrap();
            there.link_poses().to_vec()
        };
        let bar = |turn: f64| Vector3::new((0.5 + turn).cos(), (0.5 + turn).sin(), 0.0);
        let left_of_a_stage = bar(0.0) + bar(angle);
        for stage in 0..stages {
            #[expect(clippy::cast_precision_loss, reason = "a count of stages")]
            let expected = left_of_a_stage * stage as f64;
            let off = poses[2 * stage + 1].translation.vector - expected;
            // Each joint is closed to 1e-13 rad, and turns all stages beyond it: the sum of their distances grows as the square.
            #[expect(clippy::cast_precision_loss, reason = "a count of stages")]
            let allowed = 1e-13 * ((stage + 1) * (stage + 1)) as f64;
            assert!(off.norm() < allowed, "stage {stage}: {off:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Starts in which every pin is turned at random, so that far links are metres away and some stages are nearly stretched.
    #[test]
    fn many_loops_close_from_far_away(
        stages in 5_usize..60,
        is_lift in any::<bool>(),
        turns in prop::collection::vec(-0.6..0.6_f64, 240),
    ) {
        let mechanism = if is_lift { scissor_lift(stages) } else { bennett_row(stages) };
        let start = guess(&mechanism);
        let start = DVector::from_fn(start.len(), |k, _| start[k] + turns[k]);
        let mut system = SparseSystem::new(&mechanism, start).unwrap();
        let iterations = system.close(&[], 200);
        prop_assert!(iterations.is_ok(), "{iterations:?}");
        let poses = system.link_poses();
        for joint in mechanism.joints() {
            let [first, second] = [0, 1].map(|side| poses[joint.links[side]] * joint.frames[side]);
            let apart = first.translation.vector - second.translation.vector;
            let axes = first.rotation * Vector3::z() - second.rotation * Vector3::z();
            prop_assert!(apart.norm() < 1e-10 && axes.norm() < 1e-10, "{}", joint.name);
        }
    }
}

#[test]
fn open_loops_are_reported() {
    let mut joints = bennett_row(50).joints().to_vec();
    // A link that is a tenth of a millimetre too long, in a row without play to compensate it.
    joints[60].frames[0].translation.vector.x += 1e-4;
    let names = (0..102).map(|k| format!("link {k}")).collect();
    let mechanism = Mechanism::new("row", names, joints).unwrap();
    let mut system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
    let error = system.close(&[], 50).unwrap_err();
    let Error::NotReached { residual, .. } = error else { panic!("{error}") };
    assert!((1e-8..1e-2).contains(&residual), "{residual:e}");
    assert_eq!(residual, system.residual());
    assert!(matches!(system.mobility(RANK_THRESHOLD), Err(Error::NotClosed { .. })));
}

/// Rotation vectors of whole turns, at which derivatives of a rotation by its vector vanish: every motion is listed, and satisfies the dense constraints.
#[test]
fn balls_after_whole_turns_keep_all_motions() {
    let mechanism = Gpr::paper().to_mechanism("turned");
    let turn = std::f64::consts::TAU;
    let mut home = guess(&mechanism);
    home[5] = turn;
    home.rows_mut(6, 3).copy_from_slice(&[0.6 * turn, 0.0, 0.8 * turn]);
    let found = SparseSystem::new(&mechanism, home.clone()).unwrap().mobility(RANK_THRESHOLD);
    let found = found.unwrap();
    assert_eq!((found.mobility, found.motions.len(), found.finite), (3, 3, Some(1)));
    let dense = MechanismSystem::new(&mechanism, home).unwrap();
    let at = dense.at_home();
    let length = found.characteristic_length;
    let units: Vec<f64> =
        dense.coordinate_dimensions().iter().map(|one| one.unit(length)).collect();
    for motion in found.null_space().unwrap().column_iter() {
        assert!(motion.norm() > 0.1);
        let rates = DVector::from_fn(motion.len(), |k, _| motion[k] * units[k]);
        let violated = dense.constraint_jacobian(&at) * rates;
        assert!(violated.amax() < 1e-12 * motion.norm(), "{violated}");
    }
}
