//! A virtualization written in Python.

use std::sync::{Mutex, PoisonError};

use jointplay::gpr::Gpr;
use jointplay::nalgebra::Vector2;
use jointplay::virtualization::{
    MAX_VIRTUAL_JOINTS, Platform, Sides, Sockets, VirtualJoint, VirtualJointKind, Virtualization,
};
use numpy::PyArray1;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::errors;
use crate::skin::{self, fields};
use crate::symbol::symbol;

/// Methods of a Python object behind the trait.
///
/// The trait's methods cannot fail; an exception is kept, and everything after it answers with NaN and without asking Python, until the caller raises it.
pub(crate) struct OwnVirtualization {
    name: String,
    joints: Vec<VirtualJoint>,
    object: Py<PyAny>,
    platform: Py<PyAny>,
    has_closed_form: bool,
    raised: Mutex<Option<PyErr>>,
}

const NEEDED: [&str; 5] = ["name", "joints", "nominal", "sockets", "socket_velocities"];

impl OwnVirtualization {
    pub(crate) fn new(object: &Bound<'_, PyAny>, gpr: &Gpr) -> PyResult<Self> {
        let py = object.py();
        for attribute in NEEDED {
            if !object.hasattr(attribute)? {
                return Err(PyTypeError::new_err(format!(
                    "virtualization has to be a name, such as 'planar', or an object with {}, and perhaps closed_form; {} has no {attribute}",
                    NEEDED.join(", "),
                    object.get_type().name()?,
                )));
            }
        }
        let mut joints = Vec::new();
        for (index, joint) in object.getattr("joints")?.try_iter()?.enumerate() {
            joints.push(virtual_joint(&joint?, index)?);
        }
        if !(3..=MAX_VIRTUAL_JOINTS).contains(&joints.len()) {
            let error = jointplay::Error::VirtualJointCount {
                found: joints.len(),
                min: 3,
                max: MAX_VIRTUAL_JOINTS,
            };
            return Err(errors::core(py, &error));
        }
        Ok(Self {
            name: object.getattr("name")?.extract()?,
            joints,
            platform: platform(py, gpr.platform())?.unbind(),
            has_closed_form: object.hasattr("closed_form")?,
            object: object.clone().unbind(),
            raised: Mutex::new(None),
        })
    }

    /// The exception that Python's code raised, once.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Asks Python, unless it has raised before.
    fn ask<T>(&self, ask: impl FnOnce(Python<'_>) -> PyResult<T>) -> Option<T> {
        if self.raised.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
            return None;
        }
        Python::attach(|py| match ask(py) {
            Ok(answer) => Some(answer),
            Err(error) => {
                *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                None
            }
        })
    }

    /// Calls a method with the platform and numbers; its answer as numbers in a row, of a shape that is checked.
    fn numbers(
        &self,
        py: Python<'_>,
        method: &str,
        given: Option<&[f64]>,
        shape: &[usize],
    ) -> PyResult<Option<Vec<f64>>> {
        let mut arguments = vec![self.platform.bind(py).clone()];
        arguments.extend(given.map(|numbers| PyArray1::from_slice(py, numbers).into_any()));
        let answer = self.object.bind(py).call_method1(method, PyTuple::new(py, arguments)?)?;
        if answer.is_none() {
            return Ok(None);
        }
        let what = format!("what {method} of the virtualization {} returns", self.name);
        crate::arrays::numbers_of_shape(&answer, &what, shape).map(Some)
    }

    fn fill(&self, method: &str, given: Option<&[f64]>, shape: &[usize], into: &mut [f64]) -> bool {
        let answer = self.ask(|py| {
            let answer = self.numbers(py, method, given, shape)?;
            if answer.is_none() && method != "closed_form" {
                return Err(PyTypeError::new_err(format!(
                    "{method} of the virtualization {} returned None, an array of shape {shape:?} is needed",
                    self.name
                )));
            }
            Ok(answer)
        });
        match answer {
            Some(Some(numbers)) => into.copy_from_slice(&numbers),
            Some(None) => return false,
            None => into.fill(f64::NAN),
        }
        true
    }
}

impl Virtualization for OwnVirtualization {
    fn name(&self) -> &str {
        &self.name
    }

    fn joints(&self) -> &[VirtualJoint] {
        &self.joints
    }

    fn nominal(&self, _platform: &Platform, x: &mut [f64]) {
        self.fill("nominal", None, &[x.len()], x);
    }

    fn sockets(&self, _platform: &Platform, x: &[f64]) -> Sockets {
        let mut numbers = [f64::NAN; 6];
        self.fill("sockets", Some(x), &[3, 2], &mut numbers);
        [0, 1, 2].map(|k| Vector2::new(numbers[2 * k], numbers[2 * k + 1]))
    }

    fn socket_velocities(&self, _platform: &Platform, x: &[f64], velocities: &mut [Sockets]) {
        let mut numbers = vec![f64::NAN; 6 * velocities.len()];
        self.fill("socket_velocities", Some(x), &[velocities.len(), 3, 2], &mut numbers);
        for (sockets, numbers) in velocities.iter_mut().zip(numbers.chunks_exact(6)) {
            *sockets = [0, 1, 2].map(|k| Vector2::new(numbers[2 * k], numbers[2 * k + 1]));
        }
    }

    fn closed_form(&self, _platform: &Platform, sides: &Sides, x: &mut [f64]) -> bool {
        self.has_closed_form && self.fill("closed_form", Some(sides), &[x.len()], x)
    }
}

fn virtual_joint(joint: &Bound<'_, PyAny>, index: usize) -> PyResult<VirtualJoint> {
    let py = joint.py();
    let (name, limb, motion): (String, usize, String) = (
        joint.getattr("symbol")?.extract()?,
        joint.getattr("limb")?.extract()?,
        joint.getattr("motion")?.extract()?,
    );
    if limb >= 3 {
        let message = format!(
            "virtual joint {index} ({name}) belongs to limb {limb}, but limbs are counted 0, 1, 2"
        );
        return Err(errors::input(py, &message));
    }
    let motion = match motion.as_str() {
        "linear" => VirtualJointKind::Linear,
        "angular" => VirtualJointKind::Angular,
        other => {
            let known = ["linear".to_owned(), "angular".to_owned()];
            return Err(errors::unknown_name(py, "motion", other, &known));
        }
    };
    Ok(VirtualJoint { symbol: symbol(&name), limb, motion })
}

/// The platform as built, for Python.
pub(crate) fn platform<'py>(py: Python<'py>, platform: &Platform) -> PyResult<Bound<'py, PyAny>> {
    let points = |points: &[Vector2<f64>; 3]| crate::arrays::matrix(py, points.map(|p| [p.x, p.y]));
    let fields = fields!(py;
        radii_m = PyArray1::from_slice(py, platform.radii()),
        angles_rad = PyArray1::from_slice(py, platform.angles()),
        directions = points(platform.directions()),
        sockets_m = points(platform.sockets()),
        mean_radius_m = platform.mean_radius(),
    );
    skin::result(py, "Platform", &fields)
}
