//! Arrays of NumPy: read without copying where they lie in order, and written in place.

use jointplay::bulk::Column;
use numpy::prelude::*;
use numpy::{
    BorrowError, PyArray, PyArray1, PyArray2, PyArrayDyn, PyReadonlyArrayDyn, PyReadwriteArray1,
    PyUntypedArray,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors;
use crate::skin::fields;

/// Rows as a two-dimensional array.
pub(crate) fn matrix<const N: usize, const M: usize>(
    py: Python<'_>,
    rows: [[f64; M]; N],
) -> Bound<'_, PyArray2<f64>> {
    PyArray2::from_array(py, &numpy::ndarray::arr2(&rows))
}

fn array_error(py: Python<'_>, class: &str, message: &str, found: &Bound<'_, PyAny>) -> PyErr {
    let facts = || {
        let shape = found.getattr("shape").ok();
        let dtype = found.getattr("dtype").ok();
        Ok(fields!(py; shape = shape, dtype = dtype))
    };
    errors::new(py, class, message, facts())
}

/// Real numbers as an array of `float64` in this machine's byte order.
///
/// # Errors
/// `ArrayTypeError` for anything but whole and floating-point numbers.
pub(crate) fn real<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
    expected: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if let Ok(array) = given.cast::<PyArrayDyn<f64>>() {
        return Ok(array.clone());
    }
    let py = given.py();
    let numpy = py.import("numpy")?;
    let refused = |found: &str, array: &Bound<'py, PyAny>| {
        let message = format!(
            "{what} has to be {expected}, of dtype float64 or whole numbers; {found} cannot be taken as that"
        );
        array_error(py, "ArrayTypeError", &message, array)
    };
    let array = match numpy.call_method1("asarray", (given,)) {
        Ok(array) => array,
        // Rows of different lengths.
        Err(error) if error.is_instance_of::<pyo3::exceptions::PyValueError>(py) => {
            let refused = refused(&format!("{} ({error})", given.get_type().name()?), given);
            refused.set_cause(py, Some(error));
            return Err(refused);
        }
        Err(error) => return Err(error),
    };
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "i" | "u" | "f") {
        let untyped = array.cast::<PyUntypedArray>()?;
        let found =
            format!("an array of shape {} and dtype {}", array.getattr("shape")?, untyped.dtype());
        return Err(refused(&found, &array));
    }
    Ok(array.call_method1("astype", (numpy.getattr("float64")?,))?.cast_into()?)
}

/// The numbers of an array of exactly this shape, in C order.
pub(crate) fn numbers_of_shape(
    given: &Bound<'_, PyAny>,
    what: &str,
    shape: &[usize],
) -> PyResult<Vec<f64>> {
    let dimensions: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let expected = format!("an array of shape ({}{comma})", dimensions.join(", "));
    let array = real(given, what, &expected)?;
    if array.shape() != shape {
        let message = format!("{what} has to be {expected}, not {}", array.getattr("shape")?);
        return Err(array_error(given.py(), "ArrayError", &message, array.as_any()));
    }
    let array = array.try_readonly().map_err(|error| borrowed(given.py(), what, error))?;
    Ok(array.as_array().iter().copied().collect())
}

/// Numbers of an array with one axis.
pub(crate) fn row(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
    let array = real(given, what, "an array of shape (n,)")?;
    if array.ndim() != 1 {
        let message =
            format!("{what} has to be an array of shape (n,), not {}", array.getattr("shape")?);
        return Err(array_error(given.py(), "ArrayError", &message, array.as_any()));
    }
    numbers_of_shape(array.as_any(), what, array.shape())
}

fn borrowed(py: Python<'_>, what: &str, error: BorrowError) -> PyErr {
    let message = match error {
        BorrowError::NotWriteable => format!("{what} is read-only, but has to be written to"),
        _ => format!(
            "{what} shares memory with another array of this call; give arrays that do not overlap"
        ),
    };
    errors::new(py, "ArrayError", &message, Ok(PyDict::new(py)))
}

/// An array in C order, or in one piece otherwise where it has two dimensions.
fn in_one_piece<'py>(array: Bound<'py, PyArrayDyn<f64>>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let aligned: bool = array.getattr("flags")?.getattr("aligned")?.extract()?;
    if aligned && (array.is_c_contiguous() || (array.is_fortran_contiguous() && array.ndim() <= 2))
    {
        return Ok(array);
    }
    let numpy = array.py().import("numpy")?;
    let copied = numpy.call_method1("array", (array, "float64"))?;
    Ok(numpy.call_method1("ascontiguousarray", (copied,))?.cast_into()?)
}

