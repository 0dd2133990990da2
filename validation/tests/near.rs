//! Near misses: mechanisms whose dimensions are true only to some digits.

use jointplay::Error;
use jointplay::constraint::System as _;
use jointplay::format::catalogue::{self, Entry};
use jointplay::format::mechanism::parse_with;
use jointplay::mechanism::{Mechanism, MechanismSystem, assemble, close, guess};
use jointplay::mobility::{
    ForcedClosure, NearMobility, RANK_THRESHOLD, finite_mobility, kutzbach_mobility, near_mobility,
};
use jointplay::nalgebra::{DVector, Rotation3, Translation3, Vector3};
use jointplay::spatial::Pose;
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// Mechanisms of the catalogue by name.
fn mechanisms() -> Vec<(&'static str, Mechanism)> {
    let is_mechanism = |entry: &&Entry| entry.kind().as_deref() == Some("mechanism");
    let read = catalogue::entries().iter().filter(is_mechanism);
    read.map(|entry| (entry.name, parse_with(entry.text, &[]).unwrap().mechanism)).collect()
}

/// With nothing left of the tolerance, what is near is what is true.
#[test]
fn near_is_finite_for_exact_dimensions() {
    let mut failures = Vec::new();
    for (name, mechanism) in mechanisms() {
        let closed = assemble(&mechanism, &guess(&mechanism), &[], 0).unwrap();
        let system = MechanismSystem::new(&mechanism, closed.coordinates).unwrap();
        let at = system.at_home();
        let finite = finite_mobility(&system, &at, RANK_THRESHOLD).unwrap().mobility;
        let near = near_mobility(&system, &at, 1e-9).unwrap();
        if Some(near.mobility) != finite || near.needed > 1e-12 {
            failures.push(format!("{name}: finite {finite:?}, {near:?}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Each joint off by up to `by`, in radians and characteristic lengths, on both of its links.
fn perturbed(mechanism: &Mechanism, by: f64, seed: u8) -> Mechanism {
    let at = assemble(mechanism, &guess(mechanism), &[], 0).unwrap().coordinates;
    let length = MechanismSystem::new(mechanism, at).unwrap().characteristic_length();
    let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let mut next = || generator.random_range(-by..by);
    let mut joints = mechanism.joints().to_vec();
    for frame in joints.iter_mut().flat_map(|joint| &mut joint.frames) {
        let turn = Rotation3::new(Vector3::new(next(), next(), next()));
        let shift = Vector3::new(next(), next(), next()) * length;
        *frame *= Pose::from_parts(Translation3::from(shift), turn);
    }
    let made = Mechanism::new(mechanism.name(), mechanism.links().to_vec(), joints).unwrap();
    made.with_characteristic_length(length).unwrap()
}

/// Closed exactly, or as well as a least tolerance allows; with it, whether exactly.
fn closed(mechanism: &Mechanism, tolerance: f64) -> (DVector<f64>, bool) {
    match assemble(mechanism, &guess(mechanism), &[], 0) {
        Ok(closure) => (closure.coordinates, true),
        Err(Error::NotAssembled(found)) => {
            (found.within(tolerance).unwrap().coordinates.clone(), false)
        }
        Err(other) => panic!("{other}"),
    }
}

/// Made not quite true, a mechanism has the mobility that is counted, and its own within a tolerance in proportion to what is untrue.
#[test]
fn untrue_mechanisms_move_within_a_tolerance() {
    (1..=3).for_each(check_untrue_mechanisms);
}

#[test]
fn otherwise_untrue_mechanisms_move_within_a_tolerance() {
    (4..=6).for_each(check_untrue_mechanisms);
}

/// The tolerance that one motion more needs at the closed configuration next to given joint coordinates.
fn next_motion(exact: &MechanismSystem<'_>, near: &DVector<f64>) -> Option<f64> {
    let start = near.clone().resize_vertically(exact.home().len(), 0.0);
    let joints: Vec<usize> = (0..near.len()).collect();
    let closed = close(&exact.with_home(start).unwrap(), &joints, 100).unwrap();
    let system = exact.with_home(closed.coordinates).unwrap();
    near_mobility(&system, &system.at_home(), 1e-9).unwrap().next
}

fn check_untrue_mechanisms(seed: u8) {
    let mut failures = Vec::new();
    for (name, mechanism) in mechanisms() {
        let system = MechanismSystem::new(&mechanism, closed(&mechanism, 0.0).0).unwrap();
        let exact = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
        let mobility = exact.mobility.unwrap();
        let freedoms: Vec<_> = mechanism.joints().iter().map(|one| one.kind.freedoms()).collect();
        let counted = kutzbach_mobility(mechanism.links().len(), &freedoms).max(0);
        let counted = usize::try_from(counted).unwrap();
        // Of exact closures, and of near ones: a tilt can close the three-rod robot exactly, with displacements in proportion to the root of what is untrue; beyond the travel of its rods it is not searched for, and found at some scales only.
        let mut shares = [Vec::new(), Vec::new()];
        for by in [1e-4, 1e-5, 1e-6] {
            let untrue = perturbed(&mechanism, by, seed);
            let (home, exactly) = closed(&untrue, 30.0 * by);
            // Well below what one motion more would need there with exact dimensions: that is no near miss.
            let tolerance = next_motion(&system, &home).map_or(f64::INFINITY, |it| it / 10.0);
            let tolerance = tolerance.min(30.0 * by);
            let untrue = MechanismSystem::new(&untrue, home).unwrap();
            let at = untrue.at_home();
            let near = near_mobility(&untrue, &at, tolerance).unwrap();
            let forced = ForcedClosure::new(&untrue, &at);
            let real = finite_mobility(&forced, &at, RANK_THRESHOLD).unwrap().mobility.unwrap();
            if (near.mobility, real) != (mobility, counted) {
                failures.push(format!(
                    "{name}, seed {seed}, {by}: {mobility} exactly, {real} finite, {near:?}"
                ));
            }
            if mobility > counted {
                shares[usize::from(!exactly)].push(near.needed / by);
            } else if near.needed > 1e-13 {
                failures.push(format!("{name}, seed {seed}, {by}: finite motion, {near:?}"));
            }
        }
        let [exact, missing] = &shares;
        let most = |shares: &[f64]| shares.iter().copied().fold(0.0, f64::max);
        let in_proportion = |shares: &[f64], factor: f64| {
            shares.iter().all(|&share| share < 20.0 && share > most(shares) / factor)
        };
        // In proportion; near closures within what it matters that the nearest configuration moves about.
        if !in_proportion(exact, 1.5)
            || !in_proportion(missing, 10.0)
            || missing.iter().any(|&share| share < 0.05)
            || exact.iter().any(|&share| share < 1e-3)
        {
            failures.push(format!("{name}, seed {seed}: {shares:?}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A mechanism of the catalogue with other dimensions, closed as well as it can be, and what moves there.
fn near(name: &str, set: &[(&str, f64)], tolerance: f64) -> (f64, usize, NearMobility) {
    near_text(catalogue::find(name).unwrap().text, set, tolerance)
}

fn near_text(text: &str, set: &[(&str, f64)], tolerance: f64) -> (f64, usize, NearMobility) {
    let set: Vec<_> = set.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    let mechanism = parse_with(text, &set).unwrap().mechanism;
    let system = MechanismSystem::new(&mechanism, closed(&mechanism, tolerance).0).unwrap();
    let at = system.at_home();
    let forced = ForcedClosure::new(&system, &at);
    let real = finite_mobility(&forced, &at, RANK_THRESHOLD).unwrap().mobility.unwrap();
    (system.mismatch(&at), real, near_mobility(&system, &at, tolerance).unwrap())
}

/// Legs of six digits: six spins are real, the motion of the platform is real but for the digits, whatever the size of the triangles.
#[test]
fn griffis_duffy_platform_with_printed_legs() {
    let text = include_str!("../golden/griffis-duffy-printed.toml");
    for r in [0.7, 1.0, 1.3] {
        let (mismatch, real, near) = near_text(text, &[("r", r)], 1e-6);
        assert!((5e-9..1e-7).contains(&mismatch), "{mismatch:e}");
        assert_eq!((real, near.mobility), (6, 7), "{near:?}");
        assert!((mismatch..2e-7).contains(&near.needed), "{near:?}");
    }
}

/// Bennett's condition kept to fewer and fewer digits.
#[test]
fn bennetts_linkage_with_rounded_lengths() {
    for (b, least, most) in [(0.11001, 5e-6, 5e-4), (0.1101, 5e-5, 5e-3), (0.111, 5e-4, 1e-2)] {
        let (mismatch, real, near) = near("bennett", &[("b", b)], 1e-2);
        assert_eq!((real, near.mobility), (0, 1), "{b} {mismatch:e} {near:?}");
        assert!((least..most).contains(&near.needed), "{b} {near:?}");
    }
}

/// The three-rod robot has one finite motion, up and down; its tilts require play, and need far more than any rounding.
#[test]
fn three_rod_robot_tilts_only_with_play() {
    let (_, real, strict) = near("gpr-mechanism", &[], 1e-5);
    assert_eq!((real, strict.mobility), (1, 1));
    let (_, _, loose) = near("gpr-mechanism", &[], 1e-2);
    assert!(loose.mobility > 1 && loose.needed > 1e-3, "{loose:?}");
}
