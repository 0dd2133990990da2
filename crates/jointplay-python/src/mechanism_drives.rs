//! Paths of driven joints.

use std::path::PathBuf;

use jointplay::Error;
use jointplay::interop::import;
use jointplay::mechanism::{Drive, DrivePath, DrivenMotion, held_actuators};
use jointplay::nalgebra::DVector;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::arrays::real;
use crate::mechanism::PyMechanism;
use crate::mechanism_analyses::{MOST_STEPS, STEPS};
use crate::{errors, files};

/// Values of one driven joint coordinate (m, rad).
struct Driven {
    coordinate: usize,
    name: String,
    values: Vec<f64>,
}

#[pymethods]
impl PyMechanism {
    /// Values of driven joints in a table (CSV), as `jointplay move --table` reads it.
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     A line of headings, then a line of numbers for each position: a heading is the name of a coordinate, with values in the unit of the file, or its name, `_` and a unit, such as `crank_deg`. A first column of another name, whose values increase or decrease, is ignored.
    ///
    /// Returns
    /// -------
    /// dict of str to array
    ///     Values of each driven coordinate, for `drive` and `positions`, shape (n,) (m, rad).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     For a file that is no such table.
    /// OSError
    ///     For a file that cannot be read.
    fn read_drive_table<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
    ) -> PyResult<Bound<'py, PyDict>> {
        let text = files::read_text(py, &path, import::MAX_TABLE_BYTES as u64)?;
        let table = import::drive_table(&text, &self.coordinates, &self.file.mechanism)
            .map_err(|error| errors::input(py, &format!("{}: {error}", path.display())))?;
        let drives = PyDict::new(py);
        for (&coordinate, values) in table.coordinates.iter().zip(table.values) {
            let name = &self.coordinates.all()[coordinate].name;
            drives.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok(drives)
    }
}

impl PyMechanism {
    /// The path of joints with their final values, initial and final values, or values along a curve.
    pub(crate) fn drive_path(
        &self,
        py: Python<'_>,
        drives: &Bound<'_, PyMapping>,
        start: &DVector<f64>,
    ) -> PyResult<DrivePath> {
        let mut all = Vec::new();
        for item in drives.items()? {
            let (name, given): (String, Bound<'_, PyAny>) = item.extract()?;
            let coordinate = self.find(py, &name)?;
            let expected = "a number, an initial and a final value, or an array of values";
            let given = real(&given, &name, expected)?;
            let mut values: Vec<f64> = given.readonly().as_array().iter().copied().collect();
            match given.ndim() {
                0 => values.insert(0, start[coordinate]),
                1 if (2..=MOST_STEPS + 1).contains(&values.len()) => {}
                _ => {
                    let message =
                        format!("{name}: expected {expected}, got shape {:?}", given.shape());
                    return Err(errors::input(py, &message));
                }
            }
            if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
                return Err(errors::not_finite(py, &name, value));
            }
            all.push(Driven { coordinate, name, values });
        }
        let Some(longest) = all.iter().max_by_key(|one| one.values.len()) else {
            return Err(errors::input(
                py,
                "no joint is driven; expected a mapping such as {\"crank\": (0, 1)}",
            ));
        };
        let count = longest.values.len();
        if let Some(other) = all.iter().find(|one| ![2, count].contains(&one.values.len())) {
            let message = format!(
                "{} has {count} values and {} has {}: curves need the same number of values",
                longest.name,
                other.name,
                other.values.len()
            );
            return Err(errors::input(py, &message));
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of points")]
        let value = |one: &Driven, point: usize| match one.values[..] {
            [from, to] => from + (to - from) * point as f64 / (count - 1) as f64,
            _ => one.values[point],
        };
        let points = (0..count).map(|point| all.iter().map(|one| value(one, point)).collect());
        DrivePath::through(all.iter().map(|one| one.coordinate).collect(), points.collect())
            .map_err(|error| errors::core(py, &error))
    }

    /// Motors that are not driven and not free; none where something is driven that has no motor.
    pub(crate) fn held_but(
        &self,
        py: Python<'_>,
        driven: &[usize],
        free: &[String],
    ) -> PyResult<Vec<usize>> {
        let mut held = held_actuators(&self.file.mechanism, driven);
        for name in free {
            let of_joint = |k: &usize| {
                let named = &self.coordinates.all()[*k];
                named.name == *name || named.joint == *name
            };
            if !held.iter().any(of_joint) {
                if self.file.mechanism.joint(name).is_none() {
                    self.find(py, name)?;
                }
                let message = format!("free: the joint {name:?} is not held");
                return Err(errors::input(py, &message));
            }
            held.retain(|k| !of_joint(k));
        }
        Ok(held)
    }

    /// The configuration at the start of a path, or the motion that stopped before it.
    pub(crate) fn to_start(
        &self,
        from: DVector<f64>,
        path: &DrivePath,
        held: &[usize],
    ) -> Result<Result<DVector<f64>, DrivenMotion>, Error> {
        let drives: Vec<Drive> =
            path.at(0.0).map(|(coordinate, to)| Drive { coordinate, to }).collect();
        if drives.iter().all(|drive| drive.to == from[drive.coordinate]) {
            return Ok(Ok(from));
        }
        let moved = self.along(&from, &DrivePath::line(&from, &drives)?, held, STEPS)?;
        Ok(match (&moved.stopped, moved.waypoints.last()) {
            (None, Some(last)) => Ok(last.coordinates.clone()),
            _ => Err(moved),
        })
    }
}
