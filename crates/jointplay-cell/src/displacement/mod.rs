//! Displacement of a wafer by the tilt of the platform and by what else moves it, and the uncertainty of its position.

mod cause;
mod contribution;
mod effects;
mod tolerances;
mod wafer_displacement;

pub use cause::{Basis, Cause};
pub use contribution::{Bound, Contribution};
pub use effects::{ParameterEffect, parameter_effects};
pub use tolerances::Tolerances;
pub use wafer_displacement::{NominalShift, PlacedWafer, WaferDisplacement, lever_shift};
