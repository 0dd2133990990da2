//! The plan of a program in a cell: its trajectory, its check and its exports.

use std::sync::Arc;

use jointplay::cell::check::{self, CheckOptions, CheckResult, Report};
use jointplay::cell::robot::AxisKind;
use jointplay::cell::trajectory::Trajectory;
use jointplay::cell::workcell::Cell;
use jointplay::format::display_units::DisplayUnits;
use jointplay::interop::export::dialect::{DIALECTS, Dialect, MAX_BYTES};
use jointplay::interop::export::{self, MotionExport, SampleOptions, ViolationNote};
use jointplay::report;
use jointplay::report::table::{Column, Values};
use numpy::{IntoPyArray as _, PyArray1, PyArray3, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyString};

use crate::skin::{self, fields};
use crate::{errors, files};

/// Samples of a table at most, in all its arrays.
const MAX_SAMPLES: f64 = 5e7;

/// A program in a cell: its trajectory, and the result of its check.
///
/// Made by `Cell.plan`.
#[pyclass(name = "CellPlan", module = "jointplay", frozen)]
pub(crate) struct PyCellPlan {
    cell: Arc<Cell>,
    program: String,
    motion: Trajectory,
    report: Report,
    violation_notes: Vec<ViolationNote>,
}

impl PyCellPlan {
    pub(crate) fn new(
        cell: Arc<Cell>,
        program: String,
        motion: Trajectory,
        report: Report,
    ) -> Self {
        let violation_notes = export::violation_notes(&cell, &report);
        Self { cell, program, motion, report, violation_notes }
    }

    fn motion_export(&self) -> MotionExport<'_> {
        MotionExport {
            cell: &self.cell,
            motion: &self.motion,
            program: &self.program,
            violation_notes: &self.violation_notes,
        }
    }

    /// Rows of a table with a number of columns.
    fn rows(
        &self,
        py: Python<'_>,
        rate_hz: f64,
        [from_s, to_s]: [Option<f64>; 2],
        width: usize,
    ) -> PyResult<SampleOptions> {
        let duration = self.motion.duration();
        let window = [from_s.unwrap_or(0.0), to_s.unwrap_or(duration)];
        check_size(py, (window[1].min(duration) - window[0]) * rate_hz * width as f64)?;
        Ok(SampleOptions { window: Some(window), ..SampleOptions::at_rate(rate_hz) })
    }

    /// Refuses to export a program with violations unasked.
    fn check_export(&self, py: Python<'_>, despite_errors: bool) -> PyResult<()> {
        let count = self.report.violations.len();
        if count == 0 || despite_errors {
            return Ok(());
        }
        let message = format!(
            "the program has {count} violations and is not safe to run; use despite_errors=True to export it anyway"
        );
        Err(errors::new(py, "NoAnswerError", &message, Ok(PyDict::new(py))))
    }
}

#[pymethods]
impl PyCellPlan {
    /// Duration of the trajectory [s].
    #[getter]
    fn duration_s(&self) -> f64 {
        self.motion.duration()
    }

    /// Whether the check found no violation; ``False`` for a program without motion.
    #[getter]
    fn passed(&self) -> bool {
        self.report.result == CheckResult::Passed
    }

    /// Number of violations; `report()["violations"]` lists them.
    #[getter]
    fn violations(&self) -> usize {
        self.report.violations.len()
    }

    /// The smallest distance between bodies during the trajectory [m]; `None` if no pair comes near.
    #[getter]
    fn min_distance_m(&self) -> Option<f64> {
        let distances = self.report.distances.iter().map(|pair| pair.distance);
        distances.reduce(f64::min)
    }

