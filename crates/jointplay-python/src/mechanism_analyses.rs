//! What any mechanism is asked.

use jointplay::bulk::{Status, StatusCounts};
use jointplay::constraint::System as _;
use jointplay::mechanism::{
    Drive, MechanismSystem, PositionSolver, ReliefSolver, assemble, branches, guess,
    mechanism_mobility, suggest,
};
use jointplay::mobility::{RANK_THRESHOLD, near_mobility};
use jointplay::nalgebra::DVector;
use jointplay::report;
use jointplay::sensitivity::commanded_sensitivity;
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyTuple};

use crate::arrays::Spread;
use crate::many::evidence;
use crate::mechanism::{Commands, PyMechanism};
use crate::numbers::{count, finite, optional_real};
use crate::posed::{Posed, STARTS};
use crate::skin::{self, fields};
use crate::{errors, mechanism_results as results};

/// Number of steps to the start of a path.
const STEPS: usize = 60;
/// Largest number of steps of a path.
const MOST_STEPS: usize = 100_000;
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
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        #[pyo3(from_py_with = optional_real)] tolerance: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let commands = self.commands(py, at)?;
        let found = py
            .detach(|| self.posed(&commands, tolerance))
            .map_err(|error| errors::core(py, &error))?;
        let made =
            results::configuration(py, self, &found.values, found.residual, found.iterations)?;
        self.within_limits(py, &found.values, made)
    }

    /// Closed configurations found from many starts.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Joint coordinates that are to have these values (m, rad).
    /// starts : int, optional
    ///     How many starts are tried, default 50, at most 100,000; they are the same at every call.
    #[pyo3(signature = (at=None, *, starts=None))]
    fn branches<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        starts: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let starts =
            starts.map_or(Ok(BRANCH_STARTS), |given| count(given, "starts", 1..=MOST_STARTS))?;
        let commands = self.commands(py, at)?;
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let start = self.start(&commands);
        let found = py
            .detach(|| branches(&self.file.mechanism, &start, &held, starts))
            .map_err(|error| errors::core(py, &error))?;
        found
            .iter()
            .map(|one| {
                results::configuration(py, self, &one.coordinates, one.residual, one.iterations)
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
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        #[pyo3(from_py_with = optional_real)] tolerance: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let commands = self.commands(py, at)?;
        let failed = |error: jointplay::Error| errors::core(py, &error);
        if !self.is_dense() && tolerance.is_none() {
            let found = py.detach(|| {
                let (system, iterations) = self.sparse(&commands)?;
                let found = system.mobility(RANK_THRESHOLD)?;
                Ok((found, system.closure(iterations)))
            });
            let (found, closure) = found.map_err(failed)?;
            return results::sparse_mobility(py, self, self.kutzbach(), &found, &closure);
        }
        let found = py.detach(|| {
            let Posed { values, residual, iterations } = self.posed(&commands, tolerance)?;
            let system = MechanismSystem::new(&self.file.mechanism, values.clone())?;
            let at = system.at_home();
            let near = tolerance.map(|share| near_mobility(&system, &at, share)).transpose()?;
            // Loops that do not close are taken as forced shut.
            let forced = tolerance.is_some() && !system.is_closed();
            let finite = mechanism_mobility(&system, RANK_THRESHOLD, forced)?;
            Ok((values, residual, iterations, near, finite))
        });
        let (values, residual, iterations, near, finite) = found.map_err(failed)?;
        let configuration = results::configuration(py, self, &values, residual, iterations)?;
        let system = MechanismSystem::new(&self.file.mechanism, values.clone()).map_err(failed)?;
        let kutzbach = self.kutzbach();
        let made = results::mobility(py, &system, kutzbach, &finite, near.as_ref(), configuration)?;
        self.within_limits(py, &values, made)
    }

    /// Drives joints along a path and solves for the remaining ones; virtual joints are displaced by the least amount.
    ///
    /// Parameters
    /// ----------
    /// drives : dict of str to float or (float, float)
    ///     Joint coordinates with their final values, or with their initial and final values (m, rad); several are driven simultaneously.
    /// steps : int, optional
    ///     Number of equal steps, default 60.
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
    #[pyo3(signature = (drives, *, steps=None))]
    fn drive<'py>(
        &self,
        py: Python<'py>,
        drives: &Bound<'py, PyMapping>,
        steps: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let steps = steps.map_or(Ok(STEPS), |given| count(given, "steps", 1..=MOST_STEPS))?;
        if drives.is_empty()? {
            return Err(errors::input(
                py,
                "no joint is driven; expected a mapping such as {\"crank\": (0, 1)}",
            ));
        }
        let mut legs: Vec<(usize, Option<f64>, f64)> = Vec::new();
        for item in drives.items()? {
            let (name, range): (String, Bound<'py, PyAny>) = item.extract()?;
            let coordinate = self.find(py, &name)?;
            match range.extract::<(Bound<'py, PyAny>, Bound<'py, PyAny>)>() {
                Ok((from, to)) => {
                    legs.push((coordinate, Some(finite(&from, &name)?), finite(&to, &name)?));
                }
                Err(_) => legs.push((coordinate, None, finite(&range, &name)?)),
            }
        }
        let driven: Vec<usize> = legs.iter().map(|leg| leg.0).collect();
        let held = self.held(&driven);
        let failed = |error: jointplay::Error| errors::core(py, &error);
        let mut start = py.detach(|| self.assembled(&[], None)).map_err(failed)?.coordinates;
        let begin: Vec<Drive> = legs
            .iter()
            .map(|&(coordinate, from, _)| Drive {
                coordinate,
                to: from.unwrap_or(start[coordinate]),
            })
            .collect();
        if begin.iter().any(|one| one.to != start[one.coordinate]) {
            let path = py.detach(|| self.along(&start, &begin, &held, STEPS)).map_err(failed)?;
            let report = report::motion(&self.file, &driven, &held, &path);
            if let Some(message) = report.message {
                let message = format!("before the start of the path: {message}");
                let motion = results::motion(py, self, &driven, &held, &path)?;
                return Err(errors::new(
                    py,
                    "StoppedError",
                    &message,
                    Ok(fields!(py; motion = motion)),
                ));
            }
            if let Some(last) = path.waypoints.last() {
                start = last.coordinates.clone();
            }
        }
        let drives: Vec<Drive> =
            legs.iter().map(|&(coordinate, _, to)| Drive { coordinate, to }).collect();
        let moved = py.detach(|| self.along(&start, &drives, &held, steps)).map_err(failed)?;
        results::motion(py, self, &driven, &held, &moved)
    }

    /// Where the mechanism would have to have play for commands to be possible.
    ///
    /// Virtual joints are tried at every joint, in every direction that the joint constrains; those of the file are ignored.
    ///
    /// Parameters
    /// ----------
    /// commands : sequence of dict of str to float
    ///     Each with values for the same joint coordinates (m, rad).
    fn suggest<'py>(
        &self,
        py: Python<'py>,
        commands: Vec<Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(first) = commands.first() else {
            return Err(errors::input(
                py,
                "no command is given; expected a list such as [{\"crank\": 0.5}]",
            ));
        };
        let commanded: Vec<usize> =
            self.commands(py, Some(first))?.iter().map(|&(k, _)| k).collect();
        let mut all = Vec::with_capacity(commands.len());
        for command in &commands {
            let given = self.commands(py, Some(command))?;
            let value = |k: &usize| given.iter().find(|(known, _)| known == k).map(|one| one.1);
            match commanded.iter().map(value).collect::<Option<Vec<f64>>>() {
                Some(values) if given.len() == commanded.len() => {
                    all.push(DVector::from_vec(values))
                }
                _ => return Err(errors::input(py, "every command has to name the same joints")),
            }
        }
        let bare = self.file.mechanism.clone().with_virtual_joints(Vec::new());
        let bare = bare.map_err(|error| errors::internal(&error.to_string()))?;
        let found = py.detach(|| {
            let start = guess(&bare);
            let home = assemble(&bare, &start, &[], STARTS)?;
            suggest(&bare, &home.coordinates, &commanded, &all)
        });
        let found = found.map_err(|error| errors::core(py, &error))?;
        results::suggestions(py, self, &bare, &found)
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
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let commands = self.commands(py, Some(at))?;
        if self.file.mechanism.virtual_joints().is_empty() {
            return Err(errors::input(py, "this mechanism has no virtual joints"));
        }
        let commanded: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let found = py.detach(|| {
            let relief = self.relieved(&commands)?;
            let system = MechanismSystem::new(&self.file.mechanism, relief.coordinates.clone())?;
            let (at, length) = (system.at_home(), system.characteristic_length());
            let sensitivity =
                commanded_sensitivity(&system, &at, &commanded, length, RANK_THRESHOLD)?;
            Ok((relief, sensitivity))
        });
        let (relief, sensitivity) = found.map_err(|error| errors::core(py, &error))?;
        let made = results::relief(py, self, &relief, &sensitivity)?;
        let joints = relief.coordinates.rows(0, self.coordinates.joints()).into_owned();
        self.within_limits(py, &joints, made)
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
    ///
    /// Returns
    /// -------
    /// Positions
    ///     With a status for each row; rows that cannot be closed, or are beyond limits or clearances, are NaN.
    ///
    /// Notes
    /// -----
    /// The first row starts from the closed configuration nearest the guesses of the file, every other from the one before it that closed: neighbours should be near.
    #[pyo3(signature = (commanded, *, solver="least-norm", check_limits=true))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        commanded: &Bound<'py, PyMapping>,
        solver: &str,
        check_limits: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
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
            given.push((self.find(py, &name)?, name, values));
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
        let width = self.coordinates.all().len();
        let poses = spread.poses();
        let solved = py.detach(|| {
            let mut rows = Rows {
                values: vec![f64::NAN; poses * width],
                residuals: vec![f64::NAN; poses],
                status: vec![Status::NotFinite; poses],
            };
            let finite = |i: &usize| columns.iter().all(|column| column.at(*i).is_finite());
            let Some(first) = (0..poses).find(finite) else { return Ok(rows) };
            let start = indices.iter().zip(&columns).map(|(&k, column)| (k, column.at(first)));
            let mut here = self.posed(&start.collect::<Commands>(), None)?.values;
            let system = MechanismSystem::new(&self.file.mechanism, here.clone())?;
            let mut positions = PositionSolver::new(&system, &indices)?;
            // What commands leave undetermined must not save displacement of virtual joints.
            let commanded = match self.file.mechanism.virtual_joints().is_empty() {
                true => None,
                false => Some(self.commanded(&indices)?),
            };
            let commanded = commanded.filter(|commanded| commanded.undetermined() > 0);
            for (i, row) in rows.values.chunks_exact_mut(width).enumerate().skip(first) {
                let mut next = here.clone();
                for (&k, column) in indices.iter().zip(&columns) {
                    next[k] = column.at(i);
                }
                let solved = match &commanded {
                    None => {
                        let found = positions.solve(next.as_mut_slice(), solver);
                        found.map(|found| (next, found.residual))
                    }
                    Some(commanded) => {
                        let values = columns.iter().map(|column| column.at(i));
                        let found = self.relieved_at(commanded, values, solver);
                        found.map(|found| (found.coordinates, found.residual))
                    }
                };
                let (next, residual) = match solved {
                    Ok(found) => found,
                    Err(error) => {
                        rows.status[i] = Status::of(&error).ok_or(error)?;
                        continue;
                    }
                };
                let beyond = self.file.mechanism.beyond_limits(&next);
                let first = beyond.first().filter(|_| check_limits);
                rows.status[i] = match first {
                    None => Status::Solved,
                    Some(one) if one.coordinate < self.coordinates.joints() => Status::BeyondLimits,
                    Some(_) => Status::BeyondClearance,
                };
                if first.is_none() {
                    row.copy_from_slice(next.as_slice());
                    rows.residuals[i] = residual;
                }
                here = next;
            }
            Ok(rows)
        });
        let Rows { values, residuals, status } = solved.map_err(|error| match error {
            jointplay::Error::PartlyCommanded { coordinate } => {
                let joint = &self.coordinates.all()[coordinate].joint;
                let message = format!(
                    "joint \"{joint}\": some of {joint}[0], {joint}[1], {joint}[2] are commanded, but positions take all three coordinates of a rotation vector or none"
                );
                errors::input(py, &message)
            }
            error => errors::core(py, &error),
        })?;
        let array = Array2::from_shape_vec((poses, width), values)
            .map_err(|error| errors::internal(&error.to_string()))?;
        let fields = fields!(py;
            names = PyTuple::new(py, self.names(0..width))?,
            units = PyTuple::new(py, self.units(0..width))?,
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
