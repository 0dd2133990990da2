//! Results of mechanisms, as objects of Python.

use jointplay::constraint::System as _;
use jointplay::mechanism::{
    BeyondLimits, Carrier, Closure, DrivenMotion, Mechanism, MechanismMobility, MechanismSystem,
    MobilityClass, Relief, SparseMobility, Suggestions, VirtualJoint, VirtualMotion, link_motion,
    self_stresses,
};
use jointplay::mobility::NearMobility;
use jointplay::nalgebra::{DVector, Unit, Vector3};
use jointplay::report::{self, redundant_constraints};
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
    mechanism: &Bound<'py, PyMechanism>,
    values: &DVector<f64>,
    residual: f64,
    iterations: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let of = mechanism.get();
    let all = 0..of.coordinates.all().len();
    let fields = fields!(py;
        mechanism = mechanism,
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
    let length_mm = system.characteristic_length() * 1e3;
    let carried = redundant_constraints(mechanism, &stresses, length_mm);
    let carried = carried.iter().zip(&stresses.stresses).map(|(one, stress)| {
        let loads = one.remove_any_one_of.iter().zip(&stress.wrenches).map(|(load, wrench)| {
            let fields = fields!(py;
                joint = load.joint.as_str(),
                place_m = PyArray1::from_slice(py, wrench.place.as_slice()),
                force_n = PyArray1::from_slice(py, &load.force_n),
                moment_nm = PyArray1::from_vec(py, load.moment_nmm.map(|moment| moment * 1e-3).to_vec()),
            );
            skin::result(py, "JointLoad", &fields)
        });
        let loads = loads.collect::<PyResult<Vec<_>>>()?;
        let fields = fields!(py;
            what = one.what.as_str(),
            joints = PyTuple::new(py, &one.joints)?,
            couplings = PyTuple::new(py, &one.couplings)?,
            group = one.group,
            independent = one.independent,
            remove_any_one_of = PyTuple::new(py, loads)?,
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
    fields.set_item("redundant_constraints_sparsest", stresses.sparsest)?;
    let in_all = stresses.in_all.iter().map(|&j| &mechanism.joints()[j].name);
    fields
        .set_item("joints_in_all_self_stresses", PyTuple::new(py, in_all.collect::<Vec<_>>())?)?;
    let in_all = stresses.couplings_in_all.iter().map(|&k| &mechanism.couplings()[k].name);
    fields.set_item(
        "couplings_in_all_self_stresses",
        PyTuple::new(py, in_all.collect::<Vec<_>>())?,
    )?;
    fields.set_item("couplings", mechanism.couplings().len())?;
    fields.set_item("link_motions", links)?;
    fields.set_item("near", near.transpose()?)?;
    skin::result(py, "MechanismMobility", &fields)
}

pub(crate) fn sparse_mobility<'py>(
    py: Python<'py>,
    mechanism: &Bound<'py, PyMechanism>,
    kutzbach: i64,
    found: &SparseMobility,
    closure: &Closure,
) -> PyResult<Bound<'py, PyAny>> {
    let of = mechanism.get();
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
        configuration = configuration(py, mechanism, &closure.coordinates, closure.residual, closure.iterations)?,
        classification = class.description(),
        branch_dimensions = py.None(),
        redundant_constraints = PyTuple::empty(py),
        redundant_constraints_sparsest = py.None(),
        joints_in_all_self_stresses = PyTuple::empty(py),
        couplings_in_all_self_stresses = PyTuple::empty(py),
        couplings = of.file.mechanism.couplings().len(),
        link_motions = PyDict::new(py),
        near = py.None(),
    );
    skin::result(py, "MechanismMobility", &fields)
}

pub(crate) fn motion<'py>(
    py: Python<'py>,
    mechanism: &Bound<'py, PyMechanism>,
    driven: &[usize],
    held: &[usize],
    moved: &DrivenMotion,
) -> PyResult<Bound<'py, PyAny>> {
    let of = mechanism.get();
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
    let summary = report::motion(&of.file, driven, held, None, moved);
    let free = waypoints.iter().map(|at| at.free_mobility as i64);
    let within =
        waypoints.iter().map(|at| of.file.mechanism.beyond_limits(&at.coordinates).is_empty());
    let fields = fields!(py;
        mechanism = mechanism,
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
        let joints = set.virtual_joints.iter().zip(&set.largest).zip(&set.alternatives);
        let joints = joints.map(|((joint, &largest), alternatives)| {
            let others = alternatives
                .iter()
                .map(|other| suggested(py, mechanism, other, largest, &PyTuple::empty(py)))
                .collect::<PyResult<Vec<_>>>()?;
            suggested(py, mechanism, joint, largest, &PyTuple::new(py, others)?)
        });
        let fields = fields!(py;
            size_m = set.size,
            energy_j = set.energy,
            symmetric = set.symmetric,
            symmetric_for_commands = set.symmetric_for_commands,
            within_clearances = set.is_within_clearances(),
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
        in_class = found.in_class,
        lower_bound_m = found.lower_bound,
        least_energy_j = found.least_energy,
        cut_short = found.cut_short,
        untried = found.untried,
    );
    skin::result(py, "Suggestions", &fields)
}

