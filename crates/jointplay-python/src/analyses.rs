//! Results of mobility, sensitivity and comparison as Python objects.

use jointplay::gpr::{EvaluatedBounds, TiltPlay};
use jointplay::mobility::{FiniteMobility, InstantaneousMobility};
use jointplay::nalgebra::DMatrix;
use jointplay::sensitivity::Sensitivity;
use jointplay::study::{Comparison, Samples, SeriesSummary, Summary};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::model::ModelNames;
use crate::pose::PyForward;
use crate::skin::{self, fields};

/// A matrix of the library as an array.
pub(crate) fn dense<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> Bound<'py, PyArray2<f64>> {
    let shape = (matrix.nrows(), matrix.ncols());
    PyArray2::from_owned_array(
        py,
        numpy::ndarray::Array2::from_shape_fn(shape, |(i, j)| matrix[(i, j)]),
    )
}

/// Fields that mobility has of the robot and of any mechanism.
pub(crate) fn mobility_fields<'py>(
    py: Python<'py>,
    kutzbach: i64,
    finite: &FiniteMobility,
) -> PyResult<Bound<'py, PyDict>> {
    let first = &finite.instantaneous;
    Ok(fields!(py;
        kutzbach_mobility = kutzbach,
        instantaneous_mobility = first.mobility,
        finite_mobility = finite.mobility,
        finite_mobility_bounds = (finite.lower_bound, finite.upper_bound),
        rank = first.rank,
        redundancy = first.redundancy,
        singular_values = PyArray1::from_slice(py, first.singular_values.as_slice()),
        threshold = first.threshold,
        characteristic_length_m = first.characteristic_length,
        null_space = dense(py, &first.null_space),
        self_stress = dense(py, &first.self_stress),
    ))
}

pub(crate) fn mobility<'py>(
    py: Python<'py>,
    kutzbach: i64,
    finite: &FiniteMobility,
    augmented: Option<(&str, &InstantaneousMobility)>,
) -> PyResult<Bound<'py, PyAny>> {
    let fields = mobility_fields(py, kutzbach, finite)?;
    let augmented = augmented
        .map(|(name, found)| {
            let fields = fields!(py;
                virtualization = name,
                mobility = found.mobility,
                rank = found.rank,
                singular_values = PyArray1::from_slice(py, found.singular_values.as_slice()),
            );
            skin::result(py, "AugmentedMobility", &fields)
        })
        .transpose()?;
    fields.set_item("augmented", augmented)?;
    skin::result(py, "Mobility", &fields)
}

pub(crate) fn sensitivity<'py>(
    py: Python<'py>,
    found: &Sensitivity,
    names: &ModelNames,
) -> PyResult<Bound<'py, PyAny>> {
    let fields = fields!(py;
        matrix = dense(py, &found.matrix),
        rank = found.rank,
        singular_values = PyArray1::from_slice(py, found.singular_values().as_slice()),
        right_vectors = dense(py, &found.right_vectors()),
        characteristic_length_m = found.characteristic_length,
        virtualization = names.name.as_str(),
        virtual_joint_names = PyTuple::new(py, names.joint_names())?,
    );
    skin::result(py, "Sensitivity", &fields)
}

pub(crate) fn tilt_play<'py>(
    py: Python<'py>,
    play: &TiltPlay,
    names: &'static ModelNames,
) -> PyResult<Bound<'py, PyAny>> {
    let shares =
        |shares: &Option<Vec<f64>>| shares.as_ref().map(|shares| PyArray1::from_slice(py, shares));
    let bounded = |found: &EvaluatedBounds| {
        let bounds = &found.bounds;
        let fields = fields!(py;
            lower_m = bounds.lower,
            upper_m = bounds.upper,
            eigenvalue_lower_m = bounds.eigenvalue_lower,
            eigenvalue_upper_m = bounds.eigenvalue_upper,
            coarse_upper_m = bounds.coarse_upper,
            linear_m = bounds.linear,
            held = found.held,
            sensitivity = sensitivity(py, &found.sensitivity, names)?,
        );
        skin::result(py, "Bounds", &fields)
    };
    let fields = fields!(py;
        start = Bound::new(py, PyForward::new(play.start, names))?,
        end = Bound::new(py, PyForward::new(play.end, names))?,
        displacement_m = play.displacement,
        motion_m = play.motion,
        at_start = bounded(&play.at_start)?,
        at_midpoint = bounded(&play.at_midpoint)?,
        at_end = bounded(&play.at_end)?,
        limb_shares = shares(&play.limb_shares),
        side_shares = shares(&play.side_shares),
    );
    skin::result(py, "TiltPlay", &fields)
}

