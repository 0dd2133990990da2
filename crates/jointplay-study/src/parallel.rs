//! Many poses on all cores of the machine.

use jointplay_core::Error;
use jointplay_core::bulk::{Column, PoseSolver, Quantity, Status, StatusCounts, parts};
use jointplay_core::gpr::Gpr;
use jointplay_core::mechanism::{CommandedPositions, Mechanism, ReliefSolver};
use jointplay_core::virtualization::{SolveOptions, Virtualization};
use rayon::prelude::*;

/// The most threads that work is spread over: more only cost memory.
pub const MOST_THREADS: usize = 1024;

/// Poses that a core takes at a time: enough to hide handing them out, few enough to stay in its cache.
const PART: usize = 4096;

/// Poses of the platform as columns of equal length.
#[derive(Debug, Clone, Copy)]
pub struct PoseColumns<'a> {
    /// Azimuth of the tilt (rad).
    pub azimuth: Column<'a>,
    /// Angle of the tilt (rad).
    pub tilt_angle: Column<'a>,
    /// Height on the axis (m).
    pub height: Column<'a>,
}

/// [`Gpr::inverse_many`] over the cores of the current thread pool.
///
/// Poses are independent of each other, so that the result is the same to the bit for any number of threads.
///
/// # Errors
/// As [`Gpr::inverse_many`].
pub fn inverse_many(
    gpr: &Gpr,
    poses: PoseColumns<'_>,
    status: &mut [Status],
    rods: [&mut [f64]; 3],
) -> Result<StatusCounts, Error> {
    let PoseColumns { azimuth, tilt_angle, height } = poses;
    let [q_1, q_2, q_3] = rods;
    let columns = vec![q_1, q_2, q_3];
    in_parts(
        [azimuth, tilt_angle, height],
        status,
        columns,
        |[azimuth, tilt_angle, height], status, columns| {
            let Ok(rods) = <[&mut [f64]; 3]>::try_from(columns) else {
                unreachable!("parts have as many columns as the whole")
            };
            gpr.inverse_many(azimuth, tilt_angle, height, status, rods)
        },
    )
}

/// [`Gpr::forward_many`] over the cores of the current thread pool.
///
/// Poses are independent of each other, so that the result is the same to the bit for any number of threads.
///
/// # Errors
/// As [`Gpr::forward_many`].
pub fn forward_many(
    gpr: &Gpr,
    rods: [Column<'_>; 3],
    virtualization: &(dyn Virtualization + Sync),
    options: &SolveOptions,
    status: &mut [Status],
    wanted: &mut [(Quantity, &mut [f64])],
) -> Result<StatusCounts, Error> {
    with_quantities(rods, status, wanted, |rods, status, wanted| {
        gpr.forward_many(rods, virtualization, options, status, wanted)
    })
}

/// [`PoseSolver::forward_many`] over the cores of the current thread pool.
///
/// Poses are independent of each other, so that the result is the same to the bit for any number of threads.
///
/// # Errors
/// As [`PoseSolver::forward_many`].
pub fn poses_many(
    solver: &PoseSolver,
    rods: [Column<'_>; 3],
    status: &mut [Status],
    wanted: &mut [(Quantity, &mut [f64])],
) -> Result<StatusCounts, Error> {
    with_quantities(rods, status, wanted, |rods, status, wanted| {
        solver.forward_many(rods, status, wanted)
    })
}

/// Hands the poses out in parts, each with its columns of the wanted quantities.
fn with_quantities(
    rods: [Column<'_>; 3],
    status: &mut [Status],
    wanted: &mut [(Quantity, &mut [f64])],
    work: impl Fn(
        [Column<'_>; 3],
        &mut [Status],
        &mut [(Quantity, &mut [f64])],
    ) -> Result<StatusCounts, Error>
    + Sync,
) -> Result<StatusCounts, Error> {
    let quantities: Vec<Quantity> = wanted.iter().map(|(quantity, _)| *quantity).collect();
    let columns = wanted.iter_mut().map(|(_, column)| &mut **column).collect();
    in_parts(rods, status, columns, |rods, status, columns| {
        let mut wanted: Vec<_> = quantities.iter().copied().zip(columns).collect();
        work(rods, status, &mut wanted)
    })
}

/// Configurations of a mechanism that a core takes at a time: whole blocks of all processors.
const CONFIGURATIONS: usize = 512;

/// [`CommandedPositions::solve_many`] over the cores of the current thread pool.
///
/// Configurations are independent of each other, so that the result is the same to the bit for any number of threads.
///
/// # Errors
/// As [`CommandedPositions::solve_many`].
pub fn positions_many(
    positions: &CommandedPositions,
    mechanism: &Mechanism,
    rows: &mut [f64],
    solver: ReliefSolver,
    residuals: &mut [f64],
    status: &mut [Status],
) -> Result<StatusCounts, Error> {
    let width = rows.len() / status.len().max(1);
    if width == 0 || rows.len() != width * status.len() || residuals.len() != status.len() {
        // Refused, or nothing to do.
        return positions.clone().solve_many(mechanism, rows, solver, residuals, status);
    }
    rows.par_chunks_mut(width * CONFIGURATIONS)
        .zip(residuals.par_chunks_mut(CONFIGURATIONS))
        .zip(status.par_chunks_mut(CONFIGURATIONS))
        .map_init(
            || positions.clone(),
            |positions, ((rows, residuals), status)| {
                positions.solve_many(mechanism, rows, solver, residuals, status)
            },
        )
        .try_reduce(StatusCounts::default, |mut sum, more| {
            sum += more;
            Ok(sum)
        })
}

/// Hands the poses out in parts, and adds the tallies up.
fn in_parts<'a>(
    given: [Column<'a>; 3],
    status: &'a mut [Status],
    columns: Vec<&'a mut [f64]>,
    work: impl Fn([Column<'_>; 3], &mut [Status], Vec<&mut [f64]>) -> Result<StatusCounts, Error> + Sync,
) -> Result<StatusCounts, Error> {
    let parts = parts(given, status, columns, PART);
    parts.into_par_iter().map(|(given, status, columns)| work(given, status, columns)).try_reduce(
        StatusCounts::default,
        |mut sum, more| {
            sum += more;
            Ok(sum)
        },
    )
}
