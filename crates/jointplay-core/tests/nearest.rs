//! The closed configuration nearest a guess: closed by an independent chain of transforms, within limits, and as near as a scan of all configurations finds.

use crate::families;
use crate::planar;

use families::{bennett_row, scissor_lift};
use jointplay_core::Error;
use jointplay_core::mechanism::{
    Coupling, Joint, JointCoordinate, JointKind, Kinematics, Mechanism, assemble, close_commanded,
    guess, nearest_closure,
};
use jointplay_core::nalgebra::{DVector, Matrix4, Rotation3, Vector3};
use planar::{at, closed_form, four_bar, joint, rings};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;

const TURN: f64 = std::f64::consts::TAU;

/// Distance of angles, each by the shorter turn.
fn distance(from: &[f64], to: &[f64]) -> f64 {
    let one = |(a, b): (&f64, &f64)| {
        let by = (a - b).rem_euclid(TURN);
        by.min(TURN - by).powi(2)
    };
    from.iter().zip(to).map(one).sum::<f64>().sqrt()
}

#[test]
fn four_bars_close_where_a_scan_of_the_crank_finds_the_nearest() {
    let lengths = [1.0, 0.4, 0.9, 0.7];
    let mechanism = four_bar(lengths);
    let mut runner = TestRunner::deterministic();
    let guesses = prop::array::uniform4(-3.1..3.1_f64);
    let (mut nearest, count) = (0, 60);
    for _ in 0..count {
        let guess = guesses.new_tree(&mut runner).unwrap().current();
        let scan = (0..4000).flat_map(|k| closed_form(lengths, f64::from(k) * TURN / 4000.0));
        let least = scan.map(|q| distance(&q, &guess)).fold(f64::INFINITY, f64::min);
        let start = DVector::from_row_slice(&guess);
        let found = nearest_closure(&mechanism, &start, &[], 30).unwrap().unwrap();
        let q = found.coordinates.as_slice();
        let exact =
            closed_form(lengths, q[0]).iter().map(|one| distance(one, q)).fold(9.0, f64::min);
        assert!(exact < 1e-9, "{q:?}");
        // The scan is as fine as its steps.
        let reached = distance(q, &guess);
        assert!(reached > least - 1e-2, "{reached} {least}");
        nearest += i32::from(reached < least + 1e-2);
    }
    assert!(nearest * 10 >= count * 9, "{nearest} of {count}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, ..ProptestConfig::default() })]

    /// A lift of sixteen stages with every pin turned by up to 45°: corrections of the joints alone close one of five such guesses.
    #[test]
    fn guesses_of_many_loops_close(turns in prop::collection::vec(-0.8..0.8_f64, 47)) {
        let mechanism = scissor_lift(16);
        let start = turned(&mechanism, &turns);
        let found = nearest_closure(&mechanism, &start, &[], 30).unwrap();
        prop_assert!(found.is_some());
        prop_assert!(pins_apart(&mechanism, &found.unwrap().coordinates) < 1e-9);
    }

    /// Where such a guess does not close, others do, and the error lists them.
    #[test]
    fn other_starts_of_many_loops_close(
        is_lift in any::<bool>(),
        turns in prop::collection::vec(-0.8..0.8_f64, 60),
    ) {
        let mechanism = if is_lift { scissor_lift(16) } else { bennett_row(12) };
        let start = turned(&mechanism, &turns);
        match assemble(&mechanism, &start, &[], 30) {
            Ok(closed) => prop_assert!(pins_apart(&mechanism, &closed.coordinates) < 1e-9),
            Err(Error::NotAssembled(found)) => {
                prop_assert!(!found.branches.is_empty() && found.nearest.is_some(), "{found}");
                for closed in found.branches.iter().chain(&found.nearest) {
                    prop_assert!(pins_apart(&mechanism, &closed.coordinates) < 1e-9);
                }
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }
}

/// The guess of a mechanism with its coordinates turned.
fn turned(mechanism: &Mechanism, turns: &[f64]) -> DVector<f64> {
    let start = guess(mechanism);
    DVector::from_fn(start.len(), |k, _| start[k] + turns[k])
}

/// Largest distance of the two frames of a joint (m).
fn pins_apart(mechanism: &Mechanism, coordinates: &DVector<f64>) -> f64 {
    let poses = Kinematics::new(mechanism).link_poses(coordinates).unwrap();
    let apart = mechanism.joints().iter().map(|joint| {
        let [first, second] = [0, 1].map(|side| poses[joint.links[side]] * joint.frames[side]);
        (first.translation.vector - second.translation.vector).norm()
    });
    apart.fold(0.0, f64::max)
}

#[test]
fn limits_are_kept_and_the_nearest_may_be_on_one() {
    let lengths = [1.0, 0.4, 0.9, 0.7];
    let whole = four_bar(lengths);
    let mut joints = whole.joints().to_vec();
    joints[0].limits = vec![[0.5, 1.0]];
    let mechanism = whole.with_joints(joints).unwrap();
    let closed = closed_form(lengths, 1.4)[0];
    let guess = DVector::from_row_slice(&closed);
    let found = nearest_closure(&mechanism, &guess, &[], 30).unwrap().unwrap();
    assert!((found.coordinates[0] - 1.0).abs() < 1e-9, "{}", found.coordinates);
    let expected = closed_form(lengths, 1.0)[0];
    assert!(distance(found.coordinates.as_slice(), &expected) < 1e-6, "{}", found.coordinates);
    // A held coordinate keeps its value, whatever its limits.
    let held = nearest_closure(&mechanism, &guess, &[0], 30).unwrap().unwrap();
    assert_eq!(held.coordinates[0], 1.4);
    assert!(distance(held.coordinates.as_slice(), &closed) < 1e-9);
}

/// A crank that a correction moves below a limit whose other end is open: its angle a turn away is within the limits, but not near.
#[test]
fn a_limit_with_one_end_holds_a_crank_on_it_and_not_a_turn_away() {
    let lengths = [1.0, 0.4, 0.9, 0.7];
    let limited = |limits: [f64; 2]| {
        let whole = four_bar(lengths);
        let mut joints = whole.joints().to_vec();
        joints[0].limits = vec![limits];
        whole.with_joints(joints).unwrap()
    };
    let guess = DVector::from_row_slice(&closed_form(lengths, 1.4)[0]);
    let expected = closed_form(lengths, 1.0)[0];
    for limits in [[0.5, 1.0], [f64::NEG_INFINITY, 1.0], [-1000.0, 1.0]] {
        let found = nearest_closure(&limited(limits), &guess, &[], 30).unwrap().unwrap();
        let off = distance(found.coordinates.as_slice(), &expected);
        assert!(off < 1e-6, "{limits:?} {}", found.coordinates);
    }
    let guess = DVector::from_row_slice(&closed_form(lengths, 0.6)[0]);
    for limits in [[1.0, 2.0], [1.0, f64::INFINITY], [1.0, 1000.0]] {
        let found = nearest_closure(&limited(limits), &guess, &[], 30).unwrap().unwrap();
        let off = distance(found.coordinates.as_slice(), &expected);
        assert!(off < 1e-6, "{limits:?} {}", found.coordinates);
    }
    // Only a turn away: angles of four-bars repeat.
    let guess = DVector::from_row_slice(&closed_form(lengths, 0.6)[0]);
    let turned = limited([1.0 + std::f64::consts::TAU, 8.0]);
    let found = nearest_closure(&turned, &guess, &[], 30).unwrap().unwrap();
    assert!((found.coordinates[0] - 1.0 - std::f64::consts::TAU).abs() < 1e-6);
}

/// Two slides, y = 3 x + 0.1: the shortest correction from zeros makes x negative.
#[test]
fn a_correction_that_ends_beyond_limits_leads_to_the_nearest_configuration_within() {
    let slide = |name, link, limits: [f64; 2]| Joint {
        limits: vec![limits],
        ..joint(name, JointKind::Prismatic, [0, link], [at(0.0), at(0.0)])
    };
    let slides = |x: [f64; 2], y: [f64; 2]| {
        let joints = vec![slide("x", 1, x), slide("y", 2, y), slide("z", 3, [-9.0, 9.0])];
        let coupling = Coupling {
            name: "c".to_owned(),
            follower: JointCoordinate { joint: 1, freedom: 0 },
            terms: vec![(JointCoordinate { joint: 0, freedom: 0 }, 3.0)],
            offset: 0.1,
        };
        let links = ["b", "c", "d", "e"].map(str::to_owned).to_vec();
        Mechanism::new("t", links, joints).unwrap().with_couplings(vec![coupling]).unwrap()
    };
    let check = |mechanism: &Mechanism, commands: &[(usize, f64)], expected: [f64; 3]| {
        let found = close_commanded(mechanism, commands, None).unwrap();
        let off = (&found.coordinates - DVector::from_row_slice(&expected)).amax();
        assert!(off < 1e-9, "{found:?}");
        found.is_searched
    };
    let bounded = slides([0.0, 0.3], [-1.0, 1.0]);
    assert!(check(&bounded, &[], [0.0, 0.1, 0.0]));
    assert!(check(&bounded, &[(2, 1.0)], [0.0, 0.1, 1.0]));
    // A correction that ends within is kept; so is a commanded value beyond its limits.
    let wide = slides([-1.0, 1.0], [-1.0, 1.0]);
    assert!(!check(&wide, &[], [-0.03, 0.01, 0.0]));
    assert!(!check(&bounded, &[(0, -0.05)], [-0.05, -0.05, 0.0]));
    // Without a configuration within the limits, the correction is returned.
    let none = slides([0.0, 0.3], [-1.0, -0.5]);
    assert!(!check(&none, &[], [-0.03, 0.01, 0.0]));
}

#[test]
fn a_tolerance_of_dimensions_does_not_forbid_the_nearest_configuration() {
    let mechanism = four_bar([1.0, 0.4, 0.9, 0.7]);
    let guess = DVector::zeros(4);
    let Err(Error::NotAssembled(found)) = assemble(&mechanism, &guess, &[], 10) else { panic!() };
    assert!(found.accepted(None).is_some());
    assert_eq!(found.accepted(Some(1e-6)), found.accepted(None));
}

#[test]
fn links_that_cannot_close_have_no_nearest_and_name_the_frames_apart() {
    let mechanism = four_bar([5.0, 0.4, 0.9, 0.7]);
    let guess = DVector::from_row_slice(&[0.1, 0.2, 0.3, 0.4]);
    assert_eq!(nearest_closure(&mechanism, &guess, &[], 10).unwrap(), None);
    let Err(Error::NotAssembled(found)) = assemble(&mechanism, &guess, &[], 10) else { panic!() };
    assert_eq!((found.nearest.as_ref(), found.accepted(None)), (None, None));
    let open = &found.loops[0];
    assert_eq!(open.links, ["coupler", "rocker"]);
    // The ends of coupler and rocker in the plane; the links miss by 5 − (0.4 + 0.9 + 0.7) at least.
    let [a, b, _, d] = found.best.coordinates.as_slice() else { panic!() };
    let coupler = [0.4 * a.cos() + 0.9 * (a + b).cos(), 0.4 * a.sin() + 0.9 * (a + b).sin()];
    let rocker = [5.0 + 0.7 * d.cos(), 0.7 * d.sin()];
    let distance = (coupler[0] - rocker[0]).hypot(coupler[1] - rocker[1]);
    assert!((open.distance - distance).abs() < 1e-9 && distance > 3.0, "{open:?} {distance}");
    let message = found.to_string();
    assert!(message.contains("its frames on links \"coupler\" and \"rocker\""), "{message}");
}

/// The motion of a joint as a matrix, from the definition of its kind.
fn motion(kind: JointKind, q: &[f64]) -> Matrix4<f64> {
    let turn = |axis: Vector3<f64>, angle: f64| Rotation3::new(axis * angle).to_homogeneous();
    let slide = |axis: Vector3<f64>, by: f64| Matrix4::new_translation(&(axis * by));
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    match kind {
        JointKind::Revolute => turn(z, q[0]),
        JointKind::Prismatic => slide(z, q[0]),
        JointKind::Cylindrical => slide(z, q[0]) * turn(z, q[1]),
        JointKind::Universal => turn(z, q[0]) * turn(x, q[1]),
        JointKind::Spherical => turn(Vector3::new(q[0], q[1], q[2]), 1.0),
        JointKind::Planar => slide(x, q[0]) * slide(y, q[1]) * turn(z, q[2]),
        _ => unreachable!("not drawn"),
    }
}

#[test]
fn random_rings_close_within_limits_and_not_farther_than_where_they_were_closed() {
    let mut runner = TestRunner::deterministic();
    let (mut closed, mut near, mut count) = (0, 0, 0);
    for _ in 0..30 {
        let joints = rings().new_tree(&mut runner).unwrap().current();
        let names = (0..6).map(|k| format!("l{k}")).collect();
        let mechanism = Mechanism::new("rings", names, joints).unwrap();
        let f = mechanism.joint_freedoms();
        let by = prop::collection::vec(-0.8..0.8_f64, f).new_tree(&mut runner).unwrap().current();
        let guess = DVector::from_vec(by);
        count += 1;
        let Some(found) = nearest_closure(&mechanism, &guess, &[], 30).unwrap() else { continue };
        closed += 1;
        let q = &found.coordinates;
        assert!(mechanism.beyond_limits(q).is_empty(), "{q}");
        // Once around each ring, the motions of the joints cancel.
        let kinematics = Kinematics::new(&mechanism);
        let transform = |j: usize, against: bool| {
            let joint = &mechanism.joints()[j];
            let q = &q.as_slice()[kinematics.coordinates_of(j)];
            let [first, second] = joint.frames.map(|frame| frame.to_homogeneous());
            let whole = first * motion(joint.kind, q) * second.try_inverse().unwrap();
            if against { whole.try_inverse().unwrap() } else { whole }
        };
        let around = |ring: &[(usize, bool)]| {
            ring.iter().fold(Matrix4::<f64>::identity(), |pose, &(j, against)| {
                pose * transform(j, against)
            })
        };
        let first = around(&[(0, false), (1, false), (2, false), (3, false)]);
        let second = around(&[(4, false), (5, false), (6, false), (2, true), (1, true)]);
        for ring in [first, second] {
            assert!((ring - Matrix4::identity()).amax() < 1e-8, "{ring}");
        }
        let size = |from: &DVector<f64>| (from - &guess).norm();
        near += usize::from(size(q) < size(&DVector::zeros(f)) * 1.3);
    }
    assert!(closed * 10 >= count * 9, "{closed} of {count}");
    assert!(near * 10 >= closed * 9, "{near} of {closed}");
}
