//! Work cells: their files, and the plans of their programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use jointplay::cell::trajectory::Trajectory;
use jointplay::cell::workcell::Cell;
use jointplay::cell::{IncrementalPlanner, PlanError, PlanOptions, check::Report};
use jointplay::format::cell::explain_trajectory::explain_step;
use jointplay::format::cell::{Change, set_station};
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::program::Setting;
use jointplay::format::{cell, program};
use jointplay::nalgebra::Vector3;
use jointplay::spatial::Tilt;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString, PyTuple};

use crate::arrays::numbers_of_shape;
use crate::cell_plan::{PyCellPlan, axis_units};
use crate::numbers::finite;
use crate::threads::Threads;
use crate::{errors, files};

/// Time between two looks for a keyboard interrupt during a plan.
const INTERRUPT_INTERVAL: Duration = Duration::from_millis(50);

/// Text, folder of files that the text names, and name in messages, for pickling.
type Parts = (String, Option<PathBuf>, String);

/// A work cell: a robot with arms, stations, wafers, bodies and zones.
///
/// Made by `from_file`, `from_toml` or `example`; a cell never changes, `with_station` returns another.
/// Lengths are in metres and angles in radians, whatever the units of the file.
#[pyclass(name = "Cell", module = "jointplay", frozen)]
pub(crate) struct PyCell {
    cell: Arc<Cell>,
    text: String,
    folder: Option<PathBuf>,
    label: String,
}

/// A program with its name in messages.
struct Source {
    text: String,
    label: String,
}

