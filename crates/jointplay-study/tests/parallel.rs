//! Results on many cores equal those on one.

use jointplay_core::Error;
use jointplay_core::bulk::{Column, PoseSolver, Quantity, Status, StatusCounts};
use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{BuiltIn, Polar, SolveOptions, Solver};
use jointplay_study::parallel::{self, PoseColumns};

/// More than two parts, the last of them neither full nor a whole number of lanes; one tilt in a thousand has no rods.
const POSES: usize = 9_001;

fn tilts() -> (Vec<f64>, Vec<f64>) {
    let azimuth = (0..POSES).map(|i| i as f64 * 0.7).collect();
    let tilt_angle = |i: usize| if i % 1000 == 17 { 2.0 } else { 0.03 * (i as f64 * 0.37).sin() };
    (azimuth, (0..POSES).map(tilt_angle).collect())
}

/// Rods, two quantities and the statuses, with a pool of so many threads.
fn with_threads(threads: usize) -> (Vec<Vec<u64>>, Vec<Status>, StatusCounts) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (azimuth, tilt_angle) = tilts();
    let mut rods = [vec![0.0; POSES], vec![0.0; POSES], vec![0.0; POSES]];
    let mut status = vec![Status::Solved; POSES];
    let (mut x, mut torsion) = (vec![0.0; POSES], vec![0.0; POSES]);
    let mut prepared = vec![0.0; POSES];
    let tally = pool.install(|| {
        let gpr = Gpr::paper().without_limit_checks();
        let height = Column::constant(&0.5, POSES);
        let given =
            PoseColumns { azimuth: azimuth[..].into(), tilt_angle: tilt_angle[..].into(), height };
        let columns = rods.each_mut().map(|column| &mut column[..]);
        let tally = parallel::inverse_many(&gpr, given, &mut status, columns).unwrap();
        assert_eq!((tally.count(Status::TiltTooLarge), tally.failed()), (9, 9));
        let given = rods.each_ref().map(|column| Column::from(&column[..]));
        let options = SolveOptions { solver: Solver::LeastNorm, ..SolveOptions::default() };
        let wanted =
            &mut [(Quantity::VirtualJoint(4), &mut x[..]), (Quantity::Torsion, &mut torsion)];
        let tally =
            parallel::forward_many(&gpr, given, &Polar, &options, &mut status, wanted).unwrap();
        let solver = PoseSolver::new(&gpr, BuiltIn::Polar, &options).unwrap();
        let wanted = &mut [(Quantity::VirtualJoint(4), &mut prepared[..])];
        assert_eq!(parallel::poses_many(&solver, given, &mut status, wanted), Ok(tally));
        tally
    });
    let [q_1, q_2, q_3] = rods;
    let bits = [q_1, q_2, q_3, x, torsion, prepared]
        .map(|column| column.into_iter().map(f64::to_bits).collect());
    (bits.to_vec(), status, tally)
}

#[test]
fn the_same_bits_whatever_the_number_of_threads() {
    let one = with_threads(1);
    assert_eq!((one.2.poses(), one.2.count(Status::NotFinite)), (POSES, 9));
    for threads in [2, 3, 8] {
        assert!(with_threads(threads) == one, "{threads} threads");
    }
}

#[test]
fn columns_of_different_lengths() {
    let (numbers, mut status) = (vec![0.5; POSES], vec![Status::Solved; POSES]);
    let given = [numbers[..].into(), numbers[1..].into(), numbers[..].into()];
    let options = SolveOptions::default();
    let found = parallel::forward_many(
        &Gpr::paper().without_limit_checks(),
        given,
        &Polar,
        &options,
        &mut status,
        &mut [],
    );
    let expected =
        Error::LengthMismatch { what: "a column of rods", found: POSES - 1, expected: POSES };
    assert_eq!(found, Err(expected));
}
