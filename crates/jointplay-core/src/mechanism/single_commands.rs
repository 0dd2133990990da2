//! Commands of single joints that virtual joints make possible.

use nalgebra::DVector;

use super::relief::size_in_metric;
use super::small_commands::{Commands, SMALL_COMMAND};
use super::{CommandedJoints, Mechanism, MechanismSystem, ReliefSolver, relieve};
use crate::Error;
use crate::constraint::System as _;

/// A displacement of one commanded coordinate from home to either side, with the other ones held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleCommand {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Displacement to either side (m or rad).
    pub by: f64,
    /// The larger of the two displacements of the virtual joints, in the metric (m); `None` where a side is not possible.
    pub size: Option<f64>,
}

/// Displacements of single motors, or of the commanded coordinates of a mechanism without motors, by which sets of virtual joints are compared.
///
/// Each is as large as the largest command to a coordinate of its dimension, or [`SMALL_COMMAND`].
///
/// # Arguments
/// * `home` – (f) closed coordinates without virtual joints (m, rad)
///
/// # Errors
/// Those of [`MechanismSystem::new`].
pub fn single_displacements(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    Commands { commanded, values }: &Commands,
) -> Result<Vec<(usize, f64)>, Error> {
    let motors = mechanism.actuated_coordinates();
    let moved = if motors.is_empty() { commanded } else { &motors };
    let system = MechanismSystem::new(mechanism, home.clone())?;
    let (length, dimensions) = (system.characteristic_length(), system.kinematics().dimensions());
    let largest = |k: usize| {
        let same = (0..commanded.len()).filter(|&n| dimensions[commanded[n]] == dimensions[k]);
        same.flat_map(|n| values.iter().map(move |c| (c[n] - home[commanded[n]]).abs()))
            .fold(0.0, f64::max)
    };
    let displacement = |&k: &usize| match largest(k) {
        0.0 => (k, SMALL_COMMAND * dimensions[k].unit(length)),
        by => (k, by),
    };
    Ok(moved.iter().map(displacement).collect())
}

/// Displacements of the virtual joints of a mechanism for displacements of single coordinates.
///
/// # Arguments
/// * `home` – (f) closed coordinates without virtual joints (m, rad)
/// * `displacements` – commanded coordinates, each with the displacement to either side (m or rad)
///
/// # Errors
/// Those of [`relieve`] and [`CommandedJoints::new`], except where a command is not possible.
pub fn single_commands(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    displacements: &[(usize, f64)],
) -> Result<Vec<SingleCommand>, Error> {
    let count = mechanism.virtual_joints().len();
    let at_home = home.clone().resize_vertically(home.len() + count, 0.0);
    let at_home = MechanismSystem::new(mechanism, at_home)?;
    let coordinates: Vec<usize> = displacements.iter().map(|&(k, _)| k).collect();
    let commanded = CommandedJoints::new(&at_home, &coordinates)?;
    let needed = |k: usize, by: f64| {
        let values = coordinates.iter().map(|&j| home[j] + if j == k { by } else { 0.0 });
        let system = commanded.system(mechanism, values)?;
        match relieve(&system, &commanded, ReliefSolver::LeastNorm) {
            Ok(found) => Ok(Some(size_in_metric(&system, &found.virtual_joints))),
            Err(Error::NotRelieved { .. } | Error::NotLeast { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    };
    let mut found = Vec::with_capacity(displacements.len());
    for &(coordinate, by) in displacements {
        let sides = [needed(coordinate, by)?, needed(coordinate, -by)?];
        let size = match sides {
            [Some(one), Some(other)] => Some(one.max(other)),
            _ => None,
        };
        found.push(SingleCommand { coordinate, by, size });
    }
    Ok(found)
}
