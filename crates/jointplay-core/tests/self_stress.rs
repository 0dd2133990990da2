//! Redundant constraints in textbook form.

use crate::robot;

use std::collections::BTreeSet;

use jointplay_core::mechanism::{
    Mechanism, MechanismSystem, SelfStresses, StressScrew, self_stresses,
};
use jointplay_core::mobility::{RANK_THRESHOLD, instantaneous_mobility};
use jointplay_core::nalgebra::{DMatrix, Vector3};

use robot::{home, legs};

fn stresses(mechanism: &Mechanism) -> SelfStresses {
    let system = MechanismSystem::new(mechanism, home(mechanism)).unwrap();
    let first = instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    let found = self_stresses(&system, &first).unwrap();
    let basis = found.stresses.iter().filter(|one| one.independent).count();
    assert_eq!(basis, first.redundancy);
    found
}

/// Corners of a rectangle, counterclockwise.
const RECTANGLE: [[f64; 2]; 4] = [[0.1, 0.15], [-0.1, 0.15], [-0.1, -0.15], [0.1, -0.15]];

/// Balls on vertical legs press against each other in pairs: six pairs, of which any five are independent.
#[test]
fn four_vertical_legs_press_in_pairs_along_the_lines_of_their_balls() {
    let mechanism = legs(&RECTANGLE, 0.0);
    let found = stresses(&mechanism);
    assert!(found.sparsest && found.in_all.is_empty());
    assert!(found.largest_zero < 1e-13 && found.smallest_nonzero > 0.01, "{found:?}");
    let mut pairs = BTreeSet::new();
    let mut groups = [0; 3];
    for stress in &found.stresses {
        let StressScrew::Force { centers, direction, pitch, .. } = &stress.screw else {
            panic!("{stress:?}")
        };
        let legs: Vec<usize> = centers.iter().map(|ball| ball - 4).collect();
        let [a, b] = legs[..] else { panic!("{centers:?}") };
        // Legs are joints 0 to 3, balls 4 to 7.
        let joints: Vec<usize> = stress.wrenches.iter().map(|wrench| wrench.joint).collect();
        assert_eq!(joints, [a, b, a + 4, b + 4]);
        assert!(stress.single_loop && *pitch == 0.0);
        let [p, q] = [RECTANGLE[a], RECTANGLE[b]];
        let line = Vector3::new(q[0] - p[0], q[1] - p[1], 0.0).normalize();
        assert!(line.cross(direction).norm() < 1e-9);
        pairs.insert((a, b));
        groups[stress.group] += 1;
    }
    assert_eq!(pairs.len(), 6);
    // Two sides along x, two along y, two diagonals.
    assert_eq!(groups, [2, 2, 2]);
}

/// Three legs: three pairs in one group, all independent; with legs that tilt outward, none.
#[test]
fn three_vertical_legs_have_one_group_of_three_pairs() {
    let points: Vec<[f64; 2]> = [0.0_f64, 120.0, 240.0]
        .map(|a| [0.1 * a.to_radians().cos(), 0.1 * a.to_radians().sin()])
        .to_vec();
    let found = stresses(&legs(&points, 0.0));
    assert_eq!(found.stresses.len(), 3);
    assert!(found.stresses.iter().all(|one| one.group == 0 && one.independent));
    assert!(stresses(&legs(&points, 0.02)).stresses.is_empty());
}

/// Forces and moments of a self-stress are in equilibrium on each link, and releasing a joint of its support removes exactly one redundancy.
#[test]
fn self_stresses_are_in_equilibrium_on_every_link() {
    for points in [RECTANGLE.to_vec(), [[0.1, 0.0], [0.0, 0.13], [-0.1, -0.05]].to_vec()] {
        let mechanism = legs(&points, 0.0);
        for stress in stresses(&mechanism).stresses {
            for link in 0..mechanism.links().len() {
                let mut sum = [Vector3::zeros(); 2];
                for wrench in &stress.wrenches {
                    let [first, second] = mechanism.joints()[wrench.joint].links;
                    let sense =
                        f64::from(u8::from(second == link)) - f64::from(u8::from(first == link));
                    sum[0] += wrench.force * sense;
                    sum[1] += wrench.moment * sense;
                }
                assert!(sum[0].norm() + sum[1].norm() < 1e-9, "{stress:?}");
            }
        }
    }
}

/// No basis has fewer joints in total: brute force over all sets of joints.
#[test]
fn no_basis_of_self_stresses_has_fewer_joints() {
    let five = [[0.1, 0.0], [0.03, 0.1], [-0.08, 0.06], [-0.09, -0.07], [0.02, -0.11]];
    for points in [RECTANGLE.to_vec(), five.to_vec()] {
        let mechanism = legs(&points, 0.0);
        let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
        let first = instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
        let (cycles, joints) = (system.cycles(), system.cycles().ncols());
        let wrenches = DMatrix::from_fn(6 * joints, first.redundancy, |row, s| {
            (0..cycles.nrows())
                .map(|l| cycles[(l, row / 6)] * first.self_stress[(6 * l + row % 6, s)])
                .sum()
        });
        // Dimension of the span of all self-stresses with at most so many joints.
        let mut spans: Vec<Vec<f64>> = vec![Vec::new(); joints + 1];
        for set in 1_u32..1 << joints {
            let outside: Vec<usize> =
                (0..6 * joints).filter(|row| set >> (row / 6) & 1 == 0).collect();
            let rest = jointplay_core::linalg::svd(&wrenches.select_rows(&outside)).unwrap();
            let zero = rest.singular_values.iter().filter(|&&value| value > 1e-9).count();
            for column in rest.null_space(zero).column_iter() {
                spans[set.count_ones() as usize].extend(column.iter());
            }
        }
        let (mut all, mut weight, mut rank) = (Vec::new(), 0, 0);
        for (size, span) in spans.iter().enumerate() {
            all.extend(span);
            let matrix =
                DMatrix::from_column_slice(first.redundancy, all.len() / first.redundancy, &all);
            let now = jointplay_core::linalg::svd(&matrix).unwrap().rank(1e-9);
            weight += size * (now - rank);
            rank = now;
        }
        let found = stresses(&mechanism);
        let total: usize =
            found.stresses.iter().filter(|one| one.independent).map(|one| one.wrenches.len()).sum();
        assert_eq!((total, rank), (weight, first.redundancy));
    }
}
