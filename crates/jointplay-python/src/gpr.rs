//! The three-rod robot.

use std::path::PathBuf;

use jointplay::format::robot::{self, Robot};
use jointplay::gpr::{AxisHeight, CenterHeight, Gpr, Limb, Limits};
use jointplay::nalgebra::Vector2;
use jointplay::spatial::Tilt;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyTuple};

use crate::arrays::{Spread, Triples, matrix, numbers_of_shape};
use crate::many::{self, Wanted};
use crate::model::{self, Model, ModelNames, with_model};
use crate::numbers::{number, one_triple, optional_real, real, three};
use crate::pose::{PyForward, PyInverse};
use crate::prepared::PreparedSolvers;
use crate::skin::{self, fields};
use crate::{errors, own_virtualization};

/// Larger robot files are refused unread, in bytes.
const LARGEST_ROBOT_FILE: u64 = 1_000_000;

/// Allowed rods, for messages.
pub(crate) const RODS: &str = "three rod lengths or an array of shape (..., 3) in metres";

/// A three-rod robot, a GPR.
///
/// Three vertical rods of adjustable length carry a platform on ball joints.
/// Lengths are in metres and angles in radians; a robot never changes.
///
/// Parameters
/// ----------
/// socket_radius_m : float or array of shape (3,)
///     Distances of the nominal sockets from the platform's origin (m).
/// rod_limits_m : (float, float)
///     Shortest and longest rod (m).
/// tilt_limit_rad : float
///     Largest tilt toward any azimuth (rad).
/// working_height_m : float
///     Axis height at which the robot usually works (m).
/// socket_angle_rad : array of shape (3,), optional
///     Directions of the sockets in the platform (rad); default: 0°, 120° and 240°.
/// base_points_m : array of shape (3, 2), optional
///     Where the rods cross the base plane (m); default: each under its socket.
/// ball_clearance_m : float, optional
///     Radial clearance of the balls in their sockets (m), with which `needed_clearance` compares.
/// name : str, optional
///     What messages call it.
/// check_limits : bool, optional
///     Whether poses beyond the limits are refused; see `without_limit_checks`.
///
/// Examples
/// --------
/// >>> import jointplay as jp
/// >>> jp.Gpr(socket_radius_m=0.1, rod_limits_m=(0.2, 0.8), tilt_limit_rad=0.03, working_height_m=0.5)
/// Gpr(name="GPR", socket_radius_m=[0.1, 0.1, 0.1], working_height_m=0.5)
#[pyclass(name = "Gpr", module = "jointplay", frozen, eq, hash)]
pub(crate) struct PyGpr {
    pub(crate) name: String,
    pub(crate) gpr: Gpr,
    /// Its solvers for many poses.
    prepared: PreparedSolvers,
}

impl PartialEq for PyGpr {
    fn eq(&self, other: &Self) -> bool {
        self.gpr == other.gpr && self.name == other.name
    }
}

impl std::hash::Hash for PyGpr {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        // Equal robots have equal hashes, and so do both zeros.
        for limb in self.gpr.limbs() {
            let numbers =
                [limb.base_point.x, limb.base_point.y, limb.socket_radius, limb.socket_angle];
            numbers.map(|number| (number + 0.0).to_bits()).hash(state);
        }
        self.name.hash(state);
    }
}

pub(crate) fn axis_height(height: Option<f64>, gpr: &Gpr) -> AxisHeight {
    AxisHeight(height.unwrap_or_else(|| gpr.working_height()))
}

impl PyGpr {
    fn forward_one(
        &self,
        py: Python<'_>,
        rods: [f64; 3],
        model: &Model,
        options: &jointplay::virtualization::SolveOptions,
    ) -> PyResult<PyForward> {
        let found = with_model!(model, v => self.gpr.forward(rods, v, options));
        self.pose(py, found, model)
    }

    /// A pose or its error; where Python's own code raised, what it raised.
    fn pose(
        &self,
        py: Python<'_>,
        found: Result<jointplay::gpr::PlatformPose, jointplay::Error>,
        model: &Model,
    ) -> PyResult<PyForward> {
        let pose = model.checked(py, found)?;
        Ok(PyForward::new(pose, ModelNames::of_model(model)))
    }
}

