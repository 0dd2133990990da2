//! Fast positions where there are none, and again.
#![expect(clippy::unwrap_used, reason = "a test may fail at any line")]

mod robot;

use jointplay_core::Error;
use jointplay_core::mechanism::{
    Joint, JointKind, Mechanism, MechanismSystem, PositionSolver, ReliefSolver,
};
use jointplay_core::nalgebra::DVector;

use robot::{gpr, home, joint, names, polar};

/// A crank of 2, a coupler of 1.43 and a rocker of 1.80 on a base of 4: the crank turns on by 16.5° at most.
fn four_bar() -> Mechanism {
    let points = [[0.0, 0.0], [1.6, 1.2], [3.0, 1.5], [4.0, 0.0]];
    let joints = (0..4).map(|k| {
        let [x, y] = points[k];
        let (kind, z) = (JointKind::Revolute, [0.0, 0.0, 1.0]);
        joint(["A", "B", "C", "D"][k], kind, [k, (k + 1) % 4], [x, y, 0.0], z)
    });
    Mechanism::new("four-bar", names(4), joints.collect()).unwrap()
}

/// Largest mismatch of the loops, by the equations of the system.
fn mismatch(system: &MechanismSystem<'_>, coordinates: &DVector<f64>) -> f64 {
    let there = system.at(coordinates.clone()).unwrap();
    there.loop_residuals().into_iter().map(|(_, size)| size).fold(0.0, f64::max)
}

fn unreached(
    solver: &mut PositionSolver,
    coordinates: &mut DVector<f64>,
    relief: ReliefSolver,
) -> (f64, usize) {
    match solver.solve(coordinates.as_mut_slice(), relief) {
        Err(Error::NotReached { residual, iterations, .. }) => (residual, iterations),
        other => panic!("{other:?}"),
    }
}

/// Commands an impossible position: the remaining residual is at most that of the start, and is the one reported.
#[track_caller]
fn check(mechanism: &Mechanism, commanded: &[usize], start: &DVector<f64>) {
    let system = MechanismSystem::new(mechanism, start.clone()).unwrap();
    let mut solver = PositionSolver::new(&system, commanded).unwrap();
    let mut position = start.clone();
    let (residual, iterations) = unreached(&mut solver, &mut position, ReliefSolver::LeastNorm);
    assert!(iterations > 10, "{iterations}");
    for &k in commanded {
        assert_eq!(position[k], start[k]);
    }
    let found = mismatch(&system, &position);
    assert!((found - residual).abs() < 1e-9 * residual, "{found} {residual}");
    assert!(residual <= mismatch(&system, start) * (1.0 + 1e-9), "{residual}");
    // From there it can get better only.
    let mut again = position.clone();
    let (next, _) = unreached(&mut solver, &mut again, ReliefSolver::LeastNorm);
    assert!(next <= residual * (1.0 + 1e-9), "{next} after {residual}");
}

#[test]
fn what_cannot_be_reached_leaves_the_best_iterate() {
    let linkage = four_bar();
    for degrees in [17.0, 20.0, 30.0, 50.0, 70.0, 90.0, 120.0, 150.0_f64] {
        let start = DVector::from_vec(vec![degrees.to_radians(), 0.0, 0.0, 0.0]);
        check(&linkage, &[0], &start);
    }
    // Rods that differ ask for a tilt, and without virtual joints a platform on three upright rods has none.
    let rigid = gpr(|_, _| Vec::new());
    for higher in [0.02, 0.05, 0.4] {
        let mut start = home(&rigid);
        (start[0], start[4], start[8]) = (0.5, 0.5 + higher, 0.5);
        check(&rigid, &[0, 4, 8], &start);
    }
}

#[test]
fn beyond_all_numbers_the_start_is_left_alone() {
    let mechanism = gpr(polar);
    let system = MechanismSystem::new(&mechanism, home(&mechanism)).unwrap();
    let mut solver = PositionSolver::new(&system, &[0, 4, 8]).unwrap();
    let mut position = home(&mechanism);
    (position[0], position[4]) = (1e308, -1e308);
    let start = position.clone();
    let (residual, _) = unreached(&mut solver, &mut position, ReliefSolver::LeastNorm);
    assert_eq!((residual, position), (f64::INFINITY, start));
}

/// The same question has the same answer, to the last bit, whatever was asked before.
#[test]
fn a_solver_does_not_remember() {
    let mut crossed: Vec<Joint> = four_bar().joints().to_vec();
    crossed[2].kind = JointKind::Spherical;
    let with_ball = Mechanism::new("with a ball", names(4), crossed).unwrap();
    for mechanism in [four_bar(), with_ball] {
        let rest = DVector::zeros(mechanism.joint_freedoms());
        let system = MechanismSystem::new(&mechanism, rest.clone()).unwrap();
        let fresh = PositionSolver::new(&system, &[0]).unwrap();
        let mut used = fresh.clone();
        for degrees in [1.0, 1.5, 90.0, 10.0, 10.0, -20.0, 10.3_f64] {
            let mut here = rest.clone();
            here[0] = degrees.to_radians();
            let mut there = here.clone();
            let one = used.solve(here.as_mut_slice(), ReliefSolver::LeastNorm);
            let other = fresh.clone().solve(there.as_mut_slice(), ReliefSolver::LeastNorm);
            assert_eq!((one, here), (other, there), "{degrees}");
        }
    }
}
