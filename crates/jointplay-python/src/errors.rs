//! Errors of the library as exceptions, with their facts as attributes.

use jointplay::Error;
use jointplay::format::place;
use jointplay::gpr::BrokenLimit;
use jointplay::linalg::LinalgError;
use jointplay::report::study_parts::PartsError;
use jointplay::study;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::skin::{self, fields};

/// An exception of a class of the package; if that fails, the failure itself.
pub(crate) fn new(
    py: Python<'_>,
    class: &str,
    message: &str,
    facts: PyResult<Bound<'_, PyDict>>,
) -> PyErr {
    let made = facts
        .and_then(|facts| skin::class(py, class)?.call((message,), Some(&facts)))
        .map(PyErr::from_value);
    made.unwrap_or_else(|error| error)
}

/// An `ArgumentTypeError`: what an argument has to be, and the type that it has.
pub(crate) fn argument_type(given: &Bound<'_, PyAny>, name: &str, expected: &str) -> PyErr {
    let py = given.py();
    let found = match given.get_type().name() {
        Ok(found) => found,
        Err(error) => return error,
    };
    let message = format!("{name} has to be {expected}, not {found}");
    new(py, "ArgumentTypeError", &message, Ok(PyDict::new(py)))
}

/// An `InputError`.
pub(crate) fn input(py: Python<'_>, message: &str) -> PyErr {
    new(py, "InputError", message, Ok(PyDict::new(py)))
}

/// Error for an unknown name, with the known ones.
pub(crate) fn unknown_name(py: Python<'_>, what: &str, found: &str, known: &[String]) -> PyErr {
    let message = place::not_known(what, found, known);
    let facts = || Ok(fields!(py; what = what, name = found, known = known.to_vec()));
    new(py, "UnknownNameError", &message, facts())
}

/// A `FileError` with the messages of all errors of a file, and the place of the first.
pub(crate) fn file<P: std::fmt::Display>(
    py: Python<'_>,
    label: &str,
    errors: &[place::Error<P>],
) -> PyErr {
    let facts = || {
        let (line, column) = errors.first().map_or((0, 0), |error| {
            let place = &error.place;
            (place.line, place.column)
        });
        Ok(fields!(py; file = label, line = line, column = column))
    };
    let messages: Vec<String> = errors.iter().map(|error| error.with_excerpt(label)).collect();
    new(py, "FileError", &messages.join("\n"), facts())
}

/// An error of the core.
pub(crate) fn core(py: Python<'_>, error: &Error) -> PyErr {
    if *error == Error::Interrupted {
        // The exception that a signal raised.
        return PyErr::take(py).unwrap_or_else(|| PyKeyboardInterrupt::new_err(()));
    }
    let message = error.to_string();
    let (class, facts) = match class_and_facts(py, error) {
        Ok((class, facts)) => (class, Ok(facts)),
        Err(failed) => ("JointplayError", Err(failed)),
    };
    new(py, class, &message, facts)
}

fn class_and_facts<'py>(
    py: Python<'py>,
    error: &Error,
) -> PyResult<(&'static str, Bound<'py, PyDict>)> {
    use Error as E;
    Ok(match error {
        E::NotFinite { what, value } => {
            ("NotFiniteError", fields!(py; what = *what, value = *value))
        }
        E::Linalg(LinalgError::NotFinite { value }) => {
            ("NotFiniteError", fields!(py; what = "an entry of the matrix", value = *value))
        }
        E::OutOfRange { what, value, min, max, unit } => (
            "OutOfRangeError",
            fields!(py; what = *what, value = *value, min = *min, max = *max, unit = *unit),
        ),
        E::Tolerance { found, min, max } => (
            "OutOfRangeError",
            fields!(py; what = "tolerance", value = *found, min = *min, max = *max, unit = "1"),
        ),
        E::TooLong { what, value, max } => (
            "OutOfRangeError",
            fields!(py; what = *what, value = *value, min = -*max, max = *max, unit = "m"),
        ),
        E::BeyondLimits(broken) => {
            let limits = broken.iter().map(|limit| broken_limit(py, limit));
            let limits = PyTuple::new(py, limits.collect::<PyResult<Vec<_>>>()?)?;
            ("RobotLimitsError", fields!(py; limits_broken = limits))
        }
        E::TiltTooLarge { tilt_angle } => {
            ("TiltTooLargeError", fields!(py; tilt_rad = *tilt_angle))
        }
        E::NotPositive { .. }
        | E::Collinear { .. }
        | E::OppositeSenses
        | E::LimitsReversed { .. } => ("GeometryError", PyDict::new(py)),
        E::TooLarge { what, found, allowed } | E::TooConnected { what, found, allowed } => {
            ("TooLargeError", fields!(py; what = *what, found = *found, allowed = *allowed))
        }
        E::NotConverged(unconverged) => (
            "NotConvergedError",
            fields!(py;
                solver = unconverged.solver.to_string(),
                best_virtual_joints = unconverged.best.to_vec(),
                residual_m = unconverged.residual,
                threshold_m = unconverged.threshold,
                iterations = unconverged.iterations,
            ),
        ),
        E::DependentSides { characteristic_length, iterations } => (
            "DependentSidesError",
            fields!(py; characteristic_length_m = *characteristic_length, iterations = *iterations),
        ),
        E::TurnedOver { virtual_joints } => {
            ("TurnedOverError", fields!(py; virtual_joints = virtual_joints.to_vec()))
        }
        E::NotClosed { residual, allowed } => {
            ("NotClosedError", fields!(py; residual = *residual, allowed = *allowed))
        }
        E::NotAssembled(found) => {
            let branches: Vec<Vec<f64>> = found
                .branches
                .iter()
                .map(|branch| branch.coordinates.as_slice().to_vec())
                .collect();
            ("NotAssembledError", fields!(py; branches = branches))
        }
        E::NotRelieved { residual, allowed, couplings } => (
            "NotRelievedError",
            fields!(py; residual = *residual, allowed = *allowed, couplings = couplings.clone()),
        ),
        E::NotReached { residual, allowed, iterations } => (
            "NotReachedError",
            fields!(py; residual = *residual, allowed = *allowed, iterations = *iterations),
        ),
        E::NotLeast { iterations } => {
            ("NotConvergedError", fields!(py; solver = "least-norm", iterations = *iterations))
        }
        E::Undetermined(found) => (
            "UndeterminedError",
            fields!(py;
                motions = found.motions,
                singular_values = found.singular_values.as_slice().to_vec(),
            ),
        ),
        E::DependentCommands { share, allowed } => {
            ("DependentCommandsError", fields!(py; share = *share, allowed = *allowed))
        }
        E::Linalg(LinalgError::SvdNotConverged { rows, columns }) => {
            ("NoAnswerError", fields!(py; rows = *rows, columns = *columns))
        }
        _ => ("InputError", PyDict::new(py)),
    })
}