#[pymethods]
impl PyCell {
    /// The cell of a TOML file.
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     The file; robots and meshes that it names are in its folder or below.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With line and column of the first error; the message has all of them.
    /// OSError
    ///     For a file that cannot be read.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = files::read_text(py, &path, cell::MAX_BYTES as u64)?;
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Self::parse(py, text, Some(folder), path.display().to_string())
    }

    /// The cell of the text of a TOML file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     The text; see the reference of cell files.
    /// folder : path-like, optional
    ///     Folder of the files that the text names; without it, the text can name none.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder=None))]
    fn from_toml(py: Python<'_>, text: String, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::parse(py, text, folder, "text".to_owned())
    }

    /// The included example: two load ports, an aligner and a process station; `Cell.example_program` is its program.
    #[staticmethod]
    fn example(py: Python<'_>) -> PyResult<Self> {
        Self::parse(py, cell::EXAMPLE.to_owned(), None, "example.toml".to_owned())
    }

    /// Program of the included example.
    #[classattr]
    #[pyo3(name = "example_program")]
    fn example_program() -> &'static str {
        program::EXAMPLE
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.cell.name
    }

    /// Text of its file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Names of its stations.
    #[getter]
    fn stations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.cell.stations.iter().map(|station| &station.name))
    }

    /// Names of the end effectors.
    #[getter]
    fn effectors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = self.cell.robot.effectors().map(|id| self.cell.effector_name(id).to_owned());
        PyTuple::new(py, names.collect::<Vec<_>>())
    }

    /// Names of all axes: the rods, then the motors.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.cell.robot.axes.iter().map(|axis| &axis.name))
    }

    /// Unit of each axis, `'m'` or `'rad'`.
    #[getter]
    fn axis_units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, axis_units(&self.cell))
    }

    /// The cell with another pose of one station.
    ///
    /// Comments and everything else of the text remain.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Name of the station.
    /// position_m : (float, float, float), optional
    ///     Centre of the lowest wafer at rest, in the base frame [m].
    /// heading_rad : float, optional
    ///     Rotation of the station about the vertical [rad].
    /// tilt_rad : (float, float), optional
    ///     Azimuth toward which the station tilts, and tilt angle [rad]; replaces taught points.
    ///
    /// Returns
    /// -------
    /// Cell
    #[pyo3(signature = (name, *, position_m=None, heading_rad=None, tilt_rad=None))]
    fn with_station(
        &self,
        py: Python<'_>,
        name: &str,
        position_m: Option<&Bound<'_, PyAny>>,
        heading_rad: Option<&Bound<'_, PyAny>>,
        tilt_rad: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        if !self.cell.stations.iter().any(|station| station.name == name) {
            let known: Vec<String> =
                self.cell.stations.iter().map(|station| station.name.clone()).collect();
            return Err(errors::unknown_name(py, "station", name, &known));
        }
        let mut changes = Vec::new();
        if let Some(position) = position_m {
            changes.push(Change::Position(Vector3::from(finite_numbers(position, "position_m")?)));
        }
        if let Some(heading) = heading_rad {
            changes.push(Change::Heading(finite(heading, "heading_rad")?));
        }
        if let Some(tilt) = tilt_rad {
            let [azimuth, angle] = finite_numbers(tilt, "tilt_rad")?;
            changes.push(Change::Tilt(Tilt { azimuth, angle }));
        }
        let text = set_station(&self.text, name, &changes)
            .map_err(|problem| errors::file(py, &self.label, &[problem]))?;
        Self::parse(py, text, self.folder.clone(), self.label.clone())
    }

    /// Plans and checks a program.
    ///
    /// Other Python threads run meanwhile, and Ctrl-C stops the computation.
    ///
    /// Parameters
    /// ----------
    /// program : str or path-like
    ///     Text of a program, or its file as a `pathlib.Path`.
    /// parameters : dict, optional
    ///     Values of parameters of the program, by name: a number, or a text such as `'5 mm'` for a parameter with a unit.
    /// threads : int, optional
    ///     Number of threads; all cores by default. The result does not depend on it.
    ///
    /// Returns
    /// -------
    /// CellPlan
    ///     The trajectory with the result of its check, also where that has violations.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     The program has errors.
    /// PlanningError
    ///     The program has no trajectory: stations out of reach, limits, lines that the arm cannot follow.
    #[pyo3(signature = (program, *, parameters=None, threads=None))]
    fn plan(
        &self,
        py: Python<'_>,
        program: &Bound<'_, PyAny>,
        parameters: Option<&Bound<'_, PyMapping>>,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyCellPlan> {
        let source = source(py, program)?.with_parameters(py, parameters)?;
        let parsed = program::parse(&source.text)
            .map_err(|problems| errors::file(py, &source.label, &problems))?;
        let threads = Threads::of(threads, usize::MAX)?;
        let stop = AtomicBool::new(false);
        let compute = || {
            let plan = || {
                let stop = || stop.load(Ordering::Relaxed);
                let options = PlanOptions { stop: &stop, ..PlanOptions::default() };
                IncrementalPlanner::default().plan(&self.cell, &parsed, &options)
            };
            match threads {
                Threads::Here => plan(),
                Threads::Pool(pool) => pool.install(plan),
            }
        };
        match interruptible(py, &stop, compute)? {
            Ok((motion, report)) => {
                Ok(PyCellPlan::new(Arc::clone(&self.cell), source.text, motion, report))
            }
            Err(error) => Err(self.refused(py, &source, &error)),
        }
    }

    fn __repr__(&self) -> String {
        format!("<Cell {:?} with {} stations>", self.cell.name, self.cell.stations.len())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        let this = slf.get();
        let parts = (this.text.clone(), this.folder.clone(), this.label.clone());
        Ok((slf.getattr("_again")?, parts))
    }

    /// For pickling.
    #[staticmethod]
    fn _again(
        py: Python<'_>,
        text: String,
        folder: Option<PathBuf>,
        label: String,
    ) -> PyResult<Self> {
        Self::parse(py, text, folder, label)
    }
}

impl PyCell {
    fn parse(
        py: Python<'_>,
        text: String,
        folder: Option<PathBuf>,
        label: String,
    ) -> PyResult<Self> {
        let read = py.detach(|| {
            cell::read(&text, &mut |name| {
                let folder = folder.as_deref().ok_or("a text without folder can name no files")?;
                let allowed = cell::MAX_MESH_BYTES as u64;
                jointplay_files::read(folder, name, allowed).map_err(|why| why.to_string())
            })
        });
        let cell = Arc::new(read.map_err(|problems| errors::file(py, &label, &problems))?);
        Ok(Self { cell, text, folder, label })
    }

