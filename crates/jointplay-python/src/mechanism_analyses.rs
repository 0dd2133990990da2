//! Analyses of any mechanism.

use jointplay::bulk::{Status, StatusCounts};
use jointplay::mechanism::{
    Closure, CommandedPositions, MechanismSystem, OpenLoops, ReliefSolver, branches, close_sparse,
    commanded_guess, mechanism_mobility,
};
use jointplay::mobility::{RANK_THRESHOLD, near_mobility};
use jointplay::nalgebra::DVector;
use jointplay::report;
use jointplay::study::parallel;
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyTuple};

use crate::arrays::Spread;
use crate::many::evidence;
use crate::mechanism::{Commands, PyMechanism};
use crate::numbers::{count, optional_real};
use crate::skin::{self, fields};
use crate::threads::Threads;
use crate::{errors, mechanism_results as results};

/// Default number of steps of a straight path.
pub(crate) const STEPS: usize = 60;
/// Largest number of steps of a path.
pub(crate) const MOST_STEPS: usize = 100_000;
/// Starts tried for branches where no number is given.
const BRANCH_STARTS: usize = 50;
/// The most starts that may be tried for branches.
const MOST_STARTS: usize = 100_000;

/// Positions for many commands: a row of coordinates, a residual and a status for each.
struct Rows {
    values: Vec<f64>,
    residuals: Vec<f64>,
    status: Vec<Status>,
}