    /// The document of `jointplay cell check --format json`, with the units that its names carry.
    ///
    /// Parameters
    /// ----------
    /// remedies : bool
    ///     Whether to search remedies of violations, each verified by a check of the whole program.
    ///
    /// Returns
    /// -------
    /// dict
    #[pyo3(signature = (*, remedies=false))]
    fn report<'py>(&self, py: Python<'py>, remedies: bool) -> PyResult<Bound<'py, PyAny>> {
        let text = py.detach(|| {
            let (cell, motion) = (&*self.cell, &self.motion);
            let mut document =
                report::cell(cell, &self.program, motion, &self.report, DisplayUnits::Metric);
            if remedies {
                let options = CheckOptions::default();
                let found = check::remedies(cell, motion, &options, &self.report, &|| false).ok();
                document.remedies =
                    found.map(|found| report::remedy_reports(cell, &found, DisplayUnits::Metric));
            }
            serde_json::to_string(&document)
        });
        let text = text.map_err(|error| errors::internal(&error.to_string()))?;
        py.import("json")?.call_method1("loads", (text,))
    }

    /// The trajectory at a constant rate, and at its end.
    ///
    /// Parameters
    /// ----------
    /// rate_hz : float
    ///     Number of samples a second.
    ///
    /// Returns
    /// -------
    /// Samples
    #[pyo3(signature = (rate_hz=100.0))]
    fn samples<'py>(&self, py: Python<'py>, rate_hz: f64) -> PyResult<Bound<'py, PyAny>> {
        let axes = self.cell.robot.axes.len();
        let found = self.motion.duration() * rate_hz * (3 * axes) as f64;
        if !(rate_hz.is_finite() && (0.1..=100_000.0).contains(&rate_hz)) {
            let message = format!("rate_hz is {rate_hz}, but has to be from 0.1 to 100000 Hz");
            return Err(errors::input(py, &message));
        }
        check_size(py, found)?;
        let (mut times, mut steps) = (Vec::new(), Vec::new());
        let mut states: [Vec<f64>; 3] = Default::default();
        py.detach(|| {
            for sample in self.motion.samples(rate_hz) {
                times.push(sample.time);
                steps.push(sample.step as i64);
                let parts = [&sample.positions, &sample.velocities, &sample.accelerations];
                for (state, part) in states.iter_mut().zip(parts) {
                    state.extend_from_slice(part);
                }
            }
        });
        let lines: Vec<i64> =
            steps.iter().map(|&k| self.motion.steps[k as usize].place.line as i64).collect();
        let rows = times.len();
        let matrix = |values: Vec<f64>| values.into_pyarray(py).reshape([rows, axes]);
        let [positions, velocities, accelerations] = states;
        let names: Vec<&str> = self.cell.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
        let time: Bound<'py, PyArray1<f64>> = times.into_pyarray(py);
        let fields = fields!(py;
            time_s = time,
            step = steps.into_pyarray(py),
            line = lines.into_pyarray(py),
            positions = matrix(positions)?,
            velocities = matrix(velocities)?,
            accelerations = matrix(accelerations)?,
            axes = pyo3::types::PyTuple::new(py, names)?,
            axis_units = pyo3::types::PyTuple::new(py, axis_units(&self.cell))?,
        );
        skin::result(py, "Samples", &fields)
    }

    /// Chosen columns of the trajectory, as in the table of `jointplay cell export`, with the units that their names carry.
    ///
    /// Parameters
    /// ----------
    /// columns : list of str, optional
    ///     Names of columns or groups, such as `time`, `x`, `heading`, `tilt`, `speed`, `all`; an unknown name lists all of them.
    /// rate_hz : float
    ///     Number of samples a second.
    /// from_s, to_s : float, optional
    ///     First and last time; the whole trajectory by default.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray
    ///     The columns in the order of the names, such as for `pandas.DataFrame`.
    #[pyo3(signature = (columns=None, *, rate_hz=100.0, from_s=None, to_s=None))]
    fn table<'py>(
        &self,
        py: Python<'py>,
        columns: Option<Vec<String>>,
        rate_hz: f64,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let input = |error: export::Error| errors::input(py, &error.to_string());
        let columns = columns.map(|names| export::select_columns(&self.cell, &names));
        let columns = columns.transpose().map_err(input)?;
        let width = export::sample_columns(&self.cell).len();
        let width = columns.as_ref().map_or(width, Vec::len);
        let options = SampleOptions { columns, ..self.rows(py, rate_hz, [from_s, to_s], width)? };
        let table = py.detach(|| export::samples_with(&self.motion_export(), &options));
        let arrays = PyDict::new(py);
        for Column { name, values } in table.map_err(input)? {
            match values {
                Values::Real(values) => arrays.set_item(name, values.into_pyarray(py))?,
                Values::Count(values) => arrays.set_item(name, values.into_pyarray(py))?,
            }
        }
        Ok(arrays)
    }

    /// Poses of a frame of the robot in the base frame, `base_from_frame`, deflection of arms and displacements of virtual joints included.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Name of a rod, `platform`, name of a link such as `upper link 1`, or of an effector, whose frame is that of its wafer; an unknown name lists all of them.
    /// rate_hz : float
    ///     Number of samples a second.
    /// from_s, to_s : float, optional
    ///     First and last time; the whole trajectory by default.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Homogeneous transforms at the times of `table`, shape (n, 4, 4) [m].
    #[pyo3(signature = (name, *, rate_hz=100.0, from_s=None, to_s=None))]
    fn link_poses<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        rate_hz: f64,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let options = self.rows(py, rate_hz, [from_s, to_s], 16)?;
        let poses = py.detach(|| export::frame_poses(&self.motion_export(), name, &options));
        let poses = poses.map_err(|error| errors::input(py, &error.to_string()))?;
        let numbers = poses.iter().flat_map(|pose| {
            let matrix = pose.to_homogeneous();
            (0..16).map(move |k| matrix[(k / 4, k % 4)])
        });
        numbers.collect::<Vec<f64>>().into_pyarray(py).reshape([poses.len(), 4, 4])
    }

    /// The animated 3D scene of the cell as a binary glTF file.
    ///
    /// Parameters
    /// ----------
    /// rate_hz : float
    ///     Number of key frames a second.
    /// despite_errors : bool
    ///     Whether a program with violations is exported; the file then contains a warning.
    ///
    /// Returns
    /// -------
    /// bytes
    #[pyo3(signature = (*, rate_hz=60.0, despite_errors=false))]
    fn gltf<'py>(
        &self,
        py: Python<'py>,
        rate_hz: f64,
        despite_errors: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        self.check_export(py, despite_errors)?;
        let bytes = py.detach(|| export::gltf(&self.motion_export(), rate_hz));
        let bytes = bytes.map_err(|error| errors::input(py, &error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The program in the language of a controller.
    ///
    /// Parameters
    /// ----------
    /// dialect : str or path-like
    ///     Name of an included dialect, `'neutral'` or `'points'`, or a dialect file as a `pathlib.Path`.
    /// rate_hz : float
    ///     Number of points a second, for dialects with points.
    /// despite_errors : bool
    ///     Whether a program with violations is exported; the text then contains a warning.
    ///
    /// Returns
    /// -------
    /// str
    #[pyo3(signature = (dialect=None, *, rate_hz=100.0, despite_errors=false))]
    fn controller_text(
        &self,
        py: Python<'_>,
        dialect: Option<&Bound<'_, PyAny>>,
        rate_hz: f64,
        despite_errors: bool,
    ) -> PyResult<String> {
        self.check_export(py, despite_errors)?;
        let dialect = match dialect {
            None => Dialect::neutral(),
            Some(given) => read_dialect(py, given)?,
        };
        py.detach(|| dialect.write(&self.motion_export(), rate_hz))
            .map_err(|error| errors::input(py, &error.to_string()))
    }

    fn __repr__(&self) -> String {
        let violations = self.report.violations.len();
        format!("<CellPlan of {:.3} s with {violations} violations>", self.motion.duration())
    }
}

/// Refuses tables with too many numbers.
fn check_size(py: Python<'_>, found: f64) -> PyResult<()> {
    if found > MAX_SAMPLES {
        let message = format!(
            "{found:.1e} numbers are more than {MAX_SAMPLES:.0e}: lower rate_hz, or divide the program"
        );
        return Err(errors::input(py, &message));
    }
    Ok(())
}

/// Unit of each axis.
pub(crate) fn axis_units(cell: &Cell) -> Vec<&'static str> {
    let unit = |kind| match kind {
        AxisKind::Linear => "m",
        AxisKind::Rotary => "rad",
    };
    cell.robot.axes.iter().map(|axis| unit(axis.kind)).collect()
}

/// An included dialect, or that of a file.
fn read_dialect(py: Python<'_>, given: &Bound<'_, PyAny>) -> PyResult<Dialect> {
    let (label, text) = if let Ok(name) = given.cast::<PyString>() {
        let name = name.to_str()?;
        let Some(entry) = DIALECTS.iter().find(|entry| entry.name == name) else {
            let known = DIALECTS.map(|entry| entry.name.to_owned());
            return Err(errors::unknown_name(py, "dialect", name, &known));
        };
        (name.to_owned(), entry.text.to_owned())
    } else {
        let path: std::path::PathBuf = given.extract()?;
        (path.display().to_string(), files::read_text(py, &path, MAX_BYTES as u64)?)
    };
    Dialect::parse(&text).map_err(|problems| errors::file(py, &label, &problems))
}
