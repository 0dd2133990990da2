//! Conditions that the description of a wafer has to fulfil.

use super::model::Wafer;
use crate::CellError;
use crate::conditions::{MAX_LENGTH, in_range, positive};

/// Least diameter of a thin plate, in thicknesses.
const THIN: f64 = 10.0;

impl Wafer {
    /// Checks that dimensions and properties are positive and finite, and that the wafer is a thin plate.
    ///
    /// # Errors
    /// [`CellError::NotFinite`], [`CellError::NotPositive`], [`CellError::OutOfRange`], [`CellError::NotThin`]
    pub fn validate(&self) -> Result<(), CellError> {
        let Self { diameter, thickness, ref material } = *self;
        for (what, value, unit) in [
            ("the diameter of the wafer", diameter, "m"),
            ("the thickness of the wafer", thickness, "m"),
            ("Young's modulus of the wafer", material.young, "Pa"),
            ("the density of the wafer", material.density, "kg/m³"),
        ] {
            positive(what.to_owned(), value, unit)?;
        }
        in_range("the diameter of the wafer".to_owned(), diameter, 0.0, MAX_LENGTH, "m")?;
        let what = "Poisson's ratio of the wafer".to_owned();
        in_range(what, material.poisson, -0.99, 0.49, "")?;
        check_thin_plate(thickness, diameter)
    }
}

/// Checks that a wafer is a thin plate.
///
/// # Arguments
/// * `thickness` – (m)
/// * `diameter` – (m)
///
/// # Errors
/// [`CellError::NotThin`]
pub fn check_thin_plate(thickness: f64, diameter: f64) -> Result<(), CellError> {
    let allowed = diameter / THIN;
    if thickness > allowed {
        return Err(CellError::NotThin { diameter, thickness, allowed });
    }
    Ok(())
}