    /// Why a program has no plan.
    fn refused(&self, py: Python<'_>, source: &Source, error: &PlanError) -> PyErr {
        let robot = &self.cell.robot;
        let diagnostics: Vec<(usize, usize, String)> = match error {
            PlanError::Program(problems) => {
                let explained: Vec<_> = problems
                    .iter()
                    .map(|problem| {
                        program::explain(robot, &source.text, problem, DisplayUnits::Metric)
                    })
                    .collect();
                if !problems.iter().all(|problem| problem.problem.is_infeasible()) {
                    return errors::file(py, &source.label, &explained);
                }
                explained
                    .iter()
                    .map(|one| (one.place.line, one.place.column, one.problem.to_string()))
                    .collect()
            }
            PlanError::Trajectory(error) => error
                .steps
                .iter()
                .map(|one| {
                    (
                        one.place.line,
                        one.place.column,
                        explain_step(robot, one, DisplayUnits::Metric),
                    )
                })
                .collect(),
            PlanError::Cell(_) | PlanError::Interrupted(_) => {
                return errors::input(py, &error.to_string());
            }
        };
        errors::planning(py, &source.label, &diagnostics)
    }
}

/// Finite numbers of an array or sequence of this length.
fn finite_numbers<const N: usize>(given: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; N]> {
    let numbers = numbers_of_shape(given, what, &[N])?;
    if let Some(&value) = numbers.iter().find(|value| !value.is_finite()) {
        return Err(errors::not_finite(given.py(), what, value));
    }
    Ok(std::array::from_fn(|k| numbers[k]))
}

impl Source {
    /// The program with values of its parameters.
    fn with_parameters(
        self,
        py: Python<'_>,
        parameters: Option<&Bound<'_, PyMapping>>,
    ) -> PyResult<Self> {
        let Some(parameters) = parameters else { return Ok(self) };
        let mut settings = Vec::new();
        for item in parameters.items()? {
            let (name, value): (String, Bound<'_, PyAny>) = item.extract()?;
            let value = match value.cast::<PyString>() {
                Ok(text) => text.to_str()?.to_owned(),
                Err(_) => finite(&value, "parameters")?.to_string(),
            };
            settings.push(Setting { name, value });
        }
        let text = program::with_parameters(&self.text, &settings)
            .map_err(|problems| errors::file(py, &self.label, &problems))?;
        Ok(Self { text, ..self })
    }
}

/// A program given as text or as a file.
fn source(py: Python<'_>, program: &Bound<'_, PyAny>) -> PyResult<Source> {
    if let Ok(text) = program.cast::<PyString>() {
        return Ok(Source { text: text.to_str()?.to_owned(), label: "program".to_owned() });
    }
    let path: PathBuf = program.extract()?;
    let text = files::read_text(py, &path, program::MAX_BYTES as u64)?;
    Ok(Source { text, label: path.display().to_string() })
}

type Planned = Result<(Trajectory, Report), PlanError>;

/// Computes without holding the interpreter, and stops where it is interrupted.
fn interruptible(
    py: Python<'_>,
    stop: &AtomicBool,
    compute: impl FnOnce() -> Planned + Send,
) -> PyResult<Planned> {
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        scope.spawn(move || {
            // The result of an interrupted plan is not received.
            let _ = sender.send(compute());
        });
        let receiver = std::sync::Mutex::new(receiver);
        let wait = || match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(INTERRUPT_INTERVAL),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        };
        loop {
            match py.detach(wait) {
                Ok(planned) => return Ok(planned),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(interrupt) = py.check_signals() {
                        stop.store(true, Ordering::Relaxed);
                        // The thread is joined as the scope ends.
                        return Err(interrupt);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(errors::internal("the plan has ended without a result"));
                }
            }
        }
    })
}
