//! Many configurations of a mechanism at a time, compared with one by one.

use jointplay::Error;
use jointplay::bulk::Status;
use jointplay::format::{catalogue, mechanism as file};
use jointplay::mechanism::{
    CommandedPositions, DifferentialKinematics, Mechanism, MechanismSystem, PositionSolver,
    ReliefSolver, assemble, guess,
};
use jointplay::nalgebra::DVector;
use jointplay::study::parallel;
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// A mechanism of the catalogue, closed, and the coordinates of its motors.
fn closed(name: &str) -> (Mechanism, DVector<f64>, Vec<usize>) {
    let mechanism = file::parse(catalogue::find(name).unwrap().text).unwrap().mechanism;
    let driven = mechanism.actuated_coordinates();
    let home = assemble(&mechanism, &guess(&mechanism), &driven, 0).unwrap().coordinates;
    (mechanism, home, driven)
}

/// Rows with the commanded coordinates at random values around home: near ones, some far beyond what the mechanism reaches, and one that is no number.
fn rows(home: &DVector<f64>, driven: &[usize], reach: f64, count: usize) -> Vec<f64> {
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]);
    let mut rows = Vec::with_capacity(count * home.len());
    for row in 0..count {
        let mut here = home.clone();
        let reach = if row % 37 == 36 { 400.0 * reach } else { reach };
        driven.iter().for_each(|&k| here[k] += reach * random.random_range(-1.0..1.0));
        if row == 5 {
            here[driven[0]] = f64::NAN;
        }
        rows.extend_from_slice(here.as_slice());
    }
    rows
}

/// Whether commands determine all coordinates at a closed configuration.
fn is_determined(mechanism: &Mechanism, driven: &[usize], at: &[f64]) -> bool {
    let system = MechanismSystem::new(mechanism, DVector::from_column_slice(at)).unwrap();
    DifferentialKinematics::new(&system, driven).unwrap().linearize(at).is_ok()
}

#[test]
fn many_at_a_time_are_those_one_by_one() {
    let all = [
        ("four-bar", 0.3),
        ("bennett", 0.3),
        ("sarrus", 0.2),
        ("3-rps", 0.02),
        ("hexapod", 0.02),
        ("delta", 0.2),
        ("slider-crank", 0.5),
        ("3-prs", 0.01),
        ("orthoglide", 0.02),
        ("tripteron", 0.02),
        ("schatz", 0.1),
        ("gpr-mechanism", 1e-4),
    ];
    let (mut determined, mut unreached) = (0, 0);
    for (name, reach) in all {
        let (mechanism, home, driven) = closed(name);
        let width = home.len();
        let start = rows(&home, &driven, reach, 150);
        let system = MechanismSystem::new(&mechanism, home).unwrap();
        let mut solver = PositionSolver::new(&system, &driven).unwrap();
        for relief in [ReliefSolver::Newton, ReliefSolver::LeastNorm] {
            let mut found = start.clone();
            let (mut residuals, mut status) = (vec![0.0; 150], vec![Status::BeyondLimits; 150]);
            let tally = solver.solve_many(&mut found, relief, &mut residuals, &mut status).unwrap();
            assert_eq!(tally.count(Status::NotFinite), 1, "{name}");
            for (row, (found, from)) in found.chunks(width).zip(start.chunks(width)).enumerate() {
                let mut one = from.to_vec();
                match solver.solve(&mut one, relief) {
                    Ok(position) => {
                        assert_eq!(status[row], Status::Solved, "{name} {row}");
                        assert!(
                            residuals[row] < 1e-11 && position.residual < 1e-11,
                            "{name} {row}"
                        );
                        // Far commands may end at another closed configuration.
                        if row % 37 != 36 && is_determined(&mechanism, &driven, &one) {
                            let apart = found.iter().zip(&one).map(|(a, b)| (a - b).abs());
                            let apart = apart.fold(0.0, f64::max);
                            assert!(apart < 1e-9, "{name} {row}: {apart:e}");
                            determined += 1;
                        }
                    }
                    // Far commands may be reached with other steps.
                    Err(_) if row % 37 == 36 && status[row] == Status::Solved => {
                        assert!(residuals[row] < 1e-11, "{name} {row}");
                    }
                    Err(error) => {
                        assert_eq!(Some(status[row]), Status::of(&error), "{name} {row}");
                        assert!(found.iter().all(|value| value.is_nan()), "{name} {row}");
                        assert!(residuals[row].is_nan(), "{name} {row}");
                        unreached += usize::from(status[row] == Status::NotConverged);
                    }
                }
            }
        }
    }
    assert!(determined > 1500 && unreached > 10, "{determined} {unreached}");
}

#[test]
fn a_row_does_not_depend_on_the_others() {
    for (name, reach) in
        [("delta", 0.2), ("3-rps", 0.02), ("bennett", 0.3), ("gpr-mechanism", 1e-4)]
    {
        let (mechanism, home, driven) = closed(name);
        let width = home.len();
        let start = rows(&home, &driven, reach, 1100);
        let positions = CommandedPositions::new(&mechanism, &home, &driven).unwrap();
        let solve = |rows: &[f64]| {
            let count = rows.len() / width;
            let mut rows = rows.to_vec();
            let (mut residuals, mut status) = (vec![0.0; count], vec![Status::Solved; count]);
            let tally = parallel::positions_many(
                &positions,
                &mechanism,
                &mut rows,
                ReliefSolver::LeastNorm,
                &mut residuals,
                &mut status,
            );
            assert_eq!(tally.unwrap().poses(), count);
            rows.iter().map(|value| value.to_bits()).collect::<Vec<u64>>()
        };
        let all = solve(&start);
        for (first, last) in [(0, 1), (3, 4), (7, 40), (1000, 1100)] {
            let some = solve(&start[first * width..last * width]);
            assert!(some == all[first * width..last * width], "{name} {first}");
        }
        let backward: Vec<f64> = start.chunks(width).rev().flatten().copied().collect();
        let backward = solve(&backward);
        let again = backward.chunks(width).rev().flatten().copied();
        assert!(again.eq(all.iter().copied()), "{name}");
    }
}

#[test]
fn rows_and_columns_of_different_length_are_refused() {
    let (mechanism, home, driven) = closed("four-bar");
    let system = MechanismSystem::new(&mechanism, home.clone()).unwrap();
    let mut solver = PositionSolver::new(&system, &driven).unwrap();
    let mut positions = CommandedPositions::new(&mechanism, &home, &driven).unwrap();
    for (numbers, residuals) in [(11, 3), (13, 3), (12, 2), (0, 3)] {
        let (mut rows, mut column) = (vec![0.1; numbers], vec![0.0; residuals]);
        let mut status = [Status::Solved; 3];
        let newton = ReliefSolver::Newton;
        let found = solver.solve_many(&mut rows, newton, &mut column, &mut status);
        assert!(matches!(found, Err(Error::LengthMismatch { .. })), "{numbers} {residuals}");
        let found = positions.solve_many(&mechanism, &mut rows, newton, &mut column, &mut status);
        assert!(matches!(found, Err(Error::LengthMismatch { .. })), "{numbers} {residuals}");
    }
    let none = solver.solve_many(&mut [], ReliefSolver::Newton, &mut [], &mut []).unwrap();
    assert_eq!(none.poses(), 0);
}
