//! Fast positions where there are none, and again.

use std::f64::consts::TAU;

use crate::robot;

use jointplay_core::Error;
use jointplay_core::bulk::Status;
use jointplay_core::mechanism::{
    CommandedPositions, Joint, JointKind, Mechanism, MechanismSystem, PositionSolver, ReliefSolver,
    relieve_commanded,
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
    let there = system.with_home(coordinates.clone()).unwrap();
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

/// The rotation vector of a commanded ball is what was commanded, also beyond half a turn, where another one is shorter.
#[test]
fn a_commanded_ball_keeps_its_coordinates() {
    let mut joints: Vec<Joint> = four_bar().joints().to_vec();
    joints[..3].iter_mut().for_each(|joint| joint.kind = JointKind::Spherical);
    let mechanism = Mechanism::new("with balls", names(4), joints).unwrap();
    let rest = DVector::zeros(mechanism.joint_freedoms());
    let system = MechanismSystem::new(&mechanism, rest.clone()).unwrap();
    let mut solver = PositionSolver::new(&system, &[0, 1, 2]).unwrap();
    for command in [[0.0, 0.0, 0.2], [0.01, -0.02, 0.1], [0.0, 0.0, TAU + 0.2]] {
        let mut one = rest.clone();
        one.rows_mut(0, 3).copy_from_slice(&command);
        let mut many = one.clone();
        solver.solve(one.as_mut_slice(), ReliefSolver::Newton).unwrap();
        let (residual, status) = (&mut [0.0], &mut [Status::Solved]);
        solver.solve_many(many.as_mut_slice(), ReliefSolver::Newton, residual, status).unwrap();
        assert_eq!(status, &[Status::Solved]);
        for found in [one, many] {
            assert_eq!(found.as_slice()[..3], command);
            assert!(mismatch(&system, &found) < 1e-12, "{found}");
        }
    }
}

/// A crank of 1, a coupler of 2.5 and a rocker of 3 on a base of 3.5, the crank along the base at first.
fn crank_rocker() -> (Mechanism, [f64; 2]) {
    let reach: f64 = 2.5;
    // The triangle of coupler, rocker and what the crank leaves of the base.
    let x = 1.0 + (reach * reach + 2.5 * 2.5 - 9.0) / (2.0 * reach);
    let y = (2.5_f64.powi(2) - (x - 1.0).powi(2)).sqrt();
    let points = [[0.0, 0.0], [1.0, 0.0], [x, y], [3.5, 0.0]];
    let joints = (0..4).map(|k| {
        let [x, y] = points[k];
        let (kind, z) = (JointKind::Revolute, [0.0, 0.0, 1.0]);
        joint(["A", "B", "C", "D"][k], kind, [k, (k + 1) % 4], [x, y, 0.0], z)
    });
    (Mechanism::new("crank-rocker", names(4), joints.collect()).unwrap(), [x, y])
}

/// Angle of the rocker with the crank at an angle, by the cosine rule; on the branch with the knee above.
fn rocker(crank: f64) -> f64 {
    let (x, y) = (3.5 - crank.cos(), -crank.sin());
    let reach = x.hypot(y);
    let at_d = ((9.0 + reach * reach - 6.25) / (6.0 * reach)).acos();
    (-y).atan2(-x) - at_d
}

#[test]
fn a_position_far_away_is_found_on_the_branch_of_the_start() {
    let (linkage, _) = crank_rocker();
    let home = DVector::zeros(4);
    let mut positions = CommandedPositions::new(&linkage, &home, &[0]).unwrap();
    for degrees in [-725.0, -170.0, -1e-9, 0.0, 0.3, 30.0, 180.0, 359.0, 1080.0_f64] {
        let (crank, mut found) = (degrees.to_radians(), home.clone());
        let solved = positions.follow(&linkage, &[crank], &mut found, ReliefSolver::LeastNorm);
        assert!(solved.unwrap() < 1e-11);
        assert_eq!(found[0], crank);
        // Joint D turns the base against the rocker.
        let expected = rocker(0.0) - rocker(crank);
        let turns = ((found[3] - expected) / TAU).round();
        let error = found[3] - expected - turns * TAU;
        assert!(error.abs() < 1e-10, "{degrees}°: {} {expected}", found[3]);
        let mut again = home.clone();
        positions.follow(&linkage, &[crank], &mut again, ReliefSolver::LeastNorm).unwrap();
        assert_eq!(again, found, "earlier calls make no difference");
    }
}

/// Newton's method alone ends on the other branch for some of these steps of the crank, and reports them as solved.
#[test]
fn successive_positions_stay_on_their_branch_whatever_the_steps() {
    let (linkage, _) = crank_rocker();
    let home = DVector::zeros(4);
    let mut positions = CommandedPositions::new(&linkage, &home, &[0]).unwrap();
    for step in [0.01, 0.11, 0.8, 2.5, -1.9] {
        let mut found = home.clone();
        for k in 1..60 {
            let crank = step * f64::from(k);
            let solver = ReliefSolver::LeastNorm;
            let solved = positions.solve_next(&linkage, &[crank], &mut found, solver);
            assert!(solved.unwrap() < 1e-11);
            let expected = rocker(0.0) - rocker(crank);
            let turns = ((found[3] - expected) / TAU).round();
            let error = found[3] - expected - turns * TAU;
            assert!(error.abs() < 1e-10, "{step} {k}: {} {expected}", found[3]);
        }
        let nothing = positions.solve_next(&linkage, &[], &mut found, ReliefSolver::LeastNorm);
        assert!(matches!(nothing, Err(Error::LengthMismatch { .. })));
        let nan = positions.solve_next(&linkage, &[f64::NAN], &mut found, ReliefSolver::LeastNorm);
        assert!(matches!(nan, Err(Error::NotFinite { .. })));
    }
}

#[test]
fn a_position_beyond_a_dead_point_is_not_found_on_the_other_branch() {
    let linkage = four_bar();
    let mut positions = CommandedPositions::new(&linkage, &DVector::zeros(4), &[0]).unwrap();
    // The coupler and the rocker in line end the motion of the crank.
    let angle = |reach: f64| ((16.0 + 4.0 - reach * reach) / 16.0_f64).acos();
    let coupler = 1.4_f64.hypot(0.3);
    let rocker = 1.0_f64.hypot(1.5);
    let most = angle(coupler + rocker) - 1.2_f64.atan2(1.6);
    for beyond in [1.1, 2.0, 5.0] {
        let mut found = DVector::zeros(4);
        let commanded = beyond * most;
        let error = positions
            .follow(&linkage, &[commanded], &mut found, ReliefSolver::LeastNorm)
            .unwrap_err();
        let Error::NotFollowed { share } = error else { panic!("{error:?}") };
        assert!((share * beyond - 1.0).abs() < 1e-2, "{share} of {beyond}");
        assert!((found[0] - share * commanded).abs() < 1e-12);
        assert!(error.is_infeasible());
    }
}

/// Of a ball whose numbers are commanded in part, each keeps its value to the last bit.
#[test]
fn a_commanded_number_of_a_ball_keeps_its_value() {
    let mechanism = gpr(polar);
    for k in [1, 2] {
        for degrees in [0.1_f64, 0.2, 1.5] {
            let found = relieve_commanded(&mechanism, &[(k, degrees.to_radians())], None).unwrap();
            assert_eq!(found.coordinates[k], degrees.to_radians());
        }
    }
}
