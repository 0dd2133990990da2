//! One pose, as it comes out of `forward` and `inverse`: numbers at once, arrays where they are asked for.

use jointplay::gpr::PlatformPose;
use jointplay::nalgebra::{Matrix3, Rotation3, Translation3, Vector3};
use jointplay::spatial::Pose;
use jointplay::virtualization::{MAX_VIRTUAL_JOINTS, Solution, VirtualJoints};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::matrix;
use crate::errors;
use crate::model::ModelNames;

/// Where the platform is for three rods, with everything that led to it.
#[pyclass(name = "Forward", module = "jointplay", frozen, eq)]
#[derive(PartialEq)]
pub(crate) struct PyForward {
    pose: PlatformPose,
    model: &'static ModelNames,
}

impl PyForward {
    pub(crate) fn new(pose: PlatformPose, model: &'static ModelNames) -> Self {
        Self { pose, model }
    }
}

/// Numbers and names that a pose is made of, for pickling.
type Parts = (
    [f64; 3],
    [f64; 3],
    Vec<f64>,
    (String, f64, usize, f64),
    [f64; 3],
    [[f64; 3]; 3],
    String,
    Vec<(String, usize, bool)>,
);

#[pymethods]
impl PyForward {
    /// Rod lengths q_1, q_2, q_3, shape (3,) (m).
    #[getter]
    fn rods_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.pose.rods)
    }

    /// Sides L_12, L_23, L_31 between the ball centres, shape (3,) (m).
    #[getter]
    fn sides_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.pose.sides)
    }

    /// Tilt direction: azimuth of the platform normal, from -π to π (rad).
    #[getter]
    fn azimuth_rad(&self) -> f64 {
        self.pose.tilt().azimuth
    }

    /// Tilt angle, from 0 to π (rad).
    #[getter]
    fn tilt_rad(&self) -> f64 {
        self.pose.tilt().angle
    }

    /// Turn about the platform normal beyond the shortest rotation to it (rad).
    #[getter]
    fn torsion_rad(&self) -> f64 {
        self.pose.torsion()
    }

    /// Height at which the platform plane crosses the base axis (m).
    #[getter]
    fn axis_height_m(&self) -> f64 {
        self.pose.axis_height().0
    }

    /// Platform origin in the base frame, shape (3,) (m).
    #[getter]
    fn origin_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.pose.base_from_platform.translation.vector.as_slice())
    }

    /// Offset of the platform's origin from the base axis, shape (2,) (m).
    #[getter]
    fn center_shift_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.pose.center_shift().as_slice())
    }

    /// Platform normal in the base frame, shape (3,).
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.pose.normal().as_slice())
    }

    /// Homogeneous transform, shape (4, 4): `base_from_platform @ [x, y, z, 1]` is a point in the base frame (m).
    #[getter]
    fn base_from_platform<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let homogeneous = self.pose.base_from_platform.to_homogeneous();
        matrix(py, [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| homogeneous[(i, j)])))
    }

    /// Displacements X of the virtual joints, shape (M,), in the units of `virtual_joint_names` (m, rad).
    #[getter]
    fn virtual_joints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.pose.solution.virtual_joints)
    }

    /// Symbol, limb and unit of each virtual joint, such as `'u_1_m'`.
    #[getter]
    fn virtual_joint_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.model.joint_names())
    }

    /// Name of the virtualization.
    #[getter]
    fn virtualization(&self) -> &str {
        &self.model.name
    }

    /// Solver that determined the virtual joints: `'newton'`, `'least-norm'` or `'closed-form'`.
    #[getter]
    fn solver(&self) -> String {
        self.pose.solution.solver.to_string()
    }

    /// Length by which angles were multiplied to weigh them against lengths (m).
    #[getter]
    fn characteristic_length_m(&self) -> f64 {
        self.pose.solution.characteristic_length
    }

    /// Iterations done, 0 for a closed form.
    #[getter]
    fn iterations(&self) -> usize {
        self.pose.solution.iterations
    }

    /// Largest difference between a side and its virtual length (m).
    #[getter]
    fn residual_m(&self) -> f64 {
        self.pose.solution.residual
    }

    fn __repr__(&self) -> String {
        let origin = self.pose.base_from_platform.translation.vector;
        format!(
            "Forward(azimuth_rad={:?}, tilt_rad={:?}, origin_m=[{:?}, {:?}, {:?}], virtualization={:?})",
            self.azimuth_rad(),
            self.tilt_rad(),
            origin.x,
            origin.y,
            origin.z,
            self.model.name,
        )
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Parts,))> {
        let (pose, solution) = (&self.pose, &self.pose.solution);
        let rotation = pose.base_from_platform.rotation.matrix();
        let joint = |(symbol, limb, turns): (&str, usize, bool)| (symbol.to_owned(), limb, turns);
        let parts = (
            pose.rods,
            pose.sides,
            solution.virtual_joints.to_vec(),
            (
                solution.solver.to_string(),
                solution.characteristic_length,
                solution.iterations,
                solution.residual,
            ),
            pose.base_from_platform.translation.vector.into(),
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
            self.model.name.clone(),
            self.model.parts().into_iter().map(joint).collect(),
        );
        Ok((py.get_type::<Self>().getattr("_from_parts")?, (parts,)))
    }

    /// The pose of `__reduce__`.
    #[staticmethod]
    fn _from_parts(py: Python<'_>, parts: Parts) -> PyResult<Self> {
        let (rods, sides, x, (solver, characteristic_length, iterations, residual), ..) = &parts;
        let (.., origin, rotation, name, joints) = &parts;
        if x.len() > MAX_VIRTUAL_JOINTS || x.len() != joints.len() {
            return Err(errors::input(py, "these are not the parts of a pose"));
        }
        let mut virtual_joints = VirtualJoints::zeros(x.len());
        virtual_joints.copy_from_slice(x);
        let solver = crate::model::options(py, Some(solver), None)?.solver;
        let solution = Solution {
            virtual_joints,
            solver,
            characteristic_length: *characteristic_length,
            iterations: *iterations,
            residual: *residual,
        };
        let rotation = Matrix3::from_fn(|i, j| rotation[i][j]);
        let base_from_platform = Pose::from_parts(
            Translation3::from(Vector3::from(*origin)),
            Rotation3::from_matrix_unchecked(rotation),
        );
        let pose = PlatformPose { rods: *rods, sides: *sides, solution, base_from_platform };
        Ok(Self { pose, model: ModelNames::from_parts(name, joints) })
    }
}

/// The rods of one tilt.
#[pyclass(name = "Inverse", module = "jointplay", frozen, eq, hash)]
#[derive(PartialEq)]
pub(crate) struct PyInverse {
    pub(crate) rods: [f64; 3],
}

impl std::hash::Hash for PyInverse {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        // Both zeros are equal, and so have one hash.
        self.rods.map(|length| (length + 0.0).to_bits()).hash(state);
    }
}

#[pymethods]
impl PyInverse {
    #[new]
    fn new(rods_m: [f64; 3]) -> Self {
        Self { rods: rods_m }
    }

    /// Rod lengths q_1, q_2, q_3, shape (3,) (m).
    #[getter]
    fn rods_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.rods)
    }

    fn __repr__(&self) -> String {
        format!("Inverse(rods_m={:?})", self.rods)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __getnewargs__(&self) -> ([f64; 3],) {
        (self.rods,)
    }
}
