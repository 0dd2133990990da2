//! Virtualization, solver and metric from their Python arguments.

use std::collections::BTreeSet;
use std::sync::{LazyLock, Mutex, PoisonError};

use jointplay::gpr::Gpr;
use jointplay::virtualization::{
    Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, VirtualJoint, VirtualJointKind,
    Virtualization, built_in,
};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyString};

use crate::errors;
use crate::numbers::finite;
use crate::own_virtualization::OwnVirtualization;
use crate::symbol::symbol;

/// A virtualization: one of the library's, each with its own type so that it is compiled for it, or one written in Python.
pub(crate) enum Model {
    Radial,
    Polar,
    Offset,
    Planar,
    Own(Box<OwnVirtualization>),
}

/// Evaluates an expression with the virtualization itself in place of the model.
macro_rules! with_model {
    ($model:expr, $virtualization:ident => $body:expr) => {
        match $model {
            $crate::model::Model::Radial => {
                let $virtualization = &jointplay::virtualization::Radial;
                $body
            }
            $crate::model::Model::Polar => {
                let $virtualization = &jointplay::virtualization::Polar;
                $body
            }
            $crate::model::Model::Offset => {
                let $virtualization = &jointplay::virtualization::Offset;
                $body
            }
            $crate::model::Model::Planar => {
                let $virtualization = &jointplay::virtualization::Planar;
                $body
            }
            $crate::model::Model::Own(own) => {
                let $virtualization = &**own;
                $body
            }
        }
    };
}
pub(crate) use with_model;

impl Model {
    /// The model of a name, or of an object that is a virtualization; without either, planar.
    pub(crate) fn of(given: Option<&Bound<'_, PyAny>>, gpr: &Gpr) -> PyResult<Self> {
        let Some(given) = given else { return Ok(Self::Planar) };
        let Ok(name) = given.cast::<PyString>() else {
            return OwnVirtualization::new(given, gpr).map(|own| Self::Own(Box::new(own)));
        };
        let name = name.to_cow()?;
        Ok(match &*name {
            "planar" => Self::Planar,
            "radial" => Self::Radial,
            "polar" => Self::Polar,
            "offset" => Self::Offset,
            other => {
                let known: Vec<String> = built_in().iter().map(|v| v.name().to_owned()).collect();
                return Err(errors::unknown_name(given.py(), "virtualization", other, &known));
            }
        })
    }

    pub(crate) fn virtualization(&self) -> &(dyn Virtualization + Sync) {
        match self {
            Self::Radial => &Radial,
            Self::Polar => &Polar,
            Self::Offset => &Offset,
            Self::Planar => &Planar,
            Self::Own(own) => &**own,
        }
    }

    /// The result, or the exception to raise.
    pub(crate) fn checked<T>(
        &self,
        py: Python<'_>,
        found: Result<T, jointplay::Error>,
    ) -> PyResult<T> {
        match (self.raised(), found) {
            (Some(raised), _) => Err(raised),
            (None, found) => found.map_err(|error| errors::core(py, &error)),
        }
    }

    /// Exception that a virtualization written in Python raised meanwhile.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        match self {
            Self::Own(own) => own.raised(),
            _ => None,
        }
    }
}

/// The options of names and a number.
pub(crate) fn options(
    py: Python<'_>,
    solver: Option<&str>,
    metric: Option<&Bound<'_, PyAny>>,
) -> PyResult<SolveOptions> {
    let default = SolveOptions::default();
    Ok(SolveOptions {
        solver: solver.map_or(Ok(default.solver), |name| solver_of(py, name))?,
        metric: metric.map_or(Ok(default.metric), metric_of)?,
        ..default
    })
}

fn solver_of(py: Python<'_>, name: &str) -> PyResult<Solver> {
    let all = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm];
    // The three names of `Solver`, without formatting them for each call.
    match name {
        "newton" => Ok(Solver::Newton),
        "least-norm" => Ok(Solver::LeastNorm),
        "closed-form" => Ok(Solver::ClosedForm),
        other => Err(errors::unknown_name(py, "solver", other, &all.map(|one| one.to_string()))),
    }
}

fn metric_of(given: &Bound<'_, PyAny>) -> PyResult<Metric> {
    let py = given.py();
    if let Ok(name) = given.cast::<PyString>() {
        return match &*name.to_cow()? {
            "paper" => Ok(Metric::Paper),
            "radius" => Ok(Metric::PlatformRadius),
            other => {
                let known = ["paper".to_owned(), "radius".to_owned()];
                Err(errors::unknown_name(py, "metric", other, &known))
            }
        };
    }
    if given.is_instance_of::<PyFloat>() || given.is_instance_of::<PyInt>() {
        return Ok(Metric::Length(finite(given, "metric")?));
    }
    let expected = "'paper', 'radius' or a length in metres";
    Err(errors::argument_type(given, "metric", expected))
}

/// Names of the virtualization of a pose.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ModelNames {
    /// Its name.
    pub(crate) name: String,
    /// Symbol, limb from 0, and whether it turns, of each virtual joint.
    joints: Vec<(&'static str, usize, bool)>,
}

/// Every virtualization that a pose was found with: few, whatever the number of poses.
static NAMES: Mutex<BTreeSet<&'static ModelNames>> = Mutex::new(BTreeSet::new());

/// Those of the library's own virtualizations, which poses by the million refer to.
static BUILT_IN: LazyLock<[&ModelNames; 4]> = LazyLock::new(|| built_in().map(ModelNames::of));

impl ModelNames {
    pub(crate) fn of_model(model: &Model) -> &'static Self {
        // In the order of `built_in`.
        let [radial, polar, offset, planar] = *BUILT_IN;
        match model {
            Model::Radial => radial,
            Model::Polar => polar,
            Model::Offset => offset,
            Model::Planar => planar,
            Model::Own(own) => Self::of(&**own),
        }
    }

    pub(crate) fn of(virtualization: &dyn Virtualization) -> &'static Self {
        let joint = |joint: &VirtualJoint| {
            (joint.symbol, joint.limb, joint.motion == VirtualJointKind::Angular)
        };
        Self::kept(Self {
            name: virtualization.name().to_owned(),
            joints: virtualization.joints().iter().map(joint).collect(),
        })
    }

    /// Of a name and of symbol, limb from 0, and whether it turns, of each virtual joint.
    pub(crate) fn from_parts(name: &str, joints: &[(String, usize, bool)]) -> &'static Self {
        let joint = |(text, limb, turns): &(String, usize, bool)| (symbol(text), *limb, *turns);
        Self::kept(Self { name: name.to_owned(), joints: joints.iter().map(joint).collect() })
    }

    fn kept(names: Self) -> &'static Self {
        let mut all = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = all.get(&names) {
            return known;
        }
        let kept: &'static Self = Box::leak(Box::new(names));
        all.insert(kept);
        kept
    }

    pub(crate) fn parts(&self) -> Vec<(&'static str, usize, bool)> {
        self.joints.clone()
    }

    /// Symbol, limb and unit of each virtual joint, such as `u_1_m`.
    pub(crate) fn joint_names(&self) -> Vec<String> {
        let name = |&(symbol, limb, turns): &(&str, usize, bool)| {
            format!("{symbol}_{}_{}", limb + 1, if turns { "rad" } else { "m" })
        };
        self.joints.iter().map(name).collect()
    }
}
