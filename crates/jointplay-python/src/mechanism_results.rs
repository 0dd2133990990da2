//! What is found of a mechanism, as results of Python.

use jointplay::mechanism::{
    BeyondLimits, Closure, DrivenMotion, Mechanism, MechanismMobility, MechanismSystem,
    MobilityClass, Relief, SparseMobility, Suggestions, VirtualMotion, link_motion, self_stresses,
};
use jointplay::mobility::NearMobility;
use jointplay::nalgebra::DVector;
use jointplay::report;
use jointplay::sensitivity::Sensitivity;
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::analyses::{dense, mobility_fields};
use crate::errors;
use crate::mechanism::PyMechanism;
use crate::skin::{self, fields};

/// Joints and virtual joints of a configuration.
pub(crate) fn configuration<'py>(
    py: Python<'py>,
    of: &PyMechanism,
    values: &DVector<f64>,
    residual: f64,
    iterations: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let all = 0..of.coordinates.all().len();
    let fields = fields!(py;
        names = PyTuple::new(py, of.names(all.clone()))?,
        units = PyTuple::new(py, of.units(all))?,
        coordinates = PyArray1::from_slice(py, values.as_slice()),
        residual = residual,
        iterations = iterations,
    );
    skin::result(py, "Configuration", &fields)
}

pub(crate) fn mobility<'py>(
    py: Python<'py>,
    system: &MechanismSystem<'_>,
    kutzbach: i64,
    found: &MechanismMobility,
    near: Option<&NearMobility>,
    configuration: Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let failed = |error: jointplay::Error| errors::core(py, &error);
    let mechanism = system.kinematics().mechanism();
    let MechanismMobility { finite, branch_dimensions } = found;
    let first = &finite.instantaneous;
    let class = found.class();
    let stresses = self_stresses(system, first).map_err(failed)?;
    let carried = stresses.iter().map(|stress| {
        let joints = stress.wrenches.iter().map(|wrench| &mechanism.joints()[wrench.joint].name);
        let fields = fields!(py;
            what = stress.words.as_str(),
            joints = PyTuple::new(py, joints.collect::<Vec<_>>())?,
        );
        skin::result(py, "RedundantConstraint", &fields)
    });
    let carried = carried.collect::<PyResult<Vec<_>>>()?;
    let links = PyDict::new(py);
    for (l, link) in mechanism.links().iter().enumerate().skip(1) {
        let found = link_motion(system, first, l).map_err(failed)?;
        let fields = fields!(py;
            dimension = found.dimension,
            translations = found.translations,
            twists = dense(py, &found.twists),
            pitch_m_per_rad = found.screw.map(|screw| screw.pitch),
            axis_point_m = found.screw.map(|screw| PyArray1::from_slice(py, screw.point.as_slice())),
        );
        links.set_item(link, skin::result(py, "LinkMotion", &fields)?)?;
    }
    let near = near.map(|near| {
        let fields = fields!(py;
            tolerance = near.tolerance,
            mobility = near.mobility,
            needed = near.needed,
            next = near.next,
        );
        skin::result(py, "NearMobility", &fields)
    });
    let fields = mobility_fields(py, kutzbach, finite)?;
    fields.set_item("name", mechanism.name())?;
    fields.set_item("configuration", configuration)?;
    fields.set_item("classification", class.description())?;
    fields.set_item(
        "branch_dimensions",
        branch_dimensions.as_ref().map(|all| PyTuple::new(py, all)).transpose()?,
    )?;
    fields.set_item("redundant_constraints", PyTuple::new(py, carried)?)?;
    fields.set_item("link_motions", links)?;
    fields.set_item("near", near.transpose()?)?;
    skin::result(py, "MechanismMobility", &fields)
}

pub(crate) fn sparse_mobility<'py>(
    py: Python<'py>,
    of: &PyMechanism,
    kutzbach: i64,
    found: &SparseMobility,
    closure: &Closure,
) -> PyResult<Bound<'py, PyAny>> {
    let class = MobilityClass::from_mobilities(found.finite, found.mobility, found.redundancy);
    let fields = fields!(py;
        kutzbach_mobility = kutzbach,
        instantaneous_mobility = found.mobility,
        finite_mobility = found.finite,
        finite_mobility_bounds = (found.lower_bound, found.upper_bound),
        rank = found.rank,
        redundancy = found.redundancy,
        singular_values = py.None(),
        threshold = found.threshold,
        characteristic_length_m = found.characteristic_length,
        null_space = found.null_space().map(|all| dense(py, &all)),
        self_stress = py.None(),
        name = of.file.mechanism.name(),
        configuration = configuration(py, of, &closure.coordinates, closure.residual, closure.iterations)?,
        classification = class.description(),
        branch_dimensions = py.None(),
        redundant_constraints = PyTuple::empty(py),
        link_motions = PyDict::new(py),
        near = py.None(),
    );
    skin::result(py, "MechanismMobility", &fields)
}

