//! What any mechanism is asked.

use jointplay::constraint::System as _;
use jointplay::format::report;
use jointplay::mechanism::{
    Drive, MechanismSystem, PositionSolver, ReliefSolver, assemble, branches, guess,
    mechanism_mobility, suggest,
};
use jointplay::mobility::{RANK_THRESHOLD, near_mobility};
use jointplay::nalgebra::DVector;
use jointplay::sensitivity::commanded_sensitivity;
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyTuple};

use crate::arrays::Spread;
use crate::mechanism::{Commands, PyMechanism};
use crate::posed::{Posed, STARTS};
use crate::skin::{self, fields};
use crate::{errors, mechanism_results as results};

/// Steps of a way to its beginning.
const STEPS: usize = 60;
/// The most steps that a way may have.
const MOST_STEPS: usize = 100_000;

#[pymethods]
impl PyMechanism {
    /// The closed configuration nearest the guesses of the file.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Joint coordinates that are to have these values [m, rad].
    /// tolerance : float, optional
    ///     Largest mismatch that counts as closed, in radians and characteristic lengths; without it loops close exactly.
    ///
    /// Raises
    /// ------
    /// NotAssembledError
    ///     With other configurations, where some were found.
    #[pyo3(signature = (at=None, *, tolerance=None))]
    fn assemble<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        tolerance: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let commands = self.commands(py, at)?;
        let found = py
            .detach(|| self.assembled(&commands, tolerance))
            .map_err(|error| errors::core(py, &error))?;
        results::configuration(py, self, &found.coordinates, found.residual, found.iterations)
    }

    /// Closed configurations found from many starts.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Joint coordinates that are to have these values [m, rad].
    /// starts : int
    ///     How many starts are tried; they are the same at every call.
    #[pyo3(signature = (at=None, *, starts=50))]
    fn branches<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        starts: usize,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
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

    /// What can move: counted, to first order, and for real.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, optional
    ///     Joint coordinates that are to have these values [m, rad]; virtual joints give way where they must.
    /// tolerance : float, optional
    ///     Take dimensions as true only to this share: of the characteristic length, and in radians; from 1e-11 to 1e-2.
    #[pyo3(signature = (at=None, *, tolerance=None))]
    fn mobility<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyDict>>,
        tolerance: Option<f64>,
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
        let system = MechanismSystem::new(&self.file.mechanism, values).map_err(failed)?;
        results::mobility(py, &system, self.kutzbach(), &finite, near.as_ref(), configuration)
    }

    /// Drives joints along a way, all others following; virtual joints give way as little as they can.
    ///
    /// Parameters
    /// ----------
    /// ways : dict of str to float or (float, float)
    ///     Joint coordinates with where they go, or from where to where [m, rad]; several arrive together.
    /// steps : int
    ///     In how many equal steps.
    ///
    /// Returns
    /// -------
    /// Motion
    ///     Up to where it stopped, if it did; `stopped` says why.
    ///
    /// Raises
    /// ------
    /// StoppedError
    ///     Where it stops on the way to the beginning.
    ///
    /// Notes
    /// -----
    /// If only motors are driven, the others hold still; else all others follow.
    #[pyo3(signature = (ways, *, steps=STEPS))]
    fn drive<'py>(
        &self,
        py: Python<'py>,
        ways: &Bound<'py, PyMapping>,
        steps: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        if !(1..=MOST_STEPS).contains(&steps) {
            let message = format!("steps is {steps}, but has to be from 1 to {MOST_STEPS}");
            return Err(errors::input(py, &message));
        }
        if ways.is_empty()? {
            return Err(errors::input(py, "no joint is driven: say such as {\"crank\": (0, 1)}"));
        }
        let mut legs: Vec<(usize, Option<f64>, f64)> = Vec::new();
        for item in ways.items()? {
            let (name, way): (String, Bound<'py, PyAny>) = item.extract()?;
            let coordinate = self.find(py, &name)?;
            match way.extract::<(f64, f64)>() {
                Ok((from, to)) => legs.push((coordinate, Some(from), to)),
                Err(_) => legs.push((coordinate, None, way.extract()?)),
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
            let way = py.detach(|| self.along(&start, &begin, &held, STEPS)).map_err(failed)?;
            let told = report::motion(&self.file, &driven, &held, &way);
            if let Some(message) = told.message {
                let message = format!("on the way to the beginning, {message}");
                let motion = results::motion(py, self, &driven, &held, &way)?;
                return Err(errors::new(
                    py,
                    "StoppedError",
                    &message,
                    Ok(fields!(py; motion = motion)),
                ));
            }
            if let Some(last) = way.waypoints.last() {
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
    /// Virtual joints are tried at every joint, in every direction that it lacks; the file's own are left out.
    ///
    /// Parameters
    /// ----------
    /// commands : sequence of dict of str to float
    ///     Each with values for the same joint coordinates [m, rad].
    fn suggest<'py>(
        &self,
        py: Python<'py>,
        commands: Vec<Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(first) = commands.first() else {
            return Err(errors::input(py, "nothing is commanded: say such as [{\"crank\": 0.5}]"));
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
        results::suggestions(py, &bare, &found)
    }

    /// The least displacement of the virtual joints that lets joint coordinates be where they are asked to be.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float
    ///     Joint coordinates with their values [m, rad].
    ///
    /// Raises
    /// ------
    /// NotRelievedError
    ///     Where these virtual joints cannot make it possible.
    fn relieve<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let commands = self.commands(py, Some(at))?;
        if self.file.mechanism.virtual_joints().is_empty() {
            return Err(errors::input(
                py,
                "this mechanism has no virtual joints that could give way",
            ));
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
        results::relief(py, self, &relief, &sensitivity)
    }

    /// Positions of all joints for many values of some, quickly.
    ///
    /// Parameters
    /// ----------
    /// commanded : dict of str to array
    ///     Joint coordinates with their values [m, rad], which broadcast against each other.
    /// solver : str
    ///     Which displacement of virtual joints that closes the loops: `'least-norm'` or `'newton'`.
    ///
    /// Returns
    /// -------
    /// Positions
    ///     Rows that cannot be closed are NaN.
    ///
    /// Notes
    /// -----
    /// The first row starts from the closed configuration nearest the guesses of the file, every other from the one before it that closed: neighbours should be near.
    #[pyo3(signature = (commanded, *, solver="least-norm"))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        commanded: &Bound<'py, PyMapping>,
        solver: &str,
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
            return Err(errors::input(py, "nothing is commanded: say such as {\"crank\": angles}"));
        }
        let named: Vec<(&str, &Bound<'_, PyAny>)> =
            given.iter().map(|(_, name, values)| (name.as_str(), values)).collect();
        let spread = Spread::read(py, &named)?;
        let columns = spread.columns()?;
        let indices: Vec<usize> = given.iter().map(|(k, ..)| *k).collect();
        let width = self.coordinates.all().len();
        let poses = spread.poses();
        let solved = py.detach(|| {
            let mut values = vec![f64::NAN; poses * width];
            let mut residuals = vec![f64::NAN; poses];
            if poses == 0 {
                return Ok((values, residuals));
            }
            let first = indices.iter().zip(&columns).map(|(&k, column)| (k, column.at(0)));
            let mut here = self.posed(&first.collect::<Commands>(), None)?.values;
            let system = MechanismSystem::new(&self.file.mechanism, here.clone())?;
            let mut positions = PositionSolver::new(&system, &indices)?;
            for (i, row) in values.chunks_exact_mut(width).enumerate() {
                let mut next = here.clone();
                for (&k, column) in indices.iter().zip(&columns) {
                    next[k] = column.at(i);
                }
                match positions.solve(next.as_mut_slice(), solver) {
                    Ok(found) => {
                        row.copy_from_slice(next.as_slice());
                        residuals[i] = found.residual;
                        here = next;
                    }
                    Err(
                        jointplay::Error::NotReached { .. } | jointplay::Error::NotFinite { .. },
                    ) => {}
                    Err(other) => return Err(other),
                }
            }
            Ok((values, residuals))
        });
        let (values, residuals) = solved.map_err(|error| errors::core(py, &error))?;
        let array = Array2::from_shape_vec((poses, width), values)
            .map_err(|error| errors::internal(&error.to_string()))?;
        let fields = fields!(py;
            names = PyTuple::new(py, self.names(0..width))?,
            units = PyTuple::new(py, self.units(0..width))?,
            coordinates = PyArray2::from_owned_array(py, array),
            residual = PyArray1::from_vec(py, residuals),
        );
        skin::result(py, "Positions", &fields)
    }
}
