//! Closed configurations of a mechanism for commanded coordinates.

use jointplay::Error;
use jointplay::mechanism::{
    Closure, DrivePath, DrivenMotion, MechanismSystem, Relief, SparseSystem, close_commanded,
    drive_along, drive_relieved, pose_commanded, relieve_commanded,
};
use jointplay::nalgebra::DVector;

use crate::mechanism::PyMechanism;

impl PyMechanism {
    /// Whether the mechanism is small enough for dense algebra.
    pub(crate) fn is_dense(&self) -> bool {
        MechanismSystem::fits(&self.file.mechanism)
    }

    /// The closed configuration nearest the guesses, with these coordinates held.
    pub(crate) fn assembled(
        &self,
        commands: &[(usize, f64)],
        tolerance: Option<f64>,
    ) -> Result<Closure, Error> {
        close_commanded(&self.file.mechanism, commands, tolerance)
    }

    /// The closed configuration with these coordinates held, by virtual joints where it takes them.
    pub(crate) fn posed(
        &self,
        commands: &[(usize, f64)],
        tolerance: Option<f64>,
    ) -> Result<Closure, Error> {
        Ok(pose_commanded(&self.file.mechanism, commands, tolerance)?.closed)
    }

    /// Least displacement of the virtual joints that makes the commanded coordinates possible.
    pub(crate) fn relieved(&self, commands: &[(usize, f64)]) -> Result<Relief, Error> {
        relieve_commanded(&self.file.mechanism, commands, None)
    }

    /// Drives along a path: by dense algebra with virtual joints, or by sparse algebra if there are many loops.
    pub(crate) fn along(
        &self,
        from: &DVector<f64>,
        path: &DrivePath,
        held: &[usize],
        steps: usize,
    ) -> Result<DrivenMotion, Error> {
        let mechanism = &self.file.mechanism;
        if !self.is_dense() {
            let system = SparseSystem::new(mechanism, from.clone())?;
            return system.drive_along(path, held, steps, &mut |_| ());
        }
        let driven = path.coordinates();
        let free: Vec<usize> = (0..mechanism.joint_freedoms())
            .filter(|k| !driven.contains(k) && !held.contains(k))
            .collect();
        let system = MechanismSystem::new(mechanism, from.clone())?;
        if mechanism.virtual_joints().is_empty() {
            drive_along(&system, path, &free, steps, &mut |_| ())
        } else {
            let home = MechanismSystem::new(mechanism, self.assembled(&[], None)?.coordinates)?;
            drive_relieved(&home, &system, path, &free, steps, &mut |_| ())
        }
    }
}
