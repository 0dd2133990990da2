//! Derivatives of rods and poses of the three-rod robot.

use jointplay::gpr::RodDerivatives;
use jointplay::spatial::Tilt;
use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;

use crate::errors;
use crate::gpr::{PyGpr, axis_height};
use crate::model::{self, Model, ModelNames, with_model};
use crate::numbers::{one_triple, optional_real, real};
use crate::skin::{self, fields};

#[pymethods]
impl PyGpr {
    /// Rods of a tilt, with their first and second derivatives by tilt and height.
    ///
    /// Variables are (θ_x, θ_y, z), the tilt as a rotation vector in the base plane: (θ_x, θ_y) = tilt_rad · (−sin azimuth, cos azimuth).
    /// No pose is singular in them.
    ///
    /// Parameters
    /// ----------
    /// azimuth_rad, tilt_rad : float
    ///     The tilt (rad).
    /// height_m : float, optional
    ///     Axis height (m); default: the working height.
    ///
    /// Raises
    /// ------
    /// RobotLimitsError, TiltTooLargeError, NotFiniteError
    ///     As `inverse`.
    #[pyo3(signature = (azimuth_rad, tilt_rad, height_m=None))]
    fn rod_derivatives<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = real)] azimuth_rad: f64,
        #[pyo3(from_py_with = real)] tilt_rad: f64,
        #[pyo3(from_py_with = optional_real)] height_m: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let tilt = Tilt { azimuth: azimuth_rad, angle: tilt_rad };
        let height = axis_height(height_m, &self.gpr);
        let RodDerivatives { rods, rod_jacobian, second } =
            self.gpr.rod_derivatives(tilt, height).map_err(|error| errors::core(py, &error))?;
        let jacobian = Array2::from_shape_fn((3, 3), |at| rod_jacobian[at]);
        let second = Array3::from_shape_fn((3, 3, 3), |(k, i, j)| second[k][(i, j)]);
        let fields = fields!(py;
            rods_m = PyArray1::from_slice(py, &rods),
            jacobian = PyArray2::from_owned_array(py, jacobian),
            second = PyArray3::from_owned_array(py, second),
        );
        skin::result(py, "RodDerivatives", &fields)
    }

    /// First and second derivatives of the pose and of the virtual joints by the rods.
    ///
    /// Parameters
    /// ----------
    /// rods_m : array of shape (3,)
    ///     Rod lengths (m).
    /// virtualization : str, optional
    ///     `'planar'` (default), `'radial'`, `'polar'` or `'offset'`.
    /// solver, metric
    ///     Those of `forward`; `'newton'` for three virtual joints only, since its choice among the solutions for six follows from no equation.
    ///
    /// Raises
    /// ------
    /// NoAnswerError
    ///     As `forward`.
    /// InputError
    ///     For a virtualization of your own, and for `'newton'` with six virtual joints.
    #[pyo3(signature = (rods_m, virtualization=None, *, solver=None, metric=None))]
    fn platform_derivatives<'py>(
        &self,
        py: Python<'py>,
        rods_m: &Bound<'py, PyAny>,
        virtualization: Option<&Bound<'py, PyAny>>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (gpr, rods) = (&self.gpr, one_triple(rods_m)?);
        let model = Model::of(virtualization, gpr)?;
        let options = model::options(py, solver, metric)?;
        let found = with_model!(&model, v => gpr.forward(rods, v, &options)
            .and_then(|pose| Ok((pose, gpr.platform_derivatives(&pose, v)?))));
        let (pose, found) = model.checked(py, found)?;
        let count = pose.solution.virtual_joints.len();
        let jacobian = Array2::from_shape_fn((6, 3), |at| found.jacobian.matrix[at]);
        let changes =
            Array3::from_shape_fn((3, 6, 3), |(k, i, j)| found.jacobian_derivatives[k][(i, j)]);
        let first = Array2::from_shape_fn((count, 3), |(m, k)| found.jacobian.virtual_joints[k][m]);
        let second =
            Array3::from_shape_fn((count, 3, 3), |(m, j, k)| found.virtual_joints[j][k][m]);
        let names = ModelNames::of_model(&model);
        let fields = fields!(py;
            pose = Bound::new(py, crate::pose::PyForward::new(pose, names))?,
            jacobian = PyArray2::from_owned_array(py, jacobian),
            jacobian_derivatives = PyArray3::from_owned_array(py, changes),
            virtual_joints = PyArray2::from_owned_array(py, first),
            virtual_joints_second = PyArray3::from_owned_array(py, second),
        );
        skin::result(py, "PlatformDerivatives", &fields)
    }
}