/// A broken limit as a `BrokenLimit`.
pub(crate) fn broken_limit(py: Python<'_>, broken: BrokenLimit) -> PyResult<Bound<'_, PyAny>> {
    let fields = match broken {
        BrokenLimit::Rod { limb, length, min, max } => fields!(py;
            limit = format!("rod {limb}"), found = length, min = min, max = max, unit = "m",
        ),
        BrokenLimit::Tilt { angle: tilt_angle, max } => {
            fields!(py; limit = "tilt", found = tilt_angle, min = 0.0, max = max, unit = "rad")
        }
    };
    skin::result(py, "BrokenLimit", &fields)
}

/// A `NotFiniteError`.
pub(crate) fn not_finite(py: Python<'_>, what: &str, value: f64) -> PyErr {
    let message = format!("{what} is {value}, but has to be a finite number");
    let facts = || Ok(fields!(py; what = what, value = value));
    new(py, "NotFiniteError", &message, facts())
}

/// An error of a study: the error of its pose, with the index of the pose.
pub(crate) fn study(py: Python<'_>, error: &study::Error) -> PyErr {
    let study::Error::Pose { sample, azimuth, tilt_angle, source } = error else {
        return input(py, &error.to_string());
    };
    let made = class_and_facts(py, source).map(|(class, facts)| {
        let fields_of_pose = || {
            facts.set_item("sample", *sample)?;
            facts.set_item("azimuth_rad", *azimuth)?;
            facts.set_item("tilt_rad", *tilt_angle)?;
            Ok(facts)
        };
        let message = format!(
            "sample {sample} (azimuth {azimuth} rad, tilt angle {tilt_angle} rad): {source}"
        );
        new(py, class, &message, fields_of_pose())
    });
    made.unwrap_or_else(|failed| failed)
}

/// An error of a folder of parts.
pub(crate) fn parts(py: Python<'_>, error: &PartsError) -> PyErr {
    let message = error.to_string();
    match error {
        PartsError::Missing { missing, parts, first } => {
            let facts = || Ok(fields!(py; missing = *missing, parts = *parts, first = *first));
            new(py, "MissingPartsError", &message, facts())
        }
        PartsError::Study(found) => study(py, found),
        _ => new(py, "PartsError", &message, Ok(PyDict::new(py))),
    }
}

/// Error for a configuration of a mechanism beyond joint limits, with the result that has it.
pub(crate) fn beyond_limits(
    py: Python<'_>,
    limits: &[jointplay::report::LimitReport],
    result: &Bound<'_, PyAny>,
) -> PyErr {
    let messages: Vec<&str> = limits.iter().map(|limit| limit.message.as_str()).collect();
    let message = format!("beyond joint limits: {}", messages.join("; "));
    let facts = || {
        let names: Vec<&str> = limits.iter().map(|limit| limit.limit.as_str()).collect();
        Ok(fields!(py; limits_broken = names, result = result))
    };
    new(py, "JointLimitsError", &message, facts())
}

/// Error for a program without a trajectory, with line, column and message of each reason.
pub(crate) fn planning(py: Python<'_>, label: &str, reasons: &[(usize, usize, String)]) -> PyErr {
    let lines: Vec<String> = reasons
        .iter()
        .map(|(line, column, message)| format!("{label}:{line}:{column}: {message}"))
        .collect();
    let facts = || {
        let reasons = PyTuple::new(py, reasons.iter().cloned())?;
        Ok(fields!(py; file = label, reasons = reasons))
    };
    new(py, "PlanningError", &lines.join("\n"), facts())
}

/// An internal error.
pub(crate) fn internal(message: &str) -> PyErr {
    PyException::new_err(format!("a bug of jointplay, please report it: {message}"))
}