#[pymethods]
impl PyGpr {
    #[new]
    #[pyo3(signature = (*, socket_radius_m, rod_limits_m, tilt_limit_rad, working_height_m, socket_angle_rad=None, base_points_m=None, ball_clearance_m=None, name="GPR".to_owned(), check_limits=true))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        py: Python<'_>,
        socket_radius_m: &Bound<'_, PyAny>,
        rod_limits_m: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = real)] tilt_limit_rad: f64,
        #[pyo3(from_py_with = real)] working_height_m: f64,
        socket_angle_rad: Option<&Bound<'_, PyAny>>,
        base_points_m: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = optional_real)] ball_clearance_m: Option<f64>,
        name: String,
        check_limits: bool,
    ) -> PyResult<Self> {
        let radii = match number(socket_radius_m) {
            Some(radius) => vec![radius; 3],
            None => numbers_of_shape(socket_radius_m, "socket_radius_m", &[3])?,
        };
        let angles = match socket_angle_rad {
            Some(angles) => numbers_of_shape(angles, "socket_angle_rad", &[3])?,
            None => Gpr::paper().platform().angles().to_vec(),
        };
        let points = base_points_m.map(|points| numbers_of_shape(points, "base_points_m", &[3, 2]));
        let points = points.transpose()?;
        let limbs = [0, 1, 2].map(|k| {
            let limb = Limb::under_socket(radii[k], angles[k]);
            let base_point = points
                .as_ref()
                .map_or(limb.base_point, |points| Vector2::new(points[2 * k], points[2 * k + 1]));
            Limb { base_point, ..limb }
        });
        let rods = numbers_of_shape(rod_limits_m, "rod_limits_m", &[2])?;
        let limits = Limits { rod_min: rods[0], rod_max: rods[1], tilt_max: tilt_limit_rad };
        let gpr =
            Gpr::new(limbs, limits, working_height_m).and_then(|gpr| match ball_clearance_m {
                Some(radius) => gpr.with_ball_clearance(radius),
                None => Ok(gpr),
            });
        let gpr = gpr.map_err(|error| errors::core(py, &error))?;
        let gpr = if check_limits { gpr } else { gpr.without_limit_checks() };
        Ok(Self::with_gpr(name, gpr))
    }

    /// The robot of the paper: three sockets 120° apart on a radius of 93.218 mm.
    #[staticmethod]
    fn paper() -> Self {
        Self::of(robot::paper())
    }

    /// The robot of a TOML file, written like the included `gpr`.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With line and column, for a file that is no robot.
    /// OSError
    ///     For a file that cannot be read.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = crate::files::read_text(py, &path, LARGEST_ROBOT_FILE)?;
        Self::parse(py, &text, &path.display().to_string())
    }

    /// The robot of the text of a TOML file; see `from_file`.
    #[staticmethod]
    fn from_toml(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::parse(py, text, "text")
    }

    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Base points, shape (3, 2) (m).
    #[getter]
    fn base_points_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.gpr.base_points().map(|point| [point.x, point.y]))
    }

    /// Distances of the nominal sockets from the platform's origin, shape (3,) (m).
    #[getter]
    fn socket_radius_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.gpr.platform().radii())
    }

    /// Directions of the nominal sockets in the platform, shape (3,) (rad).
    #[getter]
    fn socket_angle_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.gpr.platform().angles())
    }

    /// Shortest and longest rod (m).
    #[getter]
    fn rod_limits_m(&self) -> (f64, f64) {
        (self.gpr.limits().rod_min, self.gpr.limits().rod_max)
    }

    /// Largest tilt toward any azimuth (rad).
    #[getter]
    fn tilt_limit_rad(&self) -> f64 {
        self.gpr.limits().tilt_max
    }

    /// Axis height at which the robot usually works (m).
    #[getter]
    fn working_height_m(&self) -> f64 {
        self.gpr.working_height()
    }

    /// The platform as built.
    #[getter]
    fn platform<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        own_virtualization::platform(py, self.gpr.platform())
    }

    /// Where the platform is for given rods: one pose, or many at a time.
    ///
    /// Poses beyond the limits of rods and tilt are refused, unless the robot is one `without_limit_checks`.
    ///
    /// Parameters
    /// ----------
    /// rods_m : three numbers, or array of shape (..., 3)
    ///     Rod lengths q_1, q_2, q_3 (m). Arrays of `float64` in C or Fortran order are read in place, others copied first.
    /// virtualization : str or Virtualization, optional
    ///     The virtual joints that model the play: `'planar'` (default), `'radial'`, `'polar'`, `'offset'`, or an object of your own.
    /// solver : str, optional
    ///     `'closed-form'` (default), `'least-norm'` or `'newton'`.
    /// metric : str or float, optional
    ///     Characteristic length, by which angles are multiplied: `'paper'` (1 mm, default), `'radius'` (the mean socket radius), or a length (m).
    /// quantities : str or sequence of str, optional
    ///     What to compute for many poses, see `ForwardMany`; default: all but `'sensitivity'`.
    /// out : dict of arrays, optional
    ///     Arrays by name of quantity, written in place: shape (...) or (..., 3), `float64`, each column in one piece, as `np.empty(shape, order="F")` makes them.
    /// threads : int, optional
    ///     Number of threads for many poses; default: all cores. The result does not depend on it.
    ///
    /// Notes
    /// -----
    /// Many poses without a closed form are interpolated by polynomials to 10⁻¹³ of the longest side, and the sides of each are checked; tilts beyond 1.4 times the limit are solved by iteration, as are single poses.
    /// The first array of rods of a robot prepares this, within some 50 µs for each virtualization, solver and metric.
    ///
    /// Returns
    /// -------
    /// Forward or ForwardMany
    ///     One pose for three numbers, many for an array of several rows, or where `quantities` or `out` are given.
    ///
    /// Raises
    /// ------
    /// NoAnswerError
    ///     For one pose without an answer, a `RobotLimitsError` beyond the limits; of many, such poses are NaN and have their status.
    #[pyo3(signature = (rods_m, virtualization=None, *, solver=None, metric=None, quantities=None, out=None, threads=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        rods_m: &Bound<'py, PyAny>,
        virtualization: Option<&Bound<'py, PyAny>>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
        quantities: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyDict>>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = Model::of(virtualization, &self.gpr)?;
        let options = model::options(py, solver, metric)?;
        let one = if out.is_none() && quantities.is_none() { three(rods_m) } else { None };
        if let Some(rods) = one {
            return Ok(Bound::new(py, self.forward_one(py, rods, &model, &options)?)?.into_any());
        }
        let rods = Triples::read(rods_m, "rods_m", RODS)?;
        if rods.shape.is_empty() && out.is_none() && quantities.is_none() {
            let [q_1, q_2, q_3] = rods.columns()?.map(|column| column.at(0));
            let one = self.forward_one(py, [q_1, q_2, q_3], &model, &options)?;
            return Ok(Bound::new(py, one)?.into_any());
        }
        let wanted = Wanted { quantities, out, threads };
        let solver = model.virtualization().as_built_in();
        let solver = solver
            .map(|known| self.prepared.of(&self.gpr, known, &options))
            .transpose()
            .map_err(|error| errors::core(py, &error))?;
        many::forward(py, (&self.gpr, solver.as_deref()), &rods, &model, &options, &wanted)
    }

    /// Rods that put the platform plane at a tilt: one, or many at a time.
    ///
    /// Exact, and the same for every virtualization.
    /// Tilts and rods beyond the limits are refused, unless the robot is one `without_limit_checks`.
    ///
    /// Parameters
    /// ----------
    /// azimuth_rad, tilt_rad : float or array
    ///     Tilt direction and tilt angle (rad).
    /// height_m : float or array, optional
    ///     Where the platform plane crosses the base axis (m); default: the working height.
    ///     The three broadcast against each other.
    /// out : array of shape (..., 3), optional
    ///     Written in place: `float64`, each column in one piece, as `np.empty(shape, order="F")` makes it.
    /// threads : int, optional
    ///     Number of threads for many tilts; default: all cores.
    ///
    /// Returns
    /// -------
    /// Inverse or InverseMany
    ///     One for three numbers, many where one of them is an array.
    ///
    /// Raises
    /// ------
    /// RobotLimitsError, TiltTooLargeError, NotFiniteError
    ///     For one tilt; of many, such tilts are NaN and have their status.
    #[pyo3(signature = (azimuth_rad, tilt_rad, height_m=None, *, out=None, threads=None))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        azimuth_rad: &Bound<'py, PyAny>,
        tilt_rad: &Bound<'py, PyAny>,
        height_m: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let height = match height_m {
            None => Some(self.gpr.working_height()),
            Some(height) => number(height),
        };
        if let (None, Some(azimuth), Some(tilt_angle), Some(height)) =
            (out, number(azimuth_rad), number(tilt_rad), height)
        {
            let rods = self
                .gpr
                .inverse(Tilt { azimuth, angle: tilt_angle }, AxisHeight(height))
                .map_err(|error| errors::core(py, &error))?;
            return Ok(Bound::new(py, PyInverse { rods })?.into_any());
        }
        let working = PyFloat::new(py, self.gpr.working_height()).into_any();
        let height_m = height_m.unwrap_or(&working);
        let given = [("azimuth_rad", azimuth_rad), ("tilt_rad", tilt_rad), ("height_m", height_m)];
        let given = Spread::read(py, &given)?;
        if given.shape.is_empty() && out.is_none() {
            let columns = given.columns()?;
            let tilt = Tilt { azimuth: columns[0].at(0), angle: columns[1].at(0) };
            let rods = self
                .gpr
                .inverse(tilt, AxisHeight(columns[2].at(0)))
                .map_err(|error| errors::core(py, &error))?;
            return Ok(Bound::new(py, PyInverse { rods })?.into_any());
        }
        many::inverse(py, &self.gpr, &given, out, threads)
    }

    /// The pose with a tilt (rad) whose platform origin lies at a height (m).
    ///
    /// The height of the origin differs from the axis height by the centre shift times the slope, and so depends on the virtualization.
    /// Other parameters are those of `forward`.
    #[pyo3(signature = (azimuth_rad, tilt_rad, center_height_m, virtualization=None, *, solver=None, metric=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn inverse_for_center(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] azimuth_rad: f64,
        #[pyo3(from_py_with = real)] tilt_rad: f64,
        #[pyo3(from_py_with = real)] center_height_m: f64,
        virtualization: Option<&Bound<'_, PyAny>>,
        solver: Option<&str>,
        metric: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyForward> {
        let model = Model::of(virtualization, &self.gpr)?;
        let options = model::options(py, solver, metric)?;
        let tilt = Tilt { azimuth: azimuth_rad, angle: tilt_rad };
        let height = CenterHeight(center_height_m);
        let found =
            with_model!(&model, v => self.gpr.inverse_for_center(tilt, height, v, &options));
        self.pose(py, found, &model)
    }

    /// The approximate model of the paper's Fig. 2: the platform turns about its centre as though no rods held it.
    ///
    /// Parameters are those of `inverse` for one tilt (rad, m).
    #[pyo3(signature = (azimuth_rad, tilt_rad, height_m=None))]
    fn approximate<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = real)] azimuth_rad: f64,
        #[pyo3(from_py_with = real)] tilt_rad: f64,
        #[pyo3(from_py_with = optional_real)] height_m: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let tilt = Tilt { azimuth: azimuth_rad, angle: tilt_rad };
        let found = self
            .gpr
            .approximate(tilt, axis_height(height_m, &self.gpr))
            .map_err(|error| errors::core(py, &error))?;
        let homogeneous = found.base_from_platform.to_homogeneous();
        let homogeneous = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| homogeneous[(i, j)]));
        let fields = fields!(py;
            rods_m = PyArray1::from_slice(py, &found.rods),
            base_from_platform = matrix(py, homogeneous),
            gaps_m = matrix(py, found.gaps.map(Into::into)),
        );
        skin::result(py, "Approximate", &fields)
    }

    /// Azimuth and tilt angle of the plane through the ball centres for rods of shape (3,) (m), in radians.
    ///
    /// Geometry alone, the same for every virtualization.
    fn plane_tilt(&self, rods_m: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let rods = one_triple(rods_m)?;
        let tilt = self.gpr.plane_tilt(&rods);
        let lost = [tilt.azimuth, tilt.angle].into_iter().find(|angle| !angle.is_finite());
        match lost {
            Some(value) => Err(errors::not_finite(rods_m.py(), "the tilt of these rods", value)),
            None => Ok((tilt.azimuth, tilt.angle)),
        }
    }

    fn __repr__(&self) -> String {
        let [r_1, r_2, r_3] = self.gpr.platform().radii();
        let unchecked = if self.gpr.checks_limits() { "" } else { ", check_limits=False" };
        format!(
            "Gpr(name={:?}, socket_radius_m=[{r_1:?}, {r_2:?}, {r_3:?}], working_height_m={:?}{unchecked})",
            self.name,
            self.gpr.working_height()
        )
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let fields = fields!(py;
            name = &self.name,
            socket_radius_m = self.socket_radius_m(py),
            socket_angle_rad = self.socket_angle_rad(py),
            base_points_m = self.base_points_m(py),
            rod_limits_m = self.rod_limits_m(),
            tilt_limit_rad = self.tilt_limit_rad(),
            working_height_m = self.working_height_m(),
            ball_clearance_m = self.gpr.ball_clearance(),
            check_limits = self.gpr.checks_limits(),
        );
        Ok((PyTuple::empty(py), fields))
    }
}

impl PyGpr {
    fn parse(py: Python<'_>, text: &str, label: &str) -> PyResult<Self> {
        let robot = robot::parse(text).map_err(|found| errors::file(py, label, &found))?;
        Ok(Self::of(robot))
    }

    /// The robot of a file.
    pub(crate) fn of(robot: Robot) -> Self {
        Self::with_gpr(robot.name, robot.gpr)
    }

    /// A robot by its name and dimensions; no solver is prepared yet.
    pub(crate) fn with_gpr(name: String, gpr: Gpr) -> Self {
        Self { name, gpr, prepared: PreparedSolvers::default() }
    }

    /// The content of a file of this robot.
    pub(crate) fn robot(&self) -> Robot {
        let (name, gpr) = (self.name.clone(), self.gpr.clone());
        Robot { name, gpr, base_mesh: None, platform_mesh: None }
    }
}
