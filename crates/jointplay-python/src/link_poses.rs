//! Poses of links and attached frames of a mechanism.

use jointplay::Error;
use jointplay::format::coordinates;
use jointplay::mechanism::{FrameId, Kinematics, exaggerated_link_poses};
use jointplay::nalgebra::DVector;
use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::real;
use crate::errors;
use crate::mechanism::PyMechanism;

/// Numbers of a homogeneous transform.
const ENTRIES: usize = 16;

#[pymethods]
impl PyMechanism {
    /// Names of the frames that the file attaches to links.
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.file.mechanism.frames().iter().map(|frame| &frame.name))
    }

    /// Poses of a link or an attached frame in the base frame, for one or many configurations.
    ///
    /// Parameters
    /// ----------
    /// coordinates : array
    ///     All coordinates, joints, then virtual joints, shape (f + M,) or (n, f + M) (m, rad).
    /// name : str
    ///     The link or the attached frame.
    /// exaggerate : float
    ///     Factor of the displacements of virtual joints, for pictures; with 1 the true poses.
    ///
    /// Returns
    /// -------
    /// array
    ///     Homogeneous transforms `base_from_frame`, shape (4, 4) or (n, 4, 4) (m); NaN for rows that are not finite.
    #[pyo3(signature = (coordinates, name, *, exaggerate=1.0))]
    fn link_poses<'py>(
        &self,
        py: Python<'py>,
        coordinates: &Bound<'py, PyAny>,
        name: &str,
        exaggerate: f64,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let width = self.coordinates.all().len();
        let expected = format!("an array of shape ({width},) or (n, {width})");
        let given = real(coordinates, "coordinates", &expected)?;
        let shape = given.shape().to_vec();
        if !matches!(shape.as_slice(), [last] | [_, last] if *last == width) {
            let message = format!("coordinates have to be {expected}, but have shape {shape:?}");
            return Err(errors::input(py, &message));
        }
        let frame = self.frame(py, name)?;
        let values = given.readonly();
        let rows: Vec<f64> = values.as_array().iter().copied().collect();
        let count = shape[..shape.len() - 1].iter().product();
        let poses = py
            .detach(|| self.poses_of(frame, &rows, count, exaggerate))
            .map_err(|error| errors::core(py, &error))?;
        let shape = [&shape[..shape.len() - 1], &[4, 4]].concat();
        let array = ArrayD::from_shape_vec(IxDyn(&shape), poses)
            .map_err(|error| errors::internal(&error.to_string()))?;
        Ok(PyArrayDyn::from_owned_array(py, array))
    }
}

impl PyMechanism {
    /// The link or attached frame of a name.
    pub(crate) fn frame(&self, py: Python<'_>, name: &str) -> PyResult<FrameId> {
        coordinates::frame(&self.file.mechanism, name).map_err(|error| match error {
            coordinates::Error::UnknownFrame { ref known, .. } => {
                errors::unknown_name(py, "link or frame", name, known)
            }
            other => errors::input(py, &other.to_string()),
        })
    }

    /// Entries of the homogeneous transforms by rows, NaN for configurations that are not finite.
    ///
    /// The number of rows is an argument of its own because mechanisms of fixed joints alone have no coordinates.
    fn poses_of(
        &self,
        frame: FrameId,
        rows: &[f64],
        count: usize,
        factor: f64,
    ) -> Result<Vec<f64>, Error> {
        let kinematics = Kinematics::new(&self.file.mechanism);
        let width = self.coordinates.all().len();
        let mut entries = Vec::with_capacity(count * ENTRIES);
        for number in 0..count {
            let row = &rows[number * width..(number + 1) * width];
            if !row.iter().all(|value| value.is_finite()) {
                entries.extend([f64::NAN; ENTRIES]);
                continue;
            }
            let row = DVector::from_column_slice(row);
            let links = exaggerated_link_poses(&self.file.mechanism, &row, factor)?;
            let pose = kinematics.frame_pose(frame, &links).to_homogeneous();
            entries.extend(pose.transpose().iter());
        }
        Ok(entries)
    }
}