pub(crate) fn motion<'py>(
    py: Python<'py>,
    of: &PyMechanism,
    driven: &[usize],
    held: &[usize],
    moved: &DrivenMotion,
) -> PyResult<Bound<'py, PyAny>> {
    let all = 0..of.coordinates.all().len();
    let waypoints = &moved.waypoints;
    let coordinates =
        Array2::from_shape_fn((waypoints.len(), all.len()), |(i, k)| waypoints[i].coordinates[k]);
    let column = |value: fn(&jointplay::mechanism::Waypoint) -> f64| {
        PyArray1::from_iter(py, waypoints.iter().map(value))
    };
    let names = of.names(all.clone());
    let named = |indices: &[usize]| PyTuple::new(py, indices.iter().map(|&k| names[k]));
    let singular = moved.singular.iter().map(|there| {
        let fields = fields!(py;
            share = there.share,
            coordinates = PyArray1::from_slice(py, there.coordinates.as_slice()),
            instantaneous_mobility = there.instantaneous_mobility,
            least_singular_value = there.least_singular_value,
            branches = there.branches,
        );
        skin::result(py, "SingularConfiguration", &fields)
    });
    let summary = report::motion(&of.file, driven, held, moved);
    let free = waypoints.iter().map(|at| at.free_mobility as i64);
    let within =
        waypoints.iter().map(|at| of.file.mechanism.beyond_limits(&at.coordinates).is_empty());
    let fields = fields!(py;
        name = of.file.mechanism.name(),
        names = PyTuple::new(py, &names)?,
        units = PyTuple::new(py, of.units(all))?,
        driven = named(driven)?,
        held = named(held)?,
        coordinates = PyArray2::from_owned_array(py, coordinates),
        share = column(|at| at.share),
        residual = column(|at| at.residual),
        least_singular_value = column(|at| at.least_singular_value),
        free_mobility = PyArray1::from_iter(py, free),
        singular = PyTuple::new(py, singular.collect::<PyResult<Vec<_>>>()?)?,
        limits_broken = PyTuple::new(py, summary.limits_broken)?,
        within_limits = PyArray1::from_iter(py, within),
        stopped = summary.stopped,
        message = summary.message,
    );
    skin::result(py, "Motion", &fields)
}

pub(crate) fn suggestions<'py>(
    py: Python<'py>,
    of: &PyMechanism,
    mechanism: &Mechanism,
    found: &Suggestions,
) -> PyResult<Bound<'py, PyAny>> {
    let placed = |all: &[DVector<f64>]| {
        let count = mechanism.joint_freedoms();
        let array = Array2::from_shape_fn((all.len(), count), |(i, k)| all[i][k]);
        PyArray2::from_owned_array(py, array)
    };
    let broken = |all: &[BeyondLimits]| {
        let names = of.names(0..mechanism.joint_freedoms());
        PyTuple::new(py, all.iter().map(|one| names[one.coordinate]).collect::<Vec<_>>())
    };
    let sets = found.sets.iter().map(|set| {
        let joints = set.virtual_joints.iter().zip(&set.largest).map(|(joint, &largest)| {
            let (motion, direction, unit) = match joint.motion {
                VirtualMotion::Slide(direction) => ("slide", direction, "m"),
                VirtualMotion::Turn { axis, .. } => ("turn", axis, "rad"),
            };
            let fields = fields!(py;
                name = joint.name.as_str(),
                joint = mechanism.joints()[joint.joint].name.as_str(),
                motion = motion,
                direction = PyArray1::from_slice(py, direction.as_slice()),
                largest = largest,
                unit = unit,
            );
            skin::result(py, "SuggestedJoint", &fields)
        });
        let fields = fields!(py;
            size_m = set.size,
            symmetric = set.symmetric,
            coordinates = placed(&set.configurations),
            limits_broken = broken(&set.beyond_limits)?,
            virtual_joints = PyTuple::new(py, joints.collect::<PyResult<Vec<_>>>()?)?,
        );
        skin::result(py, "Suggestion", &fields)
    });
    let fields = fields!(py;
        needed = found.needed,
        without_play = placed(&found.without_play),
        limits_broken = broken(&found.beyond_limits)?,
        sets = PyTuple::new(py, sets.collect::<PyResult<Vec<_>>>()?)?,
        candidates = found.candidates,
        compared = found.compared,
        cut_short = found.cut_short,
        untried = found.untried,
    );
    skin::result(py, "Suggestions", &fields)
}

pub(crate) fn relief<'py>(
    py: Python<'py>,
    of: &PyMechanism,
    found: &Relief,
    sensitivity: &Sensitivity,
) -> PyResult<Bound<'py, PyAny>> {
    let joints = of.file.mechanism.virtual_joints();
    let elastic = joints.iter().all(|joint| joint.stiffness.is_some());
    let clearances = joints.iter().map(|joint| joint.clearance.unwrap_or(f64::NAN));
    let fields = fields!(py;
        configuration = configuration(py, of, &found.coordinates, found.residual, found.iterations)?,
        virtual_joint_names = of.virtual_joint_names(py)?,
        virtual_joint_units = of.virtual_joint_units(py)?,
        virtual_joints = PyArray1::from_slice(py, found.virtual_joints.as_slice()),
        clearances = PyArray1::from_iter(py, clearances),
        size = found.size,
        size_unit = if elastic { "sqrt(J)" } else { "m" },
        singular_values = PyArray1::from_slice(py, sensitivity.singular_values().as_slice()),
        characteristic_length_m = sensitivity.characteristic_length,
    );
    skin::result(py, "Relief", &fields)
}
