//! Conditions on the numbers, names and indices of descriptions.

use std::collections::BTreeSet;

use jointplay_core::spatial::Pose;

use crate::CellError;

/// Largest length in a description (m).
pub(crate) const MAX_LENGTH: f64 = 1e9;

pub(crate) fn finite(what: String, value: f64) -> Result<f64, CellError> {
    if value.is_finite() { Ok(value) } else { Err(CellError::NotFinite { what, value }) }
}

pub(crate) fn positive(what: String, value: f64, unit: &'static str) -> Result<(), CellError> {
    if finite(what.clone(), value)? > 0.0 {
        Ok(())
    } else {
        Err(CellError::NotPositive { what, value, unit })
    }
}

pub(crate) fn in_range(
    what: String,
    value: f64,
    min: f64,
    max: f64,
    unit: &'static str,
) -> Result<(), CellError> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(CellError::OutOfRange { what, value, min, max, unit })
    }
}

pub(crate) fn count(what: &str, found: usize, min: usize, max: usize) -> Result<(), CellError> {
    if (min..=max).contains(&found) {
        Ok(())
    } else {
        Err(CellError::Count { what: what.to_owned(), found, min, max })
    }
}

/// Checks that names are unique; the error has the index of a name that is empty or repeated.
pub(crate) fn unique<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a String>,
) -> Result<(), (usize, CellError)> {
    let mut known = BTreeSet::new();
    for (index, name) in names.enumerate() {
        if name.trim().is_empty() {
            return Err((index, CellError::NoName { what: format!("one of the {what}") }));
        }
        if !known.insert(name) {
            return Err((index, CellError::NameTwice { what, name: name.clone() }));
        }
    }
    Ok(())
}

/// Checks that a number is finite and not negative.
pub(crate) fn not_negative(what: String, value: f64, unit: &'static str) -> Result<(), CellError> {
    in_range(what, value, 0.0, f64::MAX, unit)
}

/// Checks that lengths are finite and at most [`MAX_LENGTH`].
pub(crate) fn lengths(what: &str, values: &[f64]) -> Result<(), CellError> {
    let check = |&value| in_range(what.to_owned(), value, -MAX_LENGTH, MAX_LENGTH, "m");
    values.iter().try_for_each(check)
}

/// Checks that the numbers of a pose are finite.
pub(crate) fn pose(what: &str, pose: &Pose) -> Result<(), CellError> {
    lengths(&format!("the position of {what}"), pose.translation.vector.as_slice())?;
    let rotation = pose.rotation.matrix();
    rotation.iter().try_for_each(|&value| {
        finite(format!("an entry of the rotation matrix of {what}"), value).map(|_| ())
    })
}

/// Checks that an index exists.
pub(crate) fn index(
    what: &str,
    kind: &'static str,
    index: usize,
    length: usize,
) -> Result<(), CellError> {
    if index < length {
        return Ok(());
    }
    let max = length.saturating_sub(1);
    Err(CellError::NoSuch { what: what.to_owned(), kind, index, min: 0, max })
}
