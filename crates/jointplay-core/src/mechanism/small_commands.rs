//! Small displacements of the actuators, for searches without a given command.

use nalgebra::DVector;

use super::{Mechanism, MechanismSystem};
use crate::Error;
use crate::constraint::System;

/// Displacement of an actuator by default: in radians, or as a share of the characteristic length.
pub const SMALL_COMMAND: f64 = 0.05;

/// Commands to the same coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Commands {
    /// Indices of the commanded coordinates.
    pub commanded: Vec<usize>,
    /// Values of the commanded coordinates, for each command (m, rad).
    pub values: Vec<DVector<f64>>,
}

/// One command for each actuated coordinate: displaced by [`SMALL_COMMAND`], with the others held; `None` without actuators.
///
/// # Arguments
/// * `home` – (f + M) a closed configuration (m, rad)
///
/// # Errors
/// Those of [`MechanismSystem::new`].
pub fn small_commands(
    mechanism: &Mechanism,
    home: &DVector<f64>,
) -> Result<Option<Commands>, Error> {
    let system = MechanismSystem::new(mechanism, home.clone())?;
    let commanded = mechanism.actuated_coordinates();
    if commanded.is_empty() {
        return Ok(None);
    }
    let length = system.characteristic_length();
    let at_home = DVector::from_iterator(commanded.len(), commanded.iter().map(|&k| home[k]));
    let command = |(n, &k): (usize, &usize)| {
        let mut command = at_home.clone();
        command[n] += SMALL_COMMAND * system.kinematics().dimensions()[k].unit(length);
        command
    };
    let values = commanded.iter().enumerate().map(command).collect();
    Ok(Some(Commands { commanded, values }))
}
