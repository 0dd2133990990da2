//! The limits of the three-rod robot.

use jointplay::spatial::Tilt;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::arrays::{Spread, Triples};
use crate::gpr::{PyGpr, RODS};
use crate::model::{self, Model, with_model};
use crate::numbers::{number, one_triple, three};
use crate::skin::{self, fields};
use crate::{errors, many};

#[pymethods]
impl PyGpr {
    /// Whether poses beyond the limits are refused.
    #[getter]
    fn checks_limits(&self) -> bool {
        self.gpr.checks_limits()
    }

    /// The robot with the same dimensions and limits that also answers beyond its limits, for analysis.
    ///
    /// Its poses are those of the geometry, whether or not the robot can take them; `broken_limits` reports the limits that they break.
    fn without_limit_checks(&self) -> Self {
        Self::with_gpr(self.name.clone(), self.gpr.without_limit_checks())
    }

    /// Radial clearance of the balls in their sockets (m); None where it is not known.
    #[getter]
    fn ball_clearance_m(&self) -> Option<f64> {
        self.gpr.ball_clearance()
    }

    /// Clearance of the balls that a pose needs, next to the one that the robot has.
    ///
    /// Of many poses, `forward` has the displacements of the balls as `ball_displacement_m`.
    ///
    /// Parameters
    /// ----------
    /// rods_m : three numbers
    ///     Rod lengths (m).
    /// virtualization, solver, metric :
    ///     As for `forward`.
    ///
    /// Returns
    /// -------
    /// BallClearance
    ///
    /// Raises
    /// ------
    /// NoAnswerError
    ///     As `forward`.
    #[pyo3(signature = (rods_m, virtualization=None, *, solver=None, metric=None))]
    fn needed_clearance<'py>(
        &self,
        py: Python<'py>,
        rods_m: &Bound<'py, PyAny>,
        virtualization: Option<&Bound<'py, PyAny>>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = Model::of(virtualization, &self.gpr)?;
        let options = model::options(py, solver, metric)?;
        let rods = one_triple(rods_m)?;
        let found = with_model!(&model, v => {
            let pose = self.gpr.forward(rods, v, &options);
            pose.map(|pose| self.gpr.needed_clearance(&pose, v))
        });
        let needed = model.checked(py, found)?;
        let fields = fields!(py;
            displacements_m = PyArray1::from_slice(py, &needed.displacements),
            lower_bound_m = needed.lower_bound,
            upper_bound_m = needed.upper_bound(),
            available_m = needed.available,
            is_sufficient = needed.is_sufficient(),
        );
        skin::result(py, "BallClearance", &fields)
    }

    /// The limits that a pose breaks, rods first, an empty list if none; or those of many poses at a time.
    ///
    /// Parameters
    /// ----------
    /// rods_m : three numbers, or array of shape (..., 3)
    ///     Rod lengths (m).
    /// tilt_rad : float or array of shape (...), optional
    ///     Tilt angle of the platform (rad); default: the tilt of the plane through the ball centres.
    ///
    /// Returns
    /// -------
    /// list of BrokenLimit, or BrokenLimits
    ///     For three numbers, or for an array of several rows.
    #[pyo3(signature = (rods_m, tilt_rad=None))]
    fn broken_limits<'py>(
        &self,
        py: Python<'py>,
        rods_m: &Bound<'py, PyAny>,
        tilt_rad: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let tilt_angle = tilt_rad.and_then(number);
        let one_tilt = tilt_angle.is_some() || tilt_rad.is_none();
        if let (Some(rods), true) = (three(rods_m), one_tilt) {
            return self.broken_by_one(py, &rods, tilt_angle);
        }
        let rods = Triples::read(rods_m, "rods_m", RODS)?;
        if rods.shape.is_empty() && one_tilt {
            let rods = rods.columns()?.map(|column| column.at(0));
            return self.broken_by_one(py, &rods, tilt_angle);
        }
        let tilt_angle = match tilt_rad {
            Some(tilt_angle) => {
                let zeros =
                    py.import("numpy")?.call_method1("zeros", (PyTuple::new(py, &rods.shape)?,))?;
                let tilt_angle = Spread::read(py, &[("tilt_rad", tilt_angle), ("rods_m", &zeros)])?;
                if tilt_angle.shape != rods.shape {
                    let message = "tilt_rad has to be a number, or one for each pose of rods_m";
                    return Err(errors::new(py, "ArrayError", message, Ok(PyDict::new(py))));
                }
                Some(tilt_angle)
            }
            None => None,
        };
        many::broken_limits(py, &self.gpr, &rods, tilt_angle.as_ref())
    }
}

impl PyGpr {
    /// The limits that one pose breaks.
    fn broken_by_one<'py>(
        &self,
        py: Python<'py>,
        rods: &[f64; 3],
        tilt_angle: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let tilt = match tilt_angle {
            Some(tilt_angle) => Tilt { azimuth: 0.0, angle: tilt_angle },
            None => self.gpr.plane_tilt(rods),
        };
        let broken = self.gpr.limits().broken(rods, tilt);
        let broken = broken.iter().map(|limit| errors::broken_limit(py, limit));
        Ok(PyList::new(py, broken.collect::<PyResult<Vec<_>>>()?)?.into_any())
    }
}