/// A virtual joint of a suggestion.
fn suggested<'py>(
    py: Python<'py>,
    mechanism: &Mechanism,
    joint: &VirtualJoint,
    largest: f64,
    alternatives: &Bound<'py, PyTuple>,
) -> PyResult<Bound<'py, PyAny>> {
    let (motion, direction, about, unit) = match &joint.motion {
        VirtualMotion::Slide(direction) => ("slide", direction, None, "m"),
        VirtualMotion::Turn { axis, point } => {
            ("turn", axis, Some(PyArray1::from_slice(py, point.as_slice())), "rad")
        }
    };
    let at = &mechanism.joints()[joint.joint];
    let side = usize::from(joint.carrier == Carrier::Second);
    let fields = fields!(py;
        name = joint.name.as_str(),
        joint = at.name.as_str(),
        on = mechanism.links()[at.links[side]].as_str(),
        motion = motion,
        direction = PyArray1::from_slice(py, direction.as_slice()),
        about = about,
        clearance = joint.clearance,
        stiffness = joint.stiffness,
        largest = largest,
        unit = unit,
        alternatives = alternatives,
    );
    skin::result(py, "SuggestedJoint", &fields)
}

/// The virtual joint of a `SuggestedJoint`.
pub(crate) fn virtual_joint(
    py: Python<'_>,
    mechanism: &Mechanism,
    one: &Bound<'_, PyAny>,
) -> PyResult<VirtualJoint> {
    let text = |key: &str| one.getattr(key)?.extract::<String>();
    let name = text("joint")?;
    let known = || mechanism.joints().iter().map(|joint| joint.name.clone()).collect::<Vec<_>>();
    let joint =
        mechanism.joint(&name).ok_or_else(|| errors::unknown_name(py, "joint", &name, &known()))?;
    let on = text("on")?;
    let links = mechanism.joints()[joint].links.map(|link| mechanism.links()[link].as_str());
    let carrier = match links.iter().position(|link| *link == on) {
        Some(0) => Carrier::First,
        Some(_) => Carrier::Second,
        None => {
            let known = links.map(str::to_owned);
            return Err(errors::unknown_name(py, "link of this joint", &on, &known));
        }
    };
    let three = |key: &str| {
        let values: Vec<f64> = one.getattr(key)?.extract()?;
        match <[f64; 3]>::try_from(values) {
            Ok(values) if values.iter().all(|x| x.is_finite()) => Ok(Vector3::from(values)),
            _ => Err(errors::input(py, &format!("`{key}` must be three finite numbers"))),
        }
    };
    let axis = Unit::try_new(three("direction")?, 0.0)
        .ok_or_else(|| errors::input(py, "`direction` must not be zero"))?;
    let motion = match text("motion")?.as_str() {
        "slide" => VirtualMotion::Slide(axis),
        "turn" => VirtualMotion::Turn { axis, point: three("about")? },
        other => {
            let known = ["slide".to_owned(), "turn".to_owned()];
            return Err(errors::unknown_name(py, "motion", other, &known));
        }
    };
    let clearance = one.getattr("clearance")?.extract()?;
    let stiffness = one.getattr("stiffness")?.extract()?;
    Ok(VirtualJoint { name: text("name")?, joint, carrier, motion, clearance, stiffness })
}

pub(crate) fn relief<'py>(
    py: Python<'py>,
    mechanism: &Bound<'py, PyMechanism>,
    found: &Relief,
    sensitivity: &Sensitivity,
) -> PyResult<Bound<'py, PyAny>> {
    let of = mechanism.get();
    let joints = of.file.mechanism.virtual_joints();
    let elastic = joints.iter().all(|joint| joint.stiffness.is_some());
    let clearances = joints.iter().map(|joint| joint.clearance.unwrap_or(f64::NAN));
    let fields = fields!(py;
        configuration = configuration(py, mechanism, &found.coordinates, found.residual, found.iterations)?,
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
