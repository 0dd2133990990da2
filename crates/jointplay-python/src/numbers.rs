//! Plain numbers of Python, read the quick way.

use numpy::prelude::*;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList, PyTuple};

use crate::arrays::numbers_of_shape;

/// A number that is one to Python too, and no array of one entry.
pub(crate) fn number(given: &Bound<'_, PyAny>) -> Option<f64> {
    // Neither truth values, which are whole numbers to Python.
    let is_number = given.is_instance_of::<PyFloat>() || given.is_exact_instance_of::<PyInt>();
    if is_number { given.extract().ok() } else { None }
}

/// Three plain numbers, the quick way; `None` for anything else.
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
