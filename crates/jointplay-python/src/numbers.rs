//! Fast conversion of plain Python numbers.

use std::ops::RangeInclusive;

use numpy::prelude::*;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList, PyTuple};

use crate::arrays::numbers_of_shape;
use crate::errors;

/// A number that is one to Python too, and no array of one entry.
pub(crate) fn number(given: &Bound<'_, PyAny>) -> Option<f64> {
    // Neither truth values, which are whole numbers to Python.
    let is_number = given.is_instance_of::<PyFloat>() || given.is_exact_instance_of::<PyInt>();
    if is_number { given.extract().ok() } else { None }
}

/// Three plain numbers, converted fast; `None` for anything else.
pub(crate) fn three(given: &Bound<'_, PyAny>) -> Option<[f64; 3]> {
    if let Ok(tuple) = given.cast::<PyTuple>() {
        if tuple.len() != 3 {
            return None;
        }
        let entry = |k| number(&*tuple.get_borrowed_item(k).ok()?);
        return Some([entry(0)?, entry(1)?, entry(2)?]);
    }
    if let Ok(list) = given.cast::<PyList>() {
        if list.len() != 3 {
            return None;
        }
        let entry = |k| number(&list.get_item(k).ok()?);
        return Some([entry(0)?, entry(1)?, entry(2)?]);
    }
    let array = given.cast::<PyArray1<f64>>().ok()?;
    if array.len() != 3 {
        return None;
    }
    let array: PyReadonlyArray1<'_, f64> = array.try_readonly().ok()?;
    let array = array.as_array();
    Some([array[0], array[1], array[2]])
}

/// The rods of one pose.
pub(crate) fn one_triple(given: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    if let Some(rods) = three(given) {
        return Ok(rods);
    }
    let rods = numbers_of_shape(given, "rods_m", &[3])?;
    Ok([rods[0], rods[1], rods[2]])
}

/// A number, for arguments of functions.
///
/// # Errors
/// `NotFiniteError` for a whole number that no `float` holds.
pub(crate) fn real(given: &Bound<'_, PyAny>) -> PyResult<f64> {
    given.extract::<f64>().map_err(|error| too_large(given.py(), error, "a number given"))
}

/// A number or `None`, for arguments of functions.
///
/// # Errors
/// As [`real`].
pub(crate) fn optional_real(given: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if given.is_none() { Ok(None) } else { real(given).map(Some) }
}

/// A number by its name, which has to be finite.
///
/// # Errors
/// `NotFiniteError`; `ArgumentTypeError` for anything but numbers.
pub(crate) fn finite(given: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    let py = given.py();
    let value = given.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<PyTypeError>(py) {
            errors::argument_type(given, name, "a number")
        } else {
            too_large(py, error, name)
        }
    })?;
    if value.is_finite() { Ok(value) } else { Err(errors::not_finite(py, name, value)) }
}

/// A whole number within a range, by its name.
///
/// # Errors
/// `InputError` beyond the range, `ArgumentTypeError` for anything but whole numbers.
pub(crate) fn count(
    given: &Bound<'_, PyAny>,
    name: &str,
    range: RangeInclusive<usize>,
) -> PyResult<usize> {
    let py = given.py();
    match given.extract::<usize>() {
        Ok(count) if range.contains(&count) => Ok(count),
        Err(error) if error.is_instance_of::<PyTypeError>(py) => {
            Err(errors::argument_type(given, name, "a whole number"))
        }
        Err(error) if !error.is_instance_of::<PyOverflowError>(py) => Err(error),
        _ => {
            let (least, most) = range.into_inner();
            let found = given.str()?.to_string();
            let found = if found.len() > 20 { "a number of many digits".to_owned() } else { found };
            let message = format!("{name} has to be from {least} to {most}, got {found}");
            Err(errors::input(py, &message))
        }
    }
}

/// A whole number beyond all `float`s as an error of the package; other errors as they are.
fn too_large(py: Python<'_>, error: PyErr, what: &str) -> PyErr {
    if error.is_instance_of::<PyOverflowError>(py) {
        return errors::not_finite(py, what, f64::INFINITY);
    }
    error
}