/// Three numbers for each of many poses, an array of shape (…, 3) that may be read.
pub(crate) struct Triples<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    by_columns: bool,
    /// Shape of the poses.
    pub(crate) shape: Vec<usize>,
}

impl<'py> Triples<'py> {
    pub(crate) fn read(given: &Bound<'py, PyAny>, what: &str, expected: &str) -> PyResult<Self> {
        let py = given.py();
        let array = real(given, what, expected)?;
        let Some((&3, shape)) = array.shape().split_last() else {
            let message =
                format!("{what} has to be {expected}, not of shape {}", array.getattr("shape")?);
            return Err(array_error(py, "ArrayError", &message, array.as_any()));
        };
        let shape = shape.to_vec();
        let array = in_one_piece(array)?;
        let by_columns = !array.is_c_contiguous();
        let array = array.try_readonly().map_err(|error| borrowed(py, what, error))?;
        Ok(Self { array, by_columns, shape })
    }

    pub(crate) fn poses(&self) -> usize {
        self.shape.iter().product()
    }

    /// The three columns.
    pub(crate) fn columns(&self) -> PyResult<[Column<'_>; 3]> {
        let values = self.array.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        let poses = self.poses();
        let column = |k: usize| {
            if poses == 0 {
                return Ok(Column::from(&values[..0]));
            }
            if self.by_columns {
                return Ok(Column::from(&values[k * poses..(k + 1) * poses]));
            }
            Column::strided(&values[k..], 3, poses)
                .map_err(|error| errors::internal(&error.to_string()))
        };
        Ok([column(0)?, column(1)?, column(2)?])
    }
}

/// Numbers that are spread over each other's shapes.
pub(crate) struct Spread<'py> {
    arrays: Vec<PyReadonlyArrayDyn<'py, f64>>,
    /// Shape of the poses.
    pub(crate) shape: Vec<usize>,
}

impl<'py> Spread<'py> {
    /// # Arguments
    /// * `given` – each with what it is, such as `azimuth_rad`
    pub(crate) fn read(py: Python<'py>, given: &[(&str, &Bound<'py, PyAny>)]) -> PyResult<Self> {
        let mut arrays = Vec::with_capacity(given.len());
        for (what, given) in given {
            arrays.push((*what, real(given, what, "a number or an array of numbers")?));
        }
        let numpy = py.import("numpy")?;
        let shapes = arrays.iter().map(|(_, array)| array.getattr("shape"));
        let shapes = PyTuple::new(py, shapes.collect::<PyResult<Vec<_>>>()?)?;
        let shape = numpy.call_method1("broadcast_shapes", &shapes).map_err(|_| {
            let described: Vec<String> = arrays
                .iter()
                .zip(&shapes)
                .map(|((what, _), shape)| format!("{what} {shape}"))
                .collect();
            let message = format!(
                "the shapes do not fit each other: {}; each has to be a number or broadcast against the others",
                described.join(", ")
            );
            errors::new(py, "ArrayError", &message, Ok(PyDict::new(py)))
        })?;
        let poses: Vec<usize> = shape.extract()?;
        let arrays = arrays.into_iter().map(|(what, array)| {
            let array = if array.len() == 1 || array.shape() == poses {
                array
            } else {
                numpy.call_method1("broadcast_to", (array, &shape))?.cast_into()?
            };
            let flat = if array.len() == 1 || array.is_c_contiguous() {
                array
            } else {
                numpy.call_method1("ascontiguousarray", (array,))?.cast_into()?
            };
            in_one_piece(flat)?.try_readonly().map_err(|error| borrowed(py, what, error))
        });
        Ok(Self { arrays: arrays.collect::<PyResult<_>>()?, shape: poses })
    }

    pub(crate) fn poses(&self) -> usize {
        self.shape.iter().product()
    }

    pub(crate) fn columns(&self) -> PyResult<Vec<Column<'_>>> {
        let poses = self.poses();
        let mut columns = Vec::with_capacity(self.arrays.len());
        for array in &self.arrays {
            let values = array.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
            columns.push(match values {
                _ if poses == 0 => Column::from(&values[..0]),
                [value] => Column::constant(value, poses),
                values => Column::from(values),
            });
        }
        Ok(columns)
    }
}