#[pymethods]
impl PyMechanism {
    /// The closed configuration nearest the guesses of the file; where rigid links do not close for `at`, virtual joints take their least displacement.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Joint coordinates that are to have these values (m, rad).
    /// tolerance : float, optional
    ///     Largest mismatch that counts as closed, in radians and characteristic lengths; without it loops close exactly.
    ///
    /// Raises
    /// ------
    /// NotAssembledError
    ///     With other configurations, where some were found.
    /// JointLimitsError
    ///     Where the configuration is beyond joint limits or clearances; with it as `result`.
    #[pyo3(signature = (at=None, *, tolerance=None))]
    fn assemble<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        #[pyo3(from_py_with = optional_real)] tolerance: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let commands = this.commands(py, at)?;
        let found = py
            .detach(|| this.posed(&commands, tolerance))
            .map_err(|error| errors::core(py, &error))?;
        let made =
            results::configuration(py, slf, &found.coordinates, found.residual, found.iterations)?;
        this.within_limits(py, &found.coordinates, made)
    }

    /// Closed configurations found from many starts.
    ///
    /// The search ends when 16 are found from other starts than the guess: a list of 16 or 17 may lack some.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Joint coordinates that are to have these values (m, rad).
    /// starts : int, optional
    ///     How many starts are tried, default 50, at most 100,000; they are the same at every call.
    #[pyo3(signature = (at=None, *, starts=None))]
    fn branches<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        starts: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let this = slf.get();
        let starts =
            starts.map_or(Ok(BRANCH_STARTS), |given| count(given, "starts", 1..=MOST_STARTS))?;
        let commands = this.commands(py, at)?;
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let start = commanded_guess(&this.file.mechanism, &commands);
        let found = py
            .detach(|| branches(&this.file.mechanism, &start, &held, starts))
            .map_err(|error| errors::core(py, &error))?;
        found
            .closures
            .iter()
            .map(|one| {
                results::configuration(py, slf, &one.coordinates, one.residual, one.iterations)
            })
            .collect()
    }

    /// Kutzbach, instantaneous and finite mobility, and redundant constraints.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Commanded joint coordinates (m, rad); virtual joints are displaced if rigid links do not close.
    /// tolerance : float, optional
    ///     Take dimensions as true only to this share: of the characteristic length, and in radians; from 1e-11 to 1e-2.
    #[pyo3(signature = (at=None, *, tolerance=None))]
    fn mobility<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        #[pyo3(from_py_with = optional_real)] tolerance: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let commands = this.commands(py, at)?;
        let failed = |error: jointplay::Error| errors::core(py, &error);
        if !this.is_dense() && tolerance.is_none() {
            let found = py.detach(|| {
                let (system, iterations) = close_sparse(&this.file.mechanism, &commands)?;
                let found = system.mobility(RANK_THRESHOLD)?;
                Ok((found, system.closure(iterations)))
            });
            let (found, closure) = found.map_err(failed)?;
            return results::sparse_mobility(py, slf, this.kutzbach(), &found, &closure);
        }
        let found = py.detach(|| {
            let Closure { coordinates: values, residual, iterations, .. } =
                this.posed(&commands, tolerance)?;
            let system = MechanismSystem::new(&this.file.mechanism, values.clone())?;
            let at = system.at_home();
            let near = tolerance.map(|share| near_mobility(&system, &at, share)).transpose()?;
            // Loops that do not close are taken as forced shut.
            let open_loops = match tolerance {
                Some(_) if !system.is_closed() => OpenLoops::TakenAsClosed,
                _ => OpenLoops::Refused,
            };
            let finite = mechanism_mobility(&system, RANK_THRESHOLD, open_loops)?;
            Ok((values, residual, iterations, near, finite))
        });
        let (values, residual, iterations, near, finite) = found.map_err(failed)?;
        let configuration = results::configuration(py, slf, &values, residual, iterations)?;
        let system = MechanismSystem::new(&this.file.mechanism, values.clone()).map_err(failed)?;
        let kutzbach = this.kutzbach();
        let made = results::mobility(py, &system, kutzbach, &finite, near.as_ref(), configuration)?;
        this.within_limits(py, &values, made)
    }

    /// Drives joints along a path and solves for the remaining ones; virtual joints are displaced by the least amount.
    ///
    /// Parameters
    /// ----------
    /// drives : dict of str to float, (float, float) or array
    ///     Joint coordinates with their final values, with their initial and final values, or with three or more values along a curve (m, rad); several are driven simultaneously.
    /// steps : int, optional
    ///     Number of equal steps, default 60; along a curve one for each interval between its values.
    /// free : sequence of str, optional
    ///     Actuated joints that follow instead of being held.
    ///
    /// Returns
    /// -------
    /// Motion
    ///     The motion, up to where it stopped; `stopped` is the reason.
    ///
    /// Raises
    /// ------
    /// StoppedError
    ///     If it stops before the start of the path.
    ///
    /// Notes
    /// -----
    /// If only actuators are driven, the others are held; otherwise all other joints are solved for.
    #[pyo3(signature = (drives, *, steps=None, free=None))]
    fn drive<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        drives: &Bound<'py, PyMapping>,
        steps: Option<&Bound<'py, PyAny>>,
        free: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let failed = |error: jointplay::Error| errors::core(py, &error);
        let start = py.detach(|| this.at_rest()).map_err(failed)?.coordinates;
        let path = this.drive_path(py, drives, &start)?;
        let default = if path.segments() == 1 { STEPS } else { path.segments() };
        let steps = steps.map_or(Ok(default), |given| count(given, "steps", 1..=MOST_STEPS))?;
        let driven = path.coordinates();
        let held = this.held_but(py, driven, free.as_deref().unwrap_or_default())?;
        let at_start = py.detach(|| this.to_start(start, &path, &held)).map_err(failed)?;
        let start = match at_start {
            Ok(start) => start,
            Err(stopped) => {
                let report = report::motion(&this.file, driven, &held, None, &stopped);
                let message = report.message.unwrap_or_default();
                let message = format!("before the start of the path: {message}");
                let motion = results::motion(py, slf, driven, &held, &stopped)?;
                return Err(errors::new(
                    py,
                    "StoppedError",
                    &message,
                    Ok(fields!(py; motion = motion)),
                ));
            }
        };
        let moved = py.detach(|| this.along(&start, &path, &held, steps)).map_err(failed)?;
        results::motion(py, slf, driven, &held, &moved)
    }

    /// Least displacement of the virtual joints that makes commanded joint coordinates possible.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float
    ///     Joint coordinates with their values (m, rad).
    ///
    /// Raises
    /// ------
    /// NotRelievedError
    ///     Where these virtual joints cannot make it possible.
    /// JointLimitsError
    ///     Where joints are beyond their limits; with the relief as `result`. Clearances are compared by the caller.
    ///
    /// Notes
    /// -----
    /// Joints that the commands do not determine stay as near the closed configuration of the file as they can.
    fn relieve<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        at: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let commands = this.commands(py, Some(at))?;
        if this.file.mechanism.virtual_joints().is_empty() {
            return Err(errors::input(py, "this mechanism has no virtual joints"));
        }
        let commanded: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let found = py.detach(|| {
            let relief = this.relieved(&commands)?;
            let sensitivity = relief.sensitivity(&this.file.mechanism, &commanded)?;
            Ok((relief, sensitivity))
        });
        let (relief, sensitivity) = found.map_err(|error| errors::core(py, &error))?;
        let made = results::relief(py, slf, &relief, &sensitivity)?;
        let joints = relief.coordinates.rows(0, this.coordinates.joints()).into_owned();
        this.within_limits(py, &joints, made)
    }

    /// Positions of all joints for many values of some, quickly.
    ///
    /// Parameters
    /// ----------
    /// commanded : dict of str to array
    ///     Joint coordinates with their values (m, rad), which broadcast against each other.
    /// solver : str
    ///     Which displacement of virtual joints that closes the loops: `'least-norm'` or `'newton'`.
    /// check_limits : bool, optional
    ///     Whether rows beyond limits of joints or clearances of virtual joints are refused.
    /// independent : bool, optional
    ///     Whether all rows start from the configuration of the first one, in any order and many at a time.
    /// threads : int, optional
    ///     Number of threads for independent rows; default: all cores. The result does not depend on it.
    ///
    /// Returns
    /// -------
    /// Positions
    ///     With a status for each row; rows that cannot be closed, or are beyond limits or clearances, are NaN.
    ///
    /// Notes
    /// -----
    /// The first row starts from the closed configuration nearest the guesses of the file, every other from the one before it that closed, on the branch of the motion from there, at most 100 rad or characteristic lengths away; rows whose neighbours are near take the least time.
    /// Independent rows, as of a workspace map or of random samples, have to be near the first one instead: rows that Newton's method does not close from there have the status `NOT_CONVERGED`, and rows far from it may end on another branch, which their status does not show.
    #[pyo3(signature = (commanded, *, solver="least-norm", check_limits=true, independent=false, threads=None))]
    fn positions<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        commanded: &Bound<'py, PyMapping>,
        solver: &str,
        check_limits: bool,
        independent: bool,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let solver = match solver {
            "least-norm" => ReliefSolver::LeastNorm,
            "newton" => ReliefSolver::Newton,
            other => {
                let known = ["least-norm".to_owned(), "newton".to_owned()];
                return Err(errors::unknown_name(py, "solver", other, &known));
            }
        };
        let mut given = Vec::with_capacity(commanded.len()?);
        for item in commanded.items()? {
            let (name, values): (String, Bound<'py, PyAny>) = item.extract()?;
            given.push((this.find(py, &name)?, name, values));
        }
        if given.is_empty() {
            return Err(errors::input(
                py,
                "no command is given; expected a mapping such as {\"crank\": angles}",
            ));
        }
        let named: Vec<(&str, &Bound<'_, PyAny>)> =
            given.iter().map(|(_, name, values)| (name.as_str(), values)).collect();
        let spread = Spread::read(py, &named)?;
        let columns = spread.columns()?;
        let indices: Vec<usize> = given.iter().map(|(k, ..)| *k).collect();
        let width = this.coordinates.all().len();
        let poses = spread.poses();
        let threads = Threads::of(threads, poses)?;
        let solved = py.detach(|| {
            let mut rows = Rows {
                values: vec![f64::NAN; poses * width],
                residuals: vec![f64::NAN; poses],
                status: vec![Status::NotFinite; poses],
            };
            let finite = |i: &usize| columns.iter().all(|column| column.at(*i).is_finite());
            let Some(first) = (0..poses).find(finite) else { return Ok(rows) };
            let start = indices.iter().zip(&columns).map(|(&k, column)| (k, column.at(first)));
            let mechanism = &this.file.mechanism;
            let mut here = this.posed(&start.collect::<Commands>(), None)?.coordinates;
            let mut positions = CommandedPositions::new(mechanism, &here, &indices)?;
            let of_beyond = |next: &DVector<f64>| match mechanism.beyond_limits(next).first() {
                None => Status::Solved,
                Some(_) if !check_limits => Status::Solved,
                Some(one) if one.coordinate < this.coordinates.joints() => Status::BeyondLimits,
                Some(_) => Status::BeyondClearance,
            };
            if independent {
                for (i, row) in rows.values.chunks_exact_mut(width).enumerate() {
                    row.copy_from_slice(here.as_slice());
                    indices.iter().zip(&columns).for_each(|(&k, column)| row[k] = column.at(i));
                }
                let Rows { values, residuals, status } = &mut rows;
                match &threads {
                    Threads::Here => {
                        positions.solve_many(mechanism, values, solver, residuals, status)?;
                    }
                    Threads::Pool(pool) => {
                        pool.install(|| {
                            let first = &positions;
                            parallel::positions_many(
                                first, mechanism, values, solver, residuals, status,
                            )
                        })?;
                    }
                }
                let solved = status.iter_mut().zip(residuals).zip(values.chunks_exact_mut(width));
                for ((status, residual), row) in solved.filter(|((s, _), _)| **s == Status::Solved)
                {
                    *status = of_beyond(&DVector::from_column_slice(row));
                    if *status != Status::Solved {
                        row.fill(f64::NAN);
                        *residual = f64::NAN;
                    }
                }
                return Ok(rows);
            }
            let mut command = vec![0.0; indices.len()];
            for (i, row) in rows.values.chunks_exact_mut(width).enumerate().skip(first) {
                let mut next = here.clone();
                command.iter_mut().zip(&columns).for_each(|(to, column)| *to = column.at(i));
                let solved = positions.solve_next(mechanism, &command, &mut next, solver);
                let residual = match solved {
                    Ok(residual) => residual,
                    Err(error) => {
                        rows.status[i] = Status::from_error(&error).ok_or(error)?;
                        continue;
                    }
                };
                rows.status[i] = of_beyond(&next);
                if rows.status[i] == Status::Solved {
                    row.copy_from_slice(next.as_slice());
                    rows.residuals[i] = residual;
                }
                here = next;
            }
            Ok(rows)
        });
        let Rows { values, residuals, status } = solved.map_err(|error| match error {
            jointplay::Error::PartlyCommanded { coordinate } => {
                errors::input(py, &this.coordinates.partly_commanded(coordinate).to_string())
            }
            error => errors::core(py, &error),
        })?;
        let array = Array2::from_shape_vec((poses, width), values)
            .map_err(|error| errors::internal(&error.to_string()))?;
        let fields = fields!(py;
            mechanism = slf,
            names = PyTuple::new(py, this.names(0..width))?,
            units = PyTuple::new(py, this.units(0..width))?,
            coordinates = PyArray2::from_owned_array(py, array),
            residual = PyArray1::from_vec(py, residuals),
        );
        let tally = StatusCounts::of(&status);
        evidence(py, &[poses], status, tally, &fields)?;
        skin::result(py, "Positions", &fields)
    }
}

impl PyMechanism {
    /// A result, or the exception that its configuration is beyond joint limits or clearances.
    ///
    /// # Arguments
    /// * `values` – (f + M), or (f) where clearances are not to be looked at (m, rad)
    fn within_limits<'py>(
        &self,
        py: Python<'py>,
        values: &DVector<f64>,
        result: Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let beyond = self.file.mechanism.beyond_limits(values);
        if beyond.is_empty() {
            return Ok(result);
        }
        let limits = report::beyond_limits(&self.coordinates, &beyond);
        Err(errors::beyond_limits(py, &limits, &result))
    }
}
