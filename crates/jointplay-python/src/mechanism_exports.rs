//! Exports of mechanisms: models of simulators, and animated 3D scenes.

use jointplay::interop::export::mechanism::{self, Error, Written, modelica_class};
use jointplay::interop::export::{
    self, AnimatedParts, MechanismMotion, PartTable, PartsFile, UpAxis,
};
use jointplay::mechanism::Mechanism;
use jointplay::nalgebra::DVector;
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::arrays::real;
use crate::errors;
use crate::mechanism::PyMechanism;
use crate::skin::{self, fields};

#[pymethods]
impl PyMechanism {
    /// The mechanism as a model of a simulator, with its play as joints.
    ///
    /// Parameters
    /// ----------
    /// format : str
    ///     `'mjcf'` for MuJoCo, `'sdf'` for Gazebo, `'urdf'` for ROS or `'modelica'`.
    /// at : dict of str to float
    ///     Commanded coordinates of the reference configuration (m, rad).
    ///
    /// Returns
    /// -------
    /// SimulatorModel
    ///     The text of the model, that of the joints that close loops for URDF, and what the format does not keep.
    #[pyo3(signature = (format, at=None))]
    fn to_model<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        at: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let write = match format {
            "mjcf" => mechanism::mjcf,
            "modelica" => |mechanism: &Mechanism, coordinates: &DVector<f64>| {
                mechanism::modelica(mechanism, coordinates, &modelica_class(mechanism.name()))
            },
            "sdf" => mechanism::sdf,
            "urdf" => mechanism::urdf,
            _ => {
                let known = ["mjcf", "modelica", "sdf", "urdf"].map(str::to_owned);
                return Err(errors::unknown_name(py, "format", format, &known));
            }
        };
        let commands = self.commands(py, at)?;
        let found =
            py.detach(|| self.posed(&commands, None)).map_err(|error| errors::core(py, &error))?;
        let written = py.detach(|| write(&self.file.mechanism, &found.coordinates));
        let Written { text, loops, lost } = written.map_err(|error| match error {
            Error::Core(error) => errors::core(py, &error),
            other => errors::input(py, &other.to_string()),
        })?;
        let lost = PyTuple::new(py, lost)?;
        skin::result(py, "SimulatorModel", &fields!(py; text = text, loops = loops, lost = lost))
    }

    /// An animated 3D scene of configurations, and the links without a part; see `Motion.to_gltf`.
    #[pyo3(signature = (coordinates, times_s, duration_s, exaggerate, tolerance_um, parts=None, table=None, table_file=None, parts_up=None))]
    #[expect(clippy::too_many_arguments, reason = "they are those of `Motion.to_gltf`")]
    fn _gltf<'py>(
        &self,
        py: Python<'py>,
        coordinates: &Bound<'py, PyAny>,
        times_s: Option<&Bound<'py, PyAny>>,
        duration_s: f64,
        exaggerate: f64,
        tolerance_um: f64,
        parts: Option<&[u8]>,
        table: Option<Vec<(String, String)>>,
        table_file: Option<(String, String)>,
        parts_up: Option<&str>,
    ) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
        let width = self.coordinates.all().len();
        let expected = format!("an array of shape (n, {width})");
        let given = real(coordinates, "coordinates", &expected)?;
        if !matches!(given.shape(), [_, last] if *last == width) {
            let message =
                format!("coordinates have to be {expected}, but have shape {:?}", given.shape());
            return Err(errors::input(py, &message));
        }
        let values = given.readonly();
        let rows = values.as_array();
        let rows: Vec<DVector<f64>> = rows
            .rows()
            .into_iter()
            .map(|row| DVector::from_iterator(width, row.iter().copied()))
            .collect();
        let up = match parts_up {
            None => None,
            Some("y") => Some(UpAxis::Y),
            Some("z") => Some(UpAxis::Z),
            Some(other) => {
                let known = ["y", "z"].map(str::to_owned);
                return Err(errors::unknown_name(py, "axis", other, &known));
            }
        };
        let mut of_file = match table_file {
            Some((label, text)) => {
                PartTable::parse(&text).map_err(|found| errors::file(py, &label, &found))?
            }
            None => PartTable::default(),
        };
        of_file.parts.extend(table.unwrap_or_default());
        let times = match times_s {
            Some(given) => {
                let given = real(given, "times_s", "an array of shape (n,)")?;
                Some(given.readonly().as_array().iter().copied().collect::<Vec<f64>>())
            }
            None => None,
        };
        let reference =
            py.detach(|| self.posed(&[], None)).map_err(|error| errors::core(py, &error))?;
        let scene = py.detach(|| {
            let mechanism = &self.file.mechanism;
            let times = match times {
                Some(times) => times,
                None => {
                    let numbers: Vec<f64> = (0..rows.len()).map(|row| row as f64).collect();
                    export::proportional_times(duration_s, &numbers)?
                }
            };
            let at_rest = &reference.coordinates;
            let motion = MechanismMotion::new(mechanism, at_rest, &rows, times, exaggerate)?;
            let tolerance = 1e-6 * tolerance_um;
            let Some(parts) = parts else {
                let bytes = motion.gltf(tolerance)?;
                return Ok(AnimatedParts { bytes, missing: Vec::new() });
            };
            let parts = PartsFile::parse(parts)?;
            let up = up.or(of_file.up).unwrap_or_else(|| parts.up_axis());
            motion.gltf_of_parts(&parts, &of_file.parts, up, tolerance)
        });
        let AnimatedParts { bytes, missing } =
            scene.map_err(|error: export::Error| errors::input(py, &error.to_string()))?;
        Ok((PyBytes::new(py, &bytes), missing))
    }
}