/// A column that ends early, with NaN where the model has no answer.
fn whole(values: impl Iterator<Item = f64>, len: usize) -> Vec<f64> {
    values.chain(std::iter::repeat(f64::NAN)).take(len).collect()
}

pub(crate) fn comparison<'py>(py: Python<'py>, found: &Comparison) -> PyResult<Bound<'py, PyAny>> {
    let len = found.tilt_angles.len();
    let models = PyDict::new(py);
    for model in &found.models {
        let [x, y] =
            [0, 1].map(|axis| whole(model.center_shift.iter().map(|shift| shift[axis]), len));
        let shift = numpy::ndarray::Array2::from_shape_fn((len, 2), |(i, axis)| [&x, &y][axis][i]);
        let moved = whole(model.largest_displacement.iter().copied(), len);
        let fields = fields!(py;
            name = model.name.as_str(),
            center_shift_m = PyArray2::from_owned_array(py, shift),
            largest_displacement_m = PyArray1::from_vec(py, moved),
            failure = model.failure.as_ref().map(ToString::to_string),
        );
        models.set_item(&model.name, skin::result(py, "ModelCurve", &fields)?)?;
    }
    let fields = fields!(py;
        azimuth_rad = found.azimuth,
        height_m = found.height.0,
        tilt_rad = PyArray1::from_slice(py, &found.tilt_angles),
        approximate_gap_m = PyArray1::from_slice(py, &found.approximate_gap),
        models = models,
    );
    skin::result(py, "Comparison", &fields)
}

/// Columns side by side, an array of shape (n, columns) of which each column lies in one piece.
fn table<'py>(py: Python<'py>, columns: &[Vec<f64>]) -> PyResult<Bound<'py, PyAny>> {
    let rows = PyArray2::from_vec2(py, columns)
        .map_err(|error| crate::errors::internal(&error.to_string()))?;
    rows.getattr("T")
}

pub(crate) fn study<'py>(
    py: Python<'py>,
    samples: &Samples,
    summary: &Summary,
    names: &ModelNames,
) -> PyResult<Bound<'py, PyAny>> {
    let iterations = samples.iterations.iter().map(|&count| count as i64);
    let fields = fields!(py;
        virtualization = samples.virtualization.as_str(),
        virtual_joint_names = PyTuple::new(py, names.joint_names())?,
        solver = samples.solver.to_string(),
        characteristic_length_m = samples.characteristic_length,
        samples_per_row = samples.samples_per_row,
        azimuth_rad = PyArray1::from_slice(py, &samples.azimuth),
        tilt_rad = PyArray1::from_slice(py, &samples.tilt_angle),
        rods_m = table(py, &samples.rods)?,
        sides_m = table(py, &samples.sides)?,
        virtual_joints = table(py, &samples.virtual_joints)?,
        origin_m = table(py, &samples.origin)?,
        torsion_rad = PyArray1::from_slice(py, &samples.torsion),
        iterations = PyArray1::from_iter(py, iterations),
        residual_m = PyArray1::from_slice(py, &samples.residual),
        summary = study_summary(py, summary)?,
    );
    skin::result(py, "Study", &fields)
}

fn study_summary<'py>(py: Python<'py>, summary: &Summary) -> PyResult<Bound<'py, PyAny>> {
    let summary_of = |one: &SeriesSummary| {
        let fields = fields!(py;
            name = one.name.as_str(),
            min = one.min,
            max = one.max,
            pass_min = one.pass_min,
            pass_max = one.pass_max,
            minimum_at = one.minimum_at,
            maximum_at = one.maximum_at,
            constant_at = one.constant_at,
        );
        skin::result(py, "SeriesSummary", &fields)
    };
    let all = PyDict::new(py);
    for one in &summary.series {
        all.set_item(&one.name, summary_of(one)?)?;
    }
    let fields = fields!(py;
        samples = summary.samples,
        singular_passes = summary.singular_passes,
        largest_center_shift_m = summary.largest_center_shift,
        largest_torsion_rad = summary.largest_torsion,
        largest_residual_m = summary.largest_residual,
        iterations = PyTuple::new(py, &summary.iterations)?,
        beyond_tilt = summary.beyond_tilt,
        beyond_stroke = summary.beyond_stroke,
        series = all,
    );
    skin::result(py, "StudySummary", &fields)
}