/// An array of results, laid out so that each of its columns is in one piece.
pub(crate) struct Output<'py> {
    /// The array as handed out: shape of the poses, then columns, if it has several.
    pub(crate) array: Bound<'py, PyAny>,
    /// `None` where there is nothing to write: arrays without entries all lie in one place.
    columns: Vec<Option<PyReadwriteArray1<'py, f64>>>,
}

impl<'py> Output<'py> {
    /// A new array, zero until it is written.
    pub(crate) fn new(py: Python<'py>, shape: &[usize], columns: Option<usize>) -> PyResult<Self> {
        let mut all = Vec::with_capacity(shape.len() + 1);
        all.extend(columns);
        all.extend_from_slice(shape);
        let array = PyArray::<f64, _>::zeros(py, all, false);
        let array = match columns {
            None => array.into_any(),
            // Columns first in memory, last in the shape.
            Some(_) => py.import("numpy")?.call_method1("moveaxis", (array, 0, -1))?,
        };
        Self::over(array, "a new array", columns)
    }

    /// An array of the caller's, to be written in place.
    pub(crate) fn given(
        given: &Bound<'py, PyAny>,
        what: &str,
        shape: &[usize],
        columns: Option<usize>,
    ) -> PyResult<Self> {
        let py = given.py();
        let mut expected = shape.to_vec();
        expected.extend(columns);
        let expected_shape = PyTuple::new(py, &expected)?;
        let Ok(array) = given.cast::<PyArrayDyn<f64>>() else {
            let message = format!(
                "{what} has to be an array of shape {expected_shape} and dtype float64 to be written in place, not {}",
                described(given)?
            );
            return Err(array_error(py, "ArrayTypeError", &message, given));
        };
        if array.shape() != expected {
            let message = format!(
                "{what} has to be of shape {expected_shape}, not {}",
                array.getattr("shape")?
            );
            return Err(array_error(py, "ArrayError", &message, given));
        }
        Self::over(array.clone().into_any(), what, columns)
    }

    fn over(array: Bound<'py, PyAny>, what: &str, columns: Option<usize>) -> PyResult<Self> {
        let py = array.py();
        let one = |column: Bound<'py, PyAny>| -> PyResult<Option<PyReadwriteArray1<'py, f64>>> {
            if column.getattr("size")?.extract::<usize>()? == 0 {
                return Ok(None);
            }
            let contiguous: bool = column.getattr("flags")?.getattr("c_contiguous")?.extract()?;
            if !contiguous {
                let message = format!(
                    "{what} is not in one piece column by column; make it with np.empty(shape, order=\"F\"){}",
                    if columns.is_some() { "" } else { " or np.empty(n)" }
                );
                return Err(array_error(py, "ArrayError", &message, &array));
            }
            // A view, whatever the number of dimensions: the column is in one piece.
            let flat = column.call_method1("reshape", (-1,))?.cast_into::<PyArray1<f64>>()?;
            flat.try_readwrite().map(Some).map_err(|error| borrowed(py, what, error))
        };
        let columns = match columns {
            None => vec![one(array.clone())?],
            Some(count) => (0..count)
                .map(|k| one(array.get_item((py.Ellipsis(), k))?))
                .collect::<PyResult<_>>()?,
        };
        Ok(Self { array, columns })
    }

    /// The columns, to be written.
    pub(crate) fn slices(&mut self) -> PyResult<Vec<&mut [f64]>> {
        self.columns.iter_mut().map(slice).collect()
    }
}

fn slice<'a>(column: &'a mut Option<PyReadwriteArray1<'_, f64>>) -> PyResult<&'a mut [f64]> {
    column.as_mut().map_or(Ok(&mut []), |column| {
        column.as_slice_mut().map_err(|error| errors::internal(&error.to_string()))
    })
}

fn described(given: &Bound<'_, PyAny>) -> PyResult<String> {
    match given.cast::<PyUntypedArray>() {
        Ok(array) => Ok(format!("shape {} and dtype {}", given.getattr("shape")?, array.dtype())),
        Err(_) => Ok(given.get_type().name()?.to_string()),
    }
}
